"""A gymnasium wrapper that corrupts RGB, depth and dictionary observations.

Needs the extra ``gymnasium``.
"""

from __future__ import annotations

import secrets
from collections.abc import Mapping
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
from mitigate.corruptions import Corruption, DepthSensor, FrameStream, Key, Schedule
from mitigate.corruptions.normalised import check_sensor
from mitigate.corruptions.schedule import drawn, names_of
from mitigate.worlds.modalities import ENTRY_FIX, check_available

FORMATS = "uint8 [(V,) H, W, 3] for RGB, or float32 [H, W] or [(V,) H, W, 1] for depth"


class CorruptObservation(gymnasium.ObservationWrapper, gymnasium.utils.RecordConstructorArgs):
    """Corrupt the frames of an environment with the corruptions that a schedule selects.

    Random numbers depend only on the seed, the episode and the frame number.

    The observation is an RGB frame (``Box`` uint8 [H, W, 3] or [V, H, W, 3]), a depth frame
    (``Box`` float32 [H, W], [H, W, 1] or [V, H, W, 1]), or a ``Dict`` that contains one or both.
    The wrapper changes only the content of frames. Spaces, dtypes, other entries and their order
    stay the same. Apply this wrapper before frames are stacked, transposed or converted to float.
    In a vector environment, wrap each environment separately.

    Episodes are named by the seed of ``reset(seed=n)`` and the number of resets since then: "n-0",
    "n-1", ... ``frame`` is the number of steps since the reset. The corruption of a frame depends
    only on (schedule, seed, reset seed, resets, steps). Under a temporal fault, it also depends on
    earlier frames of the episode. If the first reset has no seed, the names contain a random part,
    so that the environments of a vector environment get different corruptions. If an environment
    resets itself, as with ``gymnasium.wrappers.Autoreset``, the step after the end of an episode is
    treated as the reset.

    Args:
        env: The environment.
        schedule: A schedule that selects the corruption of each frame, or one corruption for all
            frames.
        seed: Corruption seed.
        rgb: Name of the RGB entry if the observation is a ``Dict``.
        depth: Name of the depth entry if the observation is a ``Dict``.
        pose: Name of a float entry of shape [3] with x, y and heading (radians, counter-clockwise).
            With a pose, a lens flare keeps its direction in the world when the agent turns. None
            means that there is no pose.
        sensor: Depth range, and the value that marks missing depth.
        normalised: Whether depth is normalised to [0, 1] over the range of the sensor. If false,
            depth is in metres.
        hfov: Horizontal field of view of the cameras in degrees. Camera faults require it.

    Attributes:
        corruption: Corruption of the last frame.
        key: Random key of the last frame.

    Raises:
        ValueError: If the observation space has no frames of these formats, or lacks the modality
            of a corruption in the schedule. If the bounds of depth frames are smaller than the
            range of the depth sensor.
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
        hfov: float | None = None,
    ) -> None:
        gymnasium.utils.RecordConstructorArgs.__init__(
            self,
            schedule=schedule,
            seed=seed,
            rgb=rgb,
            depth=depth,
            pose=pose,
            sensor=sensor,
            normalised=normalised,
            hfov=hfov,
        )
        super().__init__(env)
        self.schedule, self.seed = schedule, seed
        self.sensor = sensor or DepthSensor()
        self.corruption: Corruption | None = None
        self.key: Key | None = None
        self._source = ""
        self._resets = self._frame = 0
        self._over = False
        degrees = dict.fromkeys((RGB, DEPTH), hfov)
        self._stream = FrameStream(self.sensor, normalised=normalised, hfov=degrees)
        self._entries = {RGB: rgb, DEPTH: depth, **({} if pose is None else {POSE: pose})}
        # modality of the observation if it is a single frame
        self._whole = _modality(env.observation_space)
        if self._whole is not None:
            self._entries = {self._whole: self._whole}
        self._check(env.observation_space, normalised)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start the next episode. A new seed restarts the count of episodes."""
        if seed is not None:
            self._source = str(seed)
            self._resets = 0
        elif not self._source:
            self._source = f"unseeded-{secrets.token_hex(4)}"
        self._begin()
        return super().reset(seed=seed, options=options)

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Step the environment and corrupt the observation.

        The step after the end of an episode counts as a reset, because the environment then resets
        itself.

        Raises:
            gymnasium.error.ResetNeeded: If ``reset`` was never called.
        """
        observation, reward, terminated, truncated, info = self.env.step(action)
        if self._resets == 0:
            raise gymnasium.error.ResetNeeded(
                "Call reset() before step(): it names the episode, which determines the random "
                "numbers."
            )
        self._frame += 1
        if self._over:
            self._begin()
        self._over = bool(terminated or truncated)
        return self.observation(observation), reward, terminated, truncated, info

    def _begin(self) -> None:
        self._episode = f"{self._source}-{self._resets}"
        self._resets += 1
        self._frame = 0
        self._over = False

    def observation(self, observation: Any) -> Any:
        """Return a corrupted copy of the observation."""
        self.corruption, self.key = drawn(self.schedule, self.seed, self._episode, self._frame)
        parts = observation if self._whole is None else {self._whole: observation}
        frames = {name: parts[entry] for name, entry in self._entries.items() if entry in parts}
        corrupted = self._stream.corrupt(frames, self.corruption, self.key)
        if self._whole is not None:
            return corrupted[self._whole]
        return {**observation, **{self._entries[name]: frame for name, frame in corrupted.items()}}

    def _check(self, space: gymnasium.Space, normalised: bool) -> None:
        spaces: Mapping[Any, Any] = {self._whole: space}
        if isinstance(space, gymnasium.spaces.Dict):
            spaces = space.spaces
        boxes = {name: spaces[entry] for name, entry in self._entries.items() if entry in spaces}
        if POSE in self._entries and POSE not in boxes:
            raise ValueError(
                f"pose must be an entry of the observation ({', '.join(spaces)}), got "
                f"{self._entries[POSE]!r}. Name the entry with x, y and heading, or pass "
                "pose=None, which keeps a lens flare at its place in the image."
            )
        boxes.pop(POSE, None)
        if not boxes or any(_modality(box) != name for name, box in boxes.items()):
            raise ValueError(
                f"The observation must be a Box of {FORMATS}, or a Dict with such entries, got "
                f"{space}. Name the entries with rgb= and depth= if they are not "
                f"{self._entries.get(RGB)!r} and {self._entries.get(DEPTH)!r}, and wrap before "
                "frames are transposed, stacked or converted to float."
            )
        names = names_of(self.schedule)
        check_available(names, boxes, "the environment has no {0}", ENTRY_FIX)
        if DEPTH in boxes:
            self._check_range(boxes[DEPTH], normalised)

    def _check_range(self, box: gymnasium.spaces.Box, normalised: bool) -> None:
        check_sensor(self.sensor)
        high = float(np.max(box.high))
        largest = max(self.sensor.z_max, self.sensor.missing)
        if normalised and high > 1.0:
            raise ValueError(
                f"The depth space must end at 1 if normalised=True, got {high:g}. For depth in "
                "metres, leave normalised out."
            )
        if not normalised and largest > high:
            raise ValueError(
                f"{self.sensor} writes depth up to {largest:g} metres, but the depth space ends at "
                f"{high:g}. Pass sensor=DepthSensor(z_max={high:g}), or normalised=True if depth "
                "is in 0-1."
            )


def _modality(space: gymnasium.Space) -> str | None:
    """Return the modality of the frames in a space. Return None if the space has another format."""
    if not isinstance(space, gymnasium.spaces.Box):
        return None
    *_, channels = space.shape if len(space.shape) in (3, 4) else (0,)
    if space.dtype == np.uint8 and channels == 3:
        return RGB
    is_depth = channels == 1 or len(space.shape) == 2
    return DEPTH if space.dtype == np.float32 and is_depth else None
