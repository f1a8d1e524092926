"""Explain errors caused by a setting, a file, the system or a missing package in one paragraph."""

from __future__ import annotations

import errno
import sys
import sysconfig
import traceback
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any, TypeVar

from mitigate.core.files import PACKAGE
from mitigate.core.names import printable

RECIPES = (PACKAGE / "recipes").resolve()  # in a checkout, this is a link
# the import names of the packages in the extras of pyproject.toml
PACKAGES = frozenset({
    "hydra", "matplotlib", "omegaconf", "panda3d", "peft", "PIL", "rosbags", "sacrebleu",
    "safetensors", "tensorboard", "torch", "torchrl", "tqdm", "transformers", "yaml",
})  # fmt: skip
Main = TypeVar("Main", bound=Callable[..., int])
_STANDARD = Path(sysconfig.get_path("stdlib")).resolve()
_INSTALLED = {"site-packages", "dist-packages"}


def error_message(error: ValueError | OSError) -> str:
    """Return a paragraph that explains an error.

    For an error in the user's code, the paragraph names the file and line. For a system error, the
    paragraph names the file and, if the disk is full, says what to do. Control characters are
    escaped.
    """
    if not isinstance(error, OSError) or error.strerror is None:
        place = own_place(error)
        return printable(f"{error} (raised in {place})" if place else str(error))
    message = f"{error.strerror}: {error.filename}" if error.filename else str(error.strerror)
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        message += (
            ". Results that were already written are intact. Free some space and run the same "
            "command again to resume."
        )
    return printable(message)


def command(name: str) -> Callable[[Main], Main]:
    """Return a decorator that makes the main function of a command explain errors.

    For a ValueError or OSError of the main function, the decorated function prints one paragraph
    instead of a traceback, and returns the exit status 2. The paragraph begins with ``name``.
    """

    def decorate(main: Main) -> Main:
        @wraps(main)
        def explained(*arguments: Any, **options: Any) -> int:
            try:
                return main(*arguments, **options)
            except BrokenPipeError:  # the program that reads the output has ended (mitigate/cli.py)
                raise
            except (OSError, ValueError) as error:
                print(f"{name}: {error_message(error)}", file=sys.stderr)
                return 2

        return explained  # type: ignore[return-value]

    return decorate


def own_place(error: BaseException) -> str:
    """Return the file, line and function of the user's code that raised ``error``.

    A library that the user's code called is treated as the user's code. The result is empty if this
    project, or a library that this project called, raised the error.
    """
    place = ""
    for frame in traceback.extract_tb(error.__traceback__):
        file = Path(frame.filename).resolve()
        if file.is_relative_to(PACKAGE) or file.is_relative_to(RECIPES):
            place = ""
        elif file.is_file() and not (_INSTALLED & {*file.parts} or file.is_relative_to(_STANDARD)):
            place = f"{frame.filename}, line {frame.lineno}, {frame.name}()"
    return place


def too_large_message(error: Exception) -> str:
    """Return an explanation if a setting or file that is too large caused the error, else ""."""
    cause = " ".join(str(error).split())[:200]
    if isinstance(error, MemoryError) or "allocate memory" in cause:
        what = "more memory than available"
    elif isinstance(error, RecursionError):
        what = "too many levels"
    elif isinstance(error, OverflowError):
        what = "too large a number"
    else:
        return ""
    return (
        f"A setting or a file asks for {what} ({cause or type(error).__name__}). Check the last "
        "option or file that you changed; HYDRA_FULL_ERROR=1 shows where it was used."
    )


def missing_package_message(what: str, error: ModuleNotFoundError, extra: str = "train") -> str:
    """Return how to install the package that ``what`` needs, or "" if no extra contains it."""
    name = (error.name or "").partition(".")[0]
    if name not in PACKAGES:
        return ""
    return (
        f"{what} needs {name}, which is not installed: in a checkout, make install, or "
        f"pip install -e '.[{extra}]'."
    )
