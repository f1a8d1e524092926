"""Checkpoints that are whole or not there: atomic writes, rotation, loading that runs no code.

Two kinds of file: ``step-00001000.pt`` holds everything a run needs to go on bit for bit;
``model.safetensors`` holds weights alone, to evaluate, ship or start from.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import nn

FORMAT = 1
REQUIRED = ("format", "step", "model", "optimizer", "scheduler", "rng", "config")
WEIGHTS = "model.safetensors"
ADAPTER = ".adapter."  # in the names of adapters' tensors, see mitigate/agents/adapters.py
_NAME = re.compile(r"step-(\d{8})\.pt")


def write_atomically(path: Path, write: Callable[[Path], Any]) -> Path:
    """Call ``write`` on a temporary neighbour of ``path``, flush it to disk, then rename it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        write(temporary)
        with open(temporary, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
    return path


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
    """Write ``state`` as ``step-<state["step"]>.pt``, then delete all but the newest ``keep``."""
    assert set(REQUIRED) <= {"format", *state}, f"state lacks {set(REQUIRED) - set(state)}"
    path = Path(folder) / f"step-{state['step']:08d}.pt"
    write_atomically(path, lambda file: torch.save({"format": FORMAT, **state}, file))
    for old in checkpoints(folder)[:-keep]:
        old.unlink()
    return path


def load(path: Path) -> dict[str, Any]:
    """Return the state in ``path`` (tensors on the CPU).

    Raises FileNotFoundError if it is missing, ValueError if it is cut short, damaged, or not a
    checkpoint of this trainer.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"There is no checkpoint {path}: check the path.")
    try:
        state = torch.load(path, map_location="cpu", weights_only=True)
    except (RuntimeError, EOFError, pickle.UnpicklingError, ValueError, KeyError, OSError) as error:
        raise ValueError(_broken(path, "is cut short, damaged or not a torch file")) from error
    missing = [k for k in REQUIRED if k not in state] if isinstance(state, dict) else REQUIRED
    if missing:
        raise ValueError(_broken(path, f"lacks {', '.join(missing)}: another program wrote it"))
    if state["format"] != FORMAT:
        raise ValueError(_broken(path, f"has format {state['format']}, this code reads {FORMAT}"))
    return state


def _broken(path: Path, cause: str) -> str:
    older = [other.name for other in checkpoints(path.parent) if other.name < path.name]
    fix = (
        f"An older checkpoint is kept: delete {path.name} and run the same command again to go on "
        f"from {older[-1]}."
        if older
        else f"No older checkpoint lies beside it: delete {path.name} to train from the start."
    )
    return f"The checkpoint {path} ({path.stat().st_size} bytes) {cause}. {fix}"


def weights_file(path: str | Path) -> Path:
    """Return the safetensors file that ``path`` (the file or its folder) means.

    Raises FileNotFoundError if there is none.
    """
    given = Path(path)
    file = given if given.suffix == ".safetensors" else given / WEIGHTS
    if not file.is_file():
        raise FileNotFoundError(
            f"There are no weights at {given}: expected a .safetensors file or a folder that holds "
            f"{WEIGHTS}, such as checkpoints/base. Train one with `make train RECIPE=base`."
        )
    return file


def save_weights(module: nn.Module, path: str | Path, *, half: bool = False) -> Path:
    """Write the tensors of ``module.state_dict()`` to a safetensors file (or into a folder).

    ``half`` rounds floats to float16, as in the shipped weights: half the bytes.
    """
    given = Path(path)
    file = given if given.suffix == ".safetensors" else given / WEIGHTS
    tensors = {
        name: (value.half() if half and value.is_floating_point() else value).cpu().clone()
        for name, value in module.state_dict().items()
        if isinstance(value, torch.Tensor)
    }
    return write_atomically(file, lambda temporary: save_file(tensors, temporary))


def load_weights(module: nn.Module, path: str | Path) -> None:
    """Fill ``module`` from :func:`save_weights`' file; names and shapes must match exactly.

    Only adapters may be absent, all of them, from weights that were trained before they came in:
    they stay as they are.

    Raises FileNotFoundError or ValueError, naming the file and the first differences.
    """
    file = weights_file(path)
    try:
        found = load_file(file)
    except (SafetensorError, OSError) as error:
        raise ValueError(
            f"The weights {file} ({file.stat().st_size} bytes) are cut short or damaged ({error}). "
            "Fetch or train them again."
        ) from error
    wanted = {k: v for k, v in module.state_dict().items() if isinstance(v, torch.Tensor)}
    if not any(ADAPTER in name for name in found):
        wanted = {name: value for name, value in wanted.items() if ADAPTER not in name}
    wrong = sorted(
        name
        for name in {*found, *wanted}
        if name not in found or name not in wanted or found[name].shape != wanted[name].shape
    )
    if wrong:
        raise ValueError(
            f"The weights {file} do not fit this {type(module).__name__}: {len(wrong)} names are "
            f"missing, unknown or of another shape ({', '.join(wrong[:4])} ...). Build the agent "
            "with the config that made them (config.yaml beside them) or choose other weights."
        )
    module.load_state_dict(found, strict=False)


def save_agent(agent: nn.Module, folder: str | Path) -> None:
    """Write what was trained into ``folder``: by the agent's own ``save``, if it has one (an
    adapter in PEFT's format), else as :func:`save_weights` does."""
    getattr(agent, "save", lambda path: save_weights(agent, path))(folder)


def load_agent(agent: nn.Module, path: str | Path) -> None:
    """Fill ``agent`` from what :func:`save_agent` wrote; raises as :func:`load_weights` does."""
    getattr(agent, "load", lambda place: load_weights(agent, place))(path)


def weights_sha(module: nn.Module, leave_out: str | None = None) -> str:
    """Return the first 12 hex digits of the sha256 over names, types, shapes and bytes.

    ``leave_out``: names that hold this text do not count.
    """
    sha = hashlib.sha256()
    for name, value in sorted(module.state_dict().items()):
        if isinstance(value, torch.Tensor) and not (leave_out and leave_out in f".{name}"):
            sha.update(f"{name} {value.dtype} {tuple(value.shape)}".encode())
            raw = value.detach().cpu().contiguous().reshape(-1).view(torch.uint8)
            sha.update(raw.numpy().tobytes())
    return sha.hexdigest()[:12]
