"""Which episodes an unchanged program is to run: a few, the same in every condition.

An episode is chosen by a hash of its name, whatever the order and the number of processes. The
first environments of a run name all that they hold; from these the bound is set that lets as many
pass as were asked for, and it is kept for all that follows.
"""

from __future__ import annotations

import fcntl
import json
import time
from dataclasses import dataclass
from pathlib import Path

from mitigate.core.files import atomic_text
from mitigate.core.json_files import read_object
from mitigate.corruptions import Key
from mitigate.corruptions.keying import digest, uniform

SETTLED = 4.0  # seconds without another environment, after which all are taken to be known (ours)


def place(name: str) -> float:
    """Where an episode stands in [0, 1): a hash of its name."""
    return uniform(digest(Key(0, name), "episodes"))


@dataclass
class Subset:
    """Keeps about ``count`` episodes, named like "scene.glb/17"; its notes are in ``folder``."""

    count: int
    folder: Path
    settled: float = SETTLED

    def keep(self, names: list[str], least: int = 1) -> list[int]:
        """Return the numbers of ``names`` to keep: ``least`` (0 or 1) of them, as Habitat refuses
        none."""
        bound = self._bound()
        if bound is None:
            bound = self._agree(names)
        places = [place(name) for name in names]
        kept = [i for i, at in enumerate(places) if at <= bound]
        return kept if kept or not least else [places.index(min(places))]

    def forget(self) -> None:
        """Forget which episodes were chosen."""
        for name in ("episodes.json", "episodes.txt"):
            (self.folder / name).unlink(missing_ok=True)

    def _bound(self) -> float | None:
        file = self.folder / "episodes.json"
        if not file.is_file():
            return None
        again = f"Move {self.folder} aside, and run the same command again."
        held = read_object(file, again)
        bound = held.get("bound")
        if not isinstance(bound, float) or not 0 <= bound <= 1 or not _is_count(held.get("of")):
            raise ValueError(f"{file} is damaged: bound must be 0 to 1, and of a number. {again}")
        if held.get("episodes") != self.count:
            raise ValueError(
                f"{self.folder} is of a run with episodes={held.get('episodes')}, and this one "
                f"asks for {self.count}. Name another folder (out=...), or delete this one."
            )
        return bound

    def least(self) -> int:
        """Return how many episodes the program was asked for; 0 if none were chosen yet."""
        if self._bound() is None:
            return 0
        of = int(read_object(self.folder / "episodes.json", "")["of"])
        return min(self.count, of)

    def _agree(self, names: list[str]) -> float:
        """Add ``names`` to those that are known, wait for others, and set the bound."""
        known = self.folder / "episodes.txt"
        with open(known, "a", encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            file.write("".join(f"{json.dumps(name)}\n" for name in names))
        while time.time() - known.stat().st_mtime < self.settled:
            time.sleep(0.1)
        with open(known, "r+", encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            bound = self._bound()
            if bound is None:
                places = sorted(place(_name(line, known)) for line in {*file})
                bound = places[min(self.count, len(places)) - 1]
                with atomic_text(self.folder / "episodes.json") as out:
                    json.dump({"bound": bound, "episodes": self.count, "of": len(places)}, out)
        return bound


def _is_count(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _name(line: str, file: Path) -> str:
    """Return the episode that a line of ``file`` names. Raises ValueError if it is damaged."""
    try:
        name: object = json.loads(line)
    except ValueError:
        name = None
    if not isinstance(name, str):
        raise ValueError(
            f"{file} has a damaged line, {line.strip()!r:.60}. Move {file.parent} aside, and run "
            "the same command again."
        )
    return name
