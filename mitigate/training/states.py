"""States of a training: ``step-00001000.pt`` holds all that a run needs to go on bit for bit.

They are whole or not there: atomic writes, rotation, loading that runs no code. Beside each lies
its sha256 (``core/checksums.py``), which is compared before the file is read.
"""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path
from typing import Any

import torch

from mitigate.core import checksums
from mitigate.core.checkpoint import unwritten

FORMAT = 1
OTHER_FOLDER = "Choose another folder (folder=...), or delete this one."
REQUIRED = ("format", "step", "model", "optimizer", "scheduler", "rng", "config")
_NAME = re.compile(r"step-(\d{8})\.pt")


class Damaged(ValueError):
    """A checkpoint is cut short, or not the bytes that were written."""


def checkpoints(folder: Path) -> list[Path]:
    """Return the checkpoints in ``folder``, oldest first."""
    found = [path for path in Path(folder).glob("step-*.pt") if _NAME.fullmatch(path.name)]
    return sorted(found)


def steps_done(path: Path) -> int:
    """Return the number of updates that a checkpoint's name states."""
    found = _NAME.fullmatch(path.name)
    assert found, f"{path} is no checkpoint's name"
    return int(found[1])


def save(folder: Path, state: dict[str, Any], *, keep: int = 2) -> Path:
    """Write ``state`` as ``step-<state["step"]>.pt``, then delete the older ones but the newest
    ``keep - 1``. One of a later step, which was damaged when the run went on, stays."""
    assert set(REQUIRED) <= {"format", *state}, f"state lacks {set(REQUIRED) - set(state)}"
    path = Path(folder) / f"step-{state['step']:08d}.pt"
    checksums.write(path, lambda file: _torch_save({"format": FORMAT, **state}, file))
    older = [other for other in checkpoints(folder) if other.name < path.name]
    for old in older[: max(0, len(older) - keep + 1)]:
        checksums.delete(old)
    checksums.delete_orphans(Path(folder), "step-*.pt")
    return path


def load(path: Path) -> dict[str, Any]:
    """Return the state in ``path`` (tensors on the CPU).

    Raises FileNotFoundError if it is missing, Damaged if it is cut short or not what was written,
    ValueError if it is not a checkpoint of this trainer, or whole and still cannot be read.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"There is no checkpoint {path}: check the path.")
    noted = checksums.sidecar(path).is_file()
    problem = checksums.problem(path) if noted else _zip_problem(path)
    if problem:
        raise Damaged(_broken(path, f"{problem}: it, or the sum, is cut short or damaged"))
    try:
        state = torch.load(path, map_location="cpu", weights_only=True)
    except Exception as error:  # of any kind, where the file was not written by torch
        if noted:  # it is, to the byte: memory ran out, or it holds what is not plain data
            cause = " ".join(str(error).split())[:300]
            what = f"The checkpoint {path} is whole, but cannot be read: {cause}"
            raise ValueError(what) from error
        raise Damaged(_broken(path, "is cut short, damaged or not a torch file")) from error
    missing = [k for k in REQUIRED if k not in state] if isinstance(state, dict) else REQUIRED
    if missing:
        raise ValueError(_broken(path, f"lacks {', '.join(missing)}: another program wrote it"))
    if state["format"] != FORMAT:
        raise ValueError(_broken(path, f"has format {state['format']}, this code reads {FORMAT}"))
    return state


def load_newest(folder: Path) -> tuple[Path, dict[str, Any]] | None:
    """Return the newest sound checkpoint in ``folder`` and its state, None if there is none at all.

    Prints a line for each damaged one that is passed over. Raises Damaged if all are damaged (none
    is deleted), and as :func:`load` does.
    """
    damaged: list[Path] = []
    for path in reversed(checkpoints(folder)):
        try:
            state = load(path)
        except Damaged:
            damaged.append(path)
            continue
        for other in damaged:
            print(f"{other} is damaged; going on from {path.name}", flush=True)
        return path, state
    if damaged:
        raise Damaged(
            f"Every checkpoint in {folder} is cut short or damaged ("
            f"{', '.join(path.name for path in damaged)}); none was deleted. Copy them back if you "
            f"have them elsewhere. If their {checksums.SUFFIX} files alone are damaged, delete "
            "these; to train from the start, delete the folder. Then run the same command again."
        )
    return None


def differences(old: Any, new: Any, path: str = "") -> list[str]:
    """Return one ``key: old -> new`` for each leaf in which two JSON-able configs differ."""
    if isinstance(old, dict) and isinstance(new, dict):
        names = [*old, *(name for name in new if name not in old)]
        return [
            line
            for name in names
            for line in differences(old.get(name), new.get(name), f"{path}.{name}".lstrip("."))
        ]
    return [] if old == new else [f"{path}: {old} -> {new}"]


def check_same(folder: Path, old: dict[str, Any], new: dict[str, Any]) -> None:
    """Raise ValueError if the run in ``folder`` was begun with the config ``old``, not ``new``."""
    different = differences(old, new)
    if different:
        raise ValueError(
            f"{folder} holds a run with other settings ({'; '.join(different[:6])}). Use the old "
            f"settings to resume it. {OTHER_FOLDER}"
        )


def as_json(config: dict[str, Any]) -> dict[str, Any]:
    """``config`` as JSON gives it back: a checkpoint is read without running code, and so holds
    plain data alone."""
    held: dict[str, Any] = json.loads(json.dumps(config))
    return held


def _zip_problem(path: Path) -> str:
    """Return what is wrong with a file of ``torch.save`` by the checksums that zip files hold."""
    try:
        with zipfile.ZipFile(path) as archive:
            packed = any(part.compress_type != zipfile.ZIP_STORED for part in archive.infolist())
            wrong = None if packed else archive.testzip()
    except Exception:  # zipfile meets a damaged file with errors of many kinds
        return "is no whole zip file, as torch writes"
    if packed:
        return "is compressed, as torch's files are not"
    return f"has other bytes in {wrong} than were written" if wrong else ""


def _broken(path: Path, cause: str) -> str:
    older = [other.name for other in checkpoints(path.parent) if other.name < path.name]
    fix = (
        f"An older checkpoint is kept: run the same command again, which goes on from {older[-1]}."
        if older
        else f"No older checkpoint lies beside it: delete {path.name} to train from the start."
    )
    return f"The checkpoint {path} ({path.stat().st_size} bytes) {cause}. {fix}"


def _torch_save(state: dict[str, Any], file: Path) -> None:
    """As ``torch.save``, where a write that fails is an OSError as elsewhere."""
    try:
        torch.save(state, file)
    except RuntimeError as error:
        raise unwritten(file, error) from error
