"""Apply one condition to the user's command: corrupt frames and instructions, and choose episodes.

An episode is chosen if the hash of its name is at most a bound, so the choice depends neither on
the order nor on the number of processes. The first environments of a run report the names of their
episodes. From these names, the bound is computed such that about the requested number of episodes
is chosen. All later environments use the same bound.
"""

from __future__ import annotations

import fcntl
import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from mitigate.bridge.results import Reports
from mitigate.core import output
from mitigate.core.files import write_json
from mitigate.core.json_files import read_object
from mitigate.core.names import counted
from mitigate.core.output import open_output
from mitigate.core.progress import say
from mitigate.corruptions import Corruption, Key, corrupt_instruction
from mitigate.corruptions.keying import digest, uniform
from mitigate.corruptions.language.text import is_english
from mitigate.corruptions.language.tokens import VOCABULARY, Tokenizer, tokenizer_for
from mitigate.corruptions.record import CAMERA
from mitigate.corruptions.registry import record
from mitigate.guards.guard import NO_GUARDS, EpisodeStart, Guards
from mitigate.worlds.episodes import read_extras

if TYPE_CHECKING:
    from mitigate.bridge.cameras import Rig

# if no new environment reports for this many seconds, all are assumed to be known (heuristic)
SETTLE_TIME = 4.0
NO_TOKENIZER = (
    "the agent's episodes hold instruction tokens in addition to the text. Without a tokenizer the "
    "agent would read the original instruction. Set tokenizer=bert_config/bert-base-uncased (a "
    "folder with the tokenizer's files; ETPNav's repository has it), or tokenizer=EPISODES.json.gz "
    "for R2R-CE's own vocabulary in that file."
)


class Observer:
    """Receives messages and frames before the corruption. This base class ignores them."""

    kinds: ClassVar[tuple[str, ...]] = ()  # kinds of cameras ("rgb", "depth") whose frames it needs

    def episode(self, message: Mapping[str, Any]) -> None:
        """Receive the message that begins an episode."""

    def frame(
        self, message: Mapping[str, Any], rig: Rig, memory: Any, offsets: Mapping[str, int]
    ) -> None:
        """Receive the frames of a call, which are in ``memory``."""

    def end(self, message: Mapping[str, Any]) -> None:
        """Receive the result of an episode."""

    def leave(self) -> None:
        """Handle an episode that was left unfinished."""


@dataclass
class Condition:
    """A corruption, its seed, and the settings with which it is applied."""

    corruption: Corruption
    seed: int
    words: Words
    # number of this repetition of the same condition; if it is not 0, random numbers depend on it
    repeat: int = 0
    missing: float = 0.0  # value in metres for missing depth
    turn: str = "left"  # direction of increasing yaw, "left" or "right"
    chosen: Subset | None = None  # chooses the episodes, or None to keep all
    guards: Guards = NO_GUARDS  # guards that change instructions and frames after the corruption
    # receives every episode and frame before the corruption (``recording.py``)
    observer: Observer = field(default_factory=Observer)

    def key(self, scene: str, episode: str, frame: int) -> Key:
        """Return the key for the random numbers of one call.

        The key consists of the seed, the name of the scene file with the episode id, and the number
        of the call.
        """
        name = f"{scene.rpartition('/')[2]}/{episode}" + (f"#{self.repeat}" if self.repeat else "")
        return Key(self.seed, name, frame)


def why_not_applicable(corruption: Corruption, clean: Reports) -> str:
    """Return the reason why a corruption cannot reach this agent, or "" if it can."""
    kinds = {camera["type"] for camera in clean.cameras}
    for part in corruption.parts:
        sensors = {*record(part.name).modalities} & {"rgb", "depth"}
        if sensors and not sensors & kinds:
            unread = f" (not read as cameras: {', '.join(clean.unread)})" if clean.unread else ""
            return f"the agent has no {' or '.join(sorted(sensors))} camera{unread}"
        if record(part.name).family == CAMERA:
            if part.name == "camera_height":
                return "the bridge cannot render from another height"
            if any(camera.get("hfov") is None for camera in clean.cameras):
                return "a camera has no hfov: describe it in connect(...).corrupt(cameras=...)"
        if part.name == "white_box":
            return "the bridge does not see the agent's system prompt"
        if part.modality == "instruction" and not clean.first.get("text"):
            if clean.first.get("category"):
                return "its goals are categories, not instructions"
            return "the program passes no instruction: connect(..., instruction=...)"
    return ""


def needs_tokenizer(corruption: Corruption, clean: Reports, words: Words) -> bool:
    """Return whether ``tokenizer=`` is missing: words are corrupted, but the agent reads tokens."""
    changes_words = any(part.modality == "instruction" for part in corruption.parts)
    reads_tokens = bool(clean.first.get("tokens")) and is_english(clean.first.get("language"))
    return changes_words and reads_tokens and words.tokenizer is None


@dataclass
class Words:
    """Corrupts instructions."""

    # The tokenizer for agents that read tokens. If it is None, changing the instruction of such an
    # agent is an error, because the agent would read the original tokens.
    tokenizer: Tokenizer | None = None
    length: int | None = None  # length of padded tokens, or None to keep the episode's length

    def corrupt(
        self,
        message: Mapping[str, Any],
        corruption: Corruption,
        key: Key,
        guards: Guards = NO_GUARDS,
    ) -> dict[str, Any]:
        """Return ``text`` and ``tokens`` for the agent, or an empty dict if nothing changes.

        Args:
            message: The message that begins the episode, with ``text``, ``tokens``, ``language``,
                ``category``.
            corruption: The corruption of the condition.
            key: Key from which all random numbers are derived.
            guards: Guards that change the corrupted instruction.

        Raises:
            ValueError: If the corrupted instruction cannot be passed to the agent.
        """
        text, tokens = message.get("text"), message.get("tokens")
        parts = [part for part in corruption.parts if part.modality == "instruction"]
        if not isinstance(text, str):
            if parts:
                raise ValueError(
                    f"{corruption.name} corrupts the words of an instruction, but the episode has "
                    "none. Pass connect(..., instruction=...), or leave the corruption out."
                )
            return {}
        changed = text
        mask = (self.tokenizer and self.tokenizer.mask_token) or "[MASK]"
        for part in parts if is_english(message.get("language"), text) else ():
            changed = corrupt_instruction(changed, part.name, part.severity, key, mask_token=mask)
        changed = guards.begin(EpisodeStart(key, changed))
        if changed == text:
            return {}
        if tokens is not None:
            if self.tokenizer is None:
                raise ValueError(NO_TOKENIZER)
            # a dataset that pads its tokens repeats the token 0 or 1 at the end
            padded = len(tokens) > 2 and tokens[-1] == tokens[-2] and tokens[-1] in (0, 1)
            length = self.length or (len(tokens) if padded else None)
            tokens = list(self.tokenizer.encode(changed, length)[0])
        return {"text": changed, "tokens": tokens}


def load_tokenizer(name: str) -> Tokenizer:
    """Load a tokenizer from a folder, a hub name, or an R2R-CE file.

    An R2R-CE file is a ``.json`` or ``.json.gz`` file with a vocabulary. Raises ValueError if the
    file or folder contains no tokenizer, and FileNotFoundError if there is no such file or folder.
    """
    if name.endswith((".json", ".json.gz")):
        return tokenizer_for(VOCABULARY, read_extras(name))
    return tokenizer_for(name, {})


def hash_episode(name: str) -> float:
    """Hash an episode's name to a number in [0, 1)."""
    return uniform(digest(Key(0, name), "episodes"))


@dataclass
class Subset:
    """Chooses about ``count`` episodes by a hash of their names."""

    count: int  # the requested number of episodes
    folder: Path  # the run's folder, in which the choice of episodes is stored
    # If no new environment reports its episodes for this many seconds, all environments are assumed
    # to be known.
    settled: float = SETTLE_TIME

    def keep(self, names: list[str], least: int = 1) -> list[int]:
        """Return the indices of the episodes to keep.

        ``names`` are the names of the episodes of one environment, such as "scene.glb/17". At least
        ``least`` episodes are kept, 0 or 1. The default is 1, because Habitat rejects an empty
        dataset.
        """
        bound = (self._choice() or self._choose(names))["bound"]
        hashes = [hash_episode(name) for name in names]
        indices = [i for i, value in enumerate(hashes) if value <= bound]
        return indices if indices or not least else [hashes.index(min(hashes))]

    def delete(self) -> None:
        """Delete the stored choice."""
        for name in ("episodes.json", "episodes.txt"):
            (self.folder / name).unlink(missing_ok=True)

    def _choice(self) -> dict[str, Any] | None:
        """Return the stored choice of episodes, or None if no choice is stored.

        Its entry "bound" is the largest hash of a chosen episode. The entry "episodes" is the
        requested number of episodes, and "of" is the number of episodes to choose from.
        """
        file = self.folder / "episodes.json"
        if not output.is_regular(file):
            return None
        again = f"Move {self.folder} aside, and run the same command again."
        choice = read_object(file, again)
        bound = choice.get("bound")
        if not isinstance(bound, float) or not 0 <= bound <= 1 or not is_count(choice.get("of")):
            raise ValueError(
                f'{file} is damaged: "bound" must be from 0 to 1, and "of" must be a whole number '
                f">= 0. {again}"
            )
        if choice.get("episodes") != self.count:
            raise ValueError(
                f"{self.folder} belongs to a run with episodes={choice.get('episodes')}, got "
                f"episodes={self.count}. Name another folder (out=...), or delete this one."
            )
        return choice

    def least(self) -> int:
        """Return how many episodes the program must run; 0 before episodes are chosen."""
        choice = self._choice()
        return min(self.count, choice["of"]) if choice else 0

    def _choose(self, names: list[str]) -> dict[str, Any]:
        """Add ``names`` to the known names, wait for other environments, and store the choice."""
        known = self.folder / "episodes.txt"
        with open_output(known, "a", encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            file.write("".join(f"{json.dumps(name)}\n" for name in names))
        while time.time() - known.stat().st_mtime < self.settled:
            time.sleep(0.1)
        with open_output(known, "r+", encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            if (choice := self._choice()) is None:
                hashes = sorted(hash_episode(_read_name(line, known)) for line in {*file})
                bound = hashes[min(self.count, len(hashes)) - 1]
                choice = {"bound": bound, "episodes": self.count, "of": len(hashes)}
                write_json(self.folder / "episodes.json", choice)
                if self.count > len(hashes):
                    only = f"the program names only {counted(len(hashes), 'episode')}"
                    say(f"episodes={self.count}, but {only}: it counts as complete with these")
        return choice


def is_count(value: object) -> bool:
    """Return whether a value from a file is a whole number >= 0."""
    return type(value) is int and value >= 0


def _read_name(line: str, file: Path) -> str:
    """Return the episode name in a ``line`` of ``file``.

    Raises ValueError if the line is damaged.
    """
    try:
        name: object = json.loads(line)
    except (ValueError, RecursionError):
        name = None
    if not isinstance(name, str):
        raise ValueError(
            f"{file} has a damaged line, {line.strip()!r:.60}. Move {file.parent} aside, and run "
            "the same command again."
        )
    return name
