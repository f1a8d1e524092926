"""Export the agent's two networks as programs that run without this package's code.

``program.pt2`` contains both networks, exported by ``torch.export``. ``perceive`` maps the frames
of panoramas to view tokens and waypoint logits. ``decide`` maps the instruction, the view tokens of
all panoramas so far and the topological map to logits over [stop], nodes and ghosts. :data:`INPUTS`
describes every input tensor. The folder's ``program.json`` contains the same description and the
vocabulary. :func:`save_onnx` writes the same two networks as ONNX files (extra ``onnx``).
"""

from __future__ import annotations

import io
import statistics
import time
from collections import defaultdict
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn
from torch.export import Dim, ExportedProgram

# this module is private, but it can store several programs in one file
from torch.export.pt2_archive._package import load_pt2, package_pt2
from torch.func import functional_call

from mitigate.agents.text import MAX_WORDS
from mitigate.agents.topological import TopologicalAgent
from mitigate.agents.topological.mapping import GEOMETRY, SIGHTINGS
from mitigate.agents.topological.planner import DecisionBatch
from mitigate.core.files import write_bytes
from mitigate.core.observation import VIEWS
from mitigate.core.seeding import torch_generator

PERCEIVE, DECIDE = "perceive", "decide"
OUTPUTS = {PERCEIVE: ("views", "waypoints"), DECIDE: ("logits",)}
INPUTS = {  # maps the name of each input to its dtype, shape and meaning
    PERCEIVE: {
        "rgb": ("uint8", "[P, 12, size, size, 3]", "view k looks 30 k degrees right"),
        "depth": ("float32", "[P, 12, size, size, 1]", "metres; 0 or not finite: no reading"),
    },
    DECIDE: {
        "tokens": ("int64", "[E, L]", "word ids of E instructions, padded with 0"),
        "views": ("float32", "[P, 12, width]", "of `perceive`, of all panoramas so far"),
        "episode": ("int64", "[B]", "row of tokens of each decision"),
        "panorama": ("int64", "[B]", "the current panorama, row of views"),
        "nodes": ("int64", "[B, N]", "panorama of each visited node, -1: padding"),
        "sightings": ("int64", "[B, G, 4]", "views that faced a ghost, panorama * 12 + k, or -1"),
        "geometry": ("float32", "[B, 1 + N + G, 12]", "place of [stop], nodes, ghosts; 0: padding"),
        "valid": ("bool", "[B, 1 + N + G]", "false: padding"),
        "allowed": ("bool", "[B, 1 + N + G]", "what may be chosen: [stop] and ghosts"),
    },
}
MEANINGS = {
    "views": "float32 [P, 12, width]: view tokens (with fusion, the view's weight as last channel)",
    "waypoints": "float32 [P, 120, 12]: logit that the way is free; angle a looks 3 a - 13.5 "
    "degrees right, distance d is 0.25 (d + 1) m",
    "logits": "float32 [B, 1 + N + G]: scores, -inf where not allowed",
}
TIMED = 20  # number of timed calls of each network


class Perceive(nn.Module):
    """The eager network ``perceive`` with the inputs in :data:`INPUTS`."""

    def __init__(self, agent: TopologicalAgent) -> None:
        super().__init__()
        self.agent = agent

    def forward(self, rgb: Tensor, depth: Tensor) -> tuple[Tensor, Tensor]:
        views, _, waypoints = self.agent.perceive(rgb, depth)
        return self.agent.planner.embed_views(views), waypoints


class Decide(nn.Module):
    """The eager network ``decide`` with the inputs in :data:`INPUTS`."""

    def __init__(self, agent: TopologicalAgent) -> None:
        super().__init__()
        self.planner = agent.planner

    def forward(
        self,
        tokens: Tensor,
        views: Tensor,
        episode: Tensor,
        panorama: Tensor,
        nodes: Tensor,
        sightings: Tensor,
        geometry: Tensor,
        valid: Tensor,
        allowed: Tensor,
    ) -> tuple[Tensor]:
        batch = DecisionBatch(episode, panorama, nodes, sightings, geometry, valid, allowed)
        return (self.planner(self.planner.read(tokens), views, batch)["logits"],)


class Stored(nn.Module):
    """Wrapper around ``network`` that stores a tensor as float16 if this loses no precision.

    Only tensors that the network uses are stored.
    """

    def __init__(self, network: nn.Module, inputs: tuple[Tensor, ...]) -> None:
        super().__init__()
        # The tuple hides the network from torch.
        # Only the buffers registered below are then exported.
        self._network = (network,)
        self._names = {name: name.replace(".", "__") for name in _used(network, inputs)}
        tensors = {**dict(network.named_parameters()), **dict(network.named_buffers())}
        for name, key in self._names.items():
            tensor = tensors[name].detach()
            half = tensor.half()
            lossless = torch.equal(half.float(), tensor.float())
            self.register_buffer(key, half if lossless else tensor)

    def forward(self, *inputs: Tensor) -> tuple[Tensor, ...]:
        tensors = {name: self.get_buffer(key).float() for name, key in self._names.items()}
        return functional_call(self._network[0], tensors, inputs)


def networks(agent: TopologicalAgent) -> dict[str, nn.Module]:
    """Return the two networks of ``agent`` in eager mode, by name. They share its weights."""
    return {PERCEIVE: Perceive(agent), DECIDE: Decide(agent)}


@torch.no_grad()
def export_programs(agent: TopologicalAgent, size: int) -> dict[str, ExportedProgram]:
    """Export both networks for views with a side of ``size`` pixels.

    The dimensions P, E, L, B, N and G in :data:`INPUTS` are dynamic and at least 1. L is at most
    ``MAX_WORDS``.
    """
    exported = {}
    inputs_by_name = probe(agent, size)
    for name, network in networks(agent).items():
        inputs = tuple(inputs_by_name[key] for key in INPUTS[name])
        # a tuple in a tuple, because Stored.forward has the single parameter *inputs
        shapes = (free_dimensions(name),)
        stored = Stored(network, inputs).eval()
        exported[name] = torch.export.export(stored, inputs, dynamic_shapes=shapes)
        exported[name].example_inputs = None  # the example inputs are not needed
        _drop_type_checks(exported[name])
        for node in exported[name].graph.nodes:  # stack traces contain paths of this machine
            node.meta.pop("stack_trace", None)
    return exported


def free_dimensions(name: str) -> tuple[dict[int, Any], ...]:
    """Return the dynamic dimensions of each input of a network, for ``torch.export``."""
    return tuple(_free(shape) for _, shape, _ in INPUTS[name].values())


def save_programs(programs: dict[str, ExportedProgram], file: Path) -> None:
    """Write both programs to one ``.pt2`` file; raise OSError if that fails.

    The content is first written to memory, because torch would crash the process if writing to disk
    failed.
    """
    with io.BytesIO() as packed:
        package_pt2(packed, exported_programs=programs)
        write_bytes(file, packed.getvalue())


def load_programs(file: Path) -> dict[str, Callable[..., tuple[Tensor, ...]]]:
    """Load the programs that :func:`save_programs` wrote, by name.

    Use it only for files that you trust: torch reads parts of such a file with pickle.
    """
    return {name: p.module() for name, p in load_pt2(str(file)).exported_programs.items()}


def probe(agent: TopologicalAgent, size: int) -> dict[str, Tensor]:
    """Return fixed inputs of both networks, one tensor per entry of :data:`INPUTS`.

    The inputs are three panoramas of random pixels, and two decisions, one of which has padding.
    """
    draw = torch_generator(0, "export probe", size)

    def integers(low: int, high: int, *shape: int) -> Tensor:
        return torch.randint(low, high, shape, generator=draw)

    p, b, n, g, words = 3, 2, 3, 4, 9
    valid = torch.ones(b, 1 + n + g, dtype=torch.bool)
    valid[1, [n, n + g]] = False
    allowed = valid.clone()
    allowed[:, 1 : 1 + n] = False
    return {
        "rgb": integers(0, 256, p, VIEWS, size, size, 3).to(torch.uint8),
        "depth": 5 * torch.rand(p, VIEWS, size, size, 1, generator=draw),
        "tokens": integers(1, len(agent.vocabulary), 2, words),
        "views": torch.randn(p, VIEWS, agent.planner.embedding_width, generator=draw),
        "episode": torch.arange(b),
        "panorama": torch.tensor([p - 1, p - 2]),
        "nodes": torch.tensor([[0, 1, 2], [0, 1, -1]]),
        "sightings": integers(-1, p * VIEWS, b, g, SIGHTINGS),
        "geometry": torch.randn(b, 1 + n + g, GEOMETRY, generator=draw),
        "valid": valid,
        "allowed": allowed,
    }


@torch.no_grad()
def outputs(programs: dict[str, Any], probe_inputs: dict[str, Tensor]) -> dict[str, Tensor]:
    """Run both networks, eager or exported, on the probe inputs; return the outputs by name.

    ``decide`` receives the view tokens that ``perceive`` returns. View tokens in the probe are not
    used.
    """
    results: dict[str, Tensor] = {}
    for name in (PERCEIVE, DECIDE):
        inputs = {**probe_inputs, **results}
        answers = programs[name](*(inputs[key] for key in INPUTS[name]))
        results |= zip(OUTPUTS[name], answers, strict=True)
    return results


def difference(one: dict[str, Tensor], two: dict[str, Tensor]) -> float:
    """Return the maximum absolute difference over all outputs.

    The difference is infinite if shapes differ, if an element is -inf in only one of the outputs,
    or if an output contains NaN.
    """
    gaps = [0.0]
    for name, a in one.items():
        b = two[name]
        if a.shape != b.shape or not torch.equal(a.isneginf(), b.isneginf()):
            return float("inf")
        gap = (a - b)[~a.isneginf()].abs()
        gaps.append(float("inf") if gap.isnan().any() else float(gap.max()))
    return max(gaps)


@torch.no_grad()
def latency(kinds: dict[str, dict[str, Any]], agent: TopologicalAgent, size: int) -> dict[str, Any]:
    """Measure the milliseconds per call of each network.

    Calls alternate between the variants of the networks, such as eager and exported. Each call to
    ``perceive`` processes one panorama. Each call to ``decide`` makes one decision among three
    nodes and four ghosts.

    Args:
        kinds: maps the name of a variant to its two networks, such as ``{"eager": networks(agent),
            "exported": ...}``.
        agent: the agent, for the probe.
        size: width of the views in pixels.

    Returns:
        Two measurements for each variant of each network. "wall" is the wall time of the fastest of
        ``TIMED`` calls. "cpu" is the median CPU time over all threads of this process. Other
        programs on the machine affect the CPU time less than the wall time.
    """
    inputs_by_name = probe(agent, size)
    single = {n: t if n == "views" else t[:1] for n, t in inputs_by_name.items()}
    times = defaultdict(list)
    for _ in range(3 + TIMED):  # the first three calls are a warm-up and are not counted
        for kind, programs in kinds.items():
            for name in (PERCEIVE, DECIDE):
                inputs = [single[key] for key in INPUTS[name]]
                wall, cpu = time.perf_counter(), time.process_time()
                programs[name](*inputs)
                spent = (time.perf_counter() - wall, time.process_time() - cpu)
                times[kind, name].append(spent)
    report: dict[str, Any] = {"threads": torch.get_num_threads(), "calls": TIMED}
    for (kind, name), seconds in times.items():
        walls, cpus = zip(*seconds[3:], strict=True)
        report.setdefault(kind, {})[name] = {
            "wall": round(1e3 * min(walls), 2),
            "cpu": round(1e3 * statistics.median(cpus), 2),
        }
    return report


def description(agent: TopologicalAgent, size: int) -> dict[str, Any]:
    """Return the content of ``program.json``: the inputs, the outputs and the vocabulary."""
    return {
        "size": size,
        "programs": {
            name: {
                "inputs": {
                    key: dict(zip(("dtype", "shape", "meaning"), entry, strict=True))
                    for key, entry in INPUTS[name].items()
                },
                "outputs": {key: MEANINGS[key] for key in OUTPUTS[name]},
            }
            for name in INPUTS
        },
        "words": list(agent.vocabulary),
        "most_words": MAX_WORDS,
    }


def _used(network: nn.Module, inputs: tuple[Tensor, ...]) -> list[str]:
    """Return the names of all buffers and of those parameters on which the outputs depend."""
    parameters = dict(network.named_parameters())
    before = {name: p.requires_grad for name, p in parameters.items()}
    network.requires_grad_(True)
    with torch.enable_grad():
        total = sum(out[torch.isfinite(out)].sum() for out in network(*inputs))
        grads = torch.autograd.grad(total, list(parameters.values()), allow_unused=True)
    for name, p in parameters.items():
        p.requires_grad_(before[name])
    used = [name for name, grad in zip(parameters, grads, strict=True) if grad is not None]
    return used + [name for name, _ in network.named_buffers()]


def _drop_type_checks(program: ExportedProgram) -> None:
    """Remove the checks of tensor types from the exported ``program``.

    A program contains more than a hundred of these checks, and none of them can fail.
    """
    graph = program.graph_module.graph
    for node in list(graph.nodes):
        if node.target is torch.ops.aten._assert_tensor_metadata.default:
            graph.erase_node(node)
    program.graph_module.recompile()


def _free(shape: str) -> dict[int, Any]:
    """Return the dynamic dimensions of a shape in :data:`INPUTS`.

    Dynamic dimensions are named by single letters or by sums that contain letters.
    """
    free: dict[int, Any] = {}
    for place, name in enumerate(shape.strip("[]").split(", ")):
        if "+" in name:
            free[place] = Dim.AUTO  # torch infers this dimension as 1 + N + G
        elif name.isupper():
            free[place] = Dim(name, min=1, max=MAX_WORDS if name == "L" else None)
    return free


# ONNX ---------------------------------------------------------------------------------------------


def save_onnx(agent: TopologicalAgent, size: int, folder: Path, most: float) -> None:
    """Write ``perceive.onnx`` and ``decide.onnx`` to ``folder``.

    The weights are float32. The dynamic dimensions are the same as in ``export_programs``. Raises
    ValueError if the extra ``onnx`` is not installed, or if :func:`check_onnx` fails.
    """
    try:
        import onnx  # noqa: F401
        import onnxruntime  # noqa: F401
        import onnxscript  # noqa: F401
    except ImportError as error:
        raise ValueError(
            f"ONNX files need the extra onnx ({error}): pip install -e '.[onnx]'."
        ) from error
    inputs = probe(agent, size)
    for name, network in networks(agent).items():
        torch.onnx.export(
            network.eval(),
            tuple(inputs[key] for key in INPUTS[name]),
            folder / f"{name}.onnx",
            dynamo=True,
            dynamic_shapes=free_dimensions(name),
            input_names=list(INPUTS[name]),
            output_names=list(OUTPUTS[name]),
            external_data=False,
            verbose=False,
        )
    check_onnx(folder, agent, size, most)


def check_onnx(folder: Path, agent: TopologicalAgent, size: int, most: float) -> None:
    """Raise ValueError if the outputs of the ONNX files in ``folder`` differ from the agent's.

    The probe inputs contain a batch of two decisions. The outputs are compared for this batch, and
    for only its first decision. Differences of at most ``most`` are allowed.
    """
    eager, probe_inputs = networks(agent), probe(agent, size)
    sessions = {name: _session(folder / f"{name}.onnx", INPUTS[name]) for name in eager}
    shared = ("rgb", "depth", "views")
    first = {name: t if name in shared else t[:1] for name, t in probe_inputs.items()}
    for inputs in (probe_inputs, first):
        gap = difference(outputs(eager, inputs), outputs(sessions, inputs))
        if not gap <= most:
            raise ValueError(
                f"The ONNX files differ from the agent by {gap:g}, more than {most:g}."
            )


def _session(file: Path, keys: Iterable[str]) -> Callable[..., tuple[Tensor, ...]]:
    """Return a function that runs the ONNX network in ``file`` like the original network."""
    import onnxruntime

    session = onnxruntime.InferenceSession(str(file))

    def run(*inputs: Tensor) -> tuple[Tensor, ...]:
        feed = {key: tensor.numpy() for key, tensor in zip(keys, inputs, strict=True)}
        return tuple(map(torch.from_numpy, session.run(None, feed)))

    return run
