"""Checkpoints that are whole or not there: atomic writes, rotation, loading that runs no code.

Two kinds of file: ``step-00001000.pt`` holds everything a run needs to go on bit for bit;
``model.safetensors`` holds weights alone, to evaluate, ship or start from. Beside each lies its
sha256 (``checksums.py``), which is compared before the file is read; a weights file without one, of
an older version or from elsewhere, is read all the same.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import zipfile
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import nn

from mitigate.core import checksums
from mitigate.core.names import short

FORMAT = 1
REQUIRED = ("format", "step", "model", "optimizer", "scheduler", "rng", "config")
WEIGHTS = "model.safetensors"
ADAPTER = ".adapter."  # in the names of adapters' tensors, see mitigate/agents/adapters.py
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
    checksums.delete_sidecars(Path(folder), "step-*.pt", orphans=True)
    return path


def load(path: Path) -> dict[str, Any]:
    """Return the state in ``path`` (tensors on the CPU).

    Raises FileNotFoundError if it is missing, Damaged if it is cut short or not what was written,
    ValueError if it is not a checkpoint of this trainer.
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


def weights_file(path: str | Path) -> Path:
    """Return the safetensors file that ``path`` (the file or its folder) means.

    Raises FileNotFoundError if there is none.
    """
    given = Path(path)
    file = given if given.suffix == ".safetensors" else given / WEIGHTS
    if not file.is_file():
        raise FileNotFoundError(
            f"There are no weights at {given}: expected a .safetensors file or a folder that holds "
            f"{WEIGHTS}, such as checkpoints/base. Train some with `make train RECIPE=base`, or as "
            "docs/agents.md says for other kinds: RECIPE=dagger, for topological_imagenet "
            "RECIPE=swap_encoder. Then name them: weights.base=runs/.../agent."
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
    return checksums.write(file, lambda temporary: _save_file(tensors, temporary))


def _torch_save(state: dict[str, Any], file: Path) -> None:
    """As ``torch.save``, where a write that fails is an OSError as elsewhere."""
    try:
        torch.save(state, file)
    except RuntimeError as error:
        raise _unwritten(file, error) from error


def _save_file(tensors: dict[str, torch.Tensor], file: Path) -> None:
    try:
        save_file(tensors, file)
    except SafetensorError as error:
        raise _unwritten(file, error) from error


def _unwritten(file: Path, error: Exception) -> OSError:
    cause = str(error).splitlines()[0][:200]
    return OSError(
        f"A checkpoint could not be written to {file.parent} ({cause}): is the disk full "
        f"({shutil.disk_usage(file.parent).free >> 20} MiB are free)? Checkpoints of before are "
        "whole; free some room, and the same command goes on from the newest."
    )


def load_weights(module: nn.Module, path: str | Path) -> None:
    """Fill ``module`` from :func:`save_weights`' file; names and shapes must match exactly.

    Only adapters may be absent, all of them, from weights that were trained before they came in:
    they stay as they are.

    Raises FileNotFoundError or ValueError, naming the file and the first differences.
    """
    file = weights_file(path)
    _fill(module, load_tensors(file), file)


def not_finite(module: nn.Module) -> list[str]:
    """Return the names of the parameters that hold NaN or infinity, and of the buffers that hold
    NaN (infinity masks attention in some)."""
    found = [n for n, p in module.named_parameters() if not torch.isfinite(p).all()]
    return found + [n for n, b in module.named_buffers() if torch.isnan(b).any()]


def check_finite(module: nn.Module, what: str) -> None:
    """Raise ValueError if the weights of ``module``, which are ``what``, are not all numbers."""
    bad = not_finite(module)
    if bad:
        raise ValueError(
            f"{what} hold NaN or infinity, {len(bad)} tensors of them ({', '.join(bad[:3])}): the "
            "training that made them went wrong. Choose other weights, or train again with a lower "
            "trainer.lr."
        )


def load_part(module: nn.Module, name: str, path: str | Path) -> None:
    """As :func:`load_weights`, of the part ``name`` alone, which is ``module``; what it has not,
    such as a layer for a sensor that this agent lacks, is left out."""
    file, prefix = weights_file(path), f"{name}."
    found = {
        k.removeprefix(prefix): v for k, v in load_tensors(file).items() if k.startswith(prefix)
    }
    if not found:
        raise ValueError(f"The weights {file} hold no part {name!r}.")
    own = {*module.state_dict(), *_borrowed(module)}
    found = {name: value for name, value in found.items() if name in own}
    _fill(module, found, file)


def _fill(module: nn.Module, found: dict[str, torch.Tensor], file: Path) -> None:
    wanted = {k: v for k, v in module.state_dict().items() if isinstance(v, torch.Tensor)}
    borrowed = _borrowed(module)
    wanted = {k: v for k, v in wanted.items() if k not in borrowed}
    wanted |= {k: v for k, v in borrowed.items() if k in found}
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
    check_finite(module, f"The weights {file}")


def _borrowed(module: nn.Module) -> dict[str, torch.Tensor]:
    """The tensors that a state dict leaves out where they are public ones: ``public_tensors`` of
    the modules in ``module`` that have such (``core/public_weights.py``)."""
    return {
        f"{prefix}.{name}" if prefix else name: value
        for prefix, part in module.named_modules()
        for name, value in getattr(part, "public_tensors", {}).items()
    }


def load_tensors(file: Path) -> dict[str, torch.Tensor]:
    """Return the tensors of a safetensors file; ValueError if it is damaged, by its sidecar (if it
    has one) or by itself."""
    problem = checksums.problem(file)
    if not problem:
        try:
            found = load_file(file)
            bad = [name for name, value in found.items() if torch.isnan(value).any()]
            if not bad:
                return found
            problem = f"holds NaN ({short(bad[0])})"
        except (SafetensorError, OSError, KeyError) as error:
            problem = f"cannot be read: {short(str(error), 200)}"
    raise ValueError(
        f"The weights {file} ({file.stat().st_size} bytes) are cut short or damaged: {file.name} "
        f"{problem}. {_again(file)}"
    )


def _again(file: Path) -> str:
    folder = file.resolve().parent
    if folder.name == "agent" and any(folder.parent.glob("*/step-*.pt")):  # as train.run writes it
        return (
            "They are those of a run: the same `make train` command writes them again from the "
            "run's checkpoints."
        )
    note = checksums.sidecar(file)
    alone = f" If you know that {note.name} alone is damaged, delete it." if note.is_file() else ""
    return f"Fetch or train them again.{alone}"


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
