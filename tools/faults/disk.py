"""Mount a small in-memory file system and fill it."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mitigate.core.output import open_output

FILLER = "filler"  # the file that takes up the free space


@contextmanager
def small_disk(folder: Path, megabytes: int) -> Iterator[bool]:
    """Mount a small file system at ``folder``; yield False if this user may not mount it."""
    folder.mkdir(parents=True, exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "tmpfs", str(folder)]
    mounted = shutil.which("mount") and not subprocess.run(mount, capture_output=True).returncode
    try:
        yield bool(mounted)
    finally:
        if mounted:
            subprocess.run(["umount", "-l", str(folder)], capture_output=True)


@contextmanager
def filled(folder: Path, left: int) -> Iterator[None]:
    """Leave ``left`` free bytes on the file system of ``folder`` during the ``with`` block."""
    free = shutil.disk_usage(folder).free
    with open_output(folder / FILLER, "wb") as file:
        os.posix_fallocate(file.fileno(), 0, max(1, free - left))
    try:
        yield
    finally:
        (folder / FILLER).unlink()
