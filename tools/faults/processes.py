"""Run commands of this project as processes, and check how they end."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from mitigate.core.files import make_folder
from mitigate.core.output import open_output

ROOT = Path(__file__).resolve().parents[2]
TIMEOUT = 600.0  # seconds after which a command is assumed to hang
# environment variables for a clock that jumps by up to a day, about once per second
JUMPING_CLOCK = {"PYTHONPATH": str(Path(__file__).parent / "clock")}
# environment variables for an output encoding that lacks some characters
ASCII_OUTPUT = {"PYTHONIOENCODING": "ascii", "LC_ALL": "C"}


class Command:
    """Runs ``python -m arguments``; its output goes to the file ``log``.

    Args:
        arguments: The module and its arguments.
        log: The file.
        environment: Additional environment variables.
        redirect: Shell code after the command: a redirection such as ``>&-``, or a pipe such as ``|
            head -n 1``.
    """

    def __init__(
        self,
        arguments: list[str],
        log: Path,
        environment: Mapping[str, str] | None = None,
        redirect: str = "",
    ) -> None:
        make_folder(log.parent)
        self.log = log
        self.began = time.monotonic()
        variables = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONUNBUFFERED": "1"}
        variables |= environment or {}
        variables["PYTHONPATH"] = os.pathsep.join(
            path for path in (variables.get("PYTHONPATH"), str(ROOT)) if path
        )
        words = [sys.executable, "-m", *arguments]
        if redirect:
            run = "" if redirect.startswith("|") else "exec "
            words = ["sh", "-c", f'{run}"$0" "$@" {redirect}', *words]
        with open_output(log, "w", encoding="utf-8") as out:
            self.process = subprocess.Popen(
                words,
                cwd=ROOT,
                env=variables,
                stdout=out,
                stderr=subprocess.STDOUT,
            )

    def output(self) -> str:
        """Return all output of the command so far."""
        return self.log.read_text(encoding="utf-8", errors="replace")

    def last_lines(self) -> str:
        """Return the last three lines of the output as one line."""
        return " | ".join(self.output().strip().splitlines()[-3:])[-400:]

    def runs(self) -> bool:
        """Return whether the command is still running."""
        return self.process.poll() is None

    def wait_for(self, condition: Callable[[], object], seconds: float = TIMEOUT) -> bool:
        """Wait until ``condition()`` is true, the command ends or ``seconds`` have passed.

        Return whether the condition is true.
        """
        deadline = time.monotonic() + seconds
        while self.runs() and time.monotonic() < deadline:
            if condition():
                return True
            time.sleep(0.01)
        return bool(condition())

    def message_problem(self, *words: str) -> str:
        """Wait until the command ends. Return "" if the command reports an error with one of the
        ``words`` and exits with status 1, or else a description of the problem.
        """
        problem = self.problem(1)
        named = any(word in self.output() for word in words)
        return problem or ("" if named else f"no message: {self.last_lines()}")

    def status(self) -> int | None:
        """Wait and return the exit status, or None if the command hung and was killed."""
        try:
            return self.process.wait(TIMEOUT)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return None

    def problem(self, *allowed: int) -> str:
        """Wait until the command ends; return "" if its exit status is ``allowed``, or else a
        description of the problem.
        """
        status = self.status()
        if status in allowed and "Traceback" not in self.output():
            return ""
        problem = "it hung" if status is None else f"status {status}, not {allowed[0]}"
        return f"{problem}: {self.last_lines()}"


def workers(command: Command) -> list[int]:
    """Return the process ids of a command's workers, which are children of its fork server."""
    return [worker for child in children(command.process.pid) for worker in children(child)]


def descendants(pid: int, word: bytes) -> list[int]:
    """Return the child processes of ``pid``, at any depth, whose command line contains ``word``."""
    matches = []
    for child in children(pid):
        with suppress(OSError):
            if word in Path(f"/proc/{child}/cmdline").read_bytes():
                matches.append(child)
        matches += descendants(child, word)
    return matches


def children(pid: int) -> list[int]:
    """Return the ids of the processes that were started by threads of ``pid``."""
    pids = []
    for file in Path(f"/proc/{pid}/task").glob("*/children"):
        with suppress(OSError):
            pids += [int(word) for word in file.read_text(encoding="utf-8").split()]
    return pids
