"""Weights: ``model.safetensors`` in a folder, to evaluate, ship or start from.

A folder has a manifest (``folders.py``), a single file has its sha256 beside it (``checksums.py``);
either is compared before the weights are read. Weights without one, of an older version or from
elsewhere, are read too. The states that a training resumes from are in ``training/states.py``.
"""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import nn

from mitigate.core import checksums, folders
from mitigate.core.files import write_text
from mitigate.core.names import short

WEIGHTS = "model.safetensors"
CONFIG = "config.yaml"
ADAPTER = ".adapter."  # in the names of adapters' tensors, see mitigate/agents/adapters.py


def weights_file(path: str | Path) -> Path:
    """Return the safetensors file that ``path`` (the file or its folder) means.

    Raises FileNotFoundError if there is none.
    """
    given = Path(path)
    file = given if given.suffix == ".safetensors" else given / WEIGHTS
    if given.is_file() and given != file:
        raise FileNotFoundError(
            f"{given} is no .safetensors file, and what else weights are kept in may run code when "
            "it is opened. Write yours as safetensors: "
            'safetensors.torch.save_file(policy.state_dict(), "mine.safetensors").'
        )
    if not file.is_file():
        raise FileNotFoundError(
            f"There are no weights at {given}: expected a .safetensors file or a folder that holds "
            f"{WEIGHTS}, such as checkpoints/base. Train some with `make train RECIPE=base`, or as "
            "docs/agents.md says for other kinds: RECIPE=dagger, for topological_imagenet "
            "RECIPE=swap_encoder. Then name them: weights.base=runs/.../agent."
        )
    return file


def save_weights(module: nn.Module, path: str | Path, *, half: bool = False) -> Path:
    """Write the tensors of ``module.state_dict()`` to a safetensors file, or into a folder.

    Args:
        module: the module.
        path: a folder, which gets ``model.safetensors`` and a manifest; or a ``.safetensors`` file,
            which gets its sha256 beside it.
        half: round floats to float16, as in the shipped weights: half the bytes.

    Returns:
        The file.
    """
    given = Path(path)
    if given.suffix == ".safetensors":
        return checksums.write(given, lambda draft: write_tensors(module, draft, half=half))
    with folders.write_folder(given, "weights") as draft:
        write_tensors(module, draft / WEIGHTS, half=half)
    return given / WEIGHTS


def write_tensors(module: nn.Module, file: Path, *, half: bool = False) -> None:
    """Write the tensors of ``module`` to ``file``, a draft; see :func:`save_weights`."""
    tensors = {
        name: (value.half() if half and value.is_floating_point() else value).cpu().clone()
        for name, value in module.state_dict().items()
        if isinstance(value, torch.Tensor)
    }
    try:
        save_file(tensors, file)
    except SafetensorError as error:
        raise unwritten(file, error) from error


def unwritten(file: Path, error: Exception) -> OSError:
    """The error that says why a checkpoint could not be written, and what to do."""
    cause = str(error).splitlines()[0][:200]
    return OSError(
        f"A checkpoint could not be written to {file.parent} ({cause}): is the disk full "
        f"({shutil.disk_usage(file.parent).free >> 20} MiB are free)? Checkpoints of before are "
        "whole; free some room, and the same command goes on from the newest."
    )


def load_weights(module: nn.Module, path: str | Path) -> None:
    """Fill ``module`` from :func:`save_weights`' file; names and shapes must match exactly, and
    the kinds of numbers: floats of any width for floats, whole numbers for whole ones.

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
        if name not in found or name not in wanted or not _fits(found[name], wanted[name])
    )
    if wrong:
        raise ValueError(
            f"The weights {file} do not fit this {type(module).__name__}: {len(wrong)} names are "
            f"missing, unknown, of another shape or of other numbers ({', '.join(wrong[:4])} ...). "
            "Build the agent with the config that made them (config.yaml beside them) or choose "
            "other weights."
        )
    module.load_state_dict(found, strict=False)
    check_finite(module, f"The weights {file}")


def _fits(found: torch.Tensor, wanted: torch.Tensor) -> bool:
    return found.shape == wanted.shape and _kind(found) == _kind(wanted)


def _kind(value: torch.Tensor) -> str:
    """Which numbers a tensor holds, of whatever width."""
    if value.dtype == torch.bool:
        return "truth"
    if value.is_complex():
        return "complex"
    return "float" if value.is_floating_point() else "whole"


def _borrowed(module: nn.Module) -> dict[str, torch.Tensor]:
    """The tensors that a state dict leaves out where they are public ones (:func:`borrow`)."""
    return {
        f"{prefix}.{name}" if prefix else name: value
        for prefix, part in module.named_modules()
        for name, value in vars(part).get("public_tensors", {}).items()
    }


def load_tensors(file: Path) -> dict[str, torch.Tensor]:
    """Return the tensors of a safetensors file; ValueError if it is damaged, by its sidecar (if it
    has one) or by itself, PermissionError if it may not be read."""
    file.open("rb").close()  # tells what may not be read from what is damaged
    problem = folders.problem(file)
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
    manifest = file.with_name(folders.MANIFEST)
    note = manifest if manifest.is_file() else checksums.sidecar(file)
    alone = f" If you know that {note.name} alone is damaged, delete it." if note.is_file() else ""
    return f"Fetch or train them again.{alone}"


@runtime_checkable
class OwnFormat(Protocol):
    """An agent with a format of its own, such as an adapter in PEFT's."""

    def save(self, folder: str | Path) -> Any: ...

    def load(self, folder: str | Path) -> Any: ...


def save_agent(agent: nn.Module, folder: str | Path, config: str | None = None) -> None:
    """Write what was trained into ``folder``, and its settings.

    Args:
        agent: written by its own ``save``, if it has one (:class:`OwnFormat`), else as
            :func:`save_weights` does.
        folder: the folder.
        config: text of ``config.yaml``; None: no such file.
    """
    if isinstance(agent, OwnFormat):
        agent.save(folder)
        if config is not None:
            folders.add_file(folder, CONFIG, config)
        return
    with folders.write_folder(folder, "agent") as draft:
        write_tensors(agent, draft / WEIGHTS)
        if config is not None:
            write_text(draft / CONFIG, config)


def load_agent(agent: nn.Module, path: str | Path) -> None:
    """Fill ``agent`` from what :func:`save_agent` wrote; raises as :func:`load_weights` does."""
    if isinstance(agent, OwnFormat):
        agent.load(path)
    else:
        load_weights(agent, path)


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


# Public weights inside a module of ours are never copied into its checkpoints, only named there. A
# checkpoint of such a module holds what differs from them, such as adapters, and the sha256 of the
# file that they came from.


def borrow(module: nn.Module, prefixes: tuple[str, ...], source: str, name: str) -> None:
    """Leave the tensors of ``module`` whose names begin so out of its state dicts, while they are
    as they are now, bit for bit; a state dict without them takes them from here.

    ``source``: sha256 of the file that they came from, in hex; ``name``: what to call them in an
    error. Loading a state dict that was made with others raises ValueError.
    """
    module.public_tensors = {  # type: ignore[assignment]
        key: value.clone() for key, value in module.state_dict().items() if key.startswith(prefixes)
    }
    module.public_name = name  # type: ignore[assignment]
    module.register_buffer("public", torch.tensor(list(bytes.fromhex(source)), dtype=torch.uint8))
    module.register_state_dict_post_hook(_leave_out)
    module.register_load_state_dict_pre_hook(_fill_in)


def _leave_out(module: Any, state: dict[str, Any], prefix: str, _: Any) -> None:
    for name, value in module.public_tensors.items():
        held = state.get(prefix + name)
        if held is not None and torch.equal(held.cpu(), value):
            del state[prefix + name]


def _fill_in(module: Any, state: dict[str, Any], prefix: str, *_: Any) -> None:
    made_with = state.get(f"{prefix}public")
    if made_with is not None and not torch.equal(made_with.cpu(), module.public.cpu()):
        raise ValueError(
            f"These weights belong to {module.public_name} with sha256 "
            f"{bytes(made_with.tolist()).hex()[:12]}, but the installed one has "
            f"{bytes(module.public.tolist()).hex()[:12]}: install the version that they were made "
            "with."
        )
    for name, value in module.public_tensors.items():
        state.setdefault(prefix + name, value)
