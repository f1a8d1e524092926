"""An entry of the leaderboard: what an agent reached, which rows say so, what it was trained on.

Entries are JSON files of strangers: nothing in one is believed but what :func:`load` has checked,
and every figure can be computed again from the rows that it names.
"""

from __future__ import annotations

import json
import re
from dataclasses import asdict, dataclass, field, fields
from importlib.metadata import version
from pathlib import Path
from typing import Any

from mitigate.core.files import atomic_text
from mitigate.core.json_files import read_json
from mitigate.core.names import counted
from mitigate.evaluation.leaderboard.checks import problem
from mitigate.evaluation.page.model import Numbers

FORMAT = 2  # 2: with ``listed``
LARGEST = 1 << 18  # bytes of an entry's file; one of 34 corruptions has 5,000 (ours)
_AGAIN = "Write it anew with `mitigate leaderboard add`."
_NUMBERS = re.compile(r"\[\n\s+([\d\s.,eE+nul-]*?)\s*\n\s+\]")


@dataclass(frozen=True)
class LeaderboardEntry:
    """What an agent reached on one split, suite, rule and severity.

    name: a heading. agents: fingerprint (``agents/fingerprint.py``) of each training seed's agent,
    and the seed of its rows. sensors: a line each. training_data, link: in words of who submits.
    scores: clean, mean and PRS, [value, low, high] with 95 % intervals, None where it is undefined.
    SR, SPL: the same of each condition. episodes: how many each condition has. listed: a hash of
    their ids (``from_rows.listed_sha``), since a table compares entries over the same episodes.
    rows: "file" (relative, or empty), "sha256" (``from_rows.rows_sha``) and "count" of
    those that it was computed from.
    """

    name: str
    agents: tuple[dict[str, Any], ...]
    sensors: tuple[str, ...]
    training_data: str
    split: str
    suite: str
    rule: str
    severity: float
    episodes: int
    listed: str
    scores: dict[str, Numbers]
    SR: dict[str, Numbers]
    SPL: dict[str, Numbers]
    rows: dict[str, Any]
    link: str = ""
    version: str = field(default_factory=lambda: version("mitigate"))
    format: int = FORMAT

    def save(self, path: Path | str) -> Path:
        """Write the entry to ``path`` as JSON, atomically. Raises ValueError for what :func:`load`
        would refuse."""
        text = json.dumps(asdict(self), indent=1, allow_nan=False)
        _check(json.loads(text), path)
        with atomic_text(path) as file:
            file.write(_short_lines(text) + "\n")
        return Path(path)

    def __str__(self) -> str:
        """A line for each score, success rates in %."""
        walked = f"{counted(self.episodes, 'episode')} of {self.split}"
        head = f"{self.name}: {walked}, severity {self.severity:g}"
        lines = (f"  {title}: {_words(title, found)}" for title, found in self.scores.items())
        return "\n".join([f"{head} ({self.rule})", *lines])


def load(path: Path | str) -> LeaderboardEntry:
    """Return the entry in the JSON file ``path``, which may be of anybody.

    Raises FileNotFoundError if there is none, ValueError, naming file and key, for a file over
    :data:`LARGEST` bytes, a key too many or too few, and every value of a wrong type, length or
    range.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"There is no entry {path}. {_AGAIN}")
    if path.stat().st_size > LARGEST:
        raise ValueError(f"{path} has more than {LARGEST} bytes, as no entry has. {_AGAIN}")
    held = read_json(path, _AGAIN)
    _check(held, path)
    return LeaderboardEntry(**held | {n: tuple(held[n]) for n in ("agents", "sensors")})


def _check(held: Any, path: Path | str) -> None:
    """Raise ValueError, naming file and key, if ``held`` is no entry."""
    names = [one.name for one in fields(LeaderboardEntry)]
    if not isinstance(held, dict) or sorted(held) != sorted(names):
        raise ValueError(
            f"{path} is no entry of the leaderboard: it needs exactly {', '.join(names)}. {_AGAIN}"
        )
    for name in names:
        wrong = problem(name, held[name])
        if wrong:
            raise ValueError(f"{path}: {name} {wrong}. {_AGAIN}")


def _words(title: str, found: Numbers) -> str:
    if found is None:
        return "undefined"
    percent = title.endswith(" SR")
    value, low, high = (
        "–" if number is None else f"{100 * number:.1f}" if percent else f"{number:.2f}"
        for number in found
    )
    return f"{value} [{low}, {high}]" + " %" * percent


def _short_lines(text: str) -> str:
    """Return indented JSON with each list of numbers on one line, as people read and compare it."""
    return _NUMBERS.sub(lambda found: f"[{' '.join(found[1].split())}]", text)
