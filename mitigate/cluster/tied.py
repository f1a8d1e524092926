"""Run a program that does not outlive its parent: ``python tied.py PARENT PROGRAM ARGUMENTS``.

A killed worker of a cluster would leave its programs running, and they would write where the next
worker writes. On Linux they end together with the worker (prctl(2)); on other systems they do not.
This file runs in a plain Python, which then becomes the program.
"""

import ctypes
import errno
import os
import shutil
import signal
import sys

PR_SET_PDEATHSIG = 1  # linux/prctl.h


def words(program):
    """Return the command line that runs ``program`` (a list of words) tied to this process.

    Raises OSError if there is no such program.
    """
    if shutil.which(program[0]) is None:
        raise FileNotFoundError(errno.ENOENT, "there is no such program", program[0])
    return [sys.executable, "-S", "-E", __file__, str(os.getpid()), *program]


def main() -> None:
    """Become the program that the command line names."""
    parent = int(sys.argv[1])
    program = sys.argv[2:]
    # Workers ignore it, and their programs would inherit that.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # the parent ended before prctl
        sys.exit(f"process {parent}, which started {program[0]}, is gone")
    os.execvp(program[0], program)


if __name__ == "__main__":
    main()
