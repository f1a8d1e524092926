"""Run a program that ends when its parent ends: ``python tied.py PARENT PROGRAM ARGUMENTS``.

When a worker of a cluster is killed, its programs would otherwise keep running and write to the
same files as the next worker. On Linux, the programs end together with the worker (prctl(2)); on
other systems they do not. This file imports only the standard library. The process that runs this
file replaces itself with the program.
"""

import ctypes
import errno
import os
import shutil
import signal
import sys

PR_SET_PDEATHSIG = 1  # linux/prctl.h


def words(program):
    """Return a command line that runs ``program`` and ends it when this process ends.

    ``program`` is a list of the program and its arguments. Raises OSError if there is no such
    program.
    """
    if shutil.which(program[0]) is None:
        raise FileNotFoundError(errno.ENOENT, "there is no such program", program[0])
    return [sys.executable, "-S", "-E", __file__, str(os.getpid()), *program]


def main() -> None:
    """Replace this process with the program that the command line names."""
    parent = int(sys.argv[1])
    program = sys.argv[2:]
    # Workers ignore SIGINT, and without this line, their programs would ignore it too.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # the parent ended before prctl was called
        sys.exit(f"process {parent}, which started {program[0]}, is gone")
    os.execvp(program[0], program)


if __name__ == "__main__":
    main()
