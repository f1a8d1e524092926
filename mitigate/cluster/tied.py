"""Run a program that ends when its parent ends: ``python tied.py PARENT PROGRAM ARGUMENTS``.

Otherwise, if a worker of a cluster is killed, its programs keep running and write to the same files
as the next worker. On Linux, the programs end together with the worker (prctl(2)); on other systems
they do not. This file runs in a plain Python, which then replaces itself by the program.
"""

import ctypes
import errno
import os
import shutil
import signal
import sys

PR_SET_PDEATHSIG = 1  # linux/prctl.h


def words(program):
    """Return a command line that runs ``program`` (a list of words) and ends it with this process.

    Raises OSError if there is no such program.
    """
    if shutil.which(program[0]) is None:
        raise FileNotFoundError(errno.ENOENT, "there is no such program", program[0])
    return [sys.executable, "-S", "-E", __file__, str(os.getpid()), *program]


def main() -> None:
    """Replace this process by the program that the command line names."""
    parent = int(sys.argv[1])
    program = sys.argv[2:]
    # Workers ignore SIGINT, and their programs would inherit this.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # the parent ended before the call of prctl
        sys.exit(f"process {parent}, which started {program[0]}, is gone")
    os.execvp(program[0], program)


if __name__ == "__main__":
    main()
