"""Schedules, which sample the corruption of each training frame."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any

from mitigate.corruptions.keying import Key, digest, uniform
from mitigate.corruptions.registry import modality
from mitigate.corruptions.suite import (
    CLEAN,
    NAMES,
    Corruption,
    check_corruption,
    check_name,
    check_severity,
)

MODES = ("clean", "per_frame", "per_episode", "success_distributed")
Severity = float | Sequence[float]  # a number, or the lower and upper limit of a range


@dataclass
class Schedule:
    """A schedule samples the corruption and the key of each frame.

    The modes are:

    - ``clean``: nothing is corrupted.
    - ``per_frame``: each frame gets its own corruption and random numbers (transient faults).
    - ``per_episode``: each episode gets its own corruption and random numbers (persistent faults).
    - ``success_distributed``: each episode gets one corruption. The probability of corruption k is
      proportional to (1 - SR_k)^alpha + floor, where SR_k is the success rate under k in an earlier
      evaluation.

    Args:
        mode: One of MODES.
        severity: Severity in [0, 1] of RGB corruptions, and of depth corruptions unless
            ``severity_depth`` is set (the paper also trains with 0.9 and 0.8). Either value may be
            a range (low, high), from which a severity is sampled uniformly per frame or episode.
        severity_depth: Severity of depth corruptions; None means ``severity``.
        clean_share: Fraction of frames (``per_frame``) or episodes that stay clean, in [0, 1].
        names: Corruptions to choose from.
        broad_share: Fraction in [0, 1] of the corrupted frames or episodes that get a random
            composition (``broad``) of the same modality instead of the sampled corruption.
        alpha: Exponent (>= 0) in the weights of ``success_distributed``.
        floor: Term (>= 0) that is added to the weights; if it is above 0, every corruption can be
            sampled.
        success: Success rate in [0, 1] of each corruption, by name. If None, weights are uniform
            until ``refresh`` is called.

    Raises:
        ValueError: If an argument is out of range.
    """

    mode: str
    severity: Severity
    severity_depth: Severity | None = None
    clean_share: float = 0.25
    names: tuple[str, ...] = NAMES
    broad_share: float = 0.0
    alpha: float = 1.0
    floor: float = 0.05
    success: dict[str, float] | None = None

    def __post_init__(self) -> None:
        if self.mode not in MODES:
            raise ValueError(
                f"The schedule mode must be one of {', '.join(MODES)}, got {self.mode!r}."
            )
        self.severity = _checked(self.severity)
        if self.severity_depth is not None:
            self.severity_depth = _checked(self.severity_depth)
        if isinstance(self.names, str):
            raise ValueError(
                f"names must be a list of corruptions, such as [{self.names!r}], got the text "
                f"{self.names!r}."
            )
        self.names = tuple(
            check_name(name) for name in (NAMES if self.names is None else self.names)
        )
        if not self.names or len(set(self.names)) < len(self.names):
            raise ValueError(
                "names must contain at least one corruption, and each only once, got "
                f"{self.names}. Leave out names to sample from all of {', '.join(NAMES)}."
            )
        shares = {"clean_share": self.clean_share, "broad_share": self.broad_share}
        for name, share in shares.items():
            if not 0.0 <= share <= 1.0:
                raise ValueError(f"{name} must be in [0, 1], got {share!r}.")
        if self.mode == "clean" and self.broad_share > 0.0:
            raise ValueError(
                f"broad_share must be 0 in the mode clean, which corrupts nothing, got "
                f"{self.broad_share!r}. Choose another mode (in a config: schedule=per_episode), "
                "or leave out broad_share."
            )
        if not (0.0 <= self.alpha < math.inf and 0.0 <= self.floor < math.inf):
            raise ValueError(
                f"alpha and floor must be finite and >= 0, got alpha = {self.alpha!r} and floor = "
                f"{self.floor!r}."
            )
        self.load_state_dict({"success": self.success})

    @classmethod
    def always(cls, name: str, severity: float) -> Schedule:
        """Return a schedule that applies one corruption to every frame, as in evaluation."""
        return cls("per_episode", severity, clean_share=0.0, names=(name,))

    @property
    def weights(self) -> dict[str, float]:
        """The probability of each corruption for a frame that is not clean; the sum is 1."""
        return dict(zip(self.names, self._weights, strict=True))

    def only(self, modality_: str) -> Schedule:
        """Return a copy of the schedule with only the corruptions of one modality.

        Raises:
            ValueError: If the schedule has no corruption of the modality.
        """
        names = tuple(name for name in self.names if modality(name) == modality_)
        if not names:
            raise ValueError(
                f"names of the schedule must contain a {modality_} corruption, got {self.names}."
            )
        return replace(self, names=names)

    def refresh(self, success: dict[str, float]) -> None:
        """Recompute the weights from success rates by name.

        Names that are not in the schedule are ignored. A corruption without a new rate keeps its
        last rate. Only ``success_distributed`` uses the rates; the other modes keep uniform
        weights.

        Raises:
            ValueError: If a corruption of the schedule has no rate, or a rate is outside [0, 1].
        """
        known = {**(self.success or {}), **success}
        missing = [name for name in self.names if name not in known]
        if missing:
            raise ValueError(
                f"Every corruption needs a success rate; {', '.join(missing)} have none. Evaluate "
                "these corruptions first, or leave them out of the schedule's names."
            )
        rates = {name: float(known[name]) for name in self.names}
        invalid = {name: rate for name, rate in rates.items() if not 0.0 <= rate <= 1.0}
        if invalid:
            raise ValueError(f"Success rates must be shares in [0, 1], got {invalid}.")
        self.success = rates
        if self.mode == "success_distributed":
            raw = [(1.0 - rate) ** self.alpha + self.floor for rate in rates.values()]
            total = sum(raw)
            self._weights = [w / total if total > 0 else 1.0 / len(raw) for w in raw]

    def draw(self, seed: int, episode: str, frame: int) -> tuple[Corruption, Key]:
        """Sample the corruption and the key of a frame.

        Both depend only on the arguments and the weights.
        """
        episode = str(episode)
        if self.mode == "clean":
            return CLEAN, Key(seed, episode, frame)
        if self.mode == "per_frame":
            episode = f"{episode}#{frame}"
        key = Key(seed, episode, frame)
        value = digest(key, "schedule")
        if uniform(value, 0) < self.clean_share:
            return CLEAN, key
        place = bisect_right(list(accumulate(self._weights)), uniform(value, 1))
        name = self.names[min(place, len(self.names) - 1)]
        if uniform(value, 3) < self.broad_share:
            name = f"broad_{modality(name)}"
        return self.corruption(name, uniform(value, 2)), key

    def corruption(self, name: str, place: float = 0.5) -> Corruption:
        """Return a corruption with the severity that this schedule has for its modality.

        Args:
            name: Name of the corruption.
            place: Position in the range of severities, from 0 (low) to 1 (high).
        """
        depth = modality(name) == "depth" and self.severity_depth is not None
        severity: Any = self.severity_depth if depth else self.severity
        low, high = severity if isinstance(severity, tuple) else (severity, severity)
        return Corruption(name, low + place * (high - low))

    def state_dict(self) -> dict:
        """Return the state as JSON data for a checkpoint.

        A resumed run that loads it has the same weights.
        """
        return {"success": None if self.success is None else dict(self.success)}

    def load_state_dict(self, state: dict) -> None:
        """Restore the result of ``state_dict()``.

        Raises:
            ValueError: If the state has no entry "success" or lacks a corruption of this schedule.
        """
        if "success" not in state:
            raise ValueError(
                f"The state of a Schedule must have the entry 'success', got only the entries "
                f"{sorted(state)}. Pass the result of state_dict()."
            )
        self.success = None
        self._weights = [1.0 / len(self.names)] * len(self.names)
        if state["success"] is not None:
            self.refresh(state["success"])


def drawn(by: Corruption | Schedule, seed: int, episode: str, frame: int) -> tuple[Corruption, Key]:
    """Return the corruption and the key of a frame.

    If ``by`` is a Corruption, it applies to every frame.

    Raises:
        ValueError: If ``by`` is neither a Corruption nor a Schedule.
    """
    if isinstance(by, Schedule):
        return by.draw(seed, episode, frame)
    return check_corruption(by), Key(seed, str(episode), frame)


def names_of(by: Corruption | Schedule) -> tuple[str, ...]:
    """Return the names of the corruptions that ``by`` may apply; () if all frames stay clean.

    Raises:
        ValueError: If ``by`` is neither a Corruption nor a Schedule.
    """
    if isinstance(by, Schedule):
        return () if by.mode == "clean" else by.names
    return tuple(part.name for part in check_corruption(by).parts)


def _checked(severity: Severity) -> float | tuple[float, float]:
    if isinstance(severity, str) or not isinstance(severity, Sequence):
        return check_severity(severity)
    ends = tuple(map(check_severity, severity))
    if len(ends) != 2 or ends[0] > ends[1]:
        raise ValueError(
            f"A range of severities must be [low, high] with low <= high, got {list(severity)}. "
            "An example is schedule.severity=[0.3,1.0]."
        )
    return ends[0], ends[1]
