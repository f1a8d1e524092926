"""Corruptions inside gymnasium: a wrapper for RGB, depth and dictionary observations.

Needs the extra ``gymnasium``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

try:
    import gymnasium
except ImportError as error:
    raise ImportError(
        "The gymnasium wrapper needs gymnasium, which is not installed: "
        "pip install -e '.[gymnasium]', or pip install gymnasium."
    ) from error

from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.corruptions import (
    Corruption,
    DepthSensor,
    Key,
    Schedule,
    corrupt_normalised,
    corrupt_observation,
)
from mitigate.corruptions.normalised import check_sensor
from mitigate.corruptions.registry import modality
from mitigate.corruptions.schedule import drawn, names_of


class CorruptObservation(gymnasium.ObservationWrapper):
    """Corrupts the frames of an environment as a schedule says, by (seed, episode, frame).

    The observation is an RGB frame (``Box`` uint8 [H, W, 3] or [V, H, W, 3]), a depth frame
    (``Box`` float32 [H, W], [H, W, 1] or [V, H, W, 1]), or a ``Dict`` that holds one or both.
    Spaces, dtypes, order and all other entries stay as they are. Wrap before frames are stacked,
    transposed or made float, and wrap each environment of a vector environment by itself.

    Episodes are named by the seed of ``reset(seed=n)`` and the resets since then: "n-0", "n-1",
    ...; "unseeded-0" and so on before the first seed. ``frame`` counts the steps from the reset. So
    the pixels are a function of (schedule, seed, reset seed, resets, steps) and of nothing else. An
    environment that resets itself, as inside ``gymnasium.wrappers.Autoreset``, has a reset in the
    step that follows the end of an episode.

    Args:
        env: the environment.
        schedule: which frame meets what, or the corruption that all meet.
        seed: of every random draw of the corruptions.
        rgb, depth: names of the two entries of a ``Dict``.
        pose: name of an entry float [3] = (x, y, heading in radians, counter-clockwise), by which a
            flare stays at its place in the world; None if there is none.
        sensor: depth range and sentinel.
        normalised: depth is in [0, 1] over the sensor's range instead of in metres.

    ``corruption`` and ``key`` are those of the last frame. Raises ValueError if the space holds no
    such frames, if the schedule draws what the space does not hold, or if the sensor's range and
    the space's bounds disagree.
    """

    def __init__(
        self,
        env: gymnasium.Env,
        schedule: Schedule | Corruption,
        seed: int = 0,
        *,
        rgb: str = RGB,
        depth: str = DEPTH,
        pose: str | None = None,
        sensor: DepthSensor | None = None,
        normalised: bool = False,
    ) -> None:
        super().__init__(env)
        self.schedule, self.seed = schedule, seed
        self.sensor = sensor or DepthSensor()
        self.corruption: Corruption | None = None
        self.key: Key | None = None
        self._source, self._resets, self._frame, self._over = "unseeded", 0, 0, False
        self._corrupt = corrupt_normalised if normalised else corrupt_observation
        space = env.observation_space
        self._whole = _modality(space) if isinstance(space, gymnasium.spaces.Box) else None
        self._entries = {RGB: rgb, DEPTH: depth, **({} if pose is None else {POSE: pose})}
        self._check(space, normalised)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin the next episode; a seed begins the count of episodes anew."""
        if seed is not None:
            self._source, self._resets = str(seed), 0
        self._begin()
        return super().reset(seed=seed, options=options)

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Step the environment; the observation is that of the next frame.

        After the end of an episode it is the first of the next one: the environment reset itself.
        Raises gymnasium's ResetNeeded before the first reset.
        """
        observation, reward, terminated, truncated, info = self.env.step(action)
        if self._resets == 0:
            raise gymnasium.error.ResetNeeded(
                "Call reset() before step(): every random draw is keyed by the episode it begins."
            )
        if self._over:
            self._begin()
        else:
            self._frame += 1
        self._over = bool(terminated or truncated)
        return self.observation(observation), reward, terminated, truncated, info

    def _begin(self) -> None:
        self._episode = f"{self._source}-{self._resets}"
        self._resets += 1
        self._frame, self._over = 0, False

    def observation(self, observation: Any) -> Any:
        """The corrupted observation of the current frame; the given one is not modified."""
        self.corruption, self.key = drawn(self.schedule, self.seed, self._episode, self._frame)
        if self._whole is not None:
            frames = {self._whole: observation}
            return self._corrupt(frames, self.corruption, self.key, self.sensor)[self._whole]
        frames = {
            name: observation[entry]
            for name, entry in self._entries.items()
            if entry in observation
        }
        corrupted = self._corrupt(frames, self.corruption, self.key, self.sensor)
        return {
            **observation,
            **{
                entry: corrupted[name] for name, entry in self._entries.items() if name in corrupted
            },
        }

    def _check(self, space: gymnasium.Space, normalised: bool) -> None:
        if self._whole is not None:
            found: dict[str, Any] = {self._whole: space}
        elif isinstance(space, gymnasium.spaces.Dict):
            found = {
                name: space[self._entries[name]]
                for name in (RGB, DEPTH)
                if self._entries[name] in space.spaces
            }
            for name, box in found.items():
                if not isinstance(box, gymnasium.spaces.Box) or _modality(box) != name:
                    raise ValueError(_explain(name, self._entries[name], box))
            if POSE in self._entries and self._entries[POSE] not in space.spaces:
                raise ValueError(
                    f"pose={self._entries[POSE]!r} is no entry of the observation (it has "
                    f"{', '.join(space.spaces)}). Name the one that holds x, y and heading, or "
                    "pass pose=None: the flare then keeps its place in the picture."
                )
        else:
            found = {}
        if not found:
            raise ValueError(
                f"The observation space {space} holds no frames: it must be a Box of uint8 "
                "[H, W, 3] RGB or of float32 depth, or a Dict with such entries. Name them "
                f"with rgb= and depth= if they are not called {self._entries[RGB]!r} and "
                f"{self._entries[DEPTH]!r}, and wrap before frames are transposed or made float."
            )
        for name in names_of(self.schedule):
            if modality(name) not in found:
                raise ValueError(
                    f"The schedule draws {name!r}, which corrupts {modality(name)}, but the "
                    f"environment gives only {', '.join(found)}. Give the schedule names of "
                    f"{', '.join(found)} corruptions, such as names=mitigate.corruptions."
                    f"{'RGB' if RGB in found else 'DEPTH'}."
                )
        if DEPTH in found:
            self._check_range(found[DEPTH], normalised)

    def _check_range(self, box: gymnasium.spaces.Box, normalised: bool) -> None:
        check_sensor(self.sensor)
        most, written = float(np.max(box.high)), max(self.sensor.z_max, self.sensor.missing)
        if normalised and most > 1.0:
            raise ValueError(
                f"The depth space reaches {most:g}, but normalised depth ends at 1. Leave "
                "normalised out for depth in metres."
            )
        if not normalised and written > most:
            raise ValueError(
                f"{self.sensor} writes depth up to {written:g} metres, but the depth space ends at "
                f"{most:g}. Pass sensor=DepthSensor(z_max={most:g}), or normalised=True if depth "
                "is in 0-1."
            )


def _modality(box: gymnasium.spaces.Box) -> str | None:
    if box.dtype == np.uint8 and len(box.shape) in (3, 4) and box.shape[-1] == 3:
        return RGB
    if box.dtype == np.float32 and (
        len(box.shape) == 2 or (len(box.shape) in (3, 4) and box.shape[-1] == 1)
    ):
        return DEPTH
    return None


def _explain(name: str, entry: str, box: gymnasium.Space) -> str:
    wanted = "uint8 [H, W, 3] or [V, H, W, 3]"
    if name == DEPTH:
        wanted = "float32 [H, W], [H, W, 1] or [V, H, W, 1] in metres or normalised"
    return (
        f"The entry {entry!r} must be a Box of {wanted}, but it is {box}. Wrap before frames are "
        "transposed, stacked or made float."
    )
