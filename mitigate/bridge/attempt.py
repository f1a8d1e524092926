"""Make one attempt to measure a condition: run the user's command and a server for its frames.

An attempt begins in an empty folder. It ends either with a finished condition (``done.json``) or
with the reason why the condition is unfinished. A command that exits with status 0 can also leave
its condition unfinished.
"""

from __future__ import annotations

import fcntl
import os
import signal
import time
from contextlib import ExitStack
from typing import IO, Any

from mitigate.bridge.cell import Cell, describe_lost, files_in, hash_files, write_done
from mitigate.bridge.events import DONE, EVENTS, LOCK, put_aside
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.program import GRACE, Command
from mitigate.bridge.recording import delete_drafts
from mitigate.bridge.results import Reports
from mitigate.bridge.server import Listener
from mitigate.core import output
from mitigate.core.files import make_folder
from mitigate.core.names import counted
from mitigate.core.output import open_output
from mitigate.core.signals import uninterrupted

DISCONNECT_TIME = 5.0  # maximum seconds until the connections of an ended command close (heuristic)
# A command that left an episode unfinished may be silent for MAX_SILENCE * patience seconds.
# After that time, the command counts as hanging (heuristic).
MAX_SILENCE = 10
MAX_NAMED = 3  # maximum number of processes that a message lists
CRASH = (
    " If the agent crashes on corrupted input, count that as a failure: catch the exception, and "
    "let the agent stop (with Habitat), or call episode.finish(success=False) (docs/bridge.md)."
)
DIFFERENT = (
    "a process died or gave up before its first step, or the command samples its episodes "
    "at random (fix its seed, and choose some by episodes=)."
)
NOT_LOADED = (
    "no Python process of it loaded the hook. Does a script replace PYTHONPATH (let it append), "
    "does it run python with -E, -I or -S, with a Python before 3.6, or in a container "
    "(docs/bridge.md)?"
)


class Attempt:
    """Runs the user's command under one condition. Call :meth:`poll` until the command ends, and
    :meth:`kill` in any case.
    """

    def __init__(self, cell: Cell) -> None:
        self.cell = cell
        # size and hash of the files that the command names, at the start of the command
        self.files: dict[str, dict[str, Any]] = {}
        self.loaded = False  # whether a Python process of the command loaded the hook
        # descriptions of processes that were still running after the command ended
        self.left: list[str] = []
        self.listener: Listener | None = None
        self.events: IO[str] | None = None
        self.process: Command | None = None
        self._opened = ExitStack()

    @uninterrupted()  # otherwise an interrupt could leave a started process unknown to ``kill``
    def start(self) -> None:
        """Start the server and the command in an empty folder.

        Files of an earlier attempt are moved to another folder first.

        Raises:
            ValueError: If another run uses the folder, or the command cannot be started.
        """
        cell, folder = self.cell, self.cell.folder
        make_folder(folder)
        lock = self._opened.enter_context(open_output(folder / LOCK, "a", encoding="utf-8"))
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise ValueError(
                f"Another run is using {folder}. Wait until it ends, or choose another folder "
                "(out=...)."
            ) from error
        self._opened.callback(output.unregister, output.register(folder, lock))
        if cell.recording is not None:
            delete_drafts(cell.recording)
        put_aside(folder, "finished" if output.is_regular(folder / DONE) else "unfinished")
        events = open_output(folder / EVENTS, "x", encoding="utf-8")
        self.events = self._opened.enter_context(events)
        chosen = cell.condition.chosen
        finished = chosen and any(chosen.folder.glob(f"conditions/*/{DONE}"))
        if chosen is not None and cell.clean is None and not finished:
            chosen.delete()  # episodes are chosen again
        self.files = hash_files(cell.command)
        listener = Listener(cell.condition, folder, cell.config.patience)
        self.listener = self._opened.enter_context(listener)
        words = self._words()
        environment = {**os.environ, **self.listener.environment(), **cell.environment}
        with open_output(cell.log, "w", encoding="utf-8") as log:
            try:
                self.process = Command(words, log, environment, self.listener.address)
            except OSError as error:
                raise ValueError(f"{words[0]} cannot be started: {error.strerror}.") from error

    def _words(self) -> list[str]:
        """Return the command and its arguments with all placeholders replaced."""
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
        """Return None while the command runs; then return a description of the problem, or ""."""
        try:
            return self._poll()
        except ValueError as error:  # the file of events is damaged
            self.kill()
            return str(error)

    def _poll(self) -> str | None:
        assert self.process is not None and self.listener is not None
        cell = self.cell
        self._check_events()
        status = self.process.status()
        if status is None:
            problem = self._describe_hang()
            if problem is not None:
                self.kill()
            return problem
        self.loaded = self.listener.was_loaded()
        self.left = self.process.left()
        self._end_command()
        if not self._wait_for_disconnects(DISCONNECT_TIME):
            # some processes run longer than the command, for example in another session
            self.listener.close_connections()
            self._wait_for_disconnects(GRACE)
        self._check_events()
        self.kill()
        problem = self._describe_problem(status)
        # delete its mark, so that the clean condition is measured again
        if cell.clean is not None and cell.extra_episodes():
            (cell.clean / DONE).unlink(missing_ok=True)
        if not problem:
            named = map(str, files_in(cell.command))
            entries = {
                "condition": cell.corruption.name,
                "severity": cell.corruption.severity,
                "repeat": cell.repeat,
                "files": self.files,
                "created": [file for file in named if file not in self.files],  # its outputs
                "episodes_told": len(cell.reports().ends),
            }
            write_done(cell.folder, cell.settings | entries)
        return problem

    def _advice(self) -> str:
        """Return advice for agents that crash on corrupted input, and the end of the output."""
        return (CRASH if self.cell.corruption.severity else "") + self.cell.output_excerpt()

    def _check_events(self) -> None:
        """Raise FolderLostError if the file of events or its folder was removed or replaced."""
        assert self.events is not None
        path = self.cell.folder / EVENTS
        output.check(path)
        if not output.is_same(os.fstat(self.events.fileno()), path):
            raise output.lost(path)

    def kill(self) -> None:
        """End all processes of the command, and the server."""
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # ignore a second Ctrl-C
        try:
            with self._opened:
                self._end_command()
        finally:
            signal.signal(signal.SIGINT, before)

    def _end_command(self) -> None:
        """End all processes of the command; connected processes get ``GRACE`` seconds to end."""
        if self.process is not None:
            self.process.end(self._is_connected)

    def _is_connected(self) -> bool:
        try:
            return self.cell.reports().connected > 0
        except ValueError:  # other code reports damaged events
            return False

    def _wait_for_disconnects(self, seconds: float) -> bool:
        """Wait at most ``seconds``, and return whether all connections have closed."""
        until = time.monotonic() + seconds
        while self.cell.reports().connected > 0:
            if time.monotonic() > until:
                return False
            time.sleep(0.05)
        return True

    def _describe_hang(self) -> str | None:
        """Return the reason why the running command will never end, or None."""
        assert self.listener is not None and self.events is not None
        if not self.listener.is_alive():
            return "the server of frames ended, and the command was stopped. Run again."
        silence = time.time() - os.fstat(self.events.fileno()).st_mtime
        if silence < self.cell.config.patience:
            return None
        reports = self.cell.reports()
        if reports.problems:
            return reports.problems[0]
        if reports.lost and (
            reports.connected < 1 or silence > MAX_SILENCE * self.cell.config.patience
        ):
            return (
                f"a process of the command ended in the middle of episode {reports.lost[0]}, and "
                f"no other process sent a message for {silence:.0f} s. The command was stopped."
                f"{self._advice()}"
            )
        return None

    def _describe_problem(self, status: int) -> str:
        """Return why the command failed, or "" if it succeeded; ``status`` is its exit status."""
        reports = self.cell.reports()
        if reports.problems:
            return reports.problems[0]
        if status:
            excerpt = self.cell.output_excerpt()
            if not reports.hellos and not self.loaded:
                return f"the command ended with status {status}, and {NOT_LOADED}{excerpt}"
            return (
                f"the command ended with status {status}."
                f"{self._advice() if reports.lost else excerpt}"
            )
        if self.left and not reports.lost:
            names = ", ".join(self.left[:MAX_NAMED]) + ", ..." * (len(self.left) > MAX_NAMED)
            count = "1 process" if len(self.left) == 1 else f"{len(self.left)} processes"
            return (
                f"the command ended, but {count} that it started still ran: {names}. They were "
                "ended. The command must wait for its processes (without &, nohup or setsid) or "
                f"end them itself. Change it, and run again.{self.cell.output_excerpt()}"
            )
        return (
            self._check_interception(reports)
            or self._check_episodes(reports)
            or self._check_count(reports)
        )

    def _check_count(self, reports: Reports) -> str:
        """Return why too few episodes ended, or ""."""
        cell = self.cell
        subset = cell.condition.chosen
        least = max(reports.announced, 0 if subset is None else subset.least())
        if len(reports.ends) >= least:
            return ""
        who = "wanted() returned" if reports.announced == least else "episodes= chose"
        return (
            f"the command ended after {counted(len(reports.ends), 'episode')}, and {who} {least}. "
            "Let it run all of them, or pass fewer to wanted() or episodes=. Then run again; the "
            f"condition is measured again.{cell.output_excerpt()}"
        )

    def _check_interception(self, reports: Reports) -> str:
        """Return why the bridge did not intercept the agent, or ""."""
        if not reports.hellos and not self.loaded:
            return f"the command ended, but {NOT_LOADED}{self.cell.output_excerpt()}"
        if not reports.hellos:
            return (
                "the command ended, and its Python loaded the hook, but it used neither "
                "habitat-lab (habitat.core.env) nor habitat-sim (habitat_sim.simulator) and never "
                "called mitigate_hook.connect. A loop of your own needs three calls: "
                "mitigate_hook.connect(), episode.corrupt() and episode.finish() (docs/bridge.md). "
                "This also applies to a loop with a different package named habitat."
                f"{self.cell.output_excerpt()}"
            )
        if mitigate_hook.ADAPTERS in self.cell.environment and not reports.adapted:
            return (
                "the adapters were not used: no instance of the class that adapters= names was "
                "called. Name the class that holds the encoder."
            )
        if not reports.ends and not reports.lost:
            return (
                "the command ended without an episode. Did it find results of another run or "
                "condition? Delete them, and let the command write to {out}, which is replaced by "
                f"{self.cell.folder}, an empty folder.{self.cell.output_excerpt()}"
            )
        return ""

    def _check_episodes(self, reports: Reports) -> str:
        """Return why episodes are missing, unfinished or without a result, or ""."""
        cell = self.cell
        if reports.lost:
            return (
                f"the command ended, but {describe_lost(reports)}. Then run again; the condition "
                f"is measured again.{self._advice()}"
            )
        if reports.connected > 0:
            return (
                "the command ended, but some of its processes still ran, and their unfinished "
                "episodes are unknown. Let the command wait for them, and run again."
            )
        if missing := cell.missing_episodes():
            return (
                f"{cell.describe_missing(missing)}, such as {missing[0]}: {DIFFERENT} Run again; "
                f"the condition is measured again.{self._advice()}"
            )
        if extra := cell.extra_episodes():
            return (
                f"{counted(len(extra), 'episode')} ended under it that the clean run lacks, such "
                f"as {extra[0]}: there, {DIFFERENT} Run again; the clean condition is "
                "measured again, too."
            )
        if problem := cell.rule_problem():
            return problem
        if not cell.rows():
            return (
                f"none of {counted(len(reports.ends), 'episode')} that ended reported a result "
                "that its own or another success rule can judge. Add the Success measure to the "
                "task, set rule=, or call episode.finish(success=...)."
            )
        return ""
