"""Run a program and keep all of its descendants: ``python supervisor.py PARENT PIPE PROGRAM ...``.

A process that detaches itself (``setsid``, a double fork, ``nohup ... &``) leaves its session and,
when its parent ends, its place among the children. The supervisor is a child subreaper (prctl(2),
Linux): such orphans become its children, so that it knows every descendant. It stays until the last
one is gone. When PARENT, which started it, is gone or it receives SIGTERM, it ends all of them.

It writes JSON lines to the file descriptor PIPE: first ``{"pid": N}`` or ``{"error": TEXT}``, and
``{"status": N}`` when the program ends. It is run as a file by a bare Python, without mitigate.
"""

import ctypes
import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress

PR_SET_CHILD_SUBREAPER = 36  # linux/prctl.h
GRACE = 3.0  # seconds between SIGTERM and SIGKILL (heuristic)
LONGEST = 10.0  # seconds in which killed processes must be gone (heuristic)
PAUSE = 0.05  # seconds between two checks


def processes():
    """Return {pid: (parent, whether it runs)} of all processes; a zombie does not run."""
    if not os.path.isdir("/proc/self"):
        return _processes_of_ps()
    found = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            with (
                suppress(OSError, ValueError, IndexError),
                open(f"/proc/{name}/stat", "rb") as file,
            ):
                text = file.read()
                fields = text[text.rindex(b")") + 2 :].split()  # proc_pid_stat(5), from field 3
                zombie = fields[0] in (b"Z", b"X") and int(fields[17]) <= 1  # of one thread
                found[int(name)] = (int(fields[1]), not zombie)
    return found


def _processes_of_ps():
    found = {}
    listed = subprocess.run(["ps", "-A", "-o", "pid=,ppid=,stat="], stdout=subprocess.PIPE)
    for line in listed.stdout.split(b"\n"):
        fields = line.split()
        if len(fields) == 3:
            found[int(fields[0])] = (int(fields[1]), not fields[2].startswith(b"Z"))
    return found


def descendants(root):
    """Return the pids of the running descendants of the process ``root``, without itself."""
    known = processes()
    children: dict = {}
    for pid, (parent, _) in known.items():
        children.setdefault(parent, []).append(pid)
    found, left = [], [root]
    while left:
        below = children.get(left.pop(), [])
        left += below
        found += [pid for pid in below if known[pid][1]]
    return found


def signal_all(pids, number):
    """Send a signal to processes; those that are gone or of another user are passed over."""
    for pid in pids:
        with suppress(ProcessLookupError, PermissionError):
            os.kill(pid, number)


def main():
    """Run the program that the command line names."""
    parent, pipe, program = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3:]
    ending = []
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, lambda *_: None)  # the parent decides; the program gets the default
    signal.signal(signal.SIGTERM, lambda *_: ending.append(True))
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)
    try:
        child = subprocess.Popen(program, start_new_session=True)
    except OSError as error:
        _tell(pipe, error=error.strerror)
        return
    _tell(pipe, pid=child.pid)
    while _reap(child, pipe):
        if os.getppid() != parent:  # it was killed, and another may start the program again
            return _end(child, pipe, 0.0)
        if ending:
            return _end(child, pipe, GRACE)
        time.sleep(PAUSE)


def _tell(pipe, **news):
    with suppress(OSError):  # the parent is gone
        os.write(pipe, (json.dumps(news) + "\n").encode())


def _reap(child, pipe):
    """Reap what ended, and report the program's status; return whether any process is left."""
    while True:
        try:
            pid, status = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return False
        if pid == 0:
            return True
        if pid == child.pid:
            child.returncode = os.waitstatus_to_exitcode(status)
            _tell(pipe, status=child.returncode)


def _end(child, pipe, grace):
    """End all descendants: by SIGTERM, and what is left after ``grace`` seconds by SIGKILL."""
    began = time.monotonic()
    signal_all(descendants(os.getpid()), signal.SIGTERM)
    while _reap(child, pipe) and time.monotonic() < began + grace + LONGEST:
        if time.monotonic() >= began + grace:
            signal_all(descendants(os.getpid()), signal.SIGKILL)
        time.sleep(PAUSE)


if __name__ == "__main__":
    main()
