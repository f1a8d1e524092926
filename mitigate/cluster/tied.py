"""Run a program that does not outlive its parent: ``python tied.py PARENT PROGRAM ARGUMENTS``.

A worker of a cluster that is killed leaves its programs behind; these would go on writing where
the next worker writes. Linux ends them with it (prctl(2)); elsewhere nothing is tied. A file to be
run, in a bare Python, before it becomes the program.
"""

import ctypes
import errno
import os
import shutil
import signal
import sys

PR_SET_PDEATHSIG = 1  # linux/prctl.h


def words(program):
    """The words of ``program`` (a list of them), tied to this process. Raises OSError if there is
    no such program."""
    if shutil.which(program[0]) is None:
        raise FileNotFoundError(errno.ENOENT, "there is no such program", program[0])
    return [sys.executable, "-S", "-E", __file__, str(os.getpid()), *program]


def main() -> None:
    """Become the program that the command line names."""
    parent, program = int(sys.argv[1]), sys.argv[2:]
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # workers ignore it, and what they start would
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it ended before it could be told
        sys.exit(f"process {parent}, which started {program[0]}, is gone")
    os.execvp(program[0], program)


if __name__ == "__main__":
    main()
