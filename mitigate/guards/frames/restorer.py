"""Define the restorer, a guard that estimates clean frames independently of the agent."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import nn

from mitigate.core.checkpoint import weights_sha
from mitigate.core.checksums import DIGITS
from mitigate.core.files import find
from mitigate.core.observation import DEPTH, RGB, Z_MAX
from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.suite import depth_views, rgb_views
from mitigate.guards.frames import folder as folders
from mitigate.guards.frames.choices import SENSORS
from mitigate.guards.frames.sensor import SensorRestorer
from mitigate.guards.guard import RESTORER, Guard


class Restorer(nn.Module, Guard):
    """Restores corrupted frames with one network per sensor.

    Args:
        sensors: "rgb", "depth" or both.
        width: number of channels of the finest feature maps of the RGB network.
        depth_width: number of channels of the finest feature maps of the depth network.
        size: shorter side in pixels of the frames that the networks process.
        far: maximum depth in metres.

    Raises:
        ValueError: If a sensor is unknown, or a size is out of range.
    """

    def __init__(
        self,
        sensors: Sequence[str] = SENSORS,
        width: int = 16,
        depth_width: int = 16,
        size: int = 64,
        far: float = Z_MAX,
    ) -> None:
        super().__init__()
        self._settings: dict[str, Any] = {
            "sensors": list(sensors),
            "width": width,
            "depth_width": depth_width,
            "size": size,
            "far": float(far),
        }
        if problem := folders.problem(self._settings):
            raise ValueError(f"agent.{problem}.")
        widths = {RGB: width, DEPTH: depth_width}
        self.nets = nn.ModuleDict({s: SensorRestorer(s, widths[s], size, far) for s in sensors})

    @property
    def encoders(self) -> dict[str, tuple[str, ...]]:
        """The networks that read each sensor, declared as in an agent (``training/plan.py``)."""
        return {sensor: (sensor,) for sensor in self.nets}

    def parts(self) -> dict[str, SensorRestorer]:
        """The networks by sensor."""
        return dict(self.nets.items())  # type: ignore[arg-type]

    def settings(self) -> dict[str, Any]:
        """Return the constructor arguments."""
        return dict(self._settings)

    def only(self, sensor: str) -> Restorer:
        """Remove the networks of all other sensors in place, and return self.

        Raises ValueError for a sensor that this restorer does not support.
        """
        if sensor not in self.nets:
            raise ValueError(
                f"This restorer is for {', '.join(self.nets)}, not for {sensor}. Remove "
                f":{sensor} from restore=."
            )
        self.nets = nn.ModuleDict({sensor: self.nets[sensor]})
        self._settings["sensors"] = [sensor]
        return self

    @property
    def hash(self) -> str:
        """The first 12 hex digits of a hash of the weights, thresholds and settings."""
        text = json.dumps([weights_sha(self), self.settings()], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]

    @property
    def frames(self) -> tuple[str, ...]:  # type: ignore[override]
        """The sensors that this restorer restores."""
        return tuple(self.nets)

    def fingerprint(self) -> str:
        """Return :attr:`hash` with the prefix that is used in rows."""
        return RESTORER + self.hash

    def observe(self, observation: Mapping[str, Any]) -> dict[str, Any]:
        """Return ``observation`` with those frames restored that the gate classifies as corrupted.

        Other entries, and frames that are classified as clean, are returned as the same objects.

        Raises:
            TypeError, ValueError: If a frame has the wrong dtype or shape.
        """
        restored = dict(observation)
        for sensor in self.nets:
            if sensor in restored:
                restored[sensor] = self.restore(sensor, restored[sensor])
        return restored

    forward = observe

    def restore(self, sensor: str, frame: np.ndarray) -> np.ndarray:
        """Return the restored frame as a new array of the same shape and dtype.

        The frame itself is returned if the gate classifies it as clean, or if it is depth outside
        the range of the training data (:meth:`SensorRestorer.knows`).

        Args:
            sensor: "rgb" or "depth".
            frame: the frames of one time step. RGB is uint8 with shape [H, W, 3] or [V, H, W, 3].
                Depth is in metres, floating point with shape [H, W], [H, W, 1] or [V, H, W, 1].

        Raises:
            KeyError: If the restorer has no network for ``sensor``.
            TypeError, ValueError: If ``frame`` has the wrong type, dtype or shape, or if its depth
                is not in metres.
        """
        net, views = self._net(sensor), self._views(sensor, frame)
        changed, result = net.judged(torch.from_numpy(views))
        return result.numpy().reshape(frame.shape).astype(frame.dtype) if changed else frame

    def doubt(self, sensor: str, frame: np.ndarray) -> float:
        """Return the gate's logit for a frame minus the gate's threshold.

        If the value is above 0, :meth:`restore` restores the frame, unless this would change most
        depth pixels too much. The value is -inf for depth that has no valid pixels or too many
        pixels beyond ``far``.
        """
        return self._net(sensor).doubt(torch.from_numpy(self._views(sensor, frame)))

    def _net(self, sensor: str) -> SensorRestorer:
        if sensor not in self.nets:
            raise KeyError(f"This restorer is for {', '.join(self.nets)}, not for {sensor}.")
        return self.nets[sensor]  # type: ignore[return-value]

    def _views(self, sensor: str, frame: np.ndarray) -> np.ndarray:
        """Return ``frame`` as a contiguous, writable array [V, H, W, c].

        Raises TypeError or ValueError if the frame is invalid.
        """
        if not isinstance(frame, np.ndarray):
            raise TypeError(
                f"A {sensor} frame must be a numpy array, not {type(frame).__name__}: give a torch "
                "tensor as frame.numpy()."
            )
        if sensor == RGB:
            views = rgb_views(frame)
        else:
            if np.issubdtype(frame.dtype, np.floating):
                frame = frame.astype(np.float32, copy=False)
            range_ = DepthSensor(z_max=self._net(sensor).far)
            views = depth_views(frame, range_, "The restorer")[..., None]
        return np.require(views, requirements=["C", "W"])

    def save(self, folder: str | Path, *, half: bool = False) -> None:
        """Write a folder for :func:`load_restorer`; with ``half``, the weights are float16."""
        folders.write(self, folder, half=half)

    def load(self, folder: str | Path) -> None:
        """Load the weights that :meth:`save` wrote; raise ValueError if the settings differ."""
        folders.fill(self, folder)


def load_restorer(folder: str | Path) -> Restorer:
    """Load the restorer in ``folder`` in eval mode; it can be called with an observation.

    Raises:
        FileNotFoundError: If the folder contains no restorer.
        ValueError: If a file is damaged or differs from the card.
    """
    path = find(str(folder))
    restorer = Restorer(**folders.card(path)["settings"])
    restorer.load(path)
    return restorer.eval()
