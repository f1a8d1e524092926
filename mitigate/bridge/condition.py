"""What the user's command meets in one condition: frames, words and a choice of episodes.

An episode is chosen by a hash of its name, whatever the order and the number of processes. The
first environments of a run name all that they hold; from these the bound is set that lets as many
pass as were asked for, and it is kept for all that follows.
"""

from __future__ import annotations

import fcntl
import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from mitigate.bridge.results import Told
from mitigate.core import output
from mitigate.core.files import atomic_text
from mitigate.core.json_files import read_object
from mitigate.core.output import open_output
from mitigate.corruptions import Corruption, Key, corrupt_instruction
from mitigate.corruptions.keying import digest, uniform
from mitigate.corruptions.language.text import is_english
from mitigate.corruptions.language.tokens import VOCABULARY, Tokenizer, tokenizer_for
from mitigate.guards.guard import NO_GUARDS, EpisodeStart, Guards
from mitigate.worlds.episodes import read_extras

if TYPE_CHECKING:
    from mitigate.bridge.cameras import Rig

SETTLED = 4.0  # seconds without another environment, after which all are taken to be known (ours)
NO_TOKENIZER = (
    "the agent's episodes hold instruction tokens beside the text, and no tokenizer was named, so "
    "that it would read the old words: tokenizer=bert_config/bert-base-uncased (a folder with the "
    "tokenizer's files; ETPNav's repository has it), or tokenizer=EPISODES.json.gz for R2R-CE's "
    "own vocabulary in that file."
)


class Observer:
    """Sees what passes before it is corrupted; the methods of this class do nothing."""

    kinds: ClassVar[tuple[str, ...]] = ()  # of the cameras that it needs to see

    def episode(self, told: Mapping[str, Any]) -> None:
        """Take what is told of an episode that begins."""

    def frame(
        self, told: Mapping[str, Any], rig: Rig, memory: Any, offsets: Mapping[str, int]
    ) -> None:
        """Take the frames of a call, which lie in ``memory``."""

    def end(self, told: Mapping[str, Any]) -> None:
        """Take how the episode went."""

    def leave(self) -> None:
        """Take that the episode did not end."""


@dataclass
class Condition:
    """What a command meets: the corruption, its seed, and how it is applied.

    repeat: number of this run of the same condition; part of the keys where it is not 0. missing:
    metres that a hole reads. turn: where a growing yaw turns. guards: change words and
    frames behind the corruption. observers: see every episode and frame, before its
    corruption (``recording.py``).
    """

    corruption: Corruption
    seed: int
    words: Words
    repeat: int = 0
    missing: float = 0.0
    turn: str = "left"
    keep: Callable[[list[str], int], list[int]] | None = None
    guards: Guards = NO_GUARDS
    observers: list[Observer] = field(default_factory=list)

    def key(self, scene: str, episode: str, frame: int) -> Key:
        """Names the draw: seed, scene file and episode id, number of the call."""
        name = f"{scene.rpartition('/')[2]}/{episode}" + (f"#{self.repeat}" if self.repeat else "")
        return Key(self.seed, name, frame)


def applicable(corruption: Corruption, clean: Told) -> str:
    """Return why a corruption cannot reach the agent of a clean run; empty if it can."""
    kinds = {camera["type"] for camera in clean.cameras}
    for part in corruption.parts:
        if part.modality in ("rgb", "depth") and part.modality not in kinds:
            return f"the agent has no {part.modality} camera"
        if part.name == "white_box":
            return "an agent's system prompt does not pass the bridge"
        if part.modality == "instruction" and not clean.first.get("text"):
            if clean.first.get("category"):
                return "its goals are categories, not instructions"
            return "no instruction was told: connect(..., instruction=...)"
    return ""


def untold(corruption: Corruption, clean: Told, words: Words) -> bool:
    """Whether the agent reads tokens, and no tokenizer was named to tell it corrupted words by."""
    spoken = any(part.modality == "instruction" for part in corruption.parts)
    reads = bool(clean.first.get("tokens")) and is_english(clean.first.get("language"))
    return spoken and reads and words.tokenizer is None


@dataclass
class Words:
    """Changes the words of episodes.

    tokenizer: for agents that read tokens; None: an agent with tokens is refused where its words
    change, since it would read the old ones. length: of padded tokens; None: as the episode's own.
    """

    tokenizer: Tokenizer | None = None
    length: int | None = None

    def heard(
        self,
        told: Mapping[str, Any],
        corruption: Corruption,
        key: Key,
        guards: Guards = NO_GUARDS,
    ) -> dict[str, Any]:
        """Return ``text`` and ``tokens`` of an episode as the agent is to have them; empty where
        they stay as they are. Raises ValueError where an agent would not hear the change.
        """
        text, tokens = told.get("text"), told.get("tokens")
        spoken = [part for part in corruption.parts if part.modality == "instruction"]
        if any(part.name == "white_box" for part in spoken):
            raise ValueError(
                "white_box is not applicable: it corrupts an agent's system prompt, which does not "
                "pass the bridge. black_box puts the same sentences in front of the instruction."
            )
        if not isinstance(text, str):
            if spoken:
                category = told.get("category")
                has = f"{category!r}, a category that agents read by number" if category else "none"
                raise ValueError(
                    f"{corruption.name} corrupts the words of an instruction, but the episode has "
                    f"{has}. Tell it, connect(..., instruction=...), or leave the corruption out."
                )
            return {}
        made = text
        for part in spoken if is_english(told.get("language")) else ():
            made = corrupt_instruction(made, part.name, part.severity, key, mask_token=self._mask())
        made = guards.begin(EpisodeStart(key, made))
        if made == text:
            return {}
        return {"text": made, "tokens": self._tokens(made, tokens)}

    def _mask(self) -> str:
        return (self.tokenizer and self.tokenizer.mask_token) or "[MASK]"

    def _tokens(self, text: str, before: list[Any] | None) -> list[int] | None:
        if before is None:
            return None
        if self.tokenizer is None:
            raise ValueError(NO_TOKENIZER)
        return list(self.tokenizer.encode(text, self.length or fixed_length(before))[0])


def tokenizer_of(name: str) -> Tokenizer:
    """Return the tokenizer in a folder or of a hub name, or the vocabulary of an R2R-CE file
    (``.json``, ``.json.gz``). Raises ValueError or FileNotFoundError if there is none."""
    if name.endswith((".json", ".json.gz")):
        return tokenizer_for(VOCABULARY, read_extras(name))
    return tokenizer_for(name, {})


def fixed_length(tokens: list[Any]) -> int | None:
    """Return the length that a dataset pads its tokens to, None if it does not pad: padding is a
    token that comes twice and more at the end."""
    repeated = len(tokens) > 2 and tokens[-1] == tokens[-2] and tokens[-1] in (0, 1)
    return len(tokens) if repeated else None


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
        if not output.is_regular(file):
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
        with open_output(known, "a", encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            file.write("".join(f"{json.dumps(name)}\n" for name in names))
        while time.time() - known.stat().st_mtime < self.settled:
            time.sleep(0.1)
        with open_output(known, "r+", encoding="utf-8") as file:
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
