"""Writes what an agent saw, heard and did: clean frames, poses, actions and measures as files.

A recording is a folder ``<scene>/<episode>/`` for each episode, with ``<camera>/000000.png`` for
each call (RGB, or depth as 16-bit millimetres), ``cameras.json``, ``episode.json``,
``steps.jsonl`` (a line a call) and ``end.json``. ``mitigate corrupt``, ``mitigate replay`` and
``recipe=encoder`` (env=frames) read it.
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
from mitigate.core.files import RECORDING, atomic_text, make_folder, write_bytes
from mitigate.core.locks import delete_abandoned
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.output import open_output
from mitigate.corruptions.frame_files import counts
from mitigate.evaluation.rows import stem_of

CAMERAS = "cameras.json"
LONGEST = 150  # characters of a name that are kept in a path (ours; a file name has 255 bytes)
UNIT = 0.001  # metres of a count of 16-bit depth
_PLAIN = re.compile(r"[^A-Za-z0-9._-]+")


def plain(name: str) -> str:
    """Return ``name`` as a part of a path: what comes from outside names no other folder."""
    return _PLAIN.sub("-", name).lstrip(".") or "unnamed"


def part(name: str) -> str:
    """Return ``name`` as a part of a path that no other name has: plain, and if it is changed by
    that, with a hash behind it."""
    made = plain(name)[:LONGEST]
    if made == name or not name:
        return made
    return f"{made}-{hashlib.sha256(name.encode('utf-8', 'replace')).hexdigest()[:8]}"


@dataclass
class Recorder(Observer):
    """Writes what passes into ``folder``; of an episode that comes again the one that ended last
    stays: until its end it lies in a folder beside."""

    folder: Path
    root: Path | None = None  # the folder that the user named, if it is one above
    watched: output.Root | None = None  # during an episode, in the process that writes it
    here: Path | None = None
    place: Path | None = None  # where it is put at its end
    cameras: dict[str, Any] = field(default_factory=dict)  # of the episode
    kinds: ClassVar[tuple[str, ...]] = (RGB, DEPTH)

    def episode(self, told: Mapping[str, Any]) -> None:
        """Begin the folder of an episode."""
        place = self.folder / part(stem_of(str(told["scene"]))) / part(str(told["id"]))
        self.leave()
        self.watched = output.register(make_folder(self.root or self.folder))
        here = place.with_name(f".{place.name}.{os.getpid()}.tmp")
        output.delete_folder(here)
        output.make_checked(here)
        self.here, self.place, self.cameras = here, place, {}
        note = {"unit": UNIT, "depth": "16-bit PNG", "frames": "clean"}
        with atomic_text(self.folder / RECORDING) as file:
            json.dump(note, file)
        said = ("scene", "id", "text", "tokens", "language", "category")
        with atomic_text(self.here / "episode.json") as file:
            json.dump({name: told.get(name) for name in said}, file)
        write_bytes(self.here / "steps.jsonl", b"")

    def frame(
        self, told: Mapping[str, Any], rig: Rig, memory: Any, offsets: Mapping[str, int]
    ) -> None:
        """Write the clean frames of a call, and where the agent was."""
        if self.here is None:
            return
        seen = {part(name): camera for name, camera in rig.told().items()}
        if not seen.keys() <= self.cameras.keys():
            self.cameras = seen | self.cameras
            with atomic_text(self.here / CAMERAS) as file:
                json.dump(self.cameras, file)
        for camera in rig.cameras:
            frame = camera.read(memory, offsets)
            write_bytes(
                self.here / part(camera.name) / f"{int(told['call']):06d}.png", png(camera, frame)
            )
        line = {name: told.get(name) for name in ("call", "position", "heading")}
        with open_output(self.here / "steps.jsonl", "a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")

    def end(self, told: Mapping[str, Any]) -> None:
        """Write how the episode went, and put it in its place."""
        if self.here is not None and self.place is not None:
            said = {name: value for name, value in told.items() if name != "kind"}
            with atomic_text(self.here / "end.json") as file:
                json.dump(said, file)
            output.delete_folder(self.place)  # of an earlier run, or a loop's second
            output.forget(self.here)
            os.replace(self.here, self.place)
        self._close()

    def leave(self) -> None:
        """Delete what there is of an episode that did not end."""
        if self.here is not None:
            with suppress(output.UnsafePathError, output.FolderLostError):  # not ours any more
                output.delete_folder(self.here)
        self._close()

    def _close(self) -> None:
        self.here = self.place = None
        if self.watched is not None:
            output.unregister(self.watched)
            self.watched = None


def delete_drafts(folder: Path) -> None:
    """Delete what processes that are no more left in the recording ``folder`` of a condition.

    Raises UnsafePathError, before anything is deleted, if ``folder``, a scene or an episode in it
    is a link to a folder, a FIFO or a device.
    """
    with output.output_folder(folder.parent):
        output.check(folder / RECORDING)
        for path in [*folder.glob("*"), *folder.glob("*/*")]:
            if not path.is_file():
                output.check(path / RECORDING)
        delete_abandoned(folder.glob("*/.*.tmp"))


def is_whole(folder: Path, ends: Iterable[Mapping[str, Any]]) -> bool:
    """Whether ``folder`` is a recording that holds all episodes that ended as ``ends`` tell."""
    places = [folder / part(stem_of(e["scene"])) / part(e["episode"]) for e in ends]
    return all((place / "end.json").is_file() for place in places)


def png(camera: Camera, frame: np.ndarray) -> bytes:
    """Return a frame as a PNG file: RGB, or depth in millimetres, 0 where there is none."""
    if camera.kind == RGB:
        picture = frame[..., ::-1]
    else:
        metres = camera.metres(frame.reshape(frame.shape[:2]).astype(np.float32))
        picture = counts(metres, UNIT)
    done, encoded = cv2.imencode(".png", picture, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    if not done:
        raise ValueError(f"The frame of the camera {camera.name!r} cannot be written as PNG.")
    return encoded.tobytes()
