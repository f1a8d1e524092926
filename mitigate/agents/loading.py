"""Load agents from folders of shipped weights, training runs and hardened exports.

No code in a folder is run. Files are compared with the manifest (``core/folders.py``). Weights are
safetensors files. Settings are plain YAML, which is checked against the schema of the agent's
class. Only classes in ``schema.KINDS`` are built. If the agent is of another class, the user builds
it, and the functions here load the weights into it (``agent=``).

``mitigate export`` writes a *hardened* folder. Its ``card.json`` records how the agent was trained
and the hash of its weights; see ``checkpoints/README.md``.
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
from mitigate.core.pretrained import PEFT_WEIGHTS

FORMAT = 2  # format number of a card
CARD, README = "card.json", "README.md"
PROGRAM, INPUTS = "program.pt2", "program.json"
FILES = (CONFIG, README, INPUTS)  # files of an exported agent besides weights and programs
ONNX = ("perceive.onnx", "decide.onnx")
# files that an export may write; if a folder holds such a file, its manifest must list the file
KNOWN = (checkpoint.WEIGHTS, adapters.WEIGHTS, adapters.SETTINGS, *FILES, PROGRAM, *ONNX)
ENTRIES = ("adapters_only", "base", "vocabulary", "commit", "agent")  # required in a card
# maximum length of a path to base weights (heuristic; the limit of Linux is 4095)
LONGEST_PATH = 1000
# agents with up to this many weights (128 MiB) are built without a file-size check (heuristic)
FREE_WEIGHTS = 1 << 25
TARGET = schema.KINDS[0]
# packages whose models are not navigation agents, and the documentation page of each package
PAGES = {
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
        folder: a hardened folder (as in :func:`load_hardened`), shipped weights
            (``checkpoints/recurrent/base``), or the folder ``agent`` of a run. A relative path is
            looked up first in the current folder, then in this project.
        agent: a user-defined agent, built with the settings of the trained agent. The weights
            are loaded into it in place. If it is None, a new agent of a shipped kind is built.

    Raises:
        FileNotFoundError, ValueError: If the weights are missing or damaged; if the settings of
            their agent are missing; if the trained agent is user-defined and ``agent`` is
            None; or if ``agent`` has different settings. The error message names the file.
        TypeError: If ``folder`` is not a path, or ``agent`` has no weights.
    """
    place = find(folder)
    if (place / CARD).is_file():
        return load_hardened(place, agent=agent)
    manifest = folders.check(place if place.is_dir() else place.parent)
    reject_other_models(place)
    if (place / "agent").is_dir():
        raise ValueError(f"{folder} is the folder of a run. Name its agent, {place / 'agent'}.")
    config = config_of(place)
    if agent is None and not config.is_file():
        raise FileNotFoundError(
            f"{config} is missing, so the settings of the agent in {folder} are unknown."
        )
    lora = place / PEFT_WEIGHTS
    weights = lora if lora.is_file() else checkpoint.weights_file(place)
    if manifest is not None and weights.name not in manifest.files:
        raise ValueError(
            f"{weights} is not listed in {folders.MANIFEST}, so it cannot be checked. {_AGAIN}"
        )
    with torch.random.fork_rng(devices=[]):  # this keeps the caller's random state unchanged
        filled = _agent_to_fill(agent, config, weights, _RUN)
        checkpoint.load_agent(filled, place)
    if config.is_file():
        give_settings(filled, config, _RUN)
    return filled.eval()


def load_hardened(folder: str | Path, *, base: str | Path | None = None, agent: Any = None) -> Any:
    """Return the agent of a hardened checkpoint on the CPU, in eval mode, ready for ``reset``.

    This function needs neither Hydra nor the simulator. A warning is issued if an attribute of
    ``agent`` has the name of a setting but a different value.

    Args:
        folder: a folder such as ``checkpoints/hardened/ts_distill``.
        base: if the folder holds only adapters, the file or folder of the weights to which they
            belong. If None, the path in the card is used. This path is looked up relative to the
            current folder, the parent folders of ``folder``, and the checkout.
        agent: a user-defined agent, built with the settings of the exported agent. The
            weights are loaded into it in place. If this agent has no ``settings()``, it receives
            the settings in the folder. If it is None, a new agent of a shipped kind is built.

    Raises:
        FileNotFoundError, ValueError: If the folder is incomplete, or differs from its card.
        TypeError: If ``folder`` is not a path, or ``agent`` has no weights.
    """
    folder = find(folder)
    card = check_hardened(folder)
    weights = _weights_of(folder, card, base)
    with torch.random.fork_rng(devices=[]):
        filled = _agent_to_fill(agent, folder / CONFIG, weights, _AGAIN)
        if agent is None and card["vocabulary"] != vocabulary_sha(filled):
            commit = f" (commit {short(card['commit'])})" if card["commit"] else ""
            raise ValueError(
                f"{folder} was exported with a different vocabulary than its {CONFIG} gives, so "
                f"instructions would be misread. Use the version that exported it{commit}."
            )
        _fill(filled, folder, card, weights)
    sha = checkpoint.weights_sha(filled)
    if sha != card["agent"]:
        raise ValueError(
            f"The agent loaded from {folder} must have the hash {short(card['agent'])} ({CARD}), "
            f"got {sha}. {_AGAIN} Convert an agent to another dtype only after loading its weights."
        )
    give_settings(filled, folder / CONFIG, _AGAIN)
    return filled.eval()


def _agent_to_fill(agent: Any, config: Path, weights: Path, again: str) -> Any:
    """Return ``agent`` if its settings match ``config``; if it is None, build a new agent."""
    if agent is None:
        return build_from(config, weights)
    # the user may pass an object of any type
    if isinstance(agent, type) or not hasattr(agent, "eval"):
        raise TypeError(
            f"agent must be a torch.nn.Module with weights, got {agent!r:.80}. Create an object of "
            "the class that was trained."
        )
    if config.is_file():
        check_same(agent, config, again)
    return agent


def build_from(config: Path, weights: Path | None = None) -> Any:
    """Build an agent of a shipped class with the settings in ``config`` and random weights.

    The YAML file is read as plain data. A large agent with more weights than the file ``weights``
    has bytes is rejected before memory is allocated for it.

    Raises:
        ValueError: If the file is damaged, or names a different kind of agent. Also if the agent is
            large and has more weights than the file ``weights`` has bytes.
    """
    kind = kind_of(config)
    make = partial(schema.class_of(kind), **agent_settings(config, kind))
    try:
        if weights is not None:
            with torch.device("meta"), warnings.catch_warnings():
                # the warning that a backbone's weights cannot be copied here
                warnings.simplefilter("ignore")
                count = sum(parameter.numel() for parameter in make().parameters())
            size = weights.stat().st_size
            if count > max(FREE_WEIGHTS, size):  # each weight takes at least one byte of the file
                raise ValueError(f"they require {count} weights, but {weights} has {size} bytes")
        return make()
    except (TypeError, ValueError, RuntimeError) as error:
        raise ValueError(f"The agent's settings in {config} do not fit ({error}).") from error


def config_of(weights: Path) -> Path:
    """Return the path of the config that belongs to ``weights``, which is a file or a folder.

    Raises:
        FileNotFoundError: If there are no weights.
        ValueError: If ``weights`` is a file inside a hardened folder; the folder itself must be
            named.
    """
    if is_hardened(weights) or (weights / PEFT_WEIGHTS).is_file():
        return weights / CONFIG
    if weights.is_file() and is_hardened(weights.parent):
        raise ValueError(
            f"{weights} belongs to a hardened folder. Name the folder, {weights.parent}."
        )
    return checkpoint.weights_file(weights).with_name(CONFIG)


def reject_other_models(run: Path) -> None:
    """Raise ValueError if a folder holds a model that is not a navigation agent.

    ``run`` is the folder of a run, or its subfolder ``agent``.
    """
    config = run / CONFIG
    target = str(_agent_node(config).get("_target_")) if config.is_file() else ""
    page = next((page for start, page in PAGES.items() if target.startswith(f"{start}.")), "")
    if page:
        folder = run / "agent" if (run / "agent").is_dir() else run
        raise ValueError(
            f"{run} must hold a navigation agent, got a {target.rpartition('.')[2]}. It needs no "
            f"export: use {folder} directly, as {page} describes."
        )


# user-defined agents -----------------------------------------------------------------------------


def check_same(agent: Any, config: Path, again: str) -> None:
    """Compare the settings of ``agent`` with those in ``config``.

    If the agent has no ``settings()``, each plain setting is compared with the agent's attribute of
    the same name. In this case, a difference causes only a warning, because the attribute may mean
    something else.

    Raises:
        ValueError: If the settings differ, or the file has no settings (this message ends with
            ``again``).
    """
    stored = _settings_in(config, again)
    actual = stated = stated_settings(agent)
    if actual is None:
        attributes = {k: read(agent, k) for k, v in stored.items() if isinstance(v, _PLAIN)}
        actual = {name: value for name, value in attributes.items() if isinstance(value, _PLAIN)}
    wrong = [k for k, v in actual.items() if k in stored and _as_json(stored[k]) != _as_json(v)]
    if not wrong:
        return
    text = (
        f"{config} belongs to an agent with {wrong[0]}={stored[wrong[0]]!r:.60}, but the given "
        f"agent has {actual[wrong[0]]!r:.60}. Build it with the settings in that file."
    )
    if stated is not None:
        raise ValueError(text)
    warnings.warn(text, stacklevel=4)


def give_settings(agent: Any, config: Path, again: str) -> None:
    """If an agent has no ``settings``, set them to the settings in ``config``.

    ``building.build_agent`` does the same, so the fingerprints are equal. Raises the same errors
    as :func:`check_same`.
    """
    if stated_settings(agent) is None:
        known = {k: v for k, v in _settings_in(config, again).items() if k != "_target_"}
        agent.settings = partial(dict, known)


def _settings_in(config: Path, again: str) -> dict[str, Any]:
    stored = _agent_node(config)
    if not stored:
        raise ValueError(f"{config} contains no settings of an agent. {again}")
    return stored


def _agent_node(config: Path) -> dict[str, Any]:
    """Return the agent's settings in ``config``, or an empty dict if it contains none."""
    node = settings.read(config).get("agent")
    return node if isinstance(node, dict) else {}


def _as_json(value: Any) -> Any:
    """Return ``value`` as it would be after it is written and read as JSON; tuples become lists."""
    return json.loads(json.dumps(value, default=lambda one: read(one, "tolist", "__str__")()))


# settings of shipped kinds of agents -------------------------------------------------------------


def kind_of(config: Path) -> str:
    """Return the kind of the agent in ``config``, one of ``schema.KINDS``.

    If ``config`` names none of them, return the first kind.
    """
    target = _agent_node(config).get("_target_")
    return target if target in schema.KINDS else TARGET


def agent_settings(config: Path, target: str = TARGET) -> dict[str, Any]:
    """Return the constructor arguments in ``config`` for an agent of the kind ``target``.

    Raises the same errors as :func:`build_from`.
    """
    known = schema.schema_of(target)
    values = settings.read_agent(config, target, known)
    schema.check(values, known, config)
    return values


# hardened folders --------------------------------------------------------------------------------


def is_hardened(folder: str | Path) -> bool:
    """Return whether ``folder`` is hardened. Raises ValueError if the manifest is damaged."""
    manifest = folders.read_manifest(folder, _AGAIN)
    return manifest is not None and manifest.kind == "hardened"


def adapters_only(folder: str | Path) -> bool:
    """Return whether ``folder`` is hardened and holds only adapters, which refer to base weights.

    Raises the same errors as :func:`read_card`.
    """
    return is_hardened(folder) and bool(read_card(Path(folder))["adapters_only"])


def fill(agent: Any, folder: str | Path) -> None:
    """Load the weights of a hardened folder into ``agent``, including adapters and base weights.

    Adapters of ``agent`` that are not in the folder are not changed. Errors are as in
    :func:`load_hardened`. ValueError is also raised if the agent has different adapters or weights.
    """
    folder = Path(folder)
    card = check_hardened(folder)
    _fill(agent, folder, card, _weights_of(folder, card, None))


def _fill(agent: Any, folder: Path, card: dict[str, Any], weights: Path) -> None:
    if not card["adapters_only"]:
        checkpoint.load_weights(agent, weights)
        return
    adapted = [*adapters.adapted(agent)]
    adapters.remove_adapters(agent)
    checkpoint.load_weights(agent, weights)
    if adapters.load_adapters(agent, folder) != adapted:
        raise ValueError(
            f"agent.adapters must name the modules of the adapters in {folder}, but names others. "
            f"Build the agent with the {CONFIG} of this folder."
        )


def check_hardened(folder: Path) -> dict[str, Any]:
    """Return the card of ``folder`` after comparing every file with the manifest.

    ``program.pt2`` may be missing: loading does not read it, and `mitigate export FOLDER
    --programs` writes it again.

    Raises:
        FileNotFoundError: If another file is missing.
        ValueError: If a file has been changed, or the card is damaged.
    """
    card = read_card(folder)
    manifest = folders.read_manifest(folder, _AGAIN)
    assert manifest is not None
    weights = [adapters.WEIGHTS, adapters.SETTINGS]
    weights = weights if card["adapters_only"] else [checkpoint.WEIGHTS]
    needed = FILES if card.get("program", True) else (CONFIG, README)
    for name in (*weights, *needed):
        if name not in manifest.files:
            raise ValueError(
                f"{folder / folders.MANIFEST} must list {name}, but does not list it. {_AGAIN}"
            )
    unlisted = [n for n in KNOWN if n not in manifest.files and os.path.lexists(folder / n)]
    if unlisted:
        raise ValueError(
            f"{folder / unlisted[0]} is not listed in {folders.MANIFEST}, so it cannot be checked. "
            "Fetch the folder again, or delete that file if you put it there."
        )
    folders.check(folder, optional=(PROGRAM,), again=_AGAIN)
    return card


def read_card(folder: Path) -> dict[str, Any]:
    """Return the contents of ``card.json`` in the hardened folder ``folder``.

    Raises the same errors as :func:`check_hardened`.
    """
    file = folder / CARD
    if not file.is_file():
        raise FileNotFoundError(
            f"{folder} is not a hardened checkpoint: {CARD} is missing. Name a folder that `make "
            "export` wrote. For weights without a card: mitigate.load(folder, agent=...)."
        )
    card = read_object(file, _AGAIN)
    manifest = folders.read_manifest(folder, _AGAIN)
    if manifest is None:
        raise FileNotFoundError(
            f"{folder} is not a complete hardened checkpoint: {folders.MANIFEST} is missing. "
            f"{_AGAIN}"
        )
    if manifest.kind != "hardened":
        raise ValueError(
            f"{file} is the card of another kind of folder, such as a restorer (restore=...). Name "
            "a hardened checkpoint (checkpoints/hardened/...)."
        )
    if card.get("format") != FORMAT:
        raise ValueError(
            f"{file} must be a card of format {FORMAT}, got {short(card.get('format'))}. {_AGAIN}"
        )
    lacking = [name for name in ENTRIES if name not in card]
    if lacking:
        raise ValueError(f"{file} lacks {', '.join(lacking)}. {_AGAIN}")
    base = card["base"] if card["adapters_only"] else {"weights": "", "sha256": ""}
    if not isinstance(base, dict) or not all(_is_path(base.get(k)) for k in ("weights", "sha256")):
        raise ValueError(f"{file} does not name the base of its adapters. {_AGAIN}")
    return card


def _is_path(value: Any) -> bool:
    """Return whether ``value`` is a printable path that file systems accept."""
    if not isinstance(value, str) or len(value) > LONGEST_PATH or not value.isprintable():
        return False
    return all(len(part.encode()) <= folders.LONGEST for part in Path(value).parts)


def vocabulary_sha(agent: Any) -> str | None:
    """Return a hash of an agent's vocabulary, or None if the agent has no vocabulary.

    The hash is the first 12 hex digits of the sha256 of the words, in the order of their ids.
    """
    if not hasattr(agent, "vocabulary"):  # only some kinds of agents have a vocabulary
        return None
    return hashlib.sha256("\n".join(agent.vocabulary).encode()).hexdigest()[:12]


def _weights_of(folder: Path, card: dict[str, Any], base: str | Path | None) -> Path:
    """Return the path of the weights; if ``folder`` holds only adapters, of their base weights."""
    if not card["adapters_only"]:
        return folder / checkpoint.WEIGHTS
    reference = card["base"]
    parents = [parent / reference["weights"] for parent in folder.resolve().parents]
    local, *shipped = places(reference["weights"])
    candidates = [local, *parents, *shipped] if base is None else [Path(base)]
    files = [p if p.suffix == ".safetensors" else p / checkpoint.WEIGHTS for p in candidates]
    present = [file for file in files if file.is_file()]
    for file in present:
        if sha256(file) == reference["sha256"]:
            return file
    cause = f"{present[0]} has a different one" if present else f"{files[0]} does not exist"
    raise (ValueError if present else FileNotFoundError)(
        f"The adapters in {folder} belong to the weights {reference['weights']} with sha256 "
        f"{reference['sha256']}, but {cause}. Name these weights: load_hardened(folder, base=...)."
    )
