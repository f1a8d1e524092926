"""Hardened checkpoints: folders that are checked by hash before anything in them is read.

``load_hardened(folder)`` needs neither Hydra nor the simulator, and runs nothing from the folder:
weights are safetensors, settings are plain YAML, and the class is one of ours. What a folder holds
is written in ``checkpoints/README.md``; ``mitigate.export`` writes it.
"""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any

import torch

from mitigate.agents import adapters, given, schema
from mitigate.core import checkpoint, settings
from mitigate.core.files import places, sha256
from mitigate.core.json_files import read_json, read_object
from mitigate.core.names import short

FORMAT = 1
CARD, CONFIG, README = "card.json", "config.yaml", "README.md"
PROGRAM, INPUTS = "program.pt2", "program.json"
FILES = (CONFIG, README, INPUTS)  # besides the weights; of an agent of ours
ONNX = ("perceive.onnx", "decide.onnx")
# all that an export writes: none of these may lie in a folder whose card does not list it
KNOWN = (checkpoint.WEIGHTS, adapters.WEIGHTS, adapters.SETTINGS, *FILES, PROGRAM, *ONNX)
LONGEST = 255  # bytes of a file's name (Linux, NAME_MAX)
LONGEST_PATH = 1000  # characters of the path of a base (ours; Linux reads 4095)
ENTRIES = (
    "files",
    "adapters_only",
    "base",
    "vocabulary",
    "commit",
    "agent",
)  # what loading reads of a card
TARGET = "mitigate.agents.topological.TopologicalAgent"
_AGAIN = "Fetch the folder again, or export it again with `make export`."


def load_hardened(folder: str | Path, *, base: str | Path | None = None, agent: Any = None) -> Any:
    """Return the agent of a hardened checkpoint on the CPU, in eval mode, ready for ``reset``.

    Args:
        folder: such as ``checkpoints/hardened/ts_distill``.
        base: for a folder of adapters, the weights they belong to (a file or folder); None: where
            the card says, looked for below the current folder, the folders above ``folder`` and
            the checkout.
        agent: an agent of a class of your own, with the settings of the one that was exported, to
            be filled in place; if it has no ``settings()``, it is given the folder's. None: one of
            ours, built here.
    Raises FileNotFoundError or ValueError, naming the file, if the folder is not whole or not what
    its card states, TypeError for a folder that is no path or an agent without weights. Warns of
    attributes of ``agent`` that are called as settings and differ from them.
    """
    if not isinstance(folder, (str, os.PathLike)):
        raise TypeError(
            f"folder must be the path of a hardened checkpoint, not {folder!r:.60}: name one, such "
            "as checkpoints/hardened/ts_distill."
        )
    if agent is not None:
        given.check_fillable(agent)
    folder = Path(folder)
    card = check(folder)
    with torch.random.fork_rng(devices=[]):  # the caller's random numbers stay as they are
        if agent is not None:
            given.check_same(agent, folder / CONFIG, _AGAIN)
            filled = _filled(agent, folder, card, base)
            given.give_settings(filled, folder / CONFIG, _AGAIN)
            return filled
        agent = build(folder / CONFIG)
        if card["vocabulary"] != vocabulary_sha(agent):
            made = f" (commit {short(card['commit'])})" if card["commit"] else ""
            raise ValueError(
                f"{folder} was exported with another vocabulary than its {CONFIG} gives the agent, "
                f"so its words would be misread. Use the version that made it{made}."
            )
        return _filled(agent, folder, card, base)


def _filled(agent: Any, folder: Path, card: dict[str, Any], base: str | Path | None) -> Any:
    """``agent`` in eval mode with the weights of ``folder``, which must be those of its card."""
    _fill(agent, folder, card, base)
    found = checkpoint.weights_sha(agent)
    if found != card["agent"]:
        raise ValueError(
            f"The weights in {folder} make an agent with the hash {found}, but {CARD} is of "
            f"{short(card['agent'])}. {_AGAIN} An agent of your own must be in float32, or what it "
            "was exported in: convert it afterwards."
        )
    return agent.eval()


def build(config: Path) -> Any:
    """Return an agent of ours with the settings in ``config`` (YAML, read as data), its weights
    random.

    Raises ValueError if the file is damaged or names another kind of agent.
    """
    kind = kind_of(config)
    found = agent_settings(config, kind)
    try:
        return schema.class_of(kind)(**found)
    except (TypeError, RuntimeError) as error:
        raise ValueError(f"The agent's settings in {config} do not fit ({error}).") from error


def config_of(weights: Path) -> Path:
    """Where the settings are of the agent that ``weights`` (a file, or a folder) belong to, whether
    there are any or not. Raises FileNotFoundError if there are no weights, ValueError for a file of
    a hardened folder, which is checked as a whole."""
    if is_hardened(weights):
        return weights / CONFIG
    if weights.is_file() and is_hardened(weights.parent):
        raise ValueError(f"{weights} is of a hardened folder: name that, {weights.parent}.")
    return checkpoint.weights_file(weights).with_name(CONFIG)


def kind_of(config: Path) -> str:
    """Return which of ``schema.KINDS`` the agent in ``config`` is; the first if it does not say."""
    held = settings.read(config).get("agent")
    named = held.get("_target_") if isinstance(held, dict) else None
    return named if isinstance(named, str) and named in schema.KINDS else TARGET


def is_ours(target: str) -> bool:
    """Whether a folder may hold an agent of the class ``target`` without the user building it."""
    return target in schema.KINDS


def agent_settings(config: Path, target: str = TARGET) -> dict[str, Any]:
    """Return the keyword arguments of the agent of the kind ``target`` in ``config``. Errors as
    :func:`build`."""
    known = schema.KINDS[target].settings
    return schema.check(settings.read_agent(config, target, known), config, target)


def check_own(held: dict[str, Any]) -> None:
    """Raise ValueError if a user's own config ``held`` sets an agent of ours to what it cannot be;
    settings that are not in its schema are for its class to refuse."""
    target = held["_target_"]
    given = {k: v for k, v in held.items() if k in schema.KINDS[target].settings}
    schema.check(given, "The options", target, "Give it such a value, or leave it out.")


def fill(agent: Any, folder: str | Path, *, base: str | Path | None = None) -> Any:
    """Read the weights of a hardened folder into ``agent``, adapters and base alike. Adapters that
    ``agent`` has and the folder lacks stay as they are.

    Arguments and errors as :func:`load_hardened`; ValueError too if the agent is another one.
    """
    folder = Path(folder)
    _fill(agent, folder, check(folder), base)
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


def is_hardened(folder: str | Path) -> bool:
    """Whether ``folder`` has the card of a hardened checkpoint, and not one of another kind.

    Raises ValueError for a card that cannot be read.
    """
    file = Path(folder) / CARD
    return file.is_file() and "sha256" in read_object(file, _AGAIN)


def adapters_only(folder: str | Path) -> bool:
    """Whether ``folder`` is hardened and, by its card, holds adapters and a reference to their base
    in place of all weights. Errors as :func:`read_card`."""
    return is_hardened(folder) and bool(read_card(Path(folder))["adapters_only"])


def check(folder: Path) -> dict[str, Any]:
    """Return the card of ``folder`` after comparing every file's sha256 with it.

    ``program.pt2`` may be missing: nothing here reads it, and `mitigate export FOLDER --programs`
    writes it again. Raises FileNotFoundError for another missing file, ValueError for a changed
    one or a damaged card.
    """
    card = read_card(folder)
    files = card["files"]
    own = (adapters.WEIGHTS, adapters.SETTINGS) if card["adapters_only"] else (checkpoint.WEIGHTS,)
    needed = FILES if card.get("program", True) else (CONFIG, README)
    for name in (*own, *needed):
        if name not in files:
            raise ValueError(f"{folder / CARD} does not list {name}, which must be there. {_AGAIN}")
    strays = [name for name in KNOWN if name not in files and os.path.lexists(folder / name)]
    if strays:
        raise ValueError(
            f"{folder / strays[0]} is not listed in {CARD}, so nothing says what it must hold. Do "
            "not use this folder: fetch it again, or delete that file if you put it there."
        )
    for name, wanted in files.items():
        if not _is_plain(name):
            raise ValueError(
                f"{folder / CARD} lists {short(name)}, which is no plain file name. Do not use "
                "this folder: its card was not written by `make export`."
            )
        if name == PROGRAM and not os.path.lexists(folder / name):
            continue  # `mitigate export FOLDER --programs` writes it
        if not (folder / name).is_file():
            raise FileNotFoundError(f"{folder} is incomplete: {name} is missing. {_AGAIN}")
        if sha256(folder / name) != wanted:
            raise ValueError(
                f"{folder / name} does not have the sha256 that {CARD} states: it was changed or "
                f"cut short. {_AGAIN}"
            )
    return card


def _is_plain(name: str) -> bool:
    """Whether ``name`` is that of a file in its folder."""
    return Path(name).name == name and name not in ("", ".", "..") and _can_be(name)


def _can_be(path: str) -> bool:
    """Whether a system can hold and show a file of that path."""
    short_enough = len(path) <= LONGEST_PATH and path.isprintable()
    return short_enough and all(len(part.encode()) <= LONGEST for part in Path(path).parts)


def read_card(folder: Path) -> dict[str, Any]:
    """Return the card of ``folder``; its own sha256 must fit. Errors as :func:`check`."""
    file = folder / CARD
    if not file.is_file():
        raise FileNotFoundError(
            f"{folder} is no hardened checkpoint: {CARD} is missing. Name a folder such as "
            "checkpoints/hardened/..., written by `make export RUN=runs/... NAME=...`; "
            "mitigate.load reads weights without a card, too, by the same agent=..."
        )
    card = read_json(file, _AGAIN)
    if isinstance(card, dict) and "format" in card and "sha256" not in card:
        raise ValueError(
            f"{file} is the card of another kind of folder, such as a restorer (restore=...): name "
            "a hardened checkpoint (checkpoints/hardened/...)."
        )
    if not isinstance(card, dict) or card.get("format") != FORMAT:
        raise ValueError(f"{file} is no card of format {FORMAT}, the one this code reads. {_AGAIN}")
    if card["sha256"] != card_sha(card):
        raise ValueError(
            f"{file} does not have the sha256 that it states: it was changed. {_AGAIN}"
        )
    lacking = [name for name in ENTRIES if name not in card]
    if lacking or not isinstance(card["files"], dict):
        raise ValueError(f"{file} lacks {', '.join(lacking or ['files'])}. {_AGAIN}")
    base = card["base"] if card["adapters_only"] else {"weights": "", "sha256": ""}
    good = isinstance(base, dict) and all(
        isinstance(base.get(name), str) and _can_be(base[name]) for name in ("weights", "sha256")
    )
    if not good:
        raise ValueError(f"{file} does not say to which base its adapters belong. {_AGAIN}")
    return card


def card_sha(card: dict[str, Any]) -> str:
    """Return the sha256 of a card's entries but "sha256" itself, as sorted JSON."""
    entries = {name: value for name, value in card.items() if name != "sha256"}
    return hashlib.sha256(json.dumps(entries, sort_keys=True).encode()).hexdigest()


def vocabulary_sha(agent: Any) -> str | None:
    """Return the first 12 hex digits of the sha256 of the words, in the order of their ids; None
    of an agent without a vocabulary."""
    if not hasattr(agent, "vocabulary"):
        return None
    return hashlib.sha256("\n".join(agent.vocabulary).encode()).hexdigest()[:12]


def _base(folder: Path, reference: dict[str, str], given: str | Path | None) -> Path:
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
