"""Agents from folders: shipped weights, the agent of a run, hardened exports.

Nothing in a folder is run. Files are compared with the manifest (``core/folders.py``), weights are
safetensors, settings are plain YAML that the schema of the agent's class checks, and only classes
of ``schema.KINDS`` are built. An agent of a class of the user's own is built by the user and filled
here (``agent=``).

A *hardened* folder was written by ``mitigate export``: its ``card.json`` says what made the agent
and which weights it must have; see ``checkpoints/README.md``.
"""

from __future__ import annotations

import hashlib
import json
import os
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import torch

from mitigate.agents import adapters, schema
from mitigate.agents.agent import stated_settings
from mitigate.core import checkpoint, folders, settings
from mitigate.core.checkpoint import CONFIG
from mitigate.core.contracts import read
from mitigate.core.files import find, places, sha256
from mitigate.core.json_files import read_object
from mitigate.core.names import short

FORMAT = 2  # of a card; 1 is read, too (core/older_folders.py)
CARD, README = "card.json", "README.md"
PROGRAM, INPUTS = "program.pt2", "program.json"
FILES = (CONFIG, README, INPUTS)  # besides the weights; of an agent with programs
ONNX = ("perceive.onnx", "decide.onnx")
# all that an export writes: none of these may be in a folder whose manifest does not list it
KNOWN = (checkpoint.WEIGHTS, adapters.WEIGHTS, adapters.SETTINGS, *FILES, PROGRAM, *ONNX)
ENTRIES = ("adapters_only", "base", "vocabulary", "commit", "agent")  # of a card, for loading
LONGEST_PATH = 1000  # characters of the path of a base (heuristic; Linux reads 4095)
TARGET = schema.KINDS[0]
PAGES = {  # by package, the page on what is trained there: its folder `agent` is used as it is
    "mitigate.encoders": "docs/encoder.md",
    "mitigate.guards.frames": "docs/restoration.md",
    "mitigate.guards.text": "docs/safeguard.md",
}
_PLAIN = (bool, int, float, str)
_RUN = "Name the folder `agent` of a run."
_AGAIN = "Fetch the folder again, or export it again with `make export`."


# load an agent from a folder ---------------------------------------------------------------------


def load(folder: str | Path, *, agent: Any = None) -> Any:
    """Return the agent in ``folder`` on the CPU, in eval mode, ready for ``reset``.

    Args:
        folder: a hardened one (as :func:`load_hardened`), shipped weights
            (``checkpoints/recurrent/base``), or the folder ``agent`` of a run; looked for from
            here, then in this project.
        agent: an agent of a class of your own, with the settings of the one that was trained, to be
            filled in place; None: one of ours, built here.

    Raises:
        FileNotFoundError, ValueError: Weights are missing, damaged or do not say what agent they
            belong to, or the agent is not ours and not given, or is another one than the one given.
            The message names the file.
        TypeError: ``folder`` is no path, or ``agent`` has no weights.
    """
    _check_path(folder, "an agent's weights", "checkpoints/base")
    place = find(folder)
    if (place / CARD).is_file():
        return load_hardened(place, agent=agent)
    refuse_what_ships_as_it_is(place)
    if (place / "agent").is_dir():
        raise ValueError(f"{folder} is the folder of a run: name its agent, {place / 'agent'}.")
    config = config_of(place)
    if agent is None and not config.is_file():
        raise FileNotFoundError(f"{config} is missing, so nobody knows what agent {folder} is of.")
    folders.check(config.parent)
    with torch.random.fork_rng(devices=[]):  # the caller's random numbers stay as they are
        filled = _to_fill(agent, config, _RUN)
        checkpoint.load_agent(filled, place)
    if config.is_file():
        give_settings(filled, config, _RUN)
    return filled.eval()


def load_hardened(folder: str | Path, *, base: str | Path | None = None, agent: Any = None) -> Any:
    """Return the agent of a hardened checkpoint on the CPU, in eval mode, ready for ``reset``.

    It needs neither Hydra nor the simulator. Attributes of ``agent`` that are named like settings
    and differ from them are warned of.

    Args:
        folder: such as ``checkpoints/hardened/ts_distill``.
        base: for a folder of adapters, the weights they belong to (a file or folder); None: where
            the card says, looked for below the current folder, the folders above ``folder`` and
            the checkout.
        agent: an agent of a class of your own, with the settings of the one that was exported, to
            be filled in place; if it has no ``settings()``, it is given the folder's. None: one of
            ours, built here.

    Raises:
        FileNotFoundError, ValueError: The folder is not whole, or not what its card states.
        TypeError: ``folder`` is no path, or ``agent`` has no weights.
    """
    _check_path(folder, "a hardened checkpoint", "checkpoints/hardened/ts_distill")
    if agent is not None:
        check_fillable(agent)
    folder = Path(folder)
    card = check_hardened(folder)
    with torch.random.fork_rng(devices=[]):
        filled = _to_fill(agent, folder / CONFIG, _AGAIN)
        if agent is None and card["vocabulary"] != vocabulary_sha(filled):
            made = f" (commit {short(card['commit'])})" if card["commit"] else ""
            raise ValueError(
                f"{folder} was exported with another vocabulary than its {CONFIG} gives the agent, "
                f"so its words would be misread. Use the version that made it{made}."
            )
        _fill(filled, folder, card, base)
    found = checkpoint.weights_sha(filled)
    if found != card["agent"]:
        raise ValueError(
            f"The weights in {folder} make an agent with the hash {found}, but {CARD} is of "
            f"{short(card['agent'])}. {_AGAIN} An agent of your own must be in float32, or what it "
            "was exported in: convert it afterwards."
        )
    give_settings(filled, folder / CONFIG, _AGAIN)
    return filled.eval()


def _check_path(folder: object, what: str, example: str) -> None:
    if not isinstance(folder, (str, os.PathLike)):
        raise TypeError(
            f"folder must be the path of {what}, not {folder!r:.60}: name one, such as {example}."
        )


def _to_fill(agent: Any, config: Path, again: str) -> Any:
    """Return an agent of ours with the settings in ``config``, or ``agent`` if these are its."""
    if agent is None:
        return build_from(config)
    check_fillable(agent)
    if config.is_file():
        check_same(agent, config, again)
    return agent


def build_from(config: Path) -> Any:
    """Return an agent of ours with the settings in ``config`` (YAML, read as data), its weights
    random.

    Raises:
        ValueError: The file is damaged or names another kind of agent.
    """
    kind = kind_of(config)
    found = agent_settings(config, kind)
    try:
        return schema.class_of(kind)(**found)
    except (TypeError, RuntimeError) as error:
        raise ValueError(f"The agent's settings in {config} do not fit ({error}).") from error


def config_of(weights: Path) -> Path:
    """Return where the settings of the agent are that ``weights`` (a file or folder) belong to.

    Raises:
        FileNotFoundError: There are no weights.
        ValueError: It is a file of a hardened folder, which is checked as a whole.
    """
    if is_hardened(weights):
        return weights / CONFIG
    if weights.is_file() and is_hardened(weights.parent):
        raise ValueError(f"{weights} is of a hardened folder: name that, {weights.parent}.")
    return checkpoint.weights_file(weights).with_name(CONFIG)


def refuse_what_ships_as_it_is(run: Path) -> None:
    """Raise ValueError for the run, or its folder ``agent``, of what is no navigation agent."""
    config = run / CONFIG
    held = settings.read(config).get("agent") if config.is_file() else None
    target = str(held.get("_target_")) if isinstance(held, dict) else ""
    page = next((page for start, page in PAGES.items() if target.startswith(f"{start}.")), "")
    if page:
        made = run / "agent" if (run / "agent").is_dir() else run
        raise ValueError(
            f"{run} holds no agent that walks but a {target.rpartition('.')[2]}, which needs no "
            f"export: {made} ships as it is. {page} says how it is used."
        )


# an agent of the user's own ----------------------------------------------------------------------


def check_fillable(agent: Any) -> None:
    """Raise TypeError for a class in place of its object, and for what has no weights."""
    if isinstance(agent, type):
        raise TypeError(f"agent is the class {agent.__name__}: give an object of it, made by it.")
    if not hasattr(agent, "eval"):  # an object of any class
        raise TypeError(
            f"agent is a {type(agent).__name__}, which has no weights to fill: give a "
            "torch.nn.Module of the class that was trained."
        )


def check_same(agent: Any, config: Path, again: str) -> None:
    """Compare the settings of ``agent`` with those in ``config``.

    Of an agent without ``settings()`` the plain attributes with their names are compared, and
    others warned of: an attribute may mean something else.

    Raises:
        ValueError: The settings differ, or, ending in ``again``, the file has none.
    """
    stored = _settings_in(config, again)
    stated = stated_settings(agent)
    own = stated
    if own is None:
        named = {k: read(agent, k) for k, v in stored.items() if isinstance(v, _PLAIN)}
        own = {name: value for name, value in named.items() if isinstance(value, _PLAIN)}
    wrong = [k for k, v in own.items() if k in stored and _as_json(stored[k]) != _as_json(v)]
    if not wrong:
        return
    text = (
        f"{config} is of an agent with {wrong[0]}={stored[wrong[0]]!r:.60}, but the one given "
        f"has {own[wrong[0]]!r:.60}. Build it with the settings in that file."
    )
    if stated is not None:
        raise ValueError(text)
    warnings.warn(text, stacklevel=4)


def give_settings(agent: Any, config: Path, again: str) -> None:
    """Give an agent without ``settings`` those in ``config``, as ``building.build_agent`` does, so
    that its fingerprint is the same. Errors as of :func:`check_same`."""
    if stated_settings(agent) is None:
        known = {k: v for k, v in _settings_in(config, again).items() if k != "_target_"}
        agent.settings = partial(dict, known)


def _settings_in(config: Path, again: str) -> dict[str, Any]:
    stored = settings.read(config).get("agent")
    if not isinstance(stored, dict):
        raise ValueError(f"{config} has no settings of an agent. {again}")
    return stored


def _as_json(value: Any) -> Any:
    """``value`` as it is once it was written: a tuple is a list."""
    return json.loads(json.dumps(value, default=lambda one: read(one, "tolist", "__str__")()))


# settings of our kinds ---------------------------------------------------------------------------


def kind_of(config: Path) -> str:
    """Return which of ``schema.KINDS`` the agent in ``config`` is; the first if it does not say."""
    held = settings.read(config).get("agent")
    named = held.get("_target_") if isinstance(held, dict) else None
    return named if isinstance(named, str) and named in schema.KINDS else TARGET


def is_ours(target: str) -> bool:
    """Return whether a folder may hold an agent of the class ``target`` that the user does not
    build."""
    return target in schema.KINDS


def agent_settings(config: Path, target: str = TARGET) -> dict[str, Any]:
    """Return the keyword arguments of the agent of the kind ``target`` in ``config``. Errors as
    :func:`build_from`."""
    known = schema.schema_of(target).settings
    return schema.check(settings.read_agent(config, target, known), config, target)


# hardened folders --------------------------------------------------------------------------------


def is_hardened(folder: str | Path) -> bool:
    """Return whether ``folder`` is a hardened one. Raises ValueError for a damaged manifest."""
    manifest = folders.read_manifest(folder, _AGAIN)
    return manifest is not None and manifest.kind == "hardened"


def adapters_only(folder: str | Path) -> bool:
    """Return whether ``folder`` is hardened and, by its card, holds adapters and a reference to
    their base in place of all weights. Errors as :func:`read_card`."""
    return is_hardened(folder) and bool(read_card(Path(folder))["adapters_only"])


def fill(agent: Any, folder: str | Path, *, base: str | Path | None = None) -> Any:
    """Read the weights of a hardened folder into ``agent``, adapters and base alike. Adapters that
    ``agent`` has and the folder lacks stay as they are.

    Arguments and errors as :func:`load_hardened`; ValueError too if the agent is another one.
    """
    folder = Path(folder)
    _fill(agent, folder, check_hardened(folder), base)
    return agent


def _fill(agent: Any, folder: Path, card: dict[str, Any], base: str | Path | None) -> None:
    if not card["adapters_only"]:
        checkpoint.load_weights(agent, folder)
        return
    mine = adapters.adapted(agent)
    adapters.remove_adapters(agent)
    checkpoint.load_weights(agent, _base(folder, card["base"], base))
    if adapters.load_adapters(agent, folder) != mine:
        raise ValueError(
            f"{folder} holds adapters of other modules than agent.adapters names: build the agent "
            f"with its {CONFIG}."
        )


def check_hardened(folder: Path) -> dict[str, Any]:
    """Return the card of ``folder`` after comparing every file with the manifest.

    ``program.pt2`` may be missing: nothing here reads it, and `mitigate export FOLDER --programs`
    writes it again.

    Raises:
        FileNotFoundError: Another file is missing.
        ValueError: A file was changed, or the card is damaged.
    """
    card = read_card(folder)
    manifest = folders.read_manifest(folder, _AGAIN)
    assert manifest is not None
    own = (adapters.WEIGHTS, adapters.SETTINGS) if card["adapters_only"] else (checkpoint.WEIGHTS,)
    needed = FILES if card.get("program", True) else (CONFIG, README)
    for name in (*own, *needed):
        if name not in manifest.files:
            raise ValueError(
                f"{folder / manifest.source} does not list {name}, which must be there. {_AGAIN}"
            )
    strays = [n for n in KNOWN if n not in manifest.files and os.path.lexists(folder / n)]
    if strays:
        raise ValueError(
            f"{folder / strays[0]} is not listed in {manifest.source}, so nothing says what it "
            "must hold. Do not use this folder: fetch it again, or delete that file if you put it "
            "there."
        )
    folders.check(folder, optional=(PROGRAM,), again=_AGAIN)
    return card


def read_card(folder: Path) -> dict[str, Any]:
    """Return the card of the hardened ``folder``. Errors as :func:`check_hardened`."""
    file = folder / CARD
    if not file.is_file():
        raise FileNotFoundError(
            f"{folder} is no hardened checkpoint: {CARD} is missing. Name a folder such as "
            "checkpoints/hardened/..., written by `make export RUN=runs/... NAME=...`; "
            "mitigate.load reads weights without a card, too, by the same agent=..."
        )
    card = read_object(file, _AGAIN)
    manifest = folders.read_manifest(folder, _AGAIN)
    if manifest is None or manifest.kind != "hardened":
        raise ValueError(
            f"{file} is the card of another kind of folder, such as a restorer (restore=...): name "
            "a hardened checkpoint (checkpoints/hardened/...)."
        )
    if manifest.source != CARD and card.get("format") != FORMAT:
        raise ValueError(f"{file} is no card of format {FORMAT}, the one this code reads. {_AGAIN}")
    lacking = [name for name in ENTRIES if name not in card]
    if lacking:
        raise ValueError(f"{file} lacks {', '.join(lacking)}. {_AGAIN}")
    base = card["base"] if card["adapters_only"] else {"weights": "", "sha256": ""}
    if not isinstance(base, dict) or not all(_is_path(base.get(k)) for k in ("weights", "sha256")):
        raise ValueError(f"{file} does not say to which base its adapters belong. {_AGAIN}")
    return card


def _is_path(value: Any) -> bool:
    """Return whether a system can hold and show a file of that path."""
    if not isinstance(value, str) or len(value) > LONGEST_PATH or not value.isprintable():
        return False
    return all(len(part.encode()) <= folders.LONGEST for part in Path(value).parts)


def vocabulary_sha(agent: Any) -> str | None:
    """Return the first 12 hex digits of the sha256 of the words, in the order of their ids; None
    of an agent without a vocabulary."""
    if not hasattr(agent, "vocabulary"):  # of two of our kinds
        return None
    return hashlib.sha256("\n".join(agent.vocabulary).encode()).hexdigest()[:12]


def _base(folder: Path, reference: dict[str, str], given: str | Path | None) -> Path:
    """Return the file of the weights that the adapters in ``folder`` belong to."""
    near = [parent / reference["weights"] for parent in folder.resolve().parents]
    here, *shipped = places(reference["weights"])
    candidates = [here, *near, *shipped] if given is None else [Path(given)]
    files = [p if p.suffix == ".safetensors" else p / checkpoint.WEIGHTS for p in candidates]
    found = [file for file in files if file.is_file()]
    for file in found:
        if sha256(file) == reference["sha256"]:
            return file
    where = f"{found[0]} has another" if found else f"there is none at {files[0]}"
    raise (ValueError if found else FileNotFoundError)(
        f"The adapters in {folder} belong to the weights {reference['weights']} with sha256 "
        f"{reference['sha256']}, but {where}. Name the right ones: load_hardened(folder, base=...)."
    )
