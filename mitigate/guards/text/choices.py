"""Parse the values of ``safeguard=``, and compute their labels and hashes.

A value is a name, a folder or an endpoint.
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

from mitigate.core.addresses import check_choice, is_plain
from mitigate.core.checksums import DIGITS
from mitigate.core.files import find, sha256
from mitigate.core.names import unknown
from mitigate.guards.text.classifier import CONFIG, WEIGHTS

CHOICES = ("none", "classifier", "prompted", "lora", "http://host/v1@model")
CLASSIFIER, ADAPTER = "checkpoints/safeguard_classifier", "checkpoints/safeguard"
# file names of an adapter in PEFT's format
ADAPTER_CONFIG, ADAPTER_WEIGHTS = "adapter_config.json", "adapter_model.safetensors"
EARLIER = "rules"  # name of the classifier in earlier versions
FOLDER = (
    "A safeguard's folder holds classifier.json and classifier.safetensors (`python -m "
    "mitigate.guards.text.fit --out FOLDER`), or card.json, adapter_config.json and "
    "adapter_model.safetensors of an adapter (`make train RECIPE=safeguard_lora`)."
)
# version of the repair rules; increase it whenever the repair of any text changes
VERSION = "17"
ANSWERS = "6"  # version of the rules for accepting answers of a language model


def current(choice: str) -> str:
    """Return "classifier" for "rules", its name in earlier versions; return other names as is."""
    return "classifier" if choice == EARLIER else choice


def check(choice: object) -> None:
    """Check that ``choice`` names a safeguard, without reading weights or sending requests.

    Raises ValueError if there is no such safeguard, and FileNotFoundError if ``choice`` is a folder
    without a safeguard.
    """
    text = choice if isinstance(choice, str) else ""
    # rejects a value that may contain a password, before a message can show the value
    check_choice(text)
    if is_endpoint(text) or text in (*CHOICES, EARLIER):
        return
    if not text or not find(text).is_dir():
        # a value that is not plain may contain a password, so the message does not show it
        names = f"Choose one of: {', '.join(CHOICES)}."
        cause = f"This value is not the name of an existing safeguard. {names}"
        if is_plain(choice):
            cause = unknown("safeguard", choice, CHOICES)
        raise ValueError(f"{cause} Or name a folder. {FOLDER}")
    if kind(text) is None:
        raise FileNotFoundError(
            f"There is no safeguard in {text}. {FOLDER} Or choose one of: {', '.join(CHOICES)}."
        )


def is_endpoint(choice: str) -> bool:
    """Return whether ``choice`` is the address of an endpoint."""
    return choice.lower().startswith(("http://", "https://"))


def kind(folder: str | Path) -> str | None:
    """Return the kind of safeguard in a folder: "classifier", "adapter", or None if there is none.

    Raises ValueError if the folder contains both.
    """
    folder = find(folder)
    classifier = (folder / CONFIG).is_file()
    adapter = any((folder / name).is_file() for name in (ADAPTER_WEIGHTS, ADAPTER_CONFIG))
    if classifier and adapter:
        raise ValueError(
            f"{folder} holds two safeguards, a classifier and an adapter: put each into a "
            "separate folder."
        )
    return "classifier" if classifier else "adapter" if adapter else None


def label(choice: str) -> str:
    """Return the label that identifies a safeguard in column names.

    The label is the safeguard's name, the name of its folder with a hash, or the host and the model
    of an endpoint.
    """
    choice = current(choice)
    if is_endpoint(choice):
        return re.sub(r"[^A-Za-z0-9.@-]+", "-", choice.partition("://")[2])
    file = weights_in(choice)
    if file is None:
        return Path(choice).name
    folder = Path(choice)
    while folder.name == "agent":  # training writes every adapter to a folder called "agent"
        folder = folder.parent
    return f"{folder.name}-{sha256(file)[:6]}"


def identity(choice: str) -> str:
    """Return a safeguard's label, followed by a hash of its version and weights.

    The weights of an endpoint are unknown, so they are not hashed. "none" has no hash.
    """
    if choice == "none":
        return choice
    choice = current(choice)
    chosen = {"classifier": CLASSIFIER, "lora": ADAPTER}.get(choice, choice)
    folders = [chosen] if chosen == CLASSIFIER else [CLASSIFIER, chosen]
    files = [file for folder in folders if (file := weights_in(find(folder)))]
    versions = [VERSION] if len(folders) == 1 else [VERSION, ANSWERS]
    parts = " ".join([*versions, *(sha256(file) for file in files)])
    return f"{label(choice)} {hashlib.sha256(parts.encode()).hexdigest()[:DIGITS]}"


def weights_in(folder: str | Path) -> Path | None:
    """Return the path of the weights in a safeguard's folder, or None for any other folder."""
    name = {"classifier": WEIGHTS, "adapter": ADAPTER_WEIGHTS}.get(kind(folder) or "")
    file = find(folder) / name if name else None
    return file if file and file.is_file() else None
