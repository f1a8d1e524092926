"""Memory that the server and an environment's process share: frames lie in it, and no socket is
wide enough for them."""

from __future__ import annotations

import mmap
import os
import secrets
from pathlib import Path
from typing import Any


class SharedMemory:
    """A file in ``folder``, mapped as ``map``; its name is gone as soon as both sides mapped it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.map: mmap.mmap | None = None
        self.file: Path | None = None

    def make(self, size: int) -> dict[str, Any]:
        """Map ``size`` new bytes; return where the other side finds them. Raises ValueError if
        there is no room."""
        self.forget()
        self.file = self.folder / secrets.token_hex(8)
        descriptor = os.open(self.file, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            os.posix_fallocate(descriptor, 0, size)
            self.map = mmap.mmap(descriptor, size)
        except OSError as error:
            raise ValueError(
                f"there is no room for {size >> 10} KiB of frames in {self.folder.parent} "
                f"({error.strerror}): free some, or enlarge it (docker: --shm-size=1g)."
            ) from error
        finally:
            os.close(descriptor)
        return {"file": str(self.file), "size": size}

    def forget(self) -> None:
        """Delete the name of what was made: the memory lasts as long as it is mapped."""
        if self.file is not None:
            self.file.unlink(missing_ok=True)
            self.file = None
