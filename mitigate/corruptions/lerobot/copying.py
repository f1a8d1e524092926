"""Write a copy of a LeRobot dataset with corrupted frames, for the command ``mitigate corrupt``.

The copy has the same metadata and rows; only the frames of the corrupted cameras differ. Copying
can be resumed: files whose checksum is in ``corrupt.json`` are not written again.
"""

from __future__ import annotations

import copy
import json
import os
import shutil
from bisect import bisect_left
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.files import make_folder, sha256, write_atomically
from mitigate.core.names import counted, escaped, short
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.output import is_regular, lost, open_output, output_folder
from mitigate.core.progress import Progress
from mitigate.corruptions.folders import (
    SUMMARY,
    Settings,
    check_folders,
    checksum,
    earlier_summary,
    short_hash,
    write_summary,
)
from mitigate.corruptions.frame_files import encode
from mitigate.corruptions.keying import Key
from mitigate.corruptions.lerobot import videos
from mitigate.corruptions.lerobot.dataset import TOLERANCE, Dataset, open_dataset, rows_of
from mitigate.corruptions.lerobot.frames import as_frame, check_images, store_depth, stored_image
from mitigate.corruptions.lerobot.metadata import EPISODES, INFO, VIDEO, Camera
from mitigate.corruptions.lerobot.tables import FIX, check_file, integers, open_table, parquet
from mitigate.corruptions.lerobot.videos import Encoding
from mitigate.corruptions.registry import version
from mitigate.corruptions.suite import SUITE_VERSION, Corruption, corrupt

UNUSED = ("episode", "unit", "no_reading")  # options that apply only to folders of frames
MAX_LISTED = 5  # maximum number of files that are printed
# keys (after the prefix "video.") in a feature's info that describe how the video was encoded
ENCODER_KEYS = ("g", "crf", "preset", "fast_decode", "extra_options", "video_backend")


# a frame: its time in the video file, the number of its episode, and its index in the episode
Instant = tuple[float, int, int]


@dataclass
class Copy:
    """A copy in progress."""

    dataset: Dataset  # the original
    out: Path  # folder of the copy
    settings: Settings
    cameras: Sequence[Camera]  # the cameras to corrupt
    tolerance: float  # maximum seconds between a row and its video frame
    encodings: Mapping[str, Encoding]  # encoding of the videos, by camera
    frames: Counter[str]  # number of frames to corrupt, by file name
    progress: Progress  # counts corrupted frames
    summary: dict[str, Any] = field(default_factory=dict)  # content of corrupt.json


def run(
    source: Path | str,
    out: Path | str,
    settings: Settings,
    cameras: Sequence[str] | None = None,
    tolerance: float = TOLERANCE,
) -> dict[str, Any]:
    """Write a corrupted copy of a dataset.

    The key of a frame is the seed, the name of the episode (such as "episode-000003") and the frame
    number in the episode. Therefore all cameras get the same random numbers in the same time step.
    The metadata keeps the statistics of the original dataset.

    The format "png" is lossless: images become PNG (depth keeps its format), and videos become
    H.264 in RGB. With "same", JPEG stays JPEG, and videos keep their codec, with the quality
    settings of lerobot.

    Args:
        source: Folder of the dataset.
        out: Folder of the copy.
        settings: Corruption, seed and format.
        cameras: Cameras to corrupt, by default all of the modality that the corruption changes.
        tolerance: Maximum seconds between a row and its video frame.

    Returns:
        The summary, which is also written to ``out/corrupt.json``.

    Raises:
        FileNotFoundError: If the folder or a file of the dataset is missing.
        ValueError: If the dataset is damaged, an option does not apply, or ``out`` contains other
            files.
        OSError: If ``out`` cannot be written.
    """
    source, out = Path(source), Path(out)
    check_folders(source, out)
    for option in fields(Settings):
        if option.name in UNUSED and getattr(settings, option.name) != option.default:
            raise ValueError(
                f"{option.name}= does not apply to the LeRobot dataset {source}: its metadata "
                f"determine this setting. Remove {option.name}=."
            )
    if not 0 < tolerance < 1:
        raise ValueError(f"tolerance must be above 0 and below 1 (seconds), got {tolerance:g}.")
    dataset = open_dataset(source)
    chosen = _choose_cameras(dataset, settings, cameras)
    encodings = {
        camera.name: _encoding(dataset, camera, settings.format)
        for camera in chosen
        if camera.stored == VIDEO
    }
    frames = _frames_per_file(dataset, chosen)
    with (
        output_folder(out, SUMMARY),
        Progress(settings.corruption, frames.total(), unit="frame") as progress,
    ):
        work = Copy(dataset, out, settings, chosen, tolerance, encodings, frames, progress)
        _begin(work)
        try:
            _copy(work)
        finally:  # a resumed run then does not write finished files again
            write_summary(out, work.summary)
    return work.summary


def _choose_cameras(
    dataset: Dataset, settings: Settings, names: Sequence[str] | None
) -> list[Camera]:
    kind = Corruption(settings.corruption, settings.severity).modality
    chosen = dataset.choose_cameras(kind, names)
    if not chosen or (names and len(chosen) < len(names)):
        others = (f"{c.name} ({c.kind})" for c in dataset.cameras.values())
        unread = (f"{name} ({reason})" for name, reason in dataset.other_cameras.items())
        raise ValueError(
            f"{settings.corruption} corrupts {kind}. Choose {kind} cameras of {dataset.path}: it "
            f"has {', '.join([*others, *unread]) or 'no camera'}."
        )
    return chosen


def _encoding(dataset: Dataset, camera: Camera, form: str) -> Encoding:
    if camera.kind == DEPTH:
        return videos.DEPTH
    if form == "png":
        return videos.LOSSLESS
    file = next(iter(dataset.episodes.values())).videos[camera.name][0]
    codec = videos.read_codec(dataset.path / file, camera)
    if codec not in videos.LOSSY:
        raise ValueError(
            f"{dataset.path / file} has the codec {short(codec)}, but format=same can write "
            f"only {', '.join(videos.LOSSY)}. Set format=png for lossless videos."
        )
    return videos.LOSSY[codec]


# ------------------------------------------------------------------------------------ files


def _copy(work: Copy) -> None:
    """Write every file of the copy.

    meta/info.json is written last, so that an incomplete copy cannot be opened.
    """
    from_video = [camera for camera in work.cameras if camera.stored == VIDEO]
    in_rows = [camera for camera in work.cameras if camera.stored != VIDEO]
    episodes = work.dataset.episodes.values()
    tables = {episode.data for episode in episodes} if in_rows else set()
    films = {
        episode.videos[camera.name][0]: camera for camera in from_video for episode in episodes
    }
    instants = _instants(work.dataset, from_video) if films else {}
    others = [f for f in _files(work.dataset.path) if f not in tables and f not in films]
    writers: dict[str, Callable[[Path], Any]] = {
        name: partial(_copy_file, work.dataset.path / name) for name in others
    }
    for name in sorted(tables):
        writers[name] = partial(_corrupt_rows, work, name, in_rows)
    for name in sorted(films):
        writers[name] = partial(_corrupt_video, work, name, films[name], instants[name])
    writers[INFO] = partial(_write_info, work)
    for name, write in writers.items():
        if not _write(work, name, write):
            work.progress.advance(work.frames[name])
    for name in writers:
        if not (work.out / name).is_file():
            raise lost(work.out / name)


def _frames_per_file(dataset: Dataset, cameras: Sequence[Camera]) -> Counter[str]:
    """Return the number of frames to corrupt, by file name."""
    frames: Counter[str] = Counter()
    for episode in dataset.episodes.values():
        for camera in cameras:
            is_video = camera.stored == VIDEO
            file = episode.videos[camera.name][0] if is_video else episode.data
            frames[file] += episode.length
    return frames


def _files(source: Path) -> Iterator[str]:
    """Yield the relative paths of files that are not hidden, except ``INFO`` and ``SUMMARY``."""
    listed = (Path(at, name) for at, inner, files in os.walk(source) for name in (*inner, *files))
    for path in sorted(listed):
        relative = path.relative_to(source)
        is_hidden = any(part.startswith(".") for part in relative.parts)
        if not is_hidden and is_regular(path) and relative.as_posix() not in (INFO, SUMMARY):
            yield relative.as_posix()


def _write(work: Copy, name: str, write: Callable[[Path], Any]) -> bool:
    """Write a file and record its checksum; return False if ``out`` already contains the file."""
    checksums = work.summary["checksums"]
    paths = (work.dataset.path / name, work.out / name)
    exists = is_regular(paths[1])
    if exists and name in checksums and checksums[name] == checksum(*paths):
        work.summary["there"] += 1
        return False
    checksums.pop(name, None)
    make_folder(paths[1].parent)
    write_atomically(paths[1], write)
    work.summary["written"] += 1
    work.summary["replaced"] += [name] * exists
    checksums[name] = checksum(*paths)
    return True


def _copy_file(source: Path, path: Path) -> None:
    with open(source, "rb") as original, open_output(path, "wb") as file:
        shutil.copyfileobj(original, file)


# ----------------------------------------------------------------------------------- frames


def _corrupt(work: Copy, camera: Camera, frame: np.ndarray, episode: str, number: int) -> Any:
    settings = work.settings
    key = Key(settings.seed, episode, number)
    try:
        return corrupt(
            frame, settings.corruption, settings.severity, key=key, sensor=settings.sensor
        )
    except ValueError as error:  # the suite does not support the frame's shape or unit
        raise ValueError(f"{camera.name}, {episode}, frame {number}: {error}") from error


def _name(episode: int) -> str:
    """Return the name of an episode, which is part of the keys of its frames."""
    return f"episode-{episode:06d}"


def _instants(dataset: Dataset, cameras: Sequence[Camera]) -> dict[str, list[Instant]]:
    """Return the times of the frames in each video of ``cameras``, in increasing order."""
    instants: defaultdict[str, list[Instant]] = defaultdict(list)
    for episode, rows, _ in rows_of(dataset, list(dataset.episodes.values())):
        for camera in cameras:
            file, start = episode.videos[camera.name]
            times = rows.times.tolist()
            instants[file] += [(start + time, episode.index, n) for n, time in enumerate(times)]
    return {file: sorted(listed) for file, listed in instants.items()}


def _corrupt_video(
    work: Copy, name: str, camera: Camera, instants: list[Instant], path: Path
) -> None:
    """Write a corrupted video.

    Frames that belong to no episode are also corrupted and kept, so that no other frame gets a new
    number.
    """
    source = work.dataset.path / name
    used: set[int] = set()

    def change(frame: np.ndarray, time: float, number: int) -> np.ndarray:
        place = bisect_left(instants, time - work.tolerance, key=itemgetter(0))
        if place == len(instants) or instants[place][0] > time + work.tolerance:
            return _corrupt(work, camera, frame, f"unused-{name}", number)
        if place in used:
            raise ValueError(
                f"{source} has two frames within {work.tolerance:g} s of {time:.6f} s. {FIX} Or "
                "set a smaller tolerance=."
            )
        used.add(place)
        _, episode, index = instants[place]
        work.progress.advance()
        return _corrupt(work, camera, frame, _name(episode), index)

    videos.corrupt_video(source, path, camera, work.encodings[camera.name], change)
    absent = [instant for place, instant in enumerate(instants) if place not in used]
    if absent:
        moment, episode, index = absent[0]
        raise ValueError(
            f"{source} must have a frame within {work.tolerance:g} s of {moment:.6f} s, for frame "
            f"{index} of episode {episode}. {len(absent)} of {len(instants)} frames are missing. "
            "Copy the dataset again, or set a larger tolerance= if its clock is inexact."
        )


def _corrupt_rows(work: Copy, name: str, cameras: Sequence[Camera], path: Path) -> None:
    """Write a file of data/ with corrupted images; its row groups stay the same."""
    source = work.dataset.path / name
    with open_table(source) as table:
        schema = table.schema_arrow
        check_images(source, schema, cameras)
        with (
            open_output(path, "wb") as file,
            parquet().ParquetWriter(file, schema, compression="snappy") as writer,
        ):
            for group in range(table.num_row_groups):
                rows = table.read_row_group(group)
                for camera in cameras:
                    rows = _replace_images(work, source, rows, camera)
                writer.write_table(rows, row_group_size=max(1, rows.num_rows))


def _replace_images(work: Copy, source: Path, rows: Any, camera: Camera) -> Any:
    import pyarrow

    episodes = integers(rows, "episode_index", source)
    numbers = integers(rows, "frame_index", source)
    column = rows.column(camera.name)
    values = []
    for row, (episode, number) in enumerate(zip(episodes, numbers, strict=True)):
        stored, form = stored_image(source, rows, row, camera, number)
        clean = as_frame(stored, camera)
        corrupted = _corrupt(work, camera, clean, _name(episode), number)
        pixels = corrupted if camera.kind == RGB else store_depth(corrupted, stored, camera)
        if form == "JPEG" and work.settings.format == "png":
            form = "PNG"
        work.progress.advance()
        values.append({**column[row].as_py(), "bytes": encode(pixels, form)})
    index = rows.schema.get_field_index(camera.name)
    return rows.set_column(index, rows.schema.field(index), pyarrow.array(values, column.type))


# --------------------------------------------------------------------------------- metadata


def _write_info(work: Copy, path: Path) -> None:
    """Write meta/info.json, in which the codecs of the new videos are set."""
    info = copy.deepcopy(dict(work.dataset.info))
    for name, encoding in work.encodings.items():
        feature = info["features"][name]
        place = feature["info"] if isinstance(feature.get("info"), dict) else {}
        for key in ENCODER_KEYS:
            place.pop(f"video.{key}", None)
        place |= {"video.codec": encoding.name, "video.pix_fmt": encoding.stored}
        feature["info"] = place
    with open_output(path, "wb") as file:
        file.write(json.dumps(info, indent=4, ensure_ascii=False).encode())


def _digest(dataset: Dataset) -> str:
    """Return a hash of the metadata and the files of data/, which determine the keys of frames."""
    names = {INFO, *(episode.data for episode in dataset.episodes.values())}
    names |= {
        path.relative_to(dataset.path).as_posix()
        for path in (dataset.path / EPISODES).glob("*/*.parquet")
    }
    for name in names:
        check_file(dataset.path / name)
    return short_hash("".join(name + sha256(dataset.path / name) for name in sorted(names)))


def _begin(work: Copy) -> None:
    """Check that an earlier run in ``out`` had the same settings; then write the settings there."""
    settings = {k: v for k, v in asdict(work.settings).items() if k not in UNUSED}
    now = {
        "suite_version": SUITE_VERSION,
        **version(work.settings.corruption),
        **settings,
        "cameras": [camera.name for camera in work.cameras],
        "tolerance": work.tolerance,
        "dataset": _digest(work.dataset),
    }
    earlier = earlier_summary(work.out, now)
    codecs = {name: f"{e.name} {e.stored}" for name, e in work.encodings.items()}
    work.summary = {
        "settings": now,
        "episodes": len(work.dataset.episodes),
        "frames": work.frames.total(),
        "videos": codecs,
        "written": 0,
        "there": 0,
        "replaced": [],
        "checksums": earlier.get("checksums", {}),
    }
    write_summary(work.out, work.summary)


def report(summary: Mapping[str, Any], out: str) -> str:
    """Return a report of a run, which the command prints."""
    settings = summary["settings"]
    lines = [
        f"{counted(summary['frames'], 'frame')} of {', '.join(settings['cameras'])} corrupted; "
        f"{counted(summary['written'], 'file')} written to {out}"
    ]
    if summary["there"]:
        lines[0] += f"; {summary['there']} already existed"
    for camera, codec in summary["videos"].items():
        lossless = codec.endswith((videos.LOSSLESS.stored, videos.DEPTH.stored))
        lines.append(f"video of {camera}: {codec}, {'lossless' if lossless else 'lossy'}")
    if summary["replaced"]:
        names = ", ".join(map(escaped, summary["replaced"][:MAX_LISTED]))
        lines.append(
            f"{counted(len(summary['replaced']), 'file')} differed from the results of this "
            f"command and were written again: {names}"
        )
    return "\n".join(lines)
