"""Define action spaces, which describe the actions that a world accepts.

The classes correspond to spaces of gymnasium, which :func:`from_gymnasium` converts. gymnasium
itself is not needed, and random actions depend only on a key.
"""

from __future__ import annotations

import operator
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np


class ActionSpace:
    """Base class of action spaces."""

    def check(self, action: Any) -> Any:
        """Check ``action`` and convert it to the format that the world accepts.

        Raises:
            ValueError: If the action is not in the space.
        """
        raise NotImplementedError

    def sample(self, rng: np.random.Generator) -> Any:
        """Return a random action, which is uniform over the bounded dimensions of the space."""
        raise NotImplementedError


@dataclass(frozen=True)
class Discrete(ActionSpace):
    """An integer from ``start`` to ``start + n - 1``."""

    n: int
    start: int = 0

    def check(self, action: Any) -> int:
        last = self.start + self.n - 1
        with suppress(TypeError):
            number = operator.index(_scalar(action))
            if self.start <= number <= last:
                return number
        raise ValueError(f"The action must be {self.start} to {last}, got {_text(action)}.")

    def sample(self, rng: np.random.Generator) -> int:
        return self.start + int(rng.integers(self.n))


@dataclass(frozen=True, eq=False)
class Box(ActionSpace):
    """An array of real numbers between ``low`` and ``high``, with the same shape and dtype."""

    low: np.ndarray
    high: np.ndarray

    def check(self, action: Any) -> np.ndarray:
        values = _array(action, self.low.shape, "real numbers")
        if not np.issubdtype(values.dtype, np.number) or not np.isfinite(values).all():
            raise ValueError(f"The action must be finite real numbers, got {_text(action)}.")
        values = values.astype(self.low.dtype)
        if (values < self.low).any() or (values > self.high).any():
            raise ValueError(
                f"The action must be between {_text(self.low)} and {_text(self.high)}, got "
                f"{_text(action)}. Clip it in the policy."
            )
        return values

    def sample(self, rng: np.random.Generator) -> np.ndarray:
        # unbounded dimensions are sampled from the standard normal distribution, as in gymnasium
        bounded = np.isfinite(self.low) & np.isfinite(self.high)
        low, high = (np.where(bounded, end, 0.0) for end in (self.low, self.high))
        values = np.where(bounded, rng.uniform(low, high), rng.standard_normal(self.low.shape))
        return np.clip(values, self.low, self.high).astype(self.low.dtype)


@dataclass(frozen=True, eq=False)
class MultiDiscrete(ActionSpace):
    """An array of integers.

    Each integer is at least 0 and less than the entry of ``counts`` at its position.
    """

    counts: np.ndarray

    def check(self, action: Any) -> np.ndarray:
        values = _array(action, self.counts.shape, "whole numbers")
        if not np.issubdtype(values.dtype, np.integer):
            raise ValueError(f"The action must be an array of whole numbers, got {_text(action)}.")
        if (values < 0).any() or (values >= self.counts).any():
            raise ValueError(
                "The action must be an array of whole numbers of at least 0 and less than "
                f"{_text(self.counts)}, got {_text(action)}."
            )
        return values.astype(np.int64)

    def sample(self, rng: np.random.Generator) -> np.ndarray:
        return rng.integers(self.counts)


@dataclass(frozen=True)
class Composite(ActionSpace):
    """A dictionary with one action for each entry of ``spaces``."""

    spaces: Mapping[str, ActionSpace]

    def check(self, action: Any) -> dict[str, Any]:
        if not isinstance(action, Mapping) or set(action) != set(self.spaces):
            raise ValueError(
                f"The action must be a dictionary with {', '.join(self.spaces)}, got "
                f"{_text(action)}."
            )
        checked = {}
        for name, space in self.spaces.items():
            try:
                checked[name] = space.check(action[name])
            except ValueError as error:
                raise ValueError(f"Action {name!r}: {error}") from None
        return checked

    def sample(self, rng: np.random.Generator) -> dict[str, Any]:
        return {name: space.sample(rng) for name, space in self.spaces.items()}


def from_gymnasium(space: Any) -> ActionSpace:
    """Return the action space that corresponds to ``space`` of gymnasium or gym.

    Raises:
        ValueError: If the kind of space is not supported, for example text or a graph.
    """
    kind = type(space).__name__
    if kind == "Discrete":
        # spaces of gym before 0.22 have no start
        return Discrete(int(space.n), int(getattr(space, "start", 0)))
    if kind == "Box":
        return Box(np.asarray(space.low), np.asarray(space.high))
    if kind == "MultiDiscrete":
        return MultiDiscrete(np.asarray(space.nvec))
    if kind == "MultiBinary":
        return MultiDiscrete(np.full(space.shape, 2))
    if kind == "Dict":
        return Composite({name: from_gymnasium(part) for name, part in space.spaces.items()})
    raise ValueError(
        "The action space must be Discrete, Box, MultiDiscrete, MultiBinary, or a Dict of these, "
        f"got {space}. Wrap the environment in a gymnasium.ActionWrapper with "
        "such a space; its method action() must convert each action."
    )


def _scalar(action: Any) -> Any:
    """Return ``action``, or its element if it is an array or tensor of shape () or (1,)."""
    return action.item() if getattr(action, "shape", None) in ((), (1,)) else action


def _array(action: Any, shape: tuple[int, ...], content: str) -> np.ndarray:
    """Return ``action`` as an array; raise ValueError unless it has ``shape``."""
    try:
        values = np.asarray(action)
    except (ValueError, TypeError):
        values = np.empty(0)
    if values.shape != shape:
        raise ValueError(
            f"The action must be an array of {content} of shape {list(shape)}, got {_text(action)}."
        )
    return values


def _text(value: Any) -> str:
    return " ".join(str(value).split())[:80] or type(value).__name__
