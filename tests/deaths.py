"""Functions that make processes die, for tests."""

from __future__ import annotations

import gc
import os
import signal
import struct
from multiprocessing.connection import Connection


def die_in_a_message() -> None:
    """Kill this process after its pipes have sent the length of a message but not all of its
    content."""
    for pipe in gc.get_objects():
        if isinstance(pipe, Connection) and not pipe.closed and pipe.writable:
            os.write(pipe.fileno(), struct.pack("!i", 1000) + b"cut off")
    os.kill(os.getpid(), signal.SIGKILL)
