"""What is said where a package is not installed that only some of this project needs."""

from __future__ import annotations

# that extras of pyproject.toml bring, by the names they are imported by
PACKAGES = frozenset({
    "hydra", "matplotlib", "omegaconf", "panda3d", "peft", "PIL", "rosbags", "sacrebleu",
    "safetensors", "tensorboard", "torch", "torchrl", "tqdm", "transformers", "yaml",
})  # fmt: skip


def lacking(what: str, error: ModuleNotFoundError, extra: str = "train") -> str:
    """What ``what`` needs and how to install it; empty if what is missing is no such package."""
    name = (error.name or "").partition(".")[0]
    if name not in PACKAGES:
        return ""
    return (
        f"{what} needs {name}, which is not installed: in a checkout, make install, or "
        f"pip install -e '.[{extra}]'."
    )
