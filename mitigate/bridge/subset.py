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
from mitigate.core.output import open_output
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
        held = json.loads(file.read_text("utf-8"))
        if held["episodes"] != self.count:
            raise ValueError(
                f"{self.folder} is of a run with episodes={held['episodes']}, and this one asks "
                f"for {self.count}. Name another folder (out=...), or delete this one."
            )
        return held["bound"]

    def _agree(self, names: list[str]) -> float:
        """Add ``names`` to those that are known, wait for others, and set the bound."""
        known = self.folder / "episodes.txt"
        with open_output(known, "a", encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            file.write("".join(f"{json.dumps(name)}\n" for name in names))
        while time.time() - known.stat().st_mtime < self.settled:
            time.sleep(0.1)
        with open_output(known, "r+", encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            bound = self._bound()
            if bound is None:
                places = sorted(place(json.loads(line)) for line in {*file})
                bound = places[min(self.count, len(places)) - 1]
                with atomic_text(self.folder / "episodes.json") as out:
                    json.dump({"bound": bound, "episodes": self.count, "of": len(places)}, out)
        return bound
