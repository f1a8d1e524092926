"""Read and write weights: ``model.safetensors`` in a folder. Single safetensors files can be read.

A folder has a manifest (``folders.py``), which is checked before the weights are read. Weights
without a manifest, such as those of another project, are also accepted. ``training/states.py``
handles the states from which training resumes.
"""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import load_file, save_file
from torch import nn

from mitigate.core import folders
from mitigate.core.files import lfs_problem, weights_below, write_text
from mitigate.core.names import short

WEIGHTS = "model.safetensors"
CONFIG = "config.yaml"
# the name of every adapter tensor contains this text (mitigate/agents/adapters.py)
ADAPTER = ".adapter."


def weights_file(path: str | Path) -> Path:
    """Return the safetensors file that ``path`` names directly or by its folder.

    Raises:
        FileNotFoundError: If there is no safetensors file at ``path``.
    """
    path = Path(path)
    file = path if path.suffix == ".safetensors" else path / WEIGHTS
    if path.is_file() and path != file:
        raise FileNotFoundError(
            f"Weights must be a .safetensors file, got {path}. Other formats may run code when "
            "they are opened. Write yours as safetensors: "
            'safetensors.torch.save_file(policy.state_dict(), "mine.safetensors").'
        )
    if not file.is_file():
        if below := weights_below(path):
            raise FileNotFoundError(
                f"There are no weights at {path}, but in its folders {', '.join(below):.500}. Name "
                f"one of these: {path / below[0]}."
            )
        raise FileNotFoundError(
            f"There are no weights at {path}: expected a .safetensors file or a folder that holds "
            f"{WEIGHTS}, such as checkpoints/base. Train some with `make train RECIPE=base` (other "
            "recipes are in docs/agents.md), and set weights.base=runs/.../agent."
        )
    return file


def save_weights(module: nn.Module, folder: str | Path) -> Path:
    """Write the tensors of ``module.state_dict()`` and a manifest into ``folder``.

    Returns:
        The safetensors file.
    """
    with folders.write_folder(folder, "weights") as draft:
        write_tensors(module, draft / WEIGHTS)
    return Path(folder) / WEIGHTS


def write_tensors(module: nn.Module, file: Path, *, half: bool = False) -> None:
    """Write the tensors of ``module`` to ``file``, which is in the draft of a folder.

    If ``half`` is true, floats are rounded to float16, as in the shipped weights.
    """
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
    """Return the error for a checkpoint that could not be written; it names the cause and a fix."""
    cause = str(error).splitlines()[0][:200]
    return OSError(
        f"A checkpoint could not be written to {file.parent} ({cause}). Is the disk full "
        f"({shutil.disk_usage(file.parent).free >> 20} MiB are free)? Earlier checkpoints are "
        "complete. Free some space and run the same command again: it resumes from the newest."
    )


def load_weights(module: nn.Module, path: str | Path) -> None:
    """Load into ``module`` the weights at ``path``, which :func:`save_weights` wrote.

    Names and shapes must match exactly. Float tensors may have a different precision; integers,
    booleans and complex numbers must keep their type. If the weights contain no adapters (like
    the weights of a base agent), the adapters of ``module`` keep their values.

    Raises:
        FileNotFoundError: If there is no safetensors file at ``path``.
        ValueError: If the weights are damaged or do not match the module; the message names the
            file and the first differences.
    """
    file = weights_file(path)
    _fill(module, load_tensors(file), file)


def not_finite(module: nn.Module) -> list[str]:
    """Return the names of parameters that contain NaN or infinity, and of buffers that contain NaN.

    Infinity is valid in a buffer, because attention masks contain it.
    """
    names = [n for n, p in module.named_parameters() if not torch.isfinite(p).all()]
    return names + [n for n, b in module.named_buffers() if torch.isnan(b).any()]


def check_finite(module: nn.Module, what: str) -> None:
    """Raise ValueError if weights of ``module`` are not finite; ``what`` names the weights."""
    bad = not_finite(module)
    if bad:
        raise ValueError(
            f"{what} hold NaN or infinity in {len(bad)} tensors ({', '.join(bad[:3])}): their "
            "training diverged. Choose other weights, or train again with a lower "
            "trainer.lr."
        )


def load_part(module: nn.Module, name: str, path: str | Path) -> None:
    """Load only the part ``name`` of the weights at ``path`` into ``module``.

    Tensors that ``module`` does not have are skipped. An example is a layer for a sensor that the
    module does not read. The checks and errors are those of :func:`load_weights`.
    """
    file = weights_file(path)
    prefix = f"{name}."
    tensors = {
        k.removeprefix(prefix): v for k, v in load_tensors(file).items() if k.startswith(prefix)
    }
    if not tensors:
        raise ValueError(f"The weights {file} contain no part {name!r}.")
    used = {*module.state_dict(), *_borrowed(module)}
    tensors = {name: value for name, value in tensors.items() if name in used}
    _fill(module, tensors, file)


def _fill(module: nn.Module, tensors: dict[str, torch.Tensor], file: Path) -> None:
    """Load the tensors of ``file`` into ``module``; raise ValueError if they do not match."""
    borrowed = _borrowed(module)
    state = {k: v for k, v in module.state_dict().items() if isinstance(v, torch.Tensor)}
    expected = {k: v for k, v in {**state, **borrowed}.items() if k not in borrowed or k in tensors}
    if not any(ADAPTER in name for name in tensors):
        expected = {name: value for name, value in expected.items() if ADAPTER not in name}
    wrong = sorted(
        name
        for name in {*tensors, *expected}
        if name not in tensors or name not in expected or not _fits(tensors[name], expected[name])
    )
    if wrong:
        raise ValueError(
            f"The weights {file} do not fit this {type(module).__name__}: {len(wrong)} tensors are "
            f"missing, unknown, or of another shape or type ({', '.join(wrong[:4])} ...). Build "
            "the agent with the config of these weights (config.yaml), or choose other weights."
        )
    module.load_state_dict(tensors, strict=False)
    check_finite(module, f"The weights {file}")


def _fits(value: torch.Tensor, expected: torch.Tensor) -> bool:
    """Return whether shapes match and both are bool, both integer, both float or both complex."""

    def kind(x: torch.Tensor) -> tuple[bool, bool, bool]:
        return x.dtype == torch.bool, x.is_complex(), x.is_floating_point()

    return value.shape == expected.shape and kind(value) == kind(expected)


def _borrowed(module: nn.Module) -> dict[str, torch.Tensor]:
    """Return the public tensors, which are not part of state dicts (:func:`borrow`)."""
    return {
        f"{prefix}.{name}" if prefix else name: value
        for prefix, part in module.named_modules()
        for name, value in vars(part).get("public_tensors", {}).items()
    }


def load_tensors(file: Path) -> dict[str, torch.Tensor]:
    """Return the tensors of a safetensors file; if a manifest lists the file, check it first.

    Raises:
        ValueError: If the file is damaged.
        PermissionError: If the user has no permission to read the file.
    """
    file.open("rb").close()  # raises PermissionError, although the file may be undamaged
    if pointer := lfs_problem(file):
        raise ValueError(f"The weights {file} cannot be read: {file.name} {pointer}.")
    try:
        # safe_open compares the sizes of tensors in the header with the size of the file.
        # Without this check, the sha256 of a sparse file of several terabytes would take hours.
        with safe_open(file, "pt"):
            problem = folders.problem(file)
        if not problem:
            tensors = load_file(file)
            bad = [name for name, value in tensors.items() if torch.isnan(value).any()]
            if not bad:
                return tensors
            problem = f"holds NaN ({short(bad[0])})"
    except PermissionError:
        raise
    except (SafetensorError, OSError, KeyError) as error:
        problem = f"cannot be read: {short(str(error), 200)}"
    raise ValueError(
        f"The weights {file} ({file.stat().st_size} bytes) are truncated or damaged: {file.name} "
        f"{problem}. {_again(file)}"
    )


def _again(file: Path) -> str:
    """Return advice for damaged weights."""
    folder = file.resolve().parent
    # this is the layout of a training run
    if folder.name == "agent" and any(folder.parent.glob("*/step-*.pt")):
        return "They belong to a run: the same `make train` command writes them again."
    note = file.with_name(folders.MANIFEST)
    alone = f" If you know that only {note.name} is damaged, delete it." if note.is_file() else ""
    return f"Fetch or train them again.{alone}"


@runtime_checkable
class OwnFormat(Protocol):
    """Protocol of agents that write their own format, such as a PEFT adapter."""

    def save(self, folder: str | Path) -> Any: ...

    def load(self, folder: str | Path) -> Any: ...


def save_agent(agent: nn.Module, folder: str | Path, config: str | None = None) -> None:
    """Write the weights of ``agent`` and its settings into ``folder``.

    Args:
        agent: the agent. If the agent has a method ``save`` (:class:`OwnFormat`), this method
            writes the weights; otherwise :func:`save_weights` does.
        folder: the folder.
        config: text of ``config.yaml``, or None to write no such file.
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
    """Load into ``agent`` the weights at ``path``, which :func:`save_agent` wrote.

    Raises the same errors as :func:`load_weights`.
    """
    if isinstance(agent, OwnFormat):
        agent.load(path)
    else:
        load_weights(agent, path)


def weights_sha(module: nn.Module, leave_out: str | None = None) -> str:
    """Return 12 hex digits of the sha256 over the names, dtypes, shapes and bytes of all tensors.

    Args:
        module: the module.
        leave_out: tensors are excluded if their name contains this text.
    """
    sha = hashlib.sha256()
    for name, value in sorted(module.state_dict().items()):
        if isinstance(value, torch.Tensor) and not (leave_out and leave_out in f".{name}"):
            sha.update(f"{name} {value.dtype} {tuple(value.shape)}".encode())
            raw = value.detach().cpu().contiguous().reshape(-1).view(torch.uint8)
            sha.update(raw.numpy().tobytes())
    return sha.hexdigest()[:12]


def borrow(module: nn.Module, prefixes: tuple[str, ...], source: str, name: str) -> None:
    """Exclude public tensors of ``module`` from its state dicts while they are unchanged.

    Public weights are therefore never copied into a checkpoint. The checkpoint contains the other
    tensors, such as adapters, and the sha256 of the public file. When the checkpoint is loaded, the
    excluded tensors get their public values. Loading a state dict that was made with a different
    public file raises ValueError.

    Args:
        module: the module.
        prefixes: prefixes of the names of the public tensors.
        source: sha256 of the public file, in hex.
        name: name of the public weights in error messages.
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
        current = state.get(prefix + name)
        if current is not None and torch.equal(current.cpu(), value):
            del state[prefix + name]


def _fill_in(module: Any, state: dict[str, Any], prefix: str, *_: Any) -> None:
    source = state.get(f"{prefix}public")
    if source is not None and not torch.equal(source.cpu(), module.public.cpu()):
        needed, has = (bytes(sha.tolist()).hex()[:12] for sha in (source, module.public))
        raise ValueError(
            f"These weights need {module.public_name} with sha256 {needed}, but the installed one "
            f"has {has}. Install the version that was used in training."
        )
    for name, value in module.public_tensors.items():
        state.setdefault(prefix + name, value)
