"""Checkpoints of training runs. A checkpoint such as ``step-00001000.pt`` contains all state that
is needed for a bit-identical resume.

Checkpoints are written atomically and rotated, and loading them runs no code. The sha256 of each
checkpoint is in a sidecar file (``core/checksums.py``) and is checked before the checkpoint is
read.
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
REQUIRED = ("format", "step", "finished", "model", "optimizer", "scheduler", "rng", "config")
_NAME = re.compile(r"step-(\d{8})\.pt")


class Damaged(ValueError):
    """A checkpoint is truncated, or its bytes have changed."""


def checkpoints(folder: Path) -> list[Path]:
    """Return the checkpoints in ``folder``, oldest first."""
    return sorted(path for path in Path(folder).glob("step-*.pt") if _NAME.fullmatch(path.name))


def steps_done(path: Path) -> int:
    """Parse the number of updates from the name of a checkpoint."""
    match = _NAME.fullmatch(path.name)
    assert match, f"{path} is not the name of a checkpoint"
    return int(match[1])


def save(folder: Path, state: dict[str, Any], *, keep: int = 2) -> Path:
    """Write ``state`` as ``step-<state["step"]>.pt`` and delete older checkpoints.

    Of the checkpoints up to this step, only the newest ``keep`` are retained. Checkpoints of later
    steps can exist only if they are damaged and the run has resumed from an earlier one. They are
    not deleted.
    """
    assert set(REQUIRED) <= {"format", *state}, f"state lacks {set(REQUIRED) - set(state)}"
    path = Path(folder) / f"step-{state['step']:08d}.pt"
    checksums.write(path, lambda file: _torch_save({"format": FORMAT, **state}, file))
    older = [other for other in checkpoints(folder) if other.name < path.name]
    for old in older[: max(0, len(older) - keep + 1)]:
        checksums.delete(old)
    checksums.delete_orphans(Path(folder), "step-*.pt")
    return path


def load(path: Path) -> dict[str, Any]:
    """Return the state that is stored in ``path``, with tensors on the CPU.

    Raises:
        FileNotFoundError: If the file is missing.
        Damaged: If the file is truncated or its bytes have changed.
        ValueError: If the file is not a checkpoint of this trainer, or if it is intact but cannot
            be read.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"There is no checkpoint {path}: check the path.")
    has_sum = checksums.sidecar(path).is_file()
    problem = checksums.problem(path) if has_sum else _zip_problem(path)
    if problem:
        raise Damaged(_broken(path, f"{problem}: the file or its checksum is truncated or damaged"))
    try:
        state = torch.load(path, map_location="cpu", weights_only=True)
    except Exception as error:  # torch may raise any kind of error for a file that it did not write
        # the file is intact, but memory ran out or the file contains more than plain data
        if has_sum:
            cause = " ".join(str(error).split())[:300]
            what = f"The checkpoint {path} is intact, but cannot be read: {cause}"
            raise ValueError(what) from error
        raise Damaged(_broken(path, "is truncated, damaged or not a torch file")) from error
    missing = [k for k in REQUIRED if k not in state] if isinstance(state, dict) else REQUIRED
    if missing:
        raise ValueError(_broken(path, f"has no {', '.join(missing)}: another program wrote it"))
    if state["format"] != FORMAT:
        raise ValueError(_broken(path, f"must have format {FORMAT}, got {state['format']}"))
    return state


def load_newest(folder: Path) -> tuple[Path, dict[str, Any]] | None:
    """Return the newest intact checkpoint in ``folder`` and its state, or None if the folder has no
    checkpoint.

    Print a line for each damaged checkpoint that is skipped. Raises Damaged if all checkpoints are
    damaged, and the errors of :func:`load`. No checkpoint is deleted.
    """
    damaged: list[Path] = []
    for path in reversed(checkpoints(folder)):
        try:
            state = load(path)
        except Damaged:
            damaged.append(path)
            continue
        for other in damaged:
            print(f"{other} is damaged; resuming from {path.name}", flush=True)
        return path, state
    if damaged:
        raise Damaged(
            f"Every checkpoint in {folder} is truncated or damaged ("
            f"{', '.join(path.name for path in damaged)}); none was deleted. If you have copies of "
            f"the checkpoints, restore them. If only the {checksums.SUFFIX} files are damaged, "
            f"delete the {checksums.SUFFIX} files. To train from the start, delete the folder. "
            "Then run the same command again."
        )
    return None


def differences(old: Any, new: Any, path: str = "") -> list[str]:
    """Return a text ``key: old -> new`` for each value that differs between two JSON configs."""
    if isinstance(old, dict) and isinstance(new, dict):
        names = [*old, *(name for name in new if name not in old)]
        return [
            line
            for name in names
            for line in differences(old.get(name), new.get(name), f"{path}.{name}".lstrip("."))
        ]
    return [] if old == new else [f"{path}: {old} -> {new}"]


def check_same(
    folder: Path, old: dict[str, Any], new: dict[str, Any], advice: str = OTHER_FOLDER
) -> None:
    """Raise ValueError if the run in ``folder`` has a config (``old``) that differs from ``new``.

    The message ends with ``advice``.
    """
    different = differences(old, new)
    if different:
        raise ValueError(
            f"{folder} holds a run with other settings ({'; '.join(different[:6])}). Use the old "
            f"settings to resume it. {advice}"
        )


def as_json(config: dict[str, Any]) -> dict[str, Any]:
    """Return ``config`` as it would be after it is written to JSON and read again.

    A checkpoint must contain only plain data, because it is read without running code.
    """
    data: dict[str, Any] = json.loads(json.dumps(config))
    return data


def _zip_problem(path: Path) -> str:
    """Describe damage in a file of ``torch.save``, detected by the checksums of its zip archive."""
    try:
        with zipfile.ZipFile(path) as archive:
            packed = any(part.compress_type != zipfile.ZIP_STORED for part in archive.infolist())
            wrong = None if packed else archive.testzip()
    except Exception:  # zipfile raises many kinds of errors for damaged files
        return "is not a complete zip file, as torch writes"
    if packed:
        return "is compressed, unlike files of torch"
    return f"has changed bytes in {wrong}" if wrong else ""


def _broken(path: Path, cause: str) -> str:
    older = [other.name for other in checkpoints(path.parent) if other.name < path.name]
    fix = (
        f"An older checkpoint exists: run the same command again to resume from {older[-1]}."
        if older
        else f"There is no older checkpoint: delete {path.name} to train from the start."
    )
    return f"The checkpoint {path} ({path.stat().st_size} bytes) {cause}. {fix}"


def _torch_save(state: dict[str, Any], file: Path) -> None:
    """Call ``torch.save``; raise OSError if the write fails."""
    try:
        torch.save(state, file)
    except RuntimeError as error:
        raise unwritten(file, error) from error
