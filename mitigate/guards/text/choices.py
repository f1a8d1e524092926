"""What may be chosen as a safeguard: names, the folders that they stand for, short names for
tables, and hashes that tell one from another in rows of results."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

from mitigate.core.files import find, sha256
from mitigate.core.names import unknown
from mitigate.guards.text.addresses import check_choice
from mitigate.guards.text.texts import weights

CHOICES = ("none", "rules", "tagger", "reader", "prompted", "lora", "tagger+lora", "reader+lora",
    "http://host/v1@model")  # fmt: skip
ADAPTER = "checkpoints/safeguard"
TAGGERS = {"tagger": "checkpoints/safeguard_tagger", "reader": "checkpoints/safeguard_reader"}
FOLDER = (
    "A safeguard's folder holds model.safetensors of a tagger or a reader (`make train "
    "RECIPE=safeguard_tagger` or RECIPE=safeguard_reader), or card.json, adapter_config.json and "
    "adapter_model.safetensors of an adapter (RECIPE=safeguard_lora)."
)
VERSION = "8"  # of what the rules give on: another one where any text is repaired otherwise
ANSWERS = "2"  # of what is taken of a language model's answers


def check(choice: object) -> None:
    """Raise ValueError for a choice that names no safeguard, FileNotFoundError for a folder that
    holds none. No weights are read, and no address is asked."""
    text = choice if isinstance(choice, str) else ""
    check_choice(text)  # before anything repeats it
    first, plus, second = text.partition("+")
    behind = bool(plus and first in TAGGERS)
    named = second if behind else text
    if named.lower().startswith(("http://", "https://")):
        return
    alone = behind and named in ("none", "rules", *TAGGERS)
    if alone or (named not in CHOICES and not (named and Path(named).is_dir())):
        raise ValueError(f"{unknown('safeguard', choice, CHOICES)} Or name a folder. {FOLDER}")
    if named not in CHOICES and not _holds_one(named):
        raise FileNotFoundError(not_in(named))
    if behind and named not in CHOICES and holds_tags(named):
        raise ValueError(
            f"Behind {first}+ stands a language model, but {named} holds a tagger or a reader: "
            f"choose {named} alone, {first} alone, or {first}+ and an adapter's folder. {FOLDER}"
        )


def not_in(folder: str | Path) -> str:
    """Return what is said of a folder that holds no safeguard."""
    return f"There is no safeguard in {folder}. {FOLDER} Or choose one of: {', '.join(CHOICES)}."


def label(choice: str) -> str:
    """Return a short name for a safeguard: an adapter's folder with a hash of its weights, an
    endpoint's host and model; the names of ours as they are."""
    if choice.lower().startswith(("http://", "https://")):
        return re.sub(r"[^A-Za-z0-9.@-]+", "-", choice.partition("://")[2])
    first, plus, second = choice.partition("+")
    if plus and first in TAGGERS:
        return f"{first}+{label(second)}"
    file = weights_in(choice)
    if file is None:
        return Path(choice).name
    folder = Path(choice)
    while folder.name == "agent":  # every trained adapter lies in a folder called so
        folder = folder.parent
    return f"{folder.name}-{sha256(file)[:6]}"


def identity(choice: str) -> str:
    """Return the label of a safeguard and a hash over the version and weights of its rules and
    over the weights of its networks (an endpoint's stay unknown); with a language model, over how
    its answers are judged too. "none" has no hash."""
    if choice == "none":
        return choice
    from mitigate.core.checksums import DIGITS

    first, plus, second = choice.partition("+")
    parts = [first, second] if plus and first in TAGGERS else [choice]
    folders = [{**TAGGERS, "lora": ADAPTER}.get(part, part) for part in parts]
    files = [file for folder in folders if (file := weights_in(find(folder)))]
    versions = [VERSION] if set(parts) <= {"rules", *TAGGERS} else [VERSION, ANSWERS]
    held = " ".join([*versions, *(sha256(file) for file in (weights.USED, *files))])
    return f"{label(choice)} {hashlib.sha256(held.encode()).hexdigest()[:DIGITS]}"


def _holds_one(folder: str) -> bool:
    """Whether a folder holds weights, or the config of an adapter that lacks them."""
    from mitigate.guards.text.language_models.adapter_folder import CONFIG

    return weights_in(folder) is not None or (Path(folder) / CONFIG).is_file()


def weights_in(folder: str | Path) -> Path | None:
    """Return the weights in a folder of a network or an adapter, by which it is opened and known;
    None for what is no such folder. Raises ValueError for a folder that holds both."""
    from mitigate.core.checkpoint import WEIGHTS
    from mitigate.guards.text.language_models.adapter_folder import ADAPTER as ADAPTER_FILE

    files = [file for name in (WEIGHTS, ADAPTER_FILE) if (file := Path(folder) / name).is_file()]
    if len(files) > 1:
        raise ValueError(
            f"{folder} holds two safeguards, {WEIGHTS} of a tagger or a reader and {ADAPTER_FILE} "
            "of an adapter: give each a folder of its own."
        )
    return files[0] if files else None


def holds_tags(folder: str | Path) -> bool:
    """Return whether a folder holds a tagger or a reader."""
    from mitigate.core.checkpoint import WEIGHTS

    file = weights_in(folder)
    return file is not None and file.name == WEIGHTS
