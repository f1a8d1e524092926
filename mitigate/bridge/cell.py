"""Represent one condition of a run, with its settings and the content of its folder.

``done.json`` marks a condition as finished. This file records how many episodes ended, and the size
and sha256 of the events at that moment. Every reader of a finished condition compares these values
first, so that a damaged file is never used as a result.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mitigate.bridge import results
from mitigate.bridge.condition import SETTLE_TIME, Condition, is_count
from mitigate.bridge.config import RunConfig
from mitigate.bridge.events import DONE, EVENTS, damaged, measure_again
from mitigate.bridge.hook.mitigate_hook import CLOSE, RESET
from mitigate.bridge.recording import is_whole
from mitigate.bridge.results import Reports
from mitigate.core import output
from mitigate.core.files import last_lines, sha256, write_json
from mitigate.core.json_files import read_object
from mitigate.core.names import counted, short
from mitigate.corruptions import Corruption
from mitigate.evaluation.rows import Row
from mitigate.worlds.measures import RULES

LOG = "output.txt"
TAIL = 12  # number of lines of the command's output that an error message repeats
# size in bytes above which a file that the command names is compared by size only, not by hash
MAX_HASHED = 1 << 30
SCHEMA: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "condition": (lambda value: isinstance(value, str) and value != "", "a name"),
    "severity": (
        lambda value: type(value) in (int, float) and 0 <= value <= 1,
        "a number from 0 to 1",
    ),
    "repeat": (is_count, "a whole number >= 0"),
    "files": (lambda value: isinstance(value, dict), "an object"),
    "created": (lambda value: isinstance(value, list), "a list"),
    "episodes_told": (is_count, "a whole number >= 0"),
    "events": (lambda value: isinstance(value, dict), "the size and the sha256 of the events"),
}


def folder_name(condition: str, severity: float, repeat: int = 0) -> str:
    """Return the name of a condition, which is also the name of its folder."""
    name = f"{condition}-s{severity:g}" if severity or condition != "clean" else condition
    return f"{name}-again{repeat}" if repeat else name


def write_done(folder: Path, entries: Mapping[str, Any]) -> None:
    """Mark a condition as finished with a file ``done.json``.

    The file contains ``entries`` and a checksum of the events.
    """
    write_json(folder / DONE, {**entries, "events": _seal(folder)})


def _seal(folder: Path) -> dict[str, Any]:
    """Return the size and the sha256 of the events in ``folder``."""
    events = folder / EVENTS
    return {"bytes": events.stat().st_size, "sha256": sha256(events)}


def read_done(folder: Path) -> dict[str, Any] | None:
    """Return the entries of a finished condition, or None if it is not finished.

    Raises ValueError if ``done.json`` is damaged or belongs to a different condition, or if the
    events changed after it was written. The message names the file and says what to do.
    """
    file = folder / DONE
    again = f"No file was changed. To continue, {measure_again(folder)}"
    if file.is_dir():
        raise ValueError(f"{file} must be a file, got a folder. {again}")
    if not output.is_regular(file):
        return None
    entries = read_object(file, again)
    for name, (is_valid, kind) in SCHEMA.items():
        value = entries.get(name)
        if not is_valid(value):
            raise ValueError(f"{file}: {name} must be {kind}, got {short(value)}. {again}")
    name = folder_name(entries["condition"], entries["severity"], entries["repeat"])
    if name != folder.name:
        raise ValueError(
            f"{folder} holds the condition {name} according to its {DONE}. If the folder was "
            f"renamed, restore the name {name}. {again}"
        )
    _compare_events(folder, entries)
    return entries


def _compare_events(folder: Path, entries: Mapping[str, Any]) -> None:
    """Raise ValueError if the events in ``folder`` changed after the condition finished."""
    count = entries["episodes_told"]
    if not output.is_regular(folder / EVENTS):
        raise damaged(folder, f"the file is missing, although {DONE} records {count} episodes")
    # read raises an error that names the damaged line
    reports = results.read(folder, count_closed=True)
    if _seal(folder) != entries["events"]:
        raise damaged(folder, f"its size or sha256 differs from that in {DONE}")
    if count not in {len(reports.ends), len(results.read(folder).ends)}:
        raise damaged(folder, f"{len(reports.ends)} episodes ended, and {DONE} records {count}")


@dataclass
class Cell:
    """One run of the command under one condition."""

    name: str  # name of the condition and of its folder
    config: RunConfig
    command: tuple[str, ...]
    folder: Path  # folder for the events and the output of the command
    condition: Condition  # applies the corruption to frames and instructions
    label: dict[str, Any]  # entries that are added to all rows
    # the result depends on these; a finished condition is reused only if they are the same
    settings: dict[str, Any]
    environment: dict[str, str]  # environment variables that are set for the command
    # Folder of the clean condition, or None for the clean condition itself. Each episode that ended
    # there must also end under this condition.
    clean: Path | None = None
    recording: Path | None = None  # the folder that the option ``record=`` names

    @property
    def corruption(self) -> Corruption:
        return self.condition.corruption

    @property
    def repeat(self) -> int:
        """The number of the repetition for a repeated clean run, else 0."""
        return self.condition.repeat

    @property
    def log(self) -> Path:
        return self.folder / LOG

    def entries(self) -> dict[str, Any] | None:
        """Return the entries of ``done.json``, or None if the condition is not finished.

        Raises ValueError if a file is damaged, or if the events do not match the entries.
        """
        return read_done(self.folder)

    def changed_settings(self) -> list[str]:
        """Return the names of settings that changed after the condition finished."""
        entries = self.entries() or self.settings
        return [name for name, value in self.settings.items() if entries.get(name) != value]

    def is_done(self) -> bool:
        """Return whether the condition is finished and need not be measured again.

        Raises ValueError if settings changed.
        """
        entries = self.entries()
        if entries is None:
            return False
        if other := self.changed_settings():
            raise ValueError(
                f"{self.folder} was run with another {', '.join(other)} "
                f"({entries.get(other[0])!r}, now {self.settings[other[0]]!r}). Choose another "
                "folder (out=...), or delete this one."
            )
        return not self.reason_to_repeat()

    def reason_to_repeat(self) -> str:
        """Return the reason why a finished condition must be measured again, or ""."""
        if self.entries() is None:
            return ""
        if missing := self.missing_episodes():
            return self.describe_missing(missing)
        reports = self.reports()
        if reports.lost:  # it was measured with another count_closed
            return describe_lost(reports)
        if self.recording is not None and not is_whole(self.recording, reports.ends.values()):
            return f"it was not recorded in {self.recording}, or only in part"
        return ""

    def missing_episodes(self) -> list[str]:
        """Return the episodes that ended under the clean condition, but not under this one."""
        return sorted(self.clean_reports().ends.keys() - self.reports().ends.keys())

    def clean_reports(self) -> Reports:
        """Return the reports of the clean condition. They are empty if this condition is clean."""
        return results.read(self.clean, self.config.count_closed) if self.clean else Reports()

    def extra_episodes(self) -> list[str]:
        """Return the episodes that ended under this condition, but not under the clean one."""
        clean = self.clean_reports().ends
        return sorted(self.reports().ends.keys() - clean.keys()) if clean else []

    def output_excerpt(self) -> str:
        """Return the last lines of the command's output, for an error message."""
        if not self.log.is_file():
            return " It printed nothing."
        with open(self.log, "rb") as file:
            tail = "\n".join(f"  | {line}" for line in last_lines(file, TAIL))
        return f"\nThe end of {self.log}:\n{tail}" if tail else " It printed nothing."

    def reports(self) -> Reports:
        """Return everything that the command's processes have reported so far."""
        return results.read(self.folder, self.config.count_closed)

    def rows(self) -> list[Row]:
        """Return the result rows."""
        reports, clean = self.reports(), self.clean_reports()
        return results.rows(reports, self.corruption, self.label, self.config.rule, clean)

    def rule_problem(self) -> str:
        """Return the reason why ``rule=`` cannot judge every episode, or "".

        A success rate over only some of the episodes would be misleading.
        """
        reports, rule = self.reports(), self.config.rule
        missing = results.count_missing(reports, rule) if rule else {}
        if not missing:
            return ""
        argument, count = next(iter(missing.items()))
        stop, distance = "whether the agent called STOP", "the distance to the goal"
        return (
            f"rule={rule} needs to know {stop if argument == 'stopped' else distance}, which "
            f"{count} of {counted(len(reports.ends), 'episode')} did not report. Pass "
            f"finish({argument}=...), or leave rule= out to count the reported success."
        )

    def describe_missing(self, missing: list[str]) -> str:
        """Return a text such as "3 of clean's 6 episodes are missing".

        "clean" is the name of the condition without corruption.
        """
        verb = "is" if len(missing) == 1 else "are"
        all_clean = counted(len(self.clean_reports().ends), "episode")
        return f"{len(missing)} of clean's {all_clean} {verb} missing"

    def depth_warning(self) -> str:
        """Return a warning if depth may be normalised to [0, 1], else ""."""
        names = ", ".join(results.maybe_normalised(self.reports()))
        warning = f"run: the depth of {names} should be in metres, but it never exceeded 1"
        return f"{warning}: {results.NORMALISED_HINT}" if names else ""

    def summary(self) -> str:
        """Return a summary, such as "41 episodes, success 58.5 (own: ...), 2 left unfinished"."""
        reports, rows, rule = self.reports(), self.rows(), self.config.rule
        first_rule = str(RULES[rule]) if rule else next((row["rule"] for row in rows), "")
        successes = [row["success"] for row in rows if row["rule"] == first_rule]
        parts = [counted(len(reports.ends), "episode") + self._describe_surplus(reports)]
        if successes:
            parts.append(f"success {100 * sum(successes) / len(successes):.1f} ({first_rule})")
        if reports.lost:
            parts.append(f"{len(reports.lost)} left unfinished")
        for name, count in results.count_without_path(reports, rule).items():
            parts.append(f"{count} successful without a path by {name}: their SPL is 1")
        for how, name in ((RESET, "reset"), (CLOSE, "closed")):
            count = sum(end.get("how") == how for end in reports.ends.values())
            if 0 < count < len(reports.ends):
                parts.append(f"{count} {name} before the end (judged where they stopped)")
        if reports.repeated:
            parts.append(f"{reports.repeated} ended twice (the first end counts)")
        without_result = len(reports.ends) - len(successes)
        if without_result and rows:
            parts.append(f"{without_result} without a result")
        return ", ".join(parts)

    def _describe_surplus(self, reports: Reports) -> str:
        """Return the reason why far more episodes ran than requested, or ""."""
        chosen = self.condition.chosen
        if chosen is None or len(reports.ends) <= 1.5 * chosen.count:
            return ""
        return (
            f" ({chosen.count} asked for: some processes connected more than {SETTLE_TIME:g} s "
            "after the others, or there are more processes than episodes)"
        )


def describe_lost(reports: Reports) -> str:
    """Return a text like "2 episodes were left unfinished, such as s0/2: a process died ...".

    If possible, the example is an episode for which the reason is known. The text ends with advice.
    """
    name = next((name for name in reports.lost if reports.dropped[name]), reports.lost[0])
    reason = reports.dropped[name] or (
        "a process of the command died, or the program left the episode. If it left the episode, "
        "let it call env.close(), or episode.finish() in a loop of your own"
    )
    if reports.dropped[name] not in ("", results.CUT_OFF):
        reason = (
            f"it was reset or closed during an exception, {reason}. To end episodes by "
            "exceptions, reset or close after the except block"
        )
    verb = "was" if len(reports.lost) == 1 else "were"
    return (
        f"{counted(len(reports.lost), 'episode')} {verb} left unfinished, such as {name}: {reason}"
    )


def hash_files(command: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Return the size and sha256 of each file that a command names."""
    hashes = {}
    for path in dict.fromkeys(files_in(command)):
        size = path.stat().st_size
        hashes[str(path)] = {"size": size, "sha256": sha256(path) if size <= MAX_HASHED else None}
    return hashes


def files_in(command: Sequence[str]) -> Iterator[Path]:
    """Yield the existing files in a command, as an argument or after the ``=`` in an argument."""
    for word in command:
        for text in (word, word.partition("=")[2]):
            # a word of the command may be code instead of a file name
            if os.path.isfile(text) and os.access(text, os.R_OK):
                yield Path(text)
