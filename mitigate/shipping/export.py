"""Export the agent of a run as a folder for deployment.

``export_command.py`` has the command and describes the folder.
"""

from __future__ import annotations

import copy
import json
import os
import pickle
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
import yaml
from safetensors.torch import load_file, save_file
from torch import Tensor, nn

from mitigate.agents import adapters, loading
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import checkpoint, folders, settings
from mitigate.core.files import find, last_lines, write_json, write_text
from mitigate.core.json_files import read_object
from mitigate.core.names import short
from mitigate.core.output import output_folder
from mitigate.core.pretrained import PEFT_WEIGHTS
from mitigate.corruptions import CLEAN
from mitigate.evaluation import rows as result_rows
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.rows import Row
from mitigate.shipping import programs
from mitigate.shipping.card import facts, metrics, readme, weights_of
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

HARDENED = Path("checkpoints/hardened")
# The next three numbers are limits of the absolute difference between two outputs (heuristic).
# The outputs are computed from fixed probe inputs; logits are about 1 to 10.
# maximum difference between the agent that a new process loads and the agent in this process
RELOADED = 1e-5
EXPORTED = 1e-3  # maximum difference between program.pt2 or the ONNX files and the agent
ROUNDED = 0.1  # maximum difference between float16 weights and the float32 weights of the run
# maximum length in characters of the line that a message quotes from a failed check (heuristic)
REASON_WIDTH = 400
MOST_PIXELS = 4096  # maximum side of the frames that exported programs read, in pixels (heuristic)
# an agent without exported programs is checked on this number of episodes (heuristic)
WALKS = 2
_RUN = "import sys; from mitigate.shipping import export; export.{}(*sys.argv[1:])"
_TRAIN = "Run `make train` to the end, then name its folder (runs/...)."


@dataclass
class Walks:
    """Settings of a check that runs clean episodes with the exported agent in a new process."""

    # constructs the agent into which the exported weights are loaded
    make_agent: Callable[[], nn.Module]
    make_world: Callable[[], World]
    episodes: Sequence[Episode]  # the check runs the first ``WALKS``

    def measures(self, agent: Any) -> list[dict[str, Any]]:
        """Return the hash of the weights of ``agent``, and the measures of each episode."""
        world = self.make_world()
        results = [run_episode(agent.eval(), world, e, CLEAN, 0) for e in self.episodes[:WALKS]]
        return [{"weights": checkpoint.weights_sha(agent)}, *results]


def export(
    run: Path,
    name: str,
    *,
    out: Path = HARDENED,
    rows: Iterable[Path | str] = (),
    overwrite: bool = False,
    onnx: bool = False,
    walks: Walks | None = None,
) -> Path:
    """Write the agent of the finished run folder ``run`` to ``out/name`` and return that folder.

    Args:
        run: folder of a finished run.
        name: name of the new folder.
        out: folder that contains it.
        rows: files or folders with result rows of the agent, in addition to those in the run
            folder.
        overwrite: whether to replace ``out/name`` if an earlier export wrote it.
        onnx: whether to also write the two networks as ONNX files.
        walks: settings of a check that runs episodes, for agents that cannot be exported as
            programs (all classes except TopologicalAgent).

    Raises:
        FileNotFoundError: If ``run`` contains no finished run.
        ValueError: If the run cannot be exported, if ``rows`` has no rows of this agent, or if the
            agent loaded from the new folder gives different outputs. It is also raised if
            ``out/name`` exists, unless ``overwrite`` is true and an earlier export wrote it. After
            an error, nothing is written.
    """
    if not re.fullmatch(r"\w[\w.+-]*", name):
        raise ValueError(
            f"The name of the folder must consist of letters, digits and . _ + -, got {name!r}."
        )
    target = out / name
    _check_free(target, overwrite)
    if onnx and walks is not None:
        raise ValueError(
            "--onnx works only for the topological agent: other agents cannot be exported as "
            "programs."
        )
    cfg, agent = finished(run, walks)
    with output_folder(out, name), folders.replace_folder(target) as draft:
        _write(draft, target, run, cfg, agent, list(rows), onnx, walks)
    return target


def finished(run: Path, walks: Walks | None = None) -> tuple[dict[str, Any], Any]:
    """Return the config and the agent of the finished run in the folder ``run``.

    Raises FileNotFoundError if there is no finished run, and ValueError if it cannot be exported,
    if its agent needs ``walks``, or if its weights overflow in float16.
    """
    weights, config = run / "agent" / checkpoint.WEIGHTS, run / loading.CONFIG
    loading.reject_other_models(run)
    if (run / "agent" / PEFT_WEIGHTS).is_file():
        raise ValueError(
            f"{run / 'agent'} needs no export: it is a PEFT folder, which mitigate and PEFT load "
            "together with the base model (docs/vlm.md)."
        )
    if not (weights.is_file() and config.is_file()):
        inside = run.name == "agent" and (run / checkpoint.WEIGHTS).is_file()
        raise FileNotFoundError(
            f"{run} holds no finished run: it needs config.yaml and agent/{checkpoint.WEIGHTS}. "
            + (f"Name the run: {run.parent}." if inside else _TRAIN)
        )
    kind = loading.kind_of(config)
    if walks is None and kind != loading.TARGET:
        raise ValueError(
            f"{run} holds a {kind.rpartition('.')[2]}, which cannot be exported as programs. Its "
            "export is checked by running episodes, which needs walks=Walks(...) (on the command "
            f"line: agent={settings.named(kind)})."
        )
    agent = loading.build_from(config) if walks is None else walks.make_agent()
    checkpoint.load_weights(agent, weights)
    if walks is None and not all(
        torch.isfinite(value.half()).all() for value in agent.state_dict().values()
    ):
        raise ValueError(f"{weights} must be finite in float16, but some numbers are not.")
    return settings.read(config), agent.eval()


def add_programs(folder: Path) -> Path:
    """Export the agent in the hardened ``folder`` again, and replace its ``program.pt2``.

    The outputs of the program on the probe inputs are compared with the outputs of the agent.

    Returns:
        The path of the file.

    Raises:
        FileNotFoundError: If ``folder`` is not a complete hardened folder.
        ValueError: If the folder is damaged, if it was exported without programs, or if the outputs
            differ.
    """
    folder = find(folder)
    folders.repair_folder(folder.resolve())
    card = loading.check_hardened(folder)
    if not card.get("program", True):
        raise ValueError(
            f"{folder} was exported without programs. Only the topological agent can be exported "
            "as programs."
        )
    agent = loading.load_hardened(folder)
    size = _input_size(folder)
    exported = programs.export_programs(agent, size)
    probe = programs.probe(agent, size)
    modules = {name: program.module() for name, program in exported.items()}
    networks = programs.networks(agent)
    gap = programs.difference(programs.outputs(networks, probe), programs.outputs(modules, probe))
    if not gap <= EXPORTED:
        raise ValueError(f"The programs differ by {gap:g}; at most {EXPORTED:g} is allowed.")
    folder = folder.resolve()
    with folders.replace_folder(folder) as draft:
        shutil.copytree(folder, draft, dirs_exist_ok=True)
        programs.save_programs(exported, draft / loading.PROGRAM)
        folders.seal(draft, "hardened")
        loading.check_hardened(draft)
    return folder / loading.PROGRAM


def _input_size(folder: Path) -> int:
    """Return the side, in pixels, of the frames that the programs in ``folder`` read."""
    size = read_object(folder / loading.INPUTS, folders.AGAIN).get("size")
    if type(size) is not int or not 1 <= size <= MOST_PIXELS:
        raise ValueError(
            f"{folder / loading.INPUTS} must hold a size of 1 to {MOST_PIXELS} pixels, got "
            f"{short(size)}. {folders.AGAIN}"
        )
    return size


def _check_free(target: Path, overwrite: bool) -> None:
    """Raise ValueError if ``target`` exists and must not be replaced.

    With ``overwrite``, only a folder that an earlier export wrote may be replaced.
    """
    if not os.path.lexists(target):
        return
    if not overwrite:
        raise ValueError(
            f"{target} already exists. Choose another name, or replace it with --overwrite."
        )
    try:
        if target.is_symlink():
            raise ValueError("it is a link")
        loading.read_card(target)
    except (ValueError, OSError) as error:
        raise ValueError(
            f"{target} was not replaced: --overwrite replaces only folders that `mitigate export` "
            f"wrote ({error}). Choose another name, or move it away."
        ) from error


def check_outputs(folder: str, expected: str) -> None:
    """Raise ValueError unless the agent and the programs in ``folder`` give the expected outputs.

    ``export`` runs this in a new process.

    Args:
        folder: the hardened folder.
        expected: safetensors file with the expected outputs on the probe inputs.
    """
    expected_outputs = load_file(expected)
    agent = loading.load_hardened(folder)
    inputs = programs.probe(agent, _input_size(Path(folder)))
    program = programs.load_programs(Path(folder) / loading.PROGRAM)
    loaded: dict[str, tuple[dict[str, Any], float]] = {
        "agent": (programs.networks(agent), RELOADED),
        "program": (program, EXPORTED),
    }
    for what, (networks, limit) in loaded.items():
        gap = programs.difference(expected_outputs, programs.outputs(networks, inputs))
        if not gap <= limit:
            raise ValueError(
                f"The reloaded {what} differs by {gap:g}; at most {limit:g} is allowed."
            )


def _write(
    draft: Path,
    target: Path,
    run: Path,
    cfg: dict[str, Any],
    agent: Any,
    rows: list[Path | str],
    onnx: bool,
    walks: Walks | None,
) -> None:
    """Write all files into ``draft``, which will become ``target``, and check them."""
    # The path of the run is left out, because it is not relevant.
    config = yaml.safe_dump({**cfg, "folder": None}, sort_keys=False)
    config = config.replace(f"{Path.cwd()}/", "")
    write_text(draft / loading.CONFIG, config)
    adapters_only = _only_adapters_trained(cfg, agent)
    # called before the slow part, so that missing files are reported at once
    known = facts(cfg, agent)
    shipped = agent
    if adapters_only:
        adapters.write_adapters(agent, draft)
    else:
        checkpoint.write_tensors(agent, draft / checkpoint.WEIGHTS, half=walks is None)
    if walks is None and not adapters_only:
        shipped = copy.deepcopy(agent)
        checkpoint.load_weights(shipped, draft)
    weights = {checkpoint.weights_sha(a) for a in (agent, shipped)}
    agent_rows = _rows(run, rows, weights)
    checks: dict[str, Any] = {"program": False, "latency_ms": {}, "checked": {"walks": WALKS}}
    expected: dict[str, Tensor] = {}
    if walks is None:
        checks, expected = _programs(draft, agent, shipped, onnx)
    card = {
        "format": loading.FORMAT,
        "name": target.name,
        **known,
        "agent": checkpoint.weights_sha(shipped),  # this entry and run_agent are hashes of weights
        "run_agent": checkpoint.weights_sha(agent),
        # tables and the leaderboard identify agents by fingerprint
        "rows_agent": sorted({str(row["agent"]) for row in agent_rows}),
        "adapters_only": adapters_only,
        "metrics": metrics(agent_rows),
        **checks,
    }
    write_text(draft / loading.README, readme(card, str(target)))
    write_json(draft / loading.CARD, card, indent=2, allow_nan=False)
    for file in draft.iterdir():
        file.chmod(0o644)  # safetensors writes files that only their owner can read
    folders.seal(draft, "hardened")
    print("reloading in a new process", flush=True)
    if walks is None:
        _reload(draft, expected)
    else:
        _reload_walks(draft, agent, walks)


def _programs(
    draft: Path, agent: TopologicalAgent, shipped: TopologicalAgent, onnx: bool
) -> tuple[dict[str, Any], dict[str, Tensor]]:
    """Write the exported programs of ``shipped``.

    Returns:
        The card's entries that describe the programs, and the outputs of ``shipped`` on the probe
        inputs.
    """
    size = agent.rgb_encoder.size
    inputs = programs.probe(agent, size)
    print("exporting the programs", flush=True)
    exported = programs.export_programs(shipped, size)
    programs.save_programs(exported, draft / loading.PROGRAM)
    write_json(
        draft / loading.INPUTS, programs.description(shipped, size), indent=2, allow_nan=False
    )
    eager = programs.networks(shipped)
    modules = {kind: program.module() for kind, program in exported.items()}
    before, after = (programs.outputs(programs.networks(a), inputs) for a in (agent, shipped))
    rounded = programs.difference(before, after)
    if not rounded <= ROUNDED:
        raise ValueError(
            f"Rounding the weights to float16 changes an output by {rounded:g}; at most "
            f"{ROUNDED:g} is allowed. Was the run trained to the end? Nothing was written."
        )
    if onnx:
        programs.save_onnx(shipped, size, draft, EXPORTED)
    checked = {
        "float16": rounded,
        "float16_tolerance": ROUNDED,
        "reload_tolerance": RELOADED,
        "program_tolerance": EXPORTED,
    }
    latency = programs.latency({"eager": eager, "exported": modules}, shipped, size)
    return {"checked": checked, "latency_ms": latency}, after


def _only_adapters_trained(cfg: dict[str, Any], agent: Any) -> bool:
    """Return whether the run trained only the adapters of ``agent``."""
    init = find(cfg.get("init") or "")
    if not adapters.adapted(agent) or not cfg.get("init") or loading.adapters_only(init):
        return False
    base = copy.deepcopy(agent)
    adapters.remove_adapters(base)
    try:
        checkpoint.load_weights(base, init)
    except ValueError:  # the initial weights already contain adapters
        return False
    return adapters.backbone_sha(base) == adapters.backbone_sha(agent)


def _rows(run: Path, rows: list[Path | str], agents: set[str]) -> list[Row]:
    """Return the rows in ``run`` and ``rows`` whose weight hash is in ``agents``.

    Raises ValueError if ``rows`` contains no row of these weights.
    """
    try:
        run_rows = result_rows.gather([run])
    except FileNotFoundError:
        run_rows = []
    other_rows = result_rows.gather(rows) if rows else []
    if rows and not any(weights_of(row) in agents for row in other_rows):
        raise ValueError(
            f"The rows belong to {', '.join(sorted({weights_of(row) for row in other_rows}))}, not "
            f"to this agent ({', '.join(sorted(agents))}). Evaluate it: `make evaluate "
            f'ARGS="checkpoint={run}/agent"`.'
        )
    return list(_of_one_agent(run_rows, other_rows, agents))


def _of_one_agent(run_rows: list[Row], other_rows: list[Row], weights: set[str]) -> Iterator[Row]:
    """Yield the rows of the exported agent, which are rows whose weight hash is in ``weights``.

    The same weights count as a different agent if a sensor is blanked or a guard is added. If the
    rows come from several such agents, only the agent in ``run_rows`` is used. Raises ValueError if
    this agent is not unique.
    """
    rows = [
        row for row in result_rows.unique([*run_rows, *other_rows]) if weights_of(row) in weights
    ]
    for sha in weights:
        mine = [row for row in rows if weights_of(row) == sha]
        agents = {row["agent"] for row in mine}
        known = {row["agent"] for row in run_rows if weights_of(row) == sha} or agents
        if len(known) > 1:
            names = sorted({f"{row['name']} ({row['agent']})" for row in mine})
            raise ValueError(
                f"The rows belong to several agents with these weights: {', '.join(names)}. Name "
                "the row files of only one of them (--rows ...)."
            )
        yield from (row for row in mine if row["agent"] in known)


def _reload(draft: Path, outputs: dict[str, Tensor]) -> None:
    """Run :func:`check_outputs` in a new process; raise ValueError if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        expected = Path(folder) / "expected.safetensors"
        save_file({name: value.contiguous() for name, value in outputs.items()}, expected)
        _run_apart("check_outputs", "outputs", draft, expected)


def _reload_walks(draft: Path, agent: nn.Module, walks: Walks) -> None:
    """Run :func:`check_walks` in a new process; raise ValueError if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        check_file, expected = Path(folder, "walks"), Path(folder, "expected.json")
        # Unpickling is safe, because this function writes the file for the process that it starts.
        check_file.write_bytes(pickle.dumps((sys.path, walks)))
        expected.write_text(json.dumps(walks.measures(agent)), encoding="utf-8")
        _run_apart("check_walks", "measures", draft, check_file, expected)


def _run_apart(check: str, what: str, *paths: Path) -> None:
    """Call the function ``check`` of this module in a new process.

    If the check fails, raise ValueError. The message states that ``what`` must be equal for the
    exported and the original agent, and quotes the last line of the output.
    """
    root = str(Path(__file__).resolve().parents[2])
    with tempfile.TemporaryFile() as errors:
        process = subprocess.run(
            [sys.executable, "-c", _RUN.format(check), *map(str, paths)],
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, (root, *sys.path)))},
            stdout=subprocess.DEVNULL,
            stderr=errors,
        )
        last = "".join(last_lines(errors, 1, REASON_WIDTH)) or "no message"
    if process.returncode:
        raise ValueError(
            f"The exported agent failed the check in a new process ({last}). Its {what} must equal "
            "those of the original agent. Nothing was written."
        )


def check_walks(draft: str, check_file: str, expected: str) -> None:
    """Raise ValueError if the agent in ``draft`` does not reproduce the measures in ``expected``.

    :func:`_reload_walks` runs this in a new process.
    """
    path, walks = pickle.loads(Path(check_file).read_bytes())
    sys.path[:] = path
    agent = loading.load_hardened(draft, agent=walks.make_agent())
    measures = json.loads(json.dumps(walks.measures(agent)))
    target = json.loads(Path(expected).read_text(encoding="utf-8"))
    if measures != target:
        raise ValueError(f"its episodes gave {measures}, expected {target}")
