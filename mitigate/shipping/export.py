"""Write a run's agent as a folder to ship (``export_command.py`` is its command line).

``checkpoints/hardened/<name>`` gets the weights (or adapters and a reference to their base),
``config.yaml``, ``program.pt2``, a card and a README. The folder is made aside, reloaded in a fresh
process and renamed into place only if the outputs on a fixed probe are the same.
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
from pathlib import Path
from typing import Any

import torch
import yaml
from safetensors.torch import load_file, save_file
from torch import Tensor, nn

from mitigate.agents import adapters, loading
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import checkpoint, folders, older_folders, settings
from mitigate.core.files import find, put_folder, write_text
from mitigate.core.output import output_folder
from mitigate.corruptions import CLEAN
from mitigate.evaluation import rows as result_rows
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.rows import Row
from mitigate.shipping import programs
from mitigate.shipping.card import facts, metrics, readme, rows_agent, weights_of
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

HARDENED = Path("checkpoints/hardened")
# largest absolute difference of an output on the probe (ours; logits are of the order of 1 to 10)
RELOADED = 1e-5  # the folder in a fresh process against the agent in this one
EXPORTED = 1e-3  # program.pt2, and the ONNX files, against the agent
ROUNDED = 0.1  # the float16 weights against the run's float32 ones
WALKS = 2  # episodes that a reloaded agent of another class must walk alike (heuristic)
_RUN = "import sys; from mitigate.shipping import export; export.{}(*sys.argv[1:])"
_TRAIN = "Run `make train` to the end, then name its folder (runs/...)."


class Walks:
    """What an exported folder is checked by: ``episodes`` walked clean, in a fresh process, by the
    agent that ``make_agent`` makes and the folder fills, in what ``make_world`` makes."""

    def __init__(
        self,
        make_agent: Callable[[], nn.Module],
        make_world: Callable[[], World],
        episodes: Sequence[Episode],
    ) -> None:
        self.make_agent, self.make_world = make_agent, make_world
        self.episodes = list(episodes)[:WALKS]

    def measures(self, agent: Any) -> list[dict[str, Any]]:
        """How ``agent`` walks, the hash of its weights first."""
        world = self.make_world()
        walked = [run_episode(agent.eval(), world, e, CLEAN, 0) for e in self.episodes]
        return [{"weights": checkpoint.weights_sha(agent)}, *walked]


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
        rows: row files or folders with the agent's evaluation; the run folder's own are found.
        overwrite: replace ``out/name``, if that is a hardened folder. onnx: write the two networks
            as ONNX files too. walks: for an agent of another class than ours, how to make it and
            what to check it by; its folder holds no programs.
    Raises FileNotFoundError if ``run`` holds no finished run, ValueError for a run of what ships as
    it is, if ``out/name`` exists (with ``overwrite``: as anything else), if ``rows`` say nothing
    about this agent, or if the written folder does not reload to the same outputs; then nothing is
    written.
    """
    if not re.fullmatch(r"\w[\w.+-]*", name):
        raise ValueError(f"{name!r} is no name for a folder: use letters, digits and . _ + -")
    target = out / name
    _check_free(target, overwrite)
    if onnx and walks is not None:
        raise ValueError("--onnx is for the topological agent: folders of others hold no programs.")
    cfg, agent = finished(run, walks)
    watched = output_folder(out, name)
    with watched, tempfile.TemporaryDirectory(prefix=f".{name}.", dir=out) as aside:
        draft = Path(aside) / name
        draft.mkdir()
        _write(draft, run, cfg, agent, name, list(rows), onnx, walks)
        put_folder(draft, target, Path(aside) / "old")
    return target


def finished(run: Path, walks: Walks | None = None) -> tuple[dict[str, Any], Any]:
    """Return the config and the agent of the finished run in the folder ``run``.

    Raises FileNotFoundError if there is none, ValueError for a run of what ships as it is, of a
    kind of agent that needs ``walks``, and for weights that do not fit float16.
    """
    weights, config = run / "agent" / checkpoint.WEIGHTS, run / loading.CONFIG
    loading.reject_other_models(run)
    if not (weights.is_file() and config.is_file()):
        inside = run.name == "agent" and (run / checkpoint.WEIGHTS).is_file()
        raise FileNotFoundError(
            f"{run} holds no finished run: it needs config.yaml and agent/{checkpoint.WEIGHTS}. "
            + (f"Name the run: {run.parent}." if inside else _TRAIN)
        )
    kind = loading.kind_of(config)
    if walks is None and kind != loading.TARGET:
        raise ValueError(
            f"{run} holds a {kind.rpartition('.')[2]}, of which a folder without programs is "
            "written: give walks to check it by (on the command line: "
            f"agent={settings.named(kind)})."
        )
    agent = loading.build_from(config) if walks is None else walks.make_agent()
    checkpoint.load_weights(agent, weights)
    if walks is None and not all(
        torch.isfinite(value.half()).all() for value in agent.state_dict().values()
    ):
        raise ValueError(f"{weights} holds numbers that are not finite in float16.")
    return settings.read(config), agent.eval()


def add_programs(folder: Path) -> Path:
    """Write ``program.pt2`` of the hardened ``folder`` again and list it in the card.

    Returns:
        The file, whose outputs on the probe are those of the agent.

    Raises:
        FileNotFoundError: if ``folder`` is not a whole hardened folder.
        ValueError: also for an agent without programs, and for other outputs.
    """
    card = loading.check_hardened(folder)
    if not card.get("program", True):
        raise ValueError(f"{folder} holds an agent of a class for which there are no programs.")
    agent = loading.load_hardened(folder)
    size = json.loads((folder / loading.INPUTS).read_text(encoding="utf-8"))["size"]
    exported = programs.export_programs(agent, size)
    probe = programs.probe(agent, size)
    modules = {name: program.module() for name, program in exported.items()}
    networks = programs.networks(agent)
    gap = programs.difference(programs.outputs(networks, probe), programs.outputs(modules, probe))
    if not gap <= EXPORTED:
        raise ValueError(f"The programs differ by {gap:g}; at most {EXPORTED:g} is allowed.")
    folder = folder.resolve()
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=folder.parent) as aside:
        draft = Path(shutil.copytree(folder, Path(aside) / folder.name))
        programs.save_programs(exported, draft / loading.PROGRAM)
        card = {**older_folders.without_sums(card), "format": loading.FORMAT}
        _write_json(draft / loading.CARD, card)
        folders.seal(draft, "hardened")
        loading.check_hardened(draft)
        put_folder(draft, folder, Path(aside) / "old")
    return folder / loading.PROGRAM


def _check_free(target: Path, overwrite: bool) -> None:
    """Raise ValueError unless ``target`` is free, or a folder of ours that may be replaced."""
    if not os.path.lexists(target):
        return
    if not overwrite:
        raise ValueError(
            f"{target} exists already: choose another name, or replace it with --overwrite."
        )
    try:
        if target.is_symlink():
            raise ValueError("it is a link")
        loading.read_card(target)
    except (ValueError, OSError) as error:
        raise ValueError(
            f"{target} is not replaced: --overwrite replaces folders that `mitigate export` wrote, "
            f"and nothing else ({error}). Choose another name, or move it away yourself."
        ) from error


def check_outputs(folder: str, expected: str) -> None:
    """Raise ValueError unless the agent and the program in ``folder`` give the outputs in the
    safetensors file ``expected`` on the probe. Run by ``export`` in a fresh process."""
    wanted = _open(load_file(expected))
    agent = loading.load_hardened(folder)
    size = json.loads((Path(folder) / loading.INPUTS).read_text(encoding="utf-8"))["size"]
    program = programs.load_programs(Path(folder) / loading.PROGRAM)
    for what, networks, most in (
        ("agent", programs.networks(agent), RELOADED),
        ("program", program, EXPORTED),
    ):
        gap = programs.difference(wanted, programs.outputs(networks, programs.probe(agent, size)))
        if not gap <= most:
            raise ValueError(
                f"The reloaded {what} differs by {gap:g}; at most {most:g} is allowed."
            )


def _write(
    draft: Path,
    run: Path,
    cfg: dict[str, Any],
    agent: Any,
    name: str,
    rows: list[Path | str],
    onnx: bool,
    walks: Walks | None,
) -> None:
    """Fill ``draft`` and check it."""
    config = yaml.safe_dump({**cfg, "folder": None}, sort_keys=False)  # where it ran is no matter
    config = config.replace(f"{Path.cwd()}/", "")
    write_text(draft / loading.CONFIG, config)
    adapters_only = _only_adapters_trained(cfg, agent)
    known = facts(cfg, agent)  # before the slow part: what is missing shows at once
    shipped = agent
    if adapters_only:
        adapters.write_adapters(agent, draft)
    else:
        checkpoint.write_tensors(agent, draft / checkpoint.WEIGHTS, half=walks is None)
    if walks is None and not adapters_only:
        shipped = copy.deepcopy(agent)
        checkpoint.load_weights(shipped, draft)
    weights = {checkpoint.weights_sha(a) for a in (agent, shipped)}
    found = _rows(run, rows, weights)
    made: dict[str, Any] = {"program": False, "latency_ms": {}}
    made["checked"] = {"walks": WALKS}
    wanted: dict[str, Tensor] = {}
    if walks is None:
        made, wanted = _programs(draft, agent, shipped, onnx)
    card = {
        "format": loading.FORMAT,
        "name": name,
        **known,
        "agent": checkpoint.weights_sha(shipped),  # of the weights alone, as run_agent
        "run_agent": checkpoint.weights_sha(agent),
        "rows_agent": rows_agent(found, weights),
        "adapters_only": adapters_only,
        "metrics": metrics(found, weights),
        **made,
    }
    write_text(draft / loading.README, readme(card))
    _write_json(draft / loading.CARD, card)
    for file in draft.iterdir():
        file.chmod(0o644)  # safetensors are written for their owner alone
    folders.seal(draft, "hardened")
    print("reloading in a fresh process", flush=True)
    if walks is None:
        _reload(draft, wanted)
    else:
        _reload_walks(draft, agent, walks)


def _programs(
    draft: Path, agent: TopologicalAgent, shipped: TopologicalAgent, onnx: bool
) -> tuple[dict[str, Any], dict[str, Tensor]]:
    """Write the exported programs of ``shipped``; what the card says of them, and the outputs on
    the probe."""
    size = agent.rgb_encoder.size
    given = programs.probe(agent, size)
    print("exporting the programs", flush=True)
    exported = programs.export_programs(shipped, size)
    programs.save_programs(exported, draft / loading.PROGRAM)
    _write_json(draft / loading.INPUTS, programs.description(shipped, size))
    eager = programs.networks(shipped)
    modules = {kind: program.module() for kind, program in exported.items()}
    before, wanted = (programs.outputs(programs.networks(a), given) for a in (agent, shipped))
    rounded = programs.difference(before, wanted)
    if not rounded <= ROUNDED:
        raise ValueError(
            f"Rounding the weights to float16 moves an output on the probe by {rounded:g}; at most "
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
    return {"checked": checked, "latency_ms": latency}, wanted


def _only_adapters_trained(cfg: dict[str, Any], agent: Any) -> bool:
    """Whether all but the adapters of ``agent`` is, bit for bit, what the run started from."""
    init = find(cfg.get("init") or "")
    if not adapters.adapted(agent) or not cfg.get("init") or loading.adapters_only(init):
        return False
    base = copy.deepcopy(agent)
    adapters.remove_adapters(base)
    try:
        checkpoint.load_weights(base, init)
    except ValueError:  # a base with adapters of its own
        return False
    return adapters.backbone_sha(base) == adapters.backbone_sha(agent)


def _rows(run: Path, rows: list[Path | str], agents: set[str]) -> list[Row]:
    """The rows of the weights ``agents``: the run's own, and those given. Raises ValueError if none
    of these are of them."""
    try:
        own = result_rows.gather([run])
    except FileNotFoundError:
        own = []
    given = result_rows.gather(rows) if rows else []
    if rows and not any(weights_of(row) in agents for row in given):
        raise ValueError(
            f"The rows given are of {', '.join(sorted({weights_of(row) for row in given}))}, not "
            f"of this agent ({', '.join(sorted(agents))}). Evaluate it: `make evaluate "
            f'ARGS="checkpoint={run}/agent"`.'
        )
    return list(_of_one_agent(own, given, agents))


def _of_one_agent(own: list[Row], given: list[Row], weights: set[str]) -> Iterator[Row]:
    """The rows of ``weights``, of one agent: with a sensor blanked, or behind a safeguard, the same
    weights are another. Where there are several, the run's own rows say which it is; raises
    ValueError if they do not."""
    rows = [row for row in result_rows.upsert(own, given) if weights_of(row) in weights]
    for sha in weights:
        mine = [row for row in rows if weights_of(row) == sha]
        agents = {row["agent"] for row in mine}
        known = {row["agent"] for row in own if weights_of(row) == sha} or agents
        if len(known) > 1:
            names = sorted({f"{row['name']} ({row['agent']})" for row in mine})
            raise ValueError(
                f"The rows given are of several agents with these weights: {', '.join(names)}. "
                "Name the files of one (--rows ...)."
            )
        yield from (row for row in mine if row["agent"] in known)


def _reload(draft: Path, wanted: dict[str, Tensor]) -> None:
    """Run :func:`check_outputs` in a fresh process; ValueError with its last words if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        expected = Path(folder) / "expected.safetensors"
        save_file(_open(wanted), expected)
        _run_apart("check_outputs", "outputs", draft, expected)


def _reload_walks(draft: Path, agent: nn.Module, walks: Walks) -> None:
    """Raise ValueError unless a fresh process reloads ``draft`` to an agent that walks as ``agent``
    does."""
    with tempfile.TemporaryDirectory() as folder:
        given, expected = Path(folder, "walks"), Path(folder, "expected.json")
        given.write_bytes(pickle.dumps((sys.path, walks)))  # ours, for the process started here
        expected.write_text(json.dumps(walks.measures(agent)), encoding="utf-8")
        _run_apart("check_walks", "agent", draft, given, expected)


def _run_apart(check: str, what: str, *paths: Path) -> None:
    """Call the function ``check`` of this module in a fresh process; ValueError with its last words
    if it fails: the folder does not reload to the same ``what``."""
    root = str(Path(__file__).resolve().parents[2])
    done = subprocess.run(
        [sys.executable, "-c", _RUN.format(check), *map(str, paths)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, (root, *sys.path)))},
        capture_output=True,
        text=True,
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise ValueError(f"The folder does not reload to the same {what} ({last}); nothing written")


def check_walks(draft: str, given: str, expected: str) -> None:
    """Raise ValueError if the agent in ``draft`` walks otherwise than ``expected`` says. Run by
    :func:`_reload_walks` in a fresh process."""
    path, walks = pickle.loads(Path(given).read_bytes())
    sys.path[:] = path
    agent = loading.load_hardened(draft, agent=walks.make_agent())
    found = json.loads(json.dumps(walks.measures(agent)))
    wanted = json.loads(Path(expected).read_text(encoding="utf-8"))
    if found != wanted:
        raise ValueError(f"it walks {found}, and walked {wanted}")


def _open(tensors: dict[str, Tensor]) -> dict[str, Tensor]:
    return {name: tensor.contiguous() for name, tensor in tensors.items()}


def _write_json(file: Path, value: Any) -> None:
    write_text(file, json.dumps(value, indent=2, allow_nan=False) + "\n")
