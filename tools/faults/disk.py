"""A small file system in memory, and how to fill it."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mitigate.core.output import open_output

FILLER = "filler"  # the file that leaves no room


@contextmanager
def small_disk(folder: Path, megabytes: int) -> Iterator[bool]:
    """A file system of its own at ``folder``; False where that is not allowed."""
    folder.mkdir(parents=True, exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "tmpfs", str(folder)]
    done = shutil.which("mount") and not subprocess.run(mount, capture_output=True).returncode
    try:
        yield bool(done)
    finally:
        if done:
            subprocess.run(["umount", "-l", str(folder)], capture_output=True)


@contextmanager
def filled(folder: Path, left: int) -> Iterator[None]:
    """Within it, ``left`` bytes are free on the file system of ``folder``."""
    free = shutil.disk_usage(folder).free
    with open_output(folder / FILLER, "wb") as file:
        os.posix_fallocate(file.fileno(), 0, max(1, free - left))
    try:
        yield
    finally:
        (folder / FILLER).unlink()
