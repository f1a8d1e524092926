"""Imitate an expert on new rollouts and on stored rollouts of earlier steps (DAgger).

Running episodes takes more time than learning from them. Therefore the current policy runs episodes
only every few steps, and their rollouts are stored on disk. Each step learns from a random sample
of all stored rollouts. The stored rollouts are an aggregated data set that grows during training,
as in Ross et al. 2011. During training, the fraction of decisions that follow the expert falls. The
loss is defined in ``recipes/imitate.py``. The rollouts of the agent must be plain data, such as
tensors, lists and text.
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
from mitigate.training.rollouts import Rollouts, batch_of
from mitigate.training.success import reject_success_distributed


class Dagger(Imitate):
    """Imitate the expert on new rollouts and on stored rollouts.

    The rollouts of a step depend only on the weights at that step, and they are stored before they
    are used. Therefore a resumed run samples the same rollouts.

    Args:
        agent: the agent, which is trained in place.
        rollouts: source of rollouts, used every ``every`` steps. Its ``follow_oracle`` is the final
            fraction of decisions that follow the expert; the fraction falls from 1 during the first
            60 % of ``steps``.
        folder: folder of the stored rollouts, with one file per job.
        steps: number of training steps.
        train_parts: same as in ``Imitate``.
        every: number of steps between two rounds of rollouts.
        walks: number of rollouts per step, both new and stored.
        losses: same as in ``Imitate``.

    Raises:
        ValueError: If the rollouts of the agent are not plain data, or if the schedule samples
            corruptions by success rate, which needs a trained agent.
    """

    sources: ClassVar[Mapping[str, Callable[..., Any]]] = {
        "rollouts": partial(Rollouts, episodes=18, follow_oracle=0.25)
    }

    @classmethod
    def misfit(cls, agent: Any) -> str:
        if as_agent(agent).plain_walks:
            return super().misfit(agent)
        return (
            "its rollouts are not plain data and cannot be stored. Choose recipe=imitation, or "
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
        reject_success_distributed(rollouts.schedule)
        super().__init__(agent, rollouts, train_parts, losses)
        self.folder = Path(folder)
        self.steps = steps
        self.least = rollouts.follow_oracle
        self.every = every
        self.walks = walks

    def jobs(self, step: int) -> list[tuple]:
        """Return the jobs of ``Rollouts``, or an empty list in steps without new rollouts.

        Each job is a pair (job of ``Rollouts``, fraction of decisions that follow the expert).
        """
        if step % self.every:
            return []
        expert_share = falling_share(step, self.steps, self.least)
        return [(job, expert_share) for job in super().jobs(step)]

    def pieces(self) -> int:
        """Return 1, which requires a single process, because rollouts are stored per process."""
        return 1

    def work(self, job: tuple) -> Any:
        rollout_job, expert_share = job
        self.rollouts.follow_oracle = expert_share
        return self.rollouts.work(rollout_job)

    def batch(self, step: int) -> dict[str, Any]:
        return super().batch(step) if step % self.every == 0 else self.collate(step, [])

    def collate(self, step: int, pieces: list[Any]) -> dict[str, Any]:
        for number, (piece, _) in enumerate(pieces):
            self._store(step, number, piece)
        size = -(-self.rollouts.episodes // self.rollouts.pieces)  # number of rollouts per job
        stored = self._stored(step, -(-self.walks // size) - len(pieces))
        return batch_of(self.rollouts.collate([*pieces, *((piece, None) for piece in stored)]))

    def _stored(self, step: int, count: int) -> list[Any]:
        """Return ``count`` randomly chosen groups of stored rollouts from earlier steps."""
        pieces = range(self.rollouts.pieces)
        known = [(s, n) for s in range(0, step, self.every) for n in pieces]
        rng = generator(self.rollouts.seed, "kept walks", step)
        count = max(0, min(count, len(known)))
        chosen: Iterable[int] = rng.choice(len(known), count, replace=False) if count else []
        return [_read(self._file(*known[i])) for i in chosen]

    def _file(self, step: int, number: int) -> Path:
        return self.folder / f"{step:06d}-{number}.pt"

    def _store(self, step: int, number: int, piece: Any) -> None:
        """Store the rollouts of one job, with floating-point tensors as float16."""
        if other := _not_plain(piece):
            raise ValueError(
                f"{type(self.rollouts.agent).__name__}.collect must return plain data (dicts, "
                f"lists, texts, numbers and torch tensors), got {other}. Files of rollouts cannot "
                "store other objects. Return plain data, or choose recipe=imitation."
            )
        buffer = io.BytesIO()
        torch.save(_floats(piece, torch.float16), buffer)
        write_bytes(self._file(step, number), buffer.getvalue())


def _read(file: Path) -> Any:
    """Read a file of stored rollouts. Raise ValueError if it is missing or damaged."""
    try:
        return _floats(torch.load(file, weights_only=True), torch.float32)
    except Exception as error:  # reading a damaged file may raise any kind of error
        raise ValueError(
            f"The stored rollout {file} is missing or damaged. DAgger cannot resume without its "
            "stored rollouts. Restore the file if you have a copy, or delete the folder of the run "
            "to start again."
        ) from error


def _not_plain(data: Any, place: str = "the result") -> str:
    """Describe the first part of ``data`` that is not plain data; return "" if there is none."""
    if isinstance(data, dict) and all(isinstance(name, str) for name in data):
        parts = [_not_plain(value, f"{place}[{name!r}]") for name, value in data.items()]
    elif isinstance(data, list):
        parts = [_not_plain(value, f"{place}[{number}]") for number, value in enumerate(data)]
    elif isinstance(data, str | int | float | torch.Tensor):
        return ""
    else:
        return f"{type(data).__name__} in {place}"
    return next(filter(None, parts), "")


def _floats(data: Any, dtype: torch.dtype) -> Any:
    """Convert the floating-point tensors in ``data`` to ``dtype``."""
    if isinstance(data, torch.Tensor):
        return data.to(dtype) if data.is_floating_point() else data
    if isinstance(data, dict):
        return {name: _floats(value, dtype) for name, value in data.items()}
    return data
