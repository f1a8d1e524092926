"""Imitate recorded conversations with images on corrupted frames; no world is needed.

The data has the format of LLaVA and NaVid: each entry has a list of images, a question, and the
answer of an expert. ``agents/vlm/dataset.py`` writes such data, and the data of other projects can
be used if its questions fit ``agent.task``. Every training step draws entries at random, corrupts
their images by the schedule, and trains on the answers with the loss of ``recipes/imitate.py``.
"""

from __future__ import annotations

import gzip
import json
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import torch

from mitigate.agents.agent import Decisions
from mitigate.agents.vlm.answers import read_answer
from mitigate.agents.vlm.conversation import MOST_FRAMES, question
from mitigate.agents.vlm.dataset import CONVERSATIONS
from mitigate.agents.vlm.rollout import Piece
from mitigate.core.files import lfs_problem, open_text, sha256
from mitigate.core.json_files import parse_json
from mitigate.core.names import short
from mitigate.core.observation import RGB
from mitigate.core.pictures import picture
from mitigate.core.seeding import generator
from mitigate.corruptions import Schedule, corrupt_observation, frame_files
from mitigate.recipes.imitate import Imitate
from mitigate.training.objective import Job, check_counts, divide
from mitigate.training.parts import TRAINABLE
from mitigate.training.rollouts import PIECES
from mitigate.training.success import reject_success_distributed

MOST_LINE = 1 << 20  # maximum number of characters in a line
MOST_LINES = 10_000_000
MOST_TEXT = 100_000  # maximum number of characters of an instruction, as in episode files
IMAGE = "<image>"


@dataclass(frozen=True)
class Entry:
    """One recorded decision: the instruction, the images and the index of the answer."""

    name: str
    instruction: str
    images: tuple[Path, ...]
    answer: int


@dataclass(eq=False, repr=False)
class Conversations:
    """Source of batches of recorded decisions, whose images are corrupted by a schedule.

    Args:
        agent: the vision-language agent.
        folder: folder with ``conversations.jsonl`` and the images.
        schedule: chooses the corruption of each image; all images of an entry are one episode. If
            None, images stay clean.
        decisions: number of entries per step.
        seed: seed of entries and corruptions.

    Raises:
        FileNotFoundError: If the file or an image is missing.
        ValueError: If an entry is invalid, a question does not fit ``agent.task``, an answer is not
            one of the allowed answers, or the schedule samples corruptions by success rate.
    """

    agent: Any
    folder: str | None
    schedule: Schedule = None  # type: ignore[assignment]
    decisions: int = 16
    seed: int = 0

    def __post_init__(self) -> None:
        check_counts(decisions=self.decisions)
        self.schedule = self.schedule or Schedule("clean", 0.0)
        reject_success_distributed(self.schedule)
        if not self.folder:
            raise ValueError(
                "The folder of the conversations is missing: stages.imitation.recipe.folder=FOLDER."
            )
        self.file = Path(self.folder) / CONVERSATIONS
        self.entries = list(read_entries(self.file, self.agent))
        if not self.entries:
            raise ValueError(f"{self.file} must hold at least one conversation.")
        for image in {image for entry in self.entries for image in entry.images}:
            if not image.is_file():
                raise FileNotFoundError(f"There is no image file {image}, which {self.file} names.")
        self.size: tuple[int, ...] | None = None  # of the images in earlier batches
        self.picture: np.ndarray | None = None

    @property
    def pieces(self) -> int:
        """The number of jobs in every step."""
        return min(PIECES, self.decisions)

    def identity(self) -> dict[str, str]:
        """Return the hash of the conversations."""
        return {"conversations_sha256": sha256(self.file)}

    def jobs(self, step: int, workers: int | None = None) -> list[Job]:
        """Return the jobs of a step, whose items are entries."""
        return divide(step, self.decisions, self.pieces)

    def work(self, job: Job) -> tuple[Piece, np.ndarray]:
        """Read and corrupt the images of a job; return its decisions and a picture of an image."""
        step, index, _, count = job
        rng = generator(self.seed, "conversation", step, index)
        chosen = [self.entries[i] for i in rng.integers(len(self.entries), size=count)]
        frames: list[np.ndarray] = []
        for number, entry in enumerate(chosen):
            for time, file in enumerate(entry.images):
                corruption, key = self.schedule.draw(self.seed, f"{step}-{index}-{number}", time)
                observation = {RGB: _read(file)}
                frames.append(corrupt_observation(observation, corruption, key)[RGB])
        for frame in frames:
            self._check_size(frame.shape[:2])
        piece = {
            "texts": [entry.instruction for entry in chosen],
            "ids": [entry.name for entry in chosen],
            "views": [[list(range(len(entry.images)))] for entry in chosen],
            "targets": [entry.answer for entry in chosen],
            "frames": torch.from_numpy(np.stack(frames)),
            "clean": torch.empty(0, dtype=torch.uint8),
        }
        seen = picture({RGB: frames[0]})
        return piece, frames[0] if seen is None else seen

    def collate(self, pieces: list[tuple[Piece, np.ndarray]]) -> Decisions:
        """Join the decisions of all jobs."""
        for piece, _ in pieces:
            self._check_size(tuple(piece["frames"].shape[1:3]))
        self.picture = pieces[0][1]
        return self.agent.join([piece for piece, _ in pieces])

    def _check_size(self, size: tuple[int, ...]) -> None:
        """Raise ValueError if an image has another size than the images before it."""
        self.size = self.size or size
        if size != self.size:
            raise ValueError(
                f"All images in {self.folder} must have the same size, got {self.size} and {size} "
                "(height, width). Resize them."
            )

    def figures(self) -> dict[str, np.ndarray]:
        """Return a picture of an image from the last batch."""
        return {} if self.picture is None else {"seen": self.picture}


class ImitateConversations(Imitate):
    """Imitate the answers in recorded conversations.

    Args:
        agent, train_parts, losses: same as in ``Imitate``.
        rollouts: the source of recorded decisions.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {"rollouts": Conversations}
    needs = ("answers", "task", *TRAINABLE)
    otherwise = "Only vision-language agents learn from conversations (agent=vlm)."


def read_entries(file: Path, agent: Any) -> Iterator[Entry]:
    """Read a file of conversations, one JSON object per line.

    Raises:
        FileNotFoundError: If the file is missing.
        ValueError: If a line is invalid; the message contains its number.
    """
    if agent.task.count("{instruction}") != 1:
        raise ValueError("agent.task must contain {instruction} exactly once.")
    parts = agent.task.replace(IMAGE, "").split("{instruction}")
    around = [question(text, agent.answers, "").strip() for text in parts]
    if file.is_file() and (pointer := lfs_problem(file)):
        raise ValueError(f"{file}: {pointer}")
    with open_text(file) as lines:
        for number in range(1, MOST_LINES + 1):
            try:
                line = lines.readline(MOST_LINE)
                if not line:
                    return
                entry = _entry(line, file.parent, agent, around) if line.strip() else None
            except (ValueError, RecursionError, EOFError, gzip.BadGzipFile) as error:
                raise ValueError(f"{file}, line {number}: {error}") from error
            if entry is not None:
                yield entry
    raise ValueError(f"{file} must have at most {MOST_LINES:,} lines.")


def _entry(line: str, folder: Path, agent: Any, around: list[str]) -> Entry:
    """Return the entry in a line; raise ValueError if it is invalid."""
    if len(line) >= MOST_LINE:
        raise ValueError(f"a line must have less than {MOST_LINE:,} characters.")
    stored = parse_json(line)
    if not isinstance(stored, dict):
        raise ValueError(f"expected an object with images and conversations, got {short(line)}.")
    images = stored.get("images", stored.get("image"))
    images = [images] if isinstance(images, str) else images
    if not isinstance(images, list) or not images or not all(isinstance(i, str) for i in images):
        raise ValueError("'images' must list at least one path of an image below the folder.")
    if len(images) > MOST_FRAMES + 1:
        raise ValueError(f"'images' must list at most {MOST_FRAMES + 1} paths, got {len(images)}.")
    turns = stored.get("conversations")
    if not isinstance(turns, list) or [_part(turn, "from") for turn in turns] != ["human", "gpt"]:
        raise ValueError("'conversations' must hold one question (human) and one answer (gpt).")
    user_text, answered = (_part(turn, "value") for turn in turns)
    if user_text.count(IMAGE) not in (0, len(images)):
        raise ValueError(
            f"the question has {user_text.count(IMAGE)} times {IMAGE} for {len(images)} images."
        )
    before, after = around
    text = user_text.replace(IMAGE, "").strip()
    fits = len(text) >= len(before) + len(after)
    if not (fits and text.startswith(before) and text.endswith(after)):
        raise ValueError(
            f"the question does not fit agent.task. Set agent.task to the text of the questions, "
            f"with {{instruction}}. The question is {json.dumps(user_text)[:300]}"
        )
    instruction = text[len(before) : len(text) - len(after)].strip()
    if len(instruction) > MOST_TEXT:
        raise ValueError(f"the instruction must have at most {MOST_TEXT:,} characters.")
    instruction.encode()  # UnicodeEncodeError is a ValueError
    answer = read_answer(answered, agent.answers)
    if answer is None:
        allowed = ", ".join(one.text for one in agent.answers)
        raise ValueError(f"the answer {short(answered)} must be one of {allowed} (agent.answers).")
    files = tuple(_inside(folder, image) for image in images)
    name = str(stored.get("episode_id", stored.get("id", "")))[:200]
    return Entry(name, instruction, files, agent.answers.index(answer))


def _part(turn: Any, name: str) -> str:
    value = turn.get(name) if isinstance(turn, dict) else None
    return value if isinstance(value, str) else ""


def _inside(folder: Path, image: str) -> Path:
    """Return the path of an image; raise ValueError if it is not below ``folder``."""
    path = Path(image)
    too_long = any(len(os.fsencode(part)) > 255 for part in path.parts)
    if path.is_absolute() or ".." in path.parts or "\0" in image or too_long:
        raise ValueError(f"the image {short(image)} must be a path below the folder.")
    return folder / path


def _read(file: Path) -> np.ndarray:
    """Return an image, uint8 [H, W, 3]."""
    try:
        frame = frame_files.read(file, 1.0)
    except frame_files.LeftOutError as error:
        raise ValueError(f"The image {file} {error}.") from error
    if frame.dtype != np.uint8:
        raise ValueError(f"The image {file} must be 8-bit RGB, got depth.")
    return frame
