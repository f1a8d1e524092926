"""Milliseconds of every corruption: steady state, per-frame mode, first frame, and the peers'."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from statistics import fmean

import cv2
import numpy as np

from mitigate.corruptions import NAMES, Key, corrupt
from mitigate.corruptions.registry import record, unseen_names
from tools.bench.peers import peers
from tools.bench.timing import fresh, steady
from tools.pages.gallery import rendered_frame

SEVERITY = 0.6  # the paper's for R2R
SEED = 7  # of the apartment rendered and of the keys
SIZES = {"480x640": (1, 480, 640), "224x224": (1, 224, 224), "12x64x64": (12, 64, 64)}
NONE = (None, None)
PANORAMA, PANORAMA_BAR = (12, 224, 224), 4.2  # the worst pair: low_light_noise, then multipath
EPISODES = 4  # in which the steady state is measured, each by itself; their mean counts
TINY = 4  # pixels: what a call on such a frame costs does not depend on the frame


@dataclass(frozen=True)
class Cost:
    """Milliseconds of one corruption at one size.

    ``steady``: the frames of an episode; ``per_frame``: each frame starts an episode, as in the
    per-frame regime; ``first``: a new severity as well, whose tables are then built; ``call``: the
    steady state of a frame of 4 x 4 pixels; ``copy``: a plain copy of the frame; ``peers``: by
    library; ``bar``: of its record, None where it has none.
    """

    steady: float
    per_frame: float
    first: float
    call: float
    copy: float
    peers: dict[str, float]
    bar: float | None

    @property
    def best_peer(self) -> tuple[str, float] | None:
        """The fastest library and its milliseconds."""
        return min(self.peers.items(), key=lambda item: item[1]) if self.peers else None

    @property
    def over(self) -> bool:
        """Whether the steady state misses the bar."""
        return self.bar is not None and self.steady > self.bar


def frames(views: int, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """RGB uint8 [V, H, W, 3] and depth float32 metres [V, H, W] from a rendered panorama."""
    rgb, depth = rendered_frame(SEED, min(height, width))
    size = width, height
    rgb = np.stack([cv2.resize(view, size) for view in rgb[:views]])
    nearest = cv2.INTER_NEAREST
    return rgb, np.stack([cv2.resize(view, size, interpolation=nearest) for view in depth[:views]])


def measure(seconds: float) -> dict[str, dict[str, Cost]]:
    """Costs by size, then by corruption (of the unseen ones at the last size alone); about
    ``seconds`` for each of several hundred clocks."""
    costs: dict[str, dict[str, Cost]] = {}
    for column, (label, shape) in enumerate(SIZES.items()):
        rgb, depth = frames(*shape)
        names = NAMES if column < 2 else (*NAMES, *unseen_names("rgb", "depth"))
        others: dict[str, dict[str, float]] = {name: {} for name in names}
        for library, calls in peers(rgb, depth, SEVERITY).items():
            for name, call in calls.items():
                others[name][library] = steady(partial(_unnumbered, call), seconds)
        costs[label] = {
            name: cost(
                name,
                rgb if record(name).modality == "rgb" else depth,
                seconds,
                others[name],
                (record(name).bars or NONE)[column] if column < 2 else None,
            )
            for name in names
        }
    return costs


def _unnumbered(call: Callable[[], object], _: int) -> object:
    return call()


def cost(
    name: str, frame: np.ndarray, seconds: float, others: dict[str, float], bar: float | None
) -> Cost:
    """Our side of one corruption, on the clock, beside the times of ``others``."""
    tiny = np.ascontiguousarray(frame[:, :TINY, :TINY])
    heading = 0.3 if len(frame) > 1 else None  # a single view always has the flare in it

    def episode(i, seen=frame, number=0):
        key = Key(SEED, f"bench {number}", i)
        return corrupt(seen, name, SEVERITY, key=key, heading=heading)

    episodes = [
        steady(partial(episode, number=number), seconds / EPISODES) for number in range(EPISODES)
    ]

    def new_episode(i):
        return corrupt(frame, name, SEVERITY, key=Key(SEED, f"episode {i}"), heading=heading)

    def new_severity(i):
        severity = math.nextafter(SEVERITY, 1.0) + 1e-7 * i
        return corrupt(frame, name, severity, key=Key(SEED, f"first {i}"), heading=heading)

    return Cost(
        fmean(episodes),
        fresh(new_episode, seconds),
        fresh(new_severity, seconds),
        steady(lambda i: episode(i, tiny), seconds),
        steady(lambda _: frame.copy(), seconds),
        others,
        bar,
    )


def worst_pair(seconds: float) -> float:
    """Milliseconds for low light with noise and multipath on one panorama, 12 x 224 x 224."""
    rgb, depth = frames(*PANORAMA)

    def both(i):
        key = Key(SEED, "bench", i)
        return (
            corrupt(rgb, "low_light_noise", SEVERITY, key=key),
            corrupt(depth, "multipath", SEVERITY, key=key),
        )

    return steady(both, seconds)
