"""DAgger: imitation on fresh walks and on walks kept from earlier steps.

Walking and looking cost more than learning. So some episodes are walked every few steps with the
current policy and kept on disk, and each step learns from walks drawn from all that were kept (Ross
et al. 2011 aggregate so; here the data grow all the time). The oracle's share of the decisions
falls over the training. For agents whose walks are plain data (tensors, lists, text); otherwise as
``recipes/imitate.py``, whose loss it uses.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import torch

from mitigate.agents.agent import as_agent
from mitigate.core.files import write_bytes
from mitigate.core.seeding import generator
from mitigate.recipes.imitate import Imitate, falling_share
from mitigate.training import success
from mitigate.training.rollouts import Rollouts, batch_of


class Dagger(Imitate):
    """Imitate the expert on fresh rollouts and on rollouts kept on disk.

    The rollouts of a step depend on its weights alone and are written before they are learned from,
    so a resumed run draws the same ones.

    Args:
        agent: trained in place.
        rollouts: run every ``every`` steps. ``follow_oracle`` is the expert's share of decisions
            at the end: it falls from 1 over the first 0.6 of ``steps``.
        folder: of the kept rollouts, one file per piece.
        steps: of the training.
        train_parts: as ``Imitate``.
        every: steps between two rollouts.
        walks: rollouts that a step learns from, fresh and kept ones.
        losses: as ``Imitate``.

    Raises:
        ValueError: for an agent whose rollouts are not plain data, and for a schedule by success,
            which an untrained agent does not have.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {
        "rollouts": partial(Rollouts, episodes=18, follow_oracle=0.25)
    }

    @classmethod
    def misfit(cls, agent: Any) -> str:
        if as_agent(agent).plain_walks:
            return super().misfit(agent)
        return (
            "its walks are no plain data, so none can be kept. Choose recipe=imitation, or "
            "recipe=base if it stores features."
        )

    def __init__(
        self,
        agent: Any,
        rollouts: Rollouts,
        folder: str,
        steps: int,
        train_parts: Sequence[str] | str | None = None,
        every: int = 6,
        walks: int = 24,
        losses: Mapping[str, float] | None = None,
    ) -> None:
        success.refuse(rollouts.schedule)
        super().__init__(agent, rollouts, train_parts, losses)
        self.folder = Path(folder)
        self.steps = steps
        self.least = rollouts.follow_oracle
        self.every = every
        self.walks = walks

    def jobs(self, step: int) -> list[tuple]:
        """As ``Rollouts.jobs``, each with the oracle's share; none where nothing is walked."""
        if step % self.every:
            return []
        expert, jobs = falling_share(step, self.steps, self.least), super().jobs(step)
        return [(*job, expert) for job in jobs]

    def pieces(self) -> int:
        """1: a step learns from walks that its own process has kept."""
        return 1

    def work(self, job: tuple) -> Any:
        *own, self.rollouts.follow_oracle = job
        return self.rollouts.work(tuple(own))

    def batch(self, step: int) -> dict[str, Any]:
        return super().batch(step) if step % self.every == 0 else self.collate(step, [])

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        for number, (piece, _) in enumerate(pieces):
            self._keep(step, number, piece)
        size = -(-self.rollouts.episodes // self.rollouts.pieces)  # walks of a piece
        again = self._drawn(step, -(-self.walks // size) - len(pieces))
        return batch_of(self.rollouts.collate([*pieces, *((piece, None) for piece in again)]))

    def _drawn(self, step: int, count: int) -> list[Any]:
        """Kept pieces, drawn from those of earlier steps."""
        pieces = range(self.rollouts.pieces)
        known = [(s, n) for s in range(0, step, self.every) for n in pieces]
        rng = generator(self.rollouts.seed, "kept walks", step)
        count = max(0, min(count, len(known)))
        chosen: Iterable[int] = rng.choice(len(known), count, replace=False) if count else []
        return [_read(self._file(*known[i])) for i in chosen]

    def _file(self, step: int, number: int) -> Path:
        return self.folder / f"{step:06d}-{number}.pt"

    def _keep(self, step: int, number: int, piece: Any) -> None:
        """Write a piece; floating tensors are kept as float16."""
        if not _is_plain(piece):
            raise ValueError(
                f"{type(self.rollouts.agent).__name__}.collect gives a {type(piece).__name__}, and "
                "kept walks are read as data alone: make it of dicts, lists, texts, numbers and "
                "tensors, as RecurrentAgent does, or train by recipes/imitate.py."
            )
        written = io.BytesIO()
        torch.save(_floats(piece, torch.float16), written)
        write_bytes(self._file(step, number), written.getvalue())


def _read(file: Path) -> Any:
    """A kept piece. Raises ValueError if it is gone or damaged: nothing can make it again."""
    try:
        return _floats(torch.load(file, weights_only=True), torch.float32)
    except Exception as error:  # of any kind, where the file is damaged
        raise ValueError(
            f"The kept walk {file} is missing or damaged. A training by DAgger learns from walks "
            "that it kept, and cannot go on without them: copy them back, or delete the run's "
            "folder to begin anew."
        ) from error


def _is_plain(data: Any) -> bool:
    if isinstance(data, dict):
        return all(isinstance(n, str) and _is_plain(value) for n, value in data.items())
    if isinstance(data, list):
        return all(map(_is_plain, data))
    return isinstance(data, str | int | float | torch.Tensor)


def _floats(data: Any, dtype: torch.dtype) -> Any:
    """``data`` with its floating tensors in ``dtype``."""
    if isinstance(data, torch.Tensor):
        return data.to(dtype) if data.is_floating_point() else data
    if isinstance(data, dict):
        return {name: _floats(value, dtype) for name, value in data.items()}
    return data
