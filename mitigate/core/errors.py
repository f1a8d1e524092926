"""Errors that a setting, a file, the system or a missing package brings about, in one paragraph."""

from __future__ import annotations

import errno
import sysconfig
import traceback
from pathlib import Path

from mitigate.core.files import PACKAGE

RECIPES = (PACKAGE / "recipes").resolve()  # of a checkout: a link
# what extras of pyproject.toml bring, by the names that are imported
PACKAGES = frozenset({
    "hydra", "matplotlib", "omegaconf", "panda3d", "peft", "PIL", "rosbags", "sacrebleu",
    "safetensors", "tensorboard", "torch", "torchrl", "tqdm", "transformers", "yaml",
})  # fmt: skip
_STANDARD = Path(sysconfig.get_path("stdlib")).resolve()
_INSTALLED = {"site-packages", "dist-packages"}


def said(error: ValueError | OSError) -> str:
    """An error in one paragraph: ours as it is; out of the user's own code with its place there; of
    the system's what it said, of which file, and what may help."""
    if not isinstance(error, OSError) or error.strerror is None:
        place = own_place(error)
        return f"{error} (raised in {place})" if place else str(error)
    told = f"{error.strerror}: {error.filename}" if error.filename else str(error.strerror)
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        told += (
            ". What was finished is kept whole: free some room, and the same command goes on from "
            "there."
        )
    return told


def own_place(error: BaseException) -> str:
    """File, line and function of the user's own code in which ``error`` was raised, by it or by a
    library that it called; empty if it was raised by this project, or by a library for it."""
    found = ""
    for frame in traceback.extract_tb(error.__traceback__):
        file = Path(frame.filename).resolve()
        if file.is_relative_to(PACKAGE) or file.is_relative_to(RECIPES):
            found = ""
        elif file.is_file() and not (_INSTALLED & {*file.parts} or file.is_relative_to(_STANDARD)):
            found = f"{frame.filename}, line {frame.lineno}, {frame.name}()"
    return found


def too_much(error: Exception) -> str:
    """What is said of an error that a setting or a file brings about; empty for any other."""
    cause = " ".join(str(error).split())[:200]
    memory = isinstance(error, MemoryError) or "allocate memory" in cause
    nested = isinstance(error, RecursionError)
    if not (memory or nested or isinstance(error, OverflowError)):
        return ""
    what = "more memory than there is" if memory else "too many levels" if nested else ""
    return (
        f"A setting or a file asks for {what or 'too great a number'} ("
        f"{cause or type(error).__name__}). Look at "
        "the last option or file that you changed; HYDRA_FULL_ERROR=1 shows where it was used."
    )


def lacking(what: str, error: ModuleNotFoundError, extra: str = "train") -> str:
    """What ``what`` needs and how to install it; empty if what is missing is no such package."""
    name = (error.name or "").partition(".")[0]
    if name not in PACKAGES:
        return ""
    return (
        f"{what} needs {name}, which is not installed: in a checkout, make install, or "
        f"pip install -e '.[{extra}]'."
    )
