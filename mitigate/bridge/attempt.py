"""One attempt to measure a condition: the user's command beside a server of frames.

An attempt begins in an empty folder. It ends with a finished condition (``done.json``), or with
the reason why it does not count, though its command may have ended well.
"""

from __future__ import annotations

import fcntl
import os
import signal
import time
from typing import IO, Any

from mitigate.bridge.cell import Cell, files_of, left_out, write_done
from mitigate.bridge.events import DONE, EVENTS, LOCK, put_aside
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.program import GRACE, Command
from mitigate.bridge.recording import delete_drafts
from mitigate.bridge.results import Told
from mitigate.bridge.server import Listener
from mitigate.core import output
from mitigate.core.files import make_folder
from mitigate.core.names import counted
from mitigate.core.output import open_output
from mitigate.core.signals import unbroken

NOTED = 5.0  # seconds in which the server notes what they left in the middle (ours)
SILENT = 10  # times patience, after which a command that lost an episode is taken to hang (ours)
SHOWN = 3  # processes that a message names
CRASH = (
    "Where the agent crashes on what it sees or hears, a loop of its own counts that as a failure: "
    "try ... except, and episode.finish(success=False) (docs/bridge.md)."
)


class Attempt:
    """Runs the command of a cell; :meth:`poll` until it ends, and :meth:`kill` in any case.

    Attributes:
        cell: The condition.
        files: Of the command, as it was started with.
        loaded: Whether a Python process of the command loaded the hook.
        left: Its processes that ran on when it had ended, described.
    """

    def __init__(self, cell: Cell) -> None:
        self.cell = cell
        self.files: dict[str, dict[str, Any]] = {}
        self.loaded = False
        self.left: list[str] = []
        self.listener: Listener | None = None
        self.lock: IO[str] | None = None
        self.events: IO[str] | None = None
        self.root: output.Root | None = None
        self.process: Command | None = None

    def start(self) -> None:
        """Start the server and the command, in an empty folder; what an earlier, unfinished run
        left in it is put aside. Raises ValueError if it is at work, or cannot be started."""
        with unbroken():  # or what was just started would not be known to ``kill``
            self._start()

    def _start(self) -> None:
        cell, folder = self.cell, self.cell.folder
        make_folder(folder)
        self.lock = open_output(folder / LOCK, "a", encoding="utf-8")
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            self.lock.close()
            raise ValueError(
                f"Another run is at work in {folder}: wait for it, or name another folder "
                "(out=...)."
            ) from error
        self.root = output.register(folder, self.lock)
        if cell.recording is not None:
            delete_drafts(cell.recording)
        put_aside(folder, "finished" if output.is_regular(folder / DONE) else "unfinished")
        self.events = open_output(folder / EVENTS, "x", encoding="utf-8")
        chosen = cell.chosen if cell.clean is None else None
        if chosen is not None and not any(chosen.folder.glob(f"conditions/*/{DONE}")):
            chosen.forget()  # of a run that came to nothing
        self.files = files_of(cell.command)
        self.listener = Listener(cell.condition, folder, cell.patience).__enter__()
        words = self._words()
        environment = {**os.environ, **self.listener.environment(), **cell.environment}
        with open_output(cell.log, "w", encoding="utf-8") as log:
            try:
                self.process = Command(words, log, environment, self.listener.address)
            except OSError as error:
                self.kill()
                raise ValueError(f"{words[0]} cannot be started: {error.strerror}.") from error

    def _words(self) -> list[str]:
        """Return the words of the command with the values of its placeholders."""
        cell = self.cell
        placeholders = {
            "{condition}": cell.name,
            "{severity}": f"{cell.corruption.severity:g}",
            "{seed}": str(cell.label["seed"]),
            "{out}": str(cell.folder.resolve()),
        }
        words = list(cell.command)
        for placeholder, value in placeholders.items():
            words = [word.replace(placeholder, value) for word in words]
        return words

    def poll(self) -> str | None:
        """Return None while it runs, then what went wrong, empty if nothing did."""
        try:
            return self._poll()
        except ValueError as error:  # its events are damaged
            self.kill()
            return str(error)

    def _poll(self) -> str | None:
        assert self.process is not None and self.listener is not None
        cell = self.cell
        self._check_events()
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
        self._check_events()
        self.kill()
        problem = self._problem(status)
        if cell.clean is not None and cell.extra_episodes():  # clean is no measure of this one
            (cell.clean / DONE).unlink(missing_ok=True)
        if not problem:
            entries = {**cell.settings, "condition": cell.corruption.name}
            entries |= {"severity": cell.corruption.severity, "repeat": cell.repeat}
            entries |= {"files": self.files, "episodes_told": len(cell.told().ends)}
            write_done(cell.folder, entries)
        return problem

    def _check_events(self) -> None:
        """Raise FolderLostError if the events, or their folder, are not those of this attempt."""
        assert self.events is not None
        path = self.cell.folder / EVENTS
        output.check(path)
        if not output.is_same(os.fstat(self.events.fileno()), path):
            raise output.lost(path)

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
            if self.root is not None:
                output.unregister(self.root)
                self.root = None
            for file in (self.events, self.lock):
                if file is not None:
                    file.close()
            self.events = self.lock = None

    def _end_command(self) -> None:
        """End all processes of the command: after ``GRACE`` those that are still connected, too."""
        if self.process is not None:
            self.process.end(self._is_connected)

    def _is_connected(self) -> bool:
        try:
            return self.cell.told().connected > 0
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
        while self.cell.told().connected > 0:
            if time.monotonic() > until:
                return False
            time.sleep(0.05)
        return True

    def _stuck(self) -> str | None:
        """Why a running command will not come to its end, None if it may."""
        assert self.listener is not None
        if not self.listener.is_alive():
            return "the server of frames ended; the command was stopped. Run again."
        events = self.cell.folder / EVENTS
        if not events.is_file():
            return None
        silent = time.time() - events.stat().st_mtime
        if silent < self.cell.patience:
            return None
        told = self.cell.told()
        if told.refused:
            return f"{told.refused[0]}"
        if told.lost and (told.connected < 1 or silent > SILENT * self.cell.patience):
            return (
                f"a process of the command ended in the middle of episode {told.lost[0]}, and "
                f"nothing was heard of any other for {silent:.0f} s; the command was stopped. "
                f"{CRASH}{self.cell.output_excerpt()}"
            )
        return None

    def _problem(self, status: int) -> str:
        """Return what went wrong under a command that ended with ``status``, empty if nothing "
        "did."""
        told = self.cell.told()
        if told.refused:
            return told.refused[0]
        if status:
            hint = f"\n{CRASH}" if told.lost else ""
            return f"the command ended with status {status}.{self.cell.output_excerpt()}{hint}"
        if self.left and not told.lost:
            return self._ran_on()
        return self._unseen(told) or self._unfinished(told) or self._too_few(told)

    def _ran_on(self) -> str:
        """What if processes of the command ran on when it had ended."""
        names = ", ".join(self.left[:SHOWN]) + ", ..." * (len(self.left) > SHOWN)
        count = "1 process" if len(self.left) == 1 else f"{len(self.left)} processes"
        return (
            f"the command ended, but {count} that it started "
            f"ran on: {names}. They were ended, and the condition is not finished. The command "
            "must wait for what it starts (without &, nohup or setsid), and must end its helpers "
            f"itself. Change it, and run again.{self.cell.output_excerpt()}"
        )

    def _too_few(self, told: Told) -> str:
        """What if fewer episodes ended than the program or ``episodes=`` announced."""
        cell = self.cell
        chosen = cell.chosen.least() if cell.chosen is not None and cell.clean is None else 0
        least = max(told.announced, chosen)
        if len(told.ends) >= least:
            return ""
        who = "wanted() returned" if told.announced == least else "episodes= chose"
        return (
            f"the command ended after {counted(len(told.ends), 'episode')}, and {who} {least}. Let "
            "it run all of them; if it is to run fewer, choose these by episodes=, or give "
            f"wanted() these alone. Then run again; the condition is "
            f"measured again.{cell.output_excerpt()}"
        )

    def _unseen(self, told: Told) -> str:
        """What if nothing of the agent passed the bridge."""
        if not told.hellos and not self.loaded:
            return (
                "the command ended, but no Python process of it loaded the hook. Does a script "
                "replace PYTHONPATH (let it append), does it run python with -E, -I or -S, or in a "
                f"container (docs/bridge.md)?{self.cell.output_excerpt()}"
            )
        if not told.hellos:
            return (
                "the command ended, and its Python loaded the hook, but it imported neither "
                "habitat-lab nor habitat-sim and never called mitigate_hook.connect, so that "
                "nothing of it passed the bridge. A loop of your own calls three functions "
                f"(docs/bridge.md).{self.cell.output_excerpt()}"
            )
        if mitigate_hook.ADAPTERS in self.cell.environment and not told.adapted:
            return (
                "the adapters were never put in: no instance of the class that adapters= names "
                "was called. Which class holds the encoder?"
            )
        if not told.ends and not told.lost:
            return (
                "the command ended without an episode. Did it find results of an earlier run, or "
                "of another condition? Delete them, and let it write to {out} in the command, "
                f"which stands for {self.cell.folder}: of each condition one, empty as it starts."
                f"{self.cell.output_excerpt()}"
            )
        return ""

    def _unfinished(self, told: Told) -> str:
        """What if episodes are not there, or say nothing."""
        cell = self.cell
        if told.lost:
            return (
                f"the command ended, but {left_out(told)}. Run again; the condition is measured "
                f"anew. {CRASH}{cell.output_excerpt()}"
            )
        if told.connected > 0:
            return (
                "the command ended, but processes of it went on, and nobody knows what they left "
                "in the middle: let it wait for them, and run again."
            )
        missing = cell.missing_episodes()
        if missing:
            return (
                f"{cell.describe_missing(missing)}, such as {missing[0]}: a process of it died or "
                "gave up before its first step, or it draws its episodes at random (fix its seed, "
                "and choose some by episodes=). Run again; the condition is measured anew. "
                f"{CRASH}{cell.output_excerpt()}"
            )
        beyond = cell.extra_episodes()
        if beyond:
            return (
                f"{counted(len(beyond), 'episode')} ended under it that clean's run lacks, such as "
                f"{beyond[0]}: a process of clean's died or gave up before its first step, or the "
                "command draws its episodes at random (fix its seed, and choose some by "
                f"episodes=). Run again; clean is measured anew, too. {CRASH}"
            )
        if unjudged := cell.unjudged():
            return unjudged
        if not cell.rows():
            return (
                f"of {counted(len(told.ends), 'episode')} that ended none said how it went, so "
                "there is no row: the metrics hold no success, and neither they nor the simulator "
                "a distance to a goal. Add the Success measure to the task, or call "
                "episode.finish(success=...)."
            )
        return ""
