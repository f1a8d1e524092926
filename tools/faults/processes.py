"""Commands of ours as processes, and what became of them."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from mitigate.core.files import make_folder
from mitigate.core.output import open_output

ROOT = Path(__file__).resolve().parents[2]
LATE = 600.0  # seconds after which a command hangs


class Command:
    """``python -m arguments``, whose output goes to the file ``log``."""

    def __init__(
        self, arguments: list[str], log: Path, environment: Mapping[str, str] | None = None
    ) -> None:
        make_folder(log.parent)
        self.log, self.began = log, time.monotonic()
        own = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONUNBUFFERED": "1", **(environment or {})}
        own["PYTHONPATH"] = os.pathsep.join(
            path for path in (own.get("PYTHONPATH"), str(ROOT)) if path
        )
        with open_output(log, "w", encoding="utf-8") as out:
            self.process = subprocess.Popen(
                [sys.executable, "-m", *arguments],
                cwd=ROOT,
                env=own,
                stdout=out,
                stderr=subprocess.STDOUT,
            )

    def said(self) -> str:
        """All of its output so far."""
        return self.log.read_text(encoding="utf-8", errors="replace")

    def end(self) -> str:
        """Its last lines, in one."""
        return " | ".join(self.said().strip().splitlines()[-3:])[-400:]

    def runs(self) -> bool:
        """Whether it has not ended yet."""
        return self.process.poll() is None

    def wait_for(self, what: Callable[[], object], seconds: float = LATE) -> bool:
        """Wait until ``what()`` is true, the command ends or the time is over; say if it is."""
        over = time.monotonic() + seconds
        while self.runs() and time.monotonic() < over:
            if what():
                return True
            time.sleep(0.01)
        return bool(what())

    def status(self) -> int | None:
        """Its exit status once it ended; None if it hung and was killed."""
        try:
            return self.process.wait(LATE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return None

    def problem(self, *allowed: int) -> str:
        """Wait; return what is wrong with how it ended, empty for an ``allowed`` status."""
        status = self.status()
        if status in allowed and "Traceback" not in self.said():
            return ""
        what = "it hung" if status is None else f"status {status}, not {allowed[0]}"
        return f"{what}: {self.end()}"


def workers(command: Command) -> list[int]:
    """Process ids of a command's workers, which a server of forks starts for it."""
    return [worker for child in children(command.process.pid) for worker in children(child)]


def children(pid: int) -> list[int]:
    """Processes that ``pid`` started."""
    try:
        listed = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="utf-8")
    except OSError:
        return []
    return [int(word) for word in listed.split()]
