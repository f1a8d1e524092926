"""Corrupt the frames of a folder and write them to a new folder.

Runs can be resumed, and files are written atomically.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from mitigate.core.files import sha256, write_bytes, write_json
from mitigate.core.json_files import LARGEST_LIST, read_object
from mitigate.core.names import escaped, short
from mitigate.core.observation import DEPTH, RGB, Z_MAX
from mitigate.core.output import is_regular, lost, output_folder
from mitigate.corruptions import frame_files
from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.faults.temporal import GATE
from mitigate.corruptions.frame_files import (
    MAX_COUNT,
    NO_READING,
    Frame,
    Plan,
    count_suffixes,
    make_plan,
)
from mitigate.corruptions.keying import Key
from mitigate.corruptions.record import CAMERA, TEMPORAL
from mitigate.corruptions.registry import family, fault_names, known, parts, version
from mitigate.corruptions.stream import FrameStream, shows_past
from mitigate.corruptions.suite import SUITE_VERSION, Corruption, check_gate, check_name

SUMMARY = "corrupt.json"
FIX = "Name another folder, or delete this one."
UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0}
EPISODES = ("folder", "all")
FORMATS = ("png", "same")


@dataclass(frozen=True)
class Settings:
    """Options for corrupting a folder; the constructor raises ValueError for an invalid value."""

    corruption: str
    severity: float
    seed: int = 0
    # "folder": each folder is an episode; "all": all frames are one episode
    episode: str = "folder"
    format: str = "png"  # output format of a corrupted JPEG: "png" or "same"
    # metres per count of a 16-bit PNG; None means mm, if a check finds this plausible
    unit: float | None = None
    z_max: float = Z_MAX  # maximum depth in metres; larger values are clipped
    missing: float = 0.0  # value of missing depth in metres
    no_reading: int = NO_READING  # pixel value of a 16-bit PNG that, like 0, means "no reading"
    hfov: float | None = None  # horizontal field of view in degrees, for camera faults

    def __post_init__(self) -> None:
        check_gate(Corruption(self.corruption, self.severity))
        if parts(self.corruption)[0] != GATE:
            of_frames = (*known("rgb", "depth"), *fault_names(TEMPORAL, CAMERA))
            check_name(self.corruption, ("clean", *of_frames))
        if self.corruption == "clean":
            raise ValueError("corruption=clean changes nothing. Copy the folder instead.")
        choices = (("episode", self.episode, EPISODES), ("format", self.format, FORMATS))
        for name, value, allowed in choices:
            if value not in allowed:
                raise ValueError(f"{name} must be one of {', '.join(allowed)}, got {value}.")
        if not 0.0 < self.metres_per_count < float("inf"):
            raise ValueError(
                "unit must be mm, cm, m or a positive number (metres per count of a 16-bit PNG, "
                f"such as 0.00025), got {self.unit}."
            )
        if not self.missing >= 0.0:
            raise ValueError(
                f"missing must be 0 (no reading) or a depth in metres, got {self.missing:g}."
            )
        if not 0 <= self.no_reading <= NO_READING:
            raise ValueError(
                f"no_reading must be between 0 and {NO_READING}, got {self.no_reading}."
            )
        DepthSensor(z_max=self.z_max)  # checks z_max
        if "camera_height" in parts(self.corruption):
            raise ValueError(
                "camera_height needs a world that renders frames again: "
                "recorded frames cannot show another height. Choose another corruption."
            )
        if family(self.corruption) == CAMERA and self.hfov is None:
            raise ValueError(
                f"{self.corruption} needs the horizontal field of view: hfov=DEGREES, such as "
                "hfov=90."
            )

    @property
    def metres_per_count(self) -> float:
        return UNITS["mm"] if self.unit is None else self.unit

    @property
    def sensor(self) -> DepthSensor:
        return DepthSensor(z_max=self.z_max, missing=self.missing)


def run(source: Path | str, out: Path | str, settings: Settings) -> dict:
    """Corrupt the frames in ``source`` and its subfolders, and write them to ``out``.

    The files in ``out`` are in the same subfolders as in ``source``.

    The frames of an episode are numbered in the natural order of their file names: "9" is before
    "10". A damaged file keeps its number. RGB and depth frames are numbered separately. A file
    that is already in ``out`` is not written again. A temporal fault repeats frames of earlier
    files of the episode.

    Returns:
        The summary with settings, counts and skipped files, which is also written to
        ``out/corrupt.json``.

    Raises:
        FileNotFoundError: If the folder does not exist or contains no frame.
        ValueError: If one folder contains the other, or ``out`` was written with different settings
            or frames, or by a different program.
        OSError: If ``out`` cannot be written.
    """
    source, out = Path(source), Path(out)
    check_folders(source, out)
    kinds = Corruption(settings.corruption, settings.severity).modalities
    plan = make_plan(source, out, kinds, settings.episode)
    if not plan.frames:
        raise FileNotFoundError(_no_frames(source, kinds, settings, plan))
    if any(frame.path.suffix.lower() == ".png" for frame in plan.frames) and DEPTH in kinds:
        _check_counts(settings)
    if DEPTH in kinds and settings.unit is None:
        frames = [source / frame.path for frame in plan.frames]
        frame_files.check_scale(frames, settings.metres_per_count, settings.z_max)
    with output_folder(out, SUMMARY):
        return _corrupt_all(source, out, settings, plan)


def _corrupt_all(source: Path, out: Path, settings: Settings, plan: Plan) -> dict:
    """Corrupt the frames of ``plan`` and return the summary."""
    summary = _begin(out, settings, plan)
    outputs = {frame.path: _output(frame.path, settings.format) for frame in plan.frames}
    names = set(outputs)
    stream = FrameStream(settings.sensor, hfov=dict.fromkeys((RGB, DEPTH), settings.hfov))
    try:
        for frame in tqdm(plan.frames, desc=settings.corruption, unit="frame", disable=None):
            name, target = frame.path.as_posix(), outputs[frame.path]
            if name in plan.left_out:
                continue
            if target != frame.path and target in names:
                plan.left_out[name] = f"would become {target.name}, which exists: use format=same"
            else:
                _corrupt_frame(source, out, target, frame, settings, plan, summary, stream)
            names.add(target)
    finally:  # a resumed run then does not compute these frames again
        write_summary(out, summary)
    for path, target in outputs.items():
        if path.as_posix() not in plan.left_out and not (out / target).is_file():
            raise lost(out / target)
    summary["left_out"] = [{"file": f, "reason": r} for f, r in sorted(plan.left_out.items())]
    write_summary(out, summary)
    return summary


def _corrupt_frame(
    source: Path,
    out: Path,
    target: Path,
    frame: Frame,
    settings: Settings,
    plan: Plan,
    summary: dict,
    stream: FrameStream,
) -> None:
    """Write a frame unless ``out`` already contains the same file, and record its checksum."""
    name = target.as_posix()
    checksums = summary["checksums"]
    files = (source / frame.path, out / target)
    exists = is_regular(out / target)
    corruption = Corruption(settings.corruption, settings.severity)
    is_known = exists and name in checksums and not shows_past(corruption)
    if is_known and checksums[name] == checksum(*files):
        summary["there"] += 1
        return
    key = Key(settings.seed, frame.episode, frame.number)

    def change(pixels: np.ndarray) -> np.ndarray:
        kind = RGB if pixels.dtype == np.uint8 else DEPTH
        return stream.corrupt({kind: pixels}, corruption, key)[kind]

    try:
        data = frame_files.corrupt_file(
            files[0], target.suffix, settings.metres_per_count, change, settings.no_reading
        )
    # catches LeftOutError, and errors for shapes that the suite does not support
    except ValueError as error:
        plan.left_out[frame.path.as_posix()] = str(error)
        checksums.pop(name, None)
        return
    if exists and files[1].stat().st_size == len(data) and files[1].read_bytes() == data:
        summary["there"] += 1
    else:
        write_bytes(files[1], data)
        summary["written"] += 1
        summary["replaced"] += [name] * exists
    checksums[name] = checksum(*files)


def checksum(*paths: Path) -> str:
    """Return one checksum for an input and an output file, or "" if one cannot be read."""
    try:
        return short_hash("".join(map(sha256, paths)))
    except OSError:
        return ""


def _output(path: Path, form: str) -> Path:
    """Return the output path for an input file."""
    jpeg = path.suffix.lower() in (".jpg", ".jpeg")
    return path.with_suffix(".png") if jpeg and form == "png" else path


# -------------------------------------------------------------------------- the output folder


def _begin(out: Path, settings: Settings, plan: Plan) -> dict:
    """Check that an earlier run in ``out`` had the same settings and episodes.

    Then write both to ``out``.
    """
    versions = {"suite_version": SUITE_VERSION, **version(settings.corruption)}
    settings_now = {**versions, **asdict(settings), "unit": settings.metres_per_count}
    earlier, episodes = earlier_summary(out, settings_now), plan.episodes()
    if earlier:
        _check_episodes(out, earlier, episodes)
    summary = {
        "settings": settings_now,
        "episodes": {
            name: {"frames": len(frames), "names": _digest(frames)}
            for name, frames in episodes.items()
        },
        "written": 0,
        "there": 0,
        "replaced": [],
        "other_modality": plan.other_modality,
        "other_files": plan.other_files,
        "left_out": [],
        "checksums": earlier.get("checksums", {}),
    }
    write_summary(out, summary)
    return summary


def earlier_summary(out: Path, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the summary of an earlier run in ``out``, or {} if the folder is empty.

    Raises ValueError if ``out`` has other files, or was written with different settings.
    """
    if all(path.name[0] == "." for path in out.iterdir()):
        return {}
    try:
        earlier = read_object(out / SUMMARY, FIX, LARGEST_LIST)
    except FileNotFoundError:
        raise ValueError(
            f"{out} must be empty or contain {SUMMARY}, which this program writes. {FIX}"
        ) from None
    before = earlier.get("settings")
    if not isinstance(before, dict) or not isinstance(earlier.get("checksums"), dict):
        raise ValueError(f"{out / SUMMARY} is damaged. {FIX}")
    different = [
        escaped(f"{name}={before.get(name)} there, {name}={settings.get(name)} now")
        for name in {**before, **settings}
        if before.get(name) != settings.get(name)
    ]
    if different:
        raise ValueError(f"{out} was made with other settings: {'; '.join(different)}. {FIX}")
    return earlier


def _check_episodes(out: Path, earlier: dict[str, Any], episodes: dict[str, list[str]]) -> None:
    """Raise ValueError if the numbers of the frames have changed since an earlier run."""
    try:
        recorded = [(n, int(e["frames"]), e["names"]) for n, e in earlier["episodes"].items()]
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"{out / SUMMARY} is damaged ({error!r:.100}). {FIX}") from error
    for name, count, digest in recorded:
        if _digest(episodes.get(name, [])[:count]) != digest:
            raise ValueError(
                f"{out} was made from other frames: among the first {count} frames of episode "
                f"{short(name, 200)}, files were added, removed or renamed, so frame numbers "
                f"changed. (Frames may be added at the end.) {FIX}"
            )


def _digest(names: list[str]) -> str:
    return short_hash("\n".join(names))


def short_hash(text: str) -> str:
    """Return a 64-bit hash of ``text`` as hex digits."""
    return blake2b(text.encode("utf-8", "surrogateescape"), digest_size=8).hexdigest()


def write_summary(out: Path, summary: dict) -> None:
    """Write ``corrupt.json``."""
    write_json(out / SUMMARY, summary, indent=1)


# -------------------------------------------------------------------------------- user errors


def check_folders(source: Path, out: Path) -> None:
    """Check that ``source`` exists and that neither folder contains the other one.

    Raises:
        FileNotFoundError: If there is no folder ``source``.
        ValueError: If ``out`` is a file, or one folder contains the other.
    """
    if not source.is_dir():
        if source.is_file():
            raise FileNotFoundError(
                f"{source} must be a folder, got a file. Put the file into a folder of its own."
            )
        raise FileNotFoundError(f"There is no folder {source}. Check the path.")
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out} is a file. Name a folder to write to.")
    real_source = source.resolve()
    real_out = out.resolve()
    if real_out.is_relative_to(real_source) or real_source.is_relative_to(real_out):
        raise ValueError(
            f"{out} and {source} must be different folders, and neither may contain the other: "
            "results would be read as frames, or overwrite them. Name another folder."
        )


def _no_frames(source: Path, kinds: Sequence[str], settings: Settings, plan: Plan) -> str:
    """Return the error message for a folder without frames of these modalities."""
    readable = {RGB: "8-bit RGB PNG or JPEG", DEPTH: "16-bit grey PNG or NPY (metres)"}
    modality = " or ".join(kinds)
    formats = " or ".join(readable[kind] for kind in kinds)
    other = ""
    if plan.other_modality:
        other += f"; {plan.other_modality} frames are of the other modality"
    if plan.other_files:
        other += f"; other files are not read: {count_suffixes(plan.other_files)}"
    return (
        f"There is no {modality} frame in {source}{other}. {settings.corruption} corrupts "
        f"{modality}: {formats} files, in the folder or in folders inside it."
    )


def _check_counts(settings: Settings) -> None:
    """Raise ValueError if depth cannot be stored in a 16-bit PNG."""
    largest = max(settings.z_max, settings.missing)
    limit = MAX_COUNT * settings.metres_per_count
    if largest > limit:
        raise ValueError(
            f"Depth must be at most {limit:g} metres to fit into a 16-bit PNG with "
            f"{settings.metres_per_count:g} metres per count, got {largest:g}. Set "
            f"z_max={limit:g} or less, or another unit."
        )
