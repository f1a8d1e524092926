"""Which frame is corrupted by what: clean, per frame, per episode, success-distributed."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any

from mitigate.corruptions.keying import Key, digest, uniform
from mitigate.corruptions.registry import broad_name, modality
from mitigate.corruptions.suite import (
    CLEAN,
    NAMES,
    Corruption,
    check_corruption,
    check_name,
    check_severity,
)

MODES = ("clean", "per_frame", "per_episode", "success_distributed")
Severity = float | Sequence[float]  # one, or the ends of a range


@dataclass
class Schedule:
    """Draws the corruption and the key of a frame.

    * ``clean``: nothing is corrupted.
    * ``per_frame``: corruption and random state are drawn anew for every frame (transient).
    * ``per_episode``: one corruption and one episode state for the whole episode (persistent).
    * ``success_distributed``: per episode, corruption k with p_k proportional to
      (1 - SR_k)^alpha + floor, where SR_k is its success rate in a prior evaluation.

    Args:
        mode: one of MODES.
        severity: s in [0, 1] of RGB corruptions, and of depth ones unless
            ``severity_depth`` is given (the paper also trains at 0.9 / 0.8). Either may be a range
            (low, high), from which each frame (per frame) or episode draws its own, uniformly.
        clean_share: share of frames (per frame) or episodes that stay clean, in [0, 1].
        names: the corruptions to draw from.
        broad_share: share of the draws that are not clean, in [0, 1], in which a random composition
            (``broad``) of the drawn corruption's modality takes its place.
        alpha, floor: of the success-distributed weights; both >= 0, floor > 0 keeps all alive.
        success: SR_k in [0, 1] by name; None means uniform weights until ``refresh``.

    Raises ValueError for anything outside these ranges.
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
                f"There is no schedule mode {self.mode!r}. Allowed modes: {', '.join(MODES)}."
            )
        self.severity = _checked(self.severity)
        if self.severity_depth is not None:
            self.severity_depth = _checked(self.severity_depth)
        if isinstance(self.names, str):
            raise ValueError(
                f"names is a list of corruptions, such as [{self.names!r}], but it is the text "
                f"{self.names!r}."
            )
        self.names = tuple(
            check_name(name) for name in (NAMES if self.names is None else self.names)
        )
        if not self.names or len(set(self.names)) < len(self.names):
            raise ValueError(
                f"A schedule needs at least one corruption and each only once, but names = "
                f"{self.names}. Leave it out to draw from all of {', '.join(NAMES)}."
            )
        shares = {"clean_share": self.clean_share, "broad_share": self.broad_share}
        for name, share in shares.items():
            if not 0.0 <= share <= 1.0:
                raise ValueError(f"{name} must be in [0, 1], but it is {share!r}.")
        if self.mode == "clean" and self.broad_share > 0.0:
            raise ValueError(
                "The mode clean corrupts nothing, so there is nothing that broad_share = "
                f"{self.broad_share!r} could be of: choose another mode (in a config: "
                "schedule=per_episode), or leave it out."
            )
        if not (0.0 <= self.alpha < math.inf and 0.0 <= self.floor < math.inf):
            raise ValueError(
                f"alpha and floor must be finite and >= 0, but alpha = {self.alpha!r} and floor = "
                f"{self.floor!r}."
            )
        success, self.success = self.success, None
        self._weights = [1.0 / len(self.names)] * len(self.names)
        if success is not None:
            self.refresh(success)

    @classmethod
    def always(cls, name: str, severity: float) -> Schedule:
        """The corruption ``name`` at ``severity`` in every frame of every episode, as evaluated."""
        return cls("per_episode", severity, clean_share=0.0, names=(name,))

    @property
    def weights(self) -> dict[str, float]:
        """Probability of each corruption given that the frame is not clean; adds up to 1."""
        return dict(zip(self.names, self._weights, strict=True))

    def only(self, modality_: str) -> Schedule:
        """The same, drawing corruptions of one modality alone. ValueError if it has none."""
        names = tuple(name for name in self.names if modality(name) == modality_)
        if not names:
            raise ValueError(f"The schedule draws no {modality_} corruption: names={self.names}.")
        return replace(self, names=names)

    def refresh(self, success: dict[str, float]) -> None:
        """Recompute the weights from success rates by name ("clean" and others are ignored).

        A name that is absent keeps its last rate. Raises ValueError if it never had one, or if a
        rate is outside [0, 1]. Other modes than success_distributed keep uniform weights.
        """
        known = {**(self.success or {}), **success}
        missing = [name for name in self.names if name not in known]
        if missing:
            raise ValueError(
                f"No success rate for {', '.join(missing)}. Evaluate these corruptions first, or "
                "leave them out of the schedule's names."
            )
        rates = {name: float(known[name]) for name in self.names}
        wrong = {name: rate for name, rate in rates.items() if not 0.0 <= rate <= 1.0}
        if wrong:
            raise ValueError(f"Success rates are shares in [0, 1], but got {wrong}.")
        self.success = rates
        if self.mode == "success_distributed":
            raw = [(1.0 - rate) ** self.alpha + self.floor for rate in rates.values()]
            total = sum(raw)
            self._weights = [w / total if total > 0 else 1.0 / len(raw) for w in raw]

    def draw(self, seed: int, episode: str, frame: int) -> tuple[Corruption, Key]:
        """The corruption and key of one frame: a function of the arguments and the weights."""
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
            name = broad_name(modality(name))
        return self.corruption(name, uniform(value, 2)), key

    def corruption(self, name: str, place: float = 0.5) -> Corruption:
        """The corruption ``name`` at this schedule's severity for its modality; of a range, at
        ``place`` between its ends (0 to 1, the middle unless told)."""
        depth = modality(name) == "depth" and self.severity_depth is not None
        severity: Any = self.severity_depth if depth else self.severity
        low, high = severity if isinstance(severity, tuple) else (severity, severity)
        return Corruption(name, low + place * (high - low))

    def state_dict(self) -> dict:
        """JSON-able: what a checkpoint keeps so that the weights survive a resume."""
        return {"success": None if self.success is None else dict(self.success)}

    def load_state_dict(self, state: dict) -> None:
        """Restore ``state_dict()``; ValueError if it lacks a corruption of this schedule."""
        if "success" not in state:
            raise ValueError(
                f"This is not the state of a Schedule: it has no 'success' entry, only "
                f"{sorted(state)}. Pass what state_dict() returned."
            )
        self.success = None
        self._weights = [1.0 / len(self.names)] * len(self.names)
        if state["success"] is not None:
            self.refresh(state["success"])


def drawn(by: Corruption | Schedule, seed: int, episode: str, frame: int) -> tuple[Corruption, Key]:
    """What ``by`` does to one frame, and the key: a corruption meets every frame.

    Raises ValueError if ``by`` is neither.
    """
    if isinstance(by, Schedule):
        return by.draw(seed, episode, frame)
    return check_corruption(by), Key(seed, str(episode), frame)


def names_of(by: Corruption | Schedule) -> tuple[str, ...]:
    """The corruptions that ``by`` may do, none if all is clean. ValueError if it is neither."""
    if isinstance(by, Schedule):
        return () if by.mode == "clean" else by.names
    return tuple(part.name for part in check_corruption(by).parts)


def _checked(severity: Severity) -> float | tuple[float, float]:
    if isinstance(severity, str) or not isinstance(severity, Sequence):
        return check_severity(severity)
    ends = tuple(map(check_severity, severity))
    if len(ends) != 2 or ends[0] > ends[1]:
        raise ValueError(
            f"A range of severities is [low, high] with low <= high, but got {list(severity)}. "
            "Write, for instance, schedule.severity=[0.3,1.0]."
        )
    return ends[0], ends[1]
