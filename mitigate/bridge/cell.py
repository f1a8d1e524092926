"""One condition of a run: its settings, and what its folder says of it.

``done.json`` marks a condition as finished. It records how many episodes ended, and the size and
sha256 of the events at that moment. Whatever reads a finished condition compares them first, so
that a damaged file is never taken for a result.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mitigate.bridge import results
from mitigate.bridge.condition import SETTLED, Condition, Subset
from mitigate.bridge.events import DONE, EVENTS, damaged
from mitigate.bridge.hook.mitigate_hook import CLOSE, RESET
from mitigate.bridge.recording import is_whole
from mitigate.bridge.results import CUT_OFF, NORMALISED, Told, near, without_path
from mitigate.core import output
from mitigate.core.files import atomic_text, sha256
from mitigate.core.json_files import read_object
from mitigate.core.names import counted, short
from mitigate.corruptions import Corruption
from mitigate.evaluation.rows import Row
from mitigate.worlds.measures import RULES

LOG = "output.txt"
TAIL = 12  # lines of the command's output that an error repeats
LARGEST = 1 << 30  # bytes of a file of the command that is hashed; of a larger one its size counts
_SHA256 = re.compile(r"[0-9a-f]{64}")


def _is_number(value: Any) -> bool:
    plain = isinstance(value, (int, float)) and not isinstance(value, bool)
    return plain and math.isfinite(value)


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _is_seal(value: Any) -> bool:
    if not isinstance(value, dict) or not _is_count(value.get("bytes")):
        return False
    return isinstance(value.get("sha256"), str) and bool(_SHA256.fullmatch(value["sha256"]))


SCHEMA: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "condition": (lambda value: isinstance(value, str) and value != "", "a name"),
    "severity": (lambda value: _is_number(value) and 0 <= value <= 1, "a number from 0 to 1"),
    "repeat": (_is_count, "a whole number >= 0"),
    "files": (lambda value: isinstance(value, dict), "an object"),
    "episodes_told": (_is_count, "a whole number >= 0"),
    "events": (_is_seal, "the size (bytes) and the sha256 of the events"),
}
OLDER = ("events",)  # entries that older versions did not write


def folder_name(condition: str, severity: float, repeat: int = 0) -> str:
    """Return the name of a condition, which is also that of its folder."""
    name = f"{condition}-s{severity:g}" if severity or condition != "clean" else condition
    return f"{name}-again{repeat}" if repeat else name


def write_done(folder: Path, entries: Mapping[str, Any]) -> None:
    """Mark the condition in ``folder`` as finished with ``entries``, which lack ``events``."""
    seal = {"bytes": (folder / EVENTS).stat().st_size, "sha256": sha256(folder / EVENTS)}
    with atomic_text(folder / DONE) as file:
        json.dump({**entries, "events": seal}, file)


def read_done(folder: Path) -> dict[str, Any] | None:
    """Return the entries of a finished condition, None if it is not finished.

    Entries may be missing: older versions wrote fewer (:func:`missing_entries`).

    Raises:
        ValueError: ``done.json`` is damaged or of another condition than the folder, or the events
            are not those that it was written with. The message names the file and what to do.
    """
    file = folder / DONE
    again = (
        f"No file was changed. Move {folder} out of {folder.parent} and run the same command "
        "again: it measures this condition again."
    )
    if file.is_dir():
        raise ValueError(f"{file} must be a file, got a folder. {again}")
    if not output.is_regular(file):
        return None
    entries = read_object(file, again)
    for name, (is_valid, kind) in SCHEMA.items():
        if name in entries and not is_valid(entries[name]):
            raise ValueError(f"{file}: {name} must be {kind}, got {short(entries[name])}. {again}")
    if not missing_entries(entries):
        _compare_name(folder, entries)
        _compare_events(folder, entries)
    return entries


def missing_entries(entries: Mapping[str, Any]) -> list[str]:
    """Return the entries that every version of this file has and that are missing."""
    return [name for name in SCHEMA if name not in entries and name not in OLDER]


def _compare_name(folder: Path, entries: Mapping[str, Any]) -> None:
    """Raise ValueError if the entries are of another condition than ``folder`` is named after."""
    name = folder_name(entries["condition"], entries["severity"], entries["repeat"])
    if name != folder.name:
        raise ValueError(
            f"{folder} holds the condition {name}, as its {DONE} says: the folder was renamed or "
            "copied, or the file was edited. No file was changed. If it was renamed, give it its "
            f"old name, {name}. Otherwise move {folder} out of {folder.parent} and run the same "
            "command again: it measures this condition again."
        )


def _compare_events(folder: Path, entries: Mapping[str, Any]) -> None:
    """Raise ValueError if the events in ``folder`` are not those of the finished condition."""
    events, count = folder / EVENTS, entries["episodes_told"]
    if not output.is_regular(events):
        raise damaged(folder, f"the file is missing, and {DONE} records {count} episodes")
    told = results.read(folder, count_closed=True)  # a damaged line is named by its number
    seal = entries.get("events")
    if seal is not None:
        size = events.stat().st_size
        if size != seal["bytes"]:
            raise damaged(folder, f"it has {size} bytes, and {DONE} records {seal['bytes']}")
        if sha256(events) != seal["sha256"]:
            raise damaged(folder, f"its sha256 is not the one that {DONE} records")
    if count not in {len(told.ends), len(results.read(folder).ends)}:
        raise damaged(folder, f"{len(told.ends)} episodes ended, and {DONE} records {count}")


def check_finished(folder: Path) -> None:
    """Raise ValueError if a finished condition in the run's ``folder`` is damaged."""
    for file in sorted((folder / "conditions").glob(f"*/{DONE}")):
        read_done(file.parent)


@dataclass
class Cell:
    """The command under one condition.

    Attributes:
        name: The condition's name, which is that of its folder.
        settings: What its result depends on, by which a finished one is known again.
        clean: Folder of the clean condition, whose episodes it must have; None for that itself.
        recording: The folder that ``record=`` asks for.
        chosen: Says which episodes were asked for.
        count_closed: See ``results.read``.
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
    clean: Path | None = None
    recording: Path | None = None
    chosen: Subset | None = None
    count_closed: bool = False

    @property
    def log(self) -> Path:
        return self.folder / LOG

    def entries(self) -> dict[str, Any] | None:
        """Return the entries of ``done.json``; None if the condition is not finished.

        Raises ValueError for a damaged file, and if the events are not those of the entries.
        """
        return read_done(self.folder)

    def changed_settings(self) -> list[str]:
        """Return the settings whose value is not the one that it was finished with."""
        entries = self.entries() or self.settings
        return [name for name, value in self.settings.items() if entries.get(name) != value]

    def is_done(self) -> bool:
        """Return whether it is finished and complete. Raises ValueError for other settings."""
        entries = self.entries()
        if entries is None:
            return False
        if other := self.changed_settings():
            raise ValueError(
                f"{self.folder} was run with another "
                f"{', '.join(other)} ({entries.get(other[0])!r}, now {self.settings[other[0]]!r}). "
                "Name another folder (out=...), or delete it."
            )
        if missing := missing_entries(entries):
            raise ValueError(
                f"{self.folder / DONE} lacks {', '.join(missing)}: it is damaged, or of an older "
                f"version. Move {self.folder} out of {self.folder.parent} and run the same command "
                "again."
            )
        return not self.reason_to_repeat()

    def reason_to_repeat(self) -> str:
        """Return why a finished condition is measured again; empty if it need not be."""
        if self.entries() is None:
            return ""
        if missing := self.missing_episodes():
            return self.describe_missing(missing)
        told = self.told()
        if told.lost:  # measured with another count_closed, or by an older version
            return left_out(told)
        if self.recording is not None and not is_whole(self.recording, told.ends.values()):
            return f"it was not recorded in {self.recording}, or not all of it"
        return ""

    def changed_files(self, files: dict[str, Any]) -> list[str]:
        """Return the files of a finished condition's command that differ from ``files``."""
        before = (self.entries() or {}).get("files", {})
        return [name for name, told in before.items() if files.get(name) != told]

    def missing_episodes(self) -> list[str]:
        """Return the episodes of the clean condition that did not end under this one."""
        return sorted(self.clean_episodes() - self.told().ends.keys())

    def clean_episodes(self) -> set[str]:
        """Return the episodes that ended under the clean condition; empty for that itself."""
        if self.clean is None:
            return set()
        return set(results.read(self.clean, self.count_closed).ends)

    def extra_episodes(self) -> list[str]:
        """Return the episodes that ended under this condition but not under the clean one."""
        clean = self.clean_episodes()
        return sorted(self.told().ends.keys() - clean) if clean else []

    def output_excerpt(self) -> str:
        """Return what an error repeats of the command's output."""
        tail = self.tail()
        return f"\nThe end of {self.log}:\n{tail}" if tail else " It printed nothing."

    def tail(self) -> str:
        """Return the last lines of the command's output."""
        lines = self.log.read_text("utf-8", "replace").splitlines() if self.log.is_file() else []
        return "\n".join(f"  | {line}" for line in lines[-TAIL:])

    def told(self) -> Told:
        """Return what its processes reported so far."""
        return results.read(self.folder, self.count_closed)

    def rows(self) -> list[Row]:
        """Return the result rows."""
        clean = None if self.clean is None else results.read(self.clean, self.count_closed)
        return results.rows(self.told(), self.corruption, self.label, self.rule, clean)

    def unjudged(self) -> str:
        """Return why ``rule=`` cannot judge every episode; empty if it can.

        The success rate of some episodes alone would be another one.
        """
        told = self.told()
        missing = {} if self.rule is None else results.unjudged(told, self.rule)
        if not missing:
            return ""
        unknown, count = next(iter(missing.items()))
        who = "no episode told"
        if count < len(told.ends):
            who = f"{count} of {counted(len(told.ends), 'episode')} did not tell"
        what = "whether the agent said STOP" if unknown == "stopped" else "how far the goal is"
        own = ""
        if any("success" in end.get("metrics", {}) for end in told.ends.values()):
            own = ", or leave rule= out to count the told success"
        return f"rule={self.rule} needs to know {what}, which {who}: finish({unknown}=...){own}."

    def describe_missing(self, missing: list[str]) -> str:
        """Return "3 of clean's 6 episodes are missing"."""
        verb = "is" if len(missing) == 1 else "are"
        return (
            f"{len(missing)} of clean's {counted(len(self.clean_episodes()), 'episode')} {verb} "
            "missing"
        )

    def depth_warning(self) -> str:
        """Return a warning of depth that may be normalised; empty if none may be."""
        names = near(self.told())
        if not names:
            return ""
        return (
            f"run: the depth of {', '.join(names)} counts as metres, and read no more than 1 in "
            f"any episode: {NORMALISED}"
        )

    def summary(self) -> str:
        """Return its progress: "41 episodes, success 58.5 (own: ...), 2 without a path ..."."""
        told, found = self.told(), self.rows()
        asks = "" if self.rule is None else str(RULES[self.rule])
        first = asks or (found[0]["rule"] if found else "")
        own = [row["success"] for row in found if row["rule"] == first]
        said = [counted(len(told.ends), "episode") + self._asked(told)]
        said += [f"success {100 * sum(own) / len(own):.1f} ({first})"] if own else []
        said += [f"{len(told.lost)} left in the middle"] if told.lost else []
        unknown = without_path(told, self.rule)
        rules = {row["rule"] for row in found}
        alike = len(set(unknown.values())) == 1 and len(unknown) == len(rules)
        for rule, count in list(unknown.items())[: 1 if alike else None]:
            by = "" if alike else f" by {rule}"
            said.append(f"{count} without a path{by}: SPL is success")
        for how, name in ((RESET, "reset"), (CLOSE, "closed")):
            left = sum(end.get("how") == how for end in told.ends.values())
            if 0 < left < len(told.ends):
                said.append(f"{left} {name} before the end (counted as it stood)")
        said += [f"{told.again} ended twice (the first counts)"] if told.again else []
        silent = len(told.ends) - len(own)
        said += [f"{silent} without a result"] if silent and found else []
        return ", ".join(said)

    def _asked(self, told: Told) -> str:
        """Return why many more episodes ran than were asked for; empty if they did not."""
        count = len(told.ends) if self.chosen is None else self.chosen.count
        if len(told.ends) <= 1.5 * count:
            return ""
        return (
            f" ({count} asked for: processes came more than {SETTLED:g} s after the others, or "
            "each of many had to keep one)"
        )


def left_out(told: Told) -> str:
    """Return "2 episodes were left in the middle, such as s0/2: a process of it died ..."; one
    whose reason is known comes first."""
    name = next((name for name in told.lost if told.dropped[name]), told.lost[0])
    why = told.dropped[name] or "a process of it died, or its loop gave up"
    if told.dropped[name] not in ("", CUT_OFF):
        why = (
            f"it was reset or closed as an exception went by, {why}; if the program ends its "
            "episodes by that, let it reset or close behind the except block"
        )
    verb = "was" if len(told.lost) == 1 else "were"
    return f"{counted(len(told.lost), 'episode')} {verb} left in the middle, such as {name}: {why}"


def files_of(command: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Size and sha256 of the files that the words of a command name, alone or behind a ``=``."""
    found = {}
    for path in dict.fromkeys(_named(command)):
        size = path.stat().st_size
        found[str(path)] = {"size": size, "sha256": sha256(path) if size <= LARGEST else None}
    return found


def _named(command: Sequence[str]) -> Iterator[Path]:
    for word in command:
        for text in (word, word.partition("=")[2]):
            if os.path.isfile(text) and os.access(text, os.R_OK):  # of any text, code too
                yield Path(text)
