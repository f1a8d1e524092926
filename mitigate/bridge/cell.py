"""One condition of a run: the user's command under one corruption, in a folder of its own."""

from __future__ import annotations

import fcntl
import os
import signal
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TextIO

from mitigate.bridge import results, verdict
from mitigate.bridge.command import GRACE, Command
from mitigate.bridge.condition import Condition
from mitigate.bridge.events import EVENTS, LOCK, put_aside
from mitigate.bridge.finished import DONE, lacks, read_done, write_done
from mitigate.bridge.identity import files_of
from mitigate.bridge.recording import delete_left, is_whole
from mitigate.bridge.results import Told
from mitigate.bridge.server import Listener
from mitigate.bridge.subset import Subset
from mitigate.bridge.verdict import lacking
from mitigate.core.files import make_folder
from mitigate.core.signals import unbroken
from mitigate.corruptions import Corruption
from mitigate.evaluation.rows import Row

LOG = "output.txt"
TAIL = 12  # lines of the command's output that an error repeats
NOTED = 5.0  # seconds in which the server notes what they left in the middle (ours)
SILENT = 10  # times patience, after which a command that lost an episode is taken to hang (ours)


@dataclass
class Cell:
    """The command under one condition. ``name`` is the condition's.

    settings: what its result depends on, by which a finished one is known again. files: of the
    command, as it was started with (``identity.py``). clean: the folder of the clean condition,
    whose episodes it is to have; None for that itself. recording: the folder that is asked for.
    chosen: says which episodes were asked for. count_closed: see ``results.read``. loaded:
    whether a Python process of it loaded the hook. left: its processes that ran on when it had
    ended, described.
    """

    name: str
    corruption: Corruption
    repeat: int
    command: tuple[str, ...]
    folder: Path
    condition: Condition
    label: dict[str, Any]
    rule: str | None
    settings: dict[str, Any]
    patience: float = 25.0
    environment: dict[str, str] = field(default_factory=dict)
    files: dict[str, Any] = field(default_factory=dict)
    clean: Path | None = None
    recording: Path | None = None
    chosen: Subset | None = None
    count_closed: bool = False
    loaded: bool = False
    left: list[str] = field(default_factory=list)
    listener: Listener | None = None
    lock: TextIO | None = None
    process: Command | None = None

    @property
    def log(self) -> Path:
        return self.folder / LOG

    def held(self) -> dict[str, Any] | None:
        """What was recorded as it ended, None if it has not. Raises ValueError for damage."""
        return read_done(self.folder)

    def others(self) -> list[str]:
        """The settings with another value than it was finished with."""
        held = self.held() or self.settings
        return [name for name, value in self.settings.items() if held.get(name) != value]

    def is_done(self) -> bool:
        """Whether it is finished and whole. Raises ValueError if it is with other settings."""
        held, other = self.held(), self.others()
        if held is not None and other:
            raise ValueError(
                f"{self.folder} was run with another {', '.join(other)} ({held.get(other[0])!r}, "
                f"now {self.settings[other[0]]!r}). Name another folder (out=...), or delete it."
            )
        if held is not None and (missing := lacks(held)):
            raise ValueError(
                f"{self.folder / DONE} lacks {', '.join(missing)}: it is damaged, or of an older "
                f"version. Move {self.folder} out of {self.folder.parent} and run the same command "
                "again."
            )
        return held is not None and not self.why_anew()

    def why_anew(self) -> str:
        """Why it is measured anew, though it was finished; empty if it need not be."""
        if self.held() is None:
            return ""
        if missing := self.missing():
            return lacking(self, missing)
        told = self.told()
        if told.lost:  # measured with another count_closed, or by an older version
            return verdict.left_out(told)
        if self.recording is not None and not is_whole(self.recording, told.ends.values()):
            return f"it was not recorded in {self.recording}, or not all of it"
        return ""

    def changed(self, files: dict[str, Any]) -> list[str]:
        """The files of the command that are not as in ``files``, if it is finished."""
        before = (self.held() or {}).get("files", {})
        return [name for name, told in before.items() if files.get(name) != told]

    def missing(self) -> list[str]:
        """Episodes of the clean condition that did not end under this one."""
        return sorted(self.of_clean() - self.told().ends.keys())

    def of_clean(self) -> set[str]:
        """The episodes that ended under the clean condition; empty for itself."""
        return (
            set() if self.clean is None else set(results.read(self.clean, self.count_closed).ends)
        )

    def beyond(self) -> list[str]:
        """Episodes that ended under this condition and not under clean, whose run lost them."""
        held = self.of_clean()
        return sorted(self.told().ends.keys() - held) if held else []

    def start(self) -> None:
        """Start the server and the command, in an empty folder; what an earlier, unfinished run
        left in it is put aside. Raises ValueError if it is at work, or cannot be started."""
        with unbroken():  # or what was just started would not be known to ``kill``
            self._start()

    def _start(self) -> None:
        make_folder(self.folder)
        self.lock = open(self.folder / LOCK, "w", encoding="utf-8")  # noqa: SIM115
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            self.lock.close()
            raise ValueError(
                f"Another run is at work in {self.folder}: wait for it, or name another folder "
                "(out=...)."
            ) from error
        kind = "finished" if (self.folder / DONE).is_file() else "unfinished"
        (self.folder / DONE).unlink(missing_ok=True)
        put_aside(self.folder, kind)
        chosen = self.chosen if self.clean is None else None
        if chosen is not None and not any(chosen.folder.glob(f"conditions/*/{DONE}")):
            chosen.forget()  # of a run that came to nothing
        if self.recording is not None:
            delete_left(self.recording)
        self.files = files_of(self.command)
        self.listener = Listener(self.condition, self.folder, self.patience).__enter__()
        words = {
            "{condition}": self.name,
            "{severity}": f"{self.corruption.severity:g}",
            "{seed}": str(self.label["seed"]),
            "{out}": str(self.folder.resolve()),
        }
        filled = list(self.command)
        for name, value in words.items():
            filled = [word.replace(name, value) for word in filled]
        with open(self.log, "w", encoding="utf-8") as log:
            try:
                own = {**self.listener.environment(), **self.environment}
                marker = self.listener.address
                self.process = Command(filled, log, {**os.environ, **own}, marker)
            except OSError as error:
                self.kill()
                raise ValueError(f"{filled[0]} cannot be started: {error.strerror}.") from error

    def poll(self) -> str | None:
        """Return None while it runs, then what went wrong, empty if nothing did."""
        try:
            return self._poll()
        except ValueError as error:  # its events are damaged
            self.kill()
            return str(error)

    def _poll(self) -> str | None:
        assert self.process is not None and self.listener is not None
        status = self.process.status()
        if status is None:
            problem = self._stuck()
            if problem is None:
                return None
            self.kill()
            return problem
        self.loaded = self.listener.was_loaded()
        self.left = self.process.left()
        self._end_command()
        self._settle()
        self.kill()
        found = verdict.problem(self, status)
        if self.clean is not None and self.beyond():  # clean is no measure of this one
            (self.clean / DONE).unlink(missing_ok=True)
        if not found:
            said = {"condition": self.corruption.name, "severity": self.corruption.severity}
            said |= {"repeat": self.repeat, "files": self.files}
            said |= {"episodes_told": len(self.told().ends)}
            write_done(self.folder, {**self.settings, **said})
        return found

    def kill(self) -> None:
        """End the command with all of its processes, and the server."""
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # a second Ctrl-C changes nothing
        try:
            self._end_command()
            if self.listener is not None:
                self.listener.__exit__()
                self.listener = None
        finally:
            signal.signal(signal.SIGINT, before)
            if self.lock is not None:
                self.lock.close()
                self.lock = None

    def _end_command(self) -> None:
        """End all processes of the command: after ``GRACE`` those that are still connected, too."""
        if self.process is not None:
            self.process.end(self._is_connected)

    def _is_connected(self) -> bool:
        try:
            return self.told().connected > 0
        except ValueError:  # damaged events, which are reported elsewhere
            return False

    def _settle(self) -> None:
        """Let the server note what the command left in the middle, also of processes that outlive
        it (in sessions and containers of their own)."""
        assert self.listener is not None
        if not self._is_quiet(NOTED):
            self.listener.close_connections()
            self._is_quiet(GRACE)

    def _is_quiet(self, seconds: float) -> bool:
        """Whether the last connection ends within so many seconds."""
        until = time.monotonic() + seconds
        while self.told().connected > 0:
            if time.monotonic() > until:
                return False
            time.sleep(0.05)
        return True

    def _stuck(self) -> str | None:
        """Why a running command will not come to its end, None if it may."""
        assert self.listener is not None
        if not self.listener.is_alive():
            return "the server of frames ended; the command was stopped. Run again."
        events = self.folder / EVENTS
        if not events.is_file():
            return None
        silent = time.time() - events.stat().st_mtime
        if silent < self.patience:
            return None
        told = self.told()
        if told.refused:
            return f"{told.refused[0]}"
        if told.lost and (told.connected < 1 or silent > SILENT * self.patience):
            return (
                f"a process of the command ended in the middle of episode {told.lost[0]}, and "
                f"nothing was heard of any other for {silent:.0f} s; the command was stopped. "
                f"{verdict.CRASH}{self.said()}"
            )
        return None

    def said(self) -> str:
        """What an error repeats of the command's output."""
        tail = self.tail()
        return f"\nThe end of {self.log}:\n{tail}" if tail else " It printed nothing."

    def tail(self) -> str:
        """The last lines of the command's output."""
        lines = self.log.read_text("utf-8", "replace").splitlines() if self.log.is_file() else []
        return "\n".join(f"  | {line}" for line in lines[-TAIL:])

    def told(self) -> Told:
        """What its processes told so far."""
        return results.read(self.folder, self.count_closed)

    def rows(self) -> list[Row]:
        """The result rows."""
        clean = None if self.clean is None else results.read(self.clean, self.count_closed)
        return results.rows(self.told(), self.corruption, self.label, self.rule, clean)

    def summary(self) -> str:
        """How far it is: "41 episodes, success 58.5"."""
        return verdict.summary(self)
