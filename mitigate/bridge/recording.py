"""Record an agent's episodes: clean frames, instructions, poses, actions and metrics.

A recording has one folder ``<scene>/<episode>/`` per episode. This folder contains one file
``<camera>/000000.png`` per camera and call (RGB, or depth as 16-bit millimetres), ``cameras.json``,
``episode.json``, ``steps.jsonl`` (one line per call) and ``end.json``. ``mitigate corrupt``,
``mitigate replay`` and ``recipe=encoder`` (env=frames) read such recordings.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import cv2
import numpy as np

from mitigate.bridge.cameras import Camera, Rig
from mitigate.bridge.condition import Observer
from mitigate.core import output
from mitigate.core.files import RECORDING, draft_path, make_folder, write_bytes, write_json
from mitigate.core.locks import delete_abandoned
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.output import open_output
from mitigate.corruptions.frame_files import counts
from mitigate.evaluation.rows import stem_of

CAMERAS = "cameras.json"
# maximum length of a name in a path, in characters (heuristic); a file name may have 255 bytes
MAX_NAME = 150
UNIT = 0.001  # metres per unit of the 16-bit depth values
_NOT_ALLOWED = re.compile(r"[^A-Za-z0-9._-]+")


def path_part(name: str) -> str:
    """Convert ``name`` to a path component that cannot leave its folder."""
    return _NOT_ALLOWED.sub("-", name).lstrip(".") or "unnamed"


def unique_part(name: str) -> str:
    """Return a unique path component, with a hash if ``name`` had to be changed."""
    part = path_part(name)[:MAX_NAME]
    if part == name or not name:
        return part
    return f"{part}-{hashlib.sha256(name.encode('utf-8', 'replace')).hexdigest()[:8]}"


def _episode_folder(scene: str, episode: str) -> str:
    return f"{unique_part(stem_of(scene))}/{unique_part(episode)}"


@dataclass
class Recorder(Observer):
    """Observer that writes frames, poses and results to ``folder``, the folder of the condition.

    An episode is first written to a temporary folder (``draft``). When the episode ends, this
    folder replaces any earlier recording of the episode (``target``). During an episode,
    ``output_root`` is used to check that no other process replaces the folder.
    """

    folder: Path
    output_root: output.Root | None = None
    draft: Path | None = None
    target: Path | None = None
    cameras: dict[str, Any] = field(default_factory=dict)
    kinds: ClassVar[tuple[str, ...]] = (RGB, DEPTH)

    def episode(self, message: Mapping[str, Any]) -> None:
        """Create the temporary folder of an episode."""
        target = self.folder / _episode_folder(str(message["scene"]), str(message["id"]))
        self.leave()
        self.output_root = output.register(make_folder(self.folder.parent))
        draft = draft_path(target)
        output.make_checked(draft)
        self.draft, self.target, self.cameras = draft, target, {}
        header = {"unit": UNIT, "depth": "16-bit PNG", "frames": "clean"}
        write_json(self.folder / RECORDING, header)
        fields = ("scene", "id", "text", "tokens", "language", "category")
        episode = {name: message.get(name) for name in fields}
        write_json(self.draft / "episode.json", episode)
        write_bytes(self.draft / "steps.jsonl", b"")

    def frame(
        self, message: Mapping[str, Any], rig: Rig, memory: Any, offsets: Mapping[str, int]
    ) -> None:
        """Write the clean frames of a call and the agent's pose."""
        if self.draft is None:
            return
        cameras = {unique_part(name): camera for name, camera in rig.describe().items()}
        if not cameras.keys() <= self.cameras.keys():
            self.cameras = cameras | self.cameras
            write_json(self.draft / CAMERAS, self.cameras)
        for camera in rig.cameras:
            frame = camera.read(memory, offsets)
            file_name = f"{int(message['call']):06d}.png"
            write_bytes(self.draft / unique_part(camera.name) / file_name, png(camera, frame))
        line = {name: message.get(name) for name in ("call", "position", "heading")}
        with open_output(self.draft / "steps.jsonl", "a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")

    def end(self, message: Mapping[str, Any]) -> None:
        """Write the result of the episode and move its folder to the final place."""
        if self.draft is not None and self.target is not None:
            result = {name: value for name, value in message.items() if name != "kind"}
            write_json(self.draft / "end.json", result)
            # an earlier run left this folder, or this run has recorded the same episode before
            output.delete_folder(self.target)
            output.forget(self.draft)
            os.replace(self.draft, self.target)
        self._close()

    def leave(self) -> None:
        """Delete the files of an episode that did not end."""
        if self.draft is not None:
            # ignore a folder that was replaced and no longer belongs to this run
            with suppress(output.UnsafePathError, output.FolderLostError):
                output.delete_folder(self.draft)
        self._close()

    def _close(self) -> None:
        self.draft = self.target = None
        if self.output_root is not None:
            output.unregister(self.output_root)
            self.output_root = None


def delete_drafts(folder: Path) -> None:
    """Delete unfinished episodes in the recording of a condition.

    An unfinished episode is deleted if the process that was recording it has ended.

    Args:
        folder: The folder of the recording.

    Raises:
        UnsafePathError: If ``folder``, or a scene or an episode in it, is a symbolic link, a FIFO
            or a device. In this case, nothing is deleted.
    """
    with output.output_folder(folder.parent):
        output.check(folder / RECORDING)
        for path in [*folder.glob("*"), *folder.glob("*/*")]:
            if not path.is_file():
                output.check(path / RECORDING)
        delete_abandoned(folder.glob("*/.*.tmp"))


def is_whole(folder: Path, ends: Iterable[Mapping[str, Any]]) -> bool:
    """Return whether the recording ``folder`` contains all episodes in ``ends``."""
    folders = (folder / _episode_folder(end["scene"], end["episode"]) for end in ends)
    return all((episode / "end.json").is_file() for episode in folders)


def png(camera: Camera, frame: np.ndarray) -> bytes:
    """Encode a frame as PNG: either RGB, or depth in millimetres with 0 for missing depth."""
    if camera.kind == RGB:
        picture = frame[..., ::-1]
    else:
        metres = camera.metres(frame.reshape(frame.shape[:2]).astype(np.float32))
        picture = counts(metres, UNIT)
    done, encoded = cv2.imencode(".png", picture, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    if not done:
        raise ValueError(f"The frame of the camera {camera.name!r} cannot be written as PNG.")
    return encoded.tobytes()
