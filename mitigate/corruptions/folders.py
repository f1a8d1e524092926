"""Corrupt a folder of frames into another one: streaming, resumable, never half-written."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from hashlib import blake2b
from pathlib import Path

import numpy as np
from tqdm import tqdm

from mitigate.core.files import read_regular, sha256, write_bytes
from mitigate.core.observation import Z_MAX
from mitigate.core.output import UnsafePathError, is_regular, lost, output_folder
from mitigate.corruptions import frame_files
from mitigate.corruptions.depth_sensor import DepthSensor
from mitigate.corruptions.frame_files import MOST, RGB, Frame, Plan, make_plan, told
from mitigate.corruptions.keying import Key
from mitigate.corruptions.registry import known, version
from mitigate.corruptions.suite import SUITE_VERSION, Corruption, check_name, corrupt

SUMMARY = "corrupt.json"
UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0}
EPISODES = ("folder", "all")
FORMATS = ("png", "same")


@dataclass(frozen=True)
class Settings:
    """What is done to a folder. Raises ValueError for a value that is not allowed."""

    corruption: str
    severity: float
    seed: int = 0
    episode: str = "folder"  # each folder is an episode, or "all" files are one
    format: str = "png"  # what a JPEG becomes: PNG, or the "same" again
    unit: float = UNITS["mm"]  # metres of one count of a 16-bit PNG
    z_max: float = Z_MAX  # metres: the sensor's range, to which depth is clipped
    missing: float = 0.0  # metres that a hole of missing data reads

    def __post_init__(self) -> None:
        Corruption(self.corruption, self.severity)
        check_name(self.corruption, ("clean", *known("rgb", "depth")))
        if self.corruption == "clean":
            raise ValueError("corruption=clean changes nothing: copy the folder instead.")
        choices = (("episode", self.episode, EPISODES), ("format", self.format, FORMATS))
        for name, value, allowed in choices:
            if value not in allowed:
                raise ValueError(
                    f"{name}={value} is not allowed: {name} is one of {', '.join(allowed)}."
                )
        if not 0.0 < self.unit < float("inf"):
            raise ValueError(
                f"unit={self.unit} is not allowed: it is the metres of one count of a 16-bit PNG, "
                "as mm, cm, m or a number above 0, such as 0.00025."
            )
        if not self.missing >= 0.0:
            raise ValueError(
                f"missing={self.missing:g} is not allowed: it is the metres that a hole of missing "
                "data reads, 0 (no reading) or more."
            )
        DepthSensor(z_max=self.z_max)  # raises ValueError for a range that is none

    @property
    def sensor(self) -> DepthSensor:
        return DepthSensor(z_max=self.z_max, missing=self.missing)


def run(source: Path | str, out: Path | str, settings: Settings) -> dict:
    """Corrupt the frames of ``source`` (all folders in it) into the same tree in ``out``.

    Frames are numbered by name inside their episode, digits counting as numbers ("9" before
    "10"); a bad file keeps its number. A file that is in ``out`` already is not written again.
    Returns the summary, which is ``out/corrupt.json`` too: settings, counts and files left out.

    Raises FileNotFoundError if there is no folder or no frame, ValueError if one folder lies in the
    other or if ``out`` was made with other settings or frames or by something else, OSError if it
    cannot be written.
    """
    source, out = Path(source), Path(out)
    _check_folders(source, out)
    wanted = Corruption(settings.corruption, settings.severity).modality
    plan = make_plan(source, out, wanted, settings.episode)
    if not plan.frames:
        raise FileNotFoundError(_nothing(source, wanted, settings, plan))
    if any(frame.path.suffix.lower() == ".png" for frame in plan.frames) and wanted != RGB:
        _check_counts(settings)
    with output_folder(out, SUMMARY):
        return _corrupt_all(source, out, settings, plan)


def _corrupt_all(source: Path, out: Path, settings: Settings, plan: Plan) -> dict:
    """Corrupt the frames of ``plan``; return the summary as :func:`run` does."""
    summary = _begin(out, settings, plan)
    outputs = {frame.path: _output(frame.path, settings.format) for frame in plan.frames}
    given = set(outputs)
    try:
        for frame in tqdm(plan.frames, desc=settings.corruption, unit="frame", disable=None):
            name, target = frame.path.as_posix(), outputs[frame.path]
            if name in plan.left_out:
                continue
            if target != frame.path and (target in given):
                plan.left_out[name] = f"would become {target.name}, which is there: use format=same"
            else:
                _corrupt_frame(source, out, target, frame, settings, plan, summary)
            given.add(target)
    finally:  # so that an interrupted run need not compute its frames again
        _write_summary(out, summary)
    missing = [
        out / outputs[frame.path]
        for frame in plan.frames
        if frame.path.as_posix() not in plan.left_out and not (out / outputs[frame.path]).is_file()
    ]
    if missing:
        raise lost(missing[0])
    summary["left_out"] = [{"file": f, "reason": r} for f, r in sorted(plan.left_out.items())]
    _write_summary(out, summary)
    return summary


def _corrupt_frame(
    source: Path,
    out: Path,
    target: Path,
    frame: Frame,
    settings: Settings,
    plan: Plan,
    summary: dict,
) -> None:
    """Write one frame unless ``out`` has it as this command writes it; record its checksum."""
    name, checksums = target.as_posix(), summary["checksums"]
    files = (source / frame.path, out / target)
    there = is_regular(out / target)
    if there and name in checksums and checksums[name] == _checksum(*files):
        summary["there"] += 1
        return
    key = Key(settings.seed, frame.episode, frame.number)

    def change(pixels: np.ndarray) -> np.ndarray:
        return corrupt(
            pixels, settings.corruption, settings.severity, key=key, sensor=settings.sensor
        )

    try:
        data = frame_files.corrupted(files[0], target.suffix, settings.unit, change)
    except ValueError as error:  # LeftOutError, or a shape that the suite refuses
        plan.left_out[frame.path.as_posix()] = str(error)
        checksums.pop(name, None)
        return
    if there and files[1].stat().st_size == len(data) and files[1].read_bytes() == data:
        summary["there"] += 1
    else:
        write_bytes(files[1], data)
        summary["written"] += 1
        summary["replaced"] += [name] * there
    checksums[name] = _checksum(*files)


def _checksum(read: Path, written: Path) -> str:
    """Return one checksum of a frame as it was read and as it was written, "" if one of the files
    cannot be read."""
    try:
        return _short_hash(sha256(read) + sha256(written))
    except OSError:
        return ""


def _output(path: Path, form: str) -> Path:
    jpeg = path.suffix.lower() in (".jpg", ".jpeg")
    return path.with_suffix(".png") if jpeg and form == "png" else path


# ------------------------------------------------------------------------- the folder written


def _begin(out: Path, settings: Settings, plan: Plan) -> dict:
    """Check what an earlier run left in ``out``, then note settings and episodes there."""
    of_its_own = version(settings.corruption)
    settings_now = {"suite_version": SUITE_VERSION, **of_its_own, **asdict(settings)}
    checksums: dict[str, str] = {}
    if out.is_dir() and any(path.name[0] != "." for path in out.iterdir()):
        checksums = _check_earlier(out, settings_now, plan.episodes())
    summary = {
        "settings": settings_now,
        "episodes": {
            name: {"frames": len(frames), "names": _digest(frames)}
            for name, frames in plan.episodes().items()
        },
        "written": 0,
        "there": 0,
        "replaced": [],
        "other_modality": plan.other_modality,
        "other_files": plan.other_files,
        "left_out": [],
        "checksums": checksums,
    }
    _write_summary(out, summary)
    return summary


def _check_earlier(out: Path, settings: dict, episodes: dict[str, list[str]]) -> dict[str, str]:
    """Return the checksums that an earlier run recorded, none if an earlier version did.

    Raises ValueError if ``out`` was not made with these settings and frames.
    """
    try:
        earlier = json.loads(read_regular(out / SUMMARY))
        was, numbered = dict(earlier["settings"]), dict(earlier["episodes"])
        known = {name: (int(e["frames"]), str(e["names"])) for name, e in numbered.items()}
        checksums = {str(k): str(v) for k, v in dict(earlier.get("checksums", {})).items()}
    except FileNotFoundError:
        raise ValueError(
            f"{out} holds files but no {SUMMARY}, so it was not made by this program. Name a new "
            "or an empty folder."
        ) from None
    except UnsafePathError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(
            f"{out / SUMMARY} is damaged ({error}), so what {out} holds is not known. Name a new "
            "folder, or delete this one."
        ) from error
    other = [
        f"{name}={was.get(name)} there, {name}={settings.get(name)} now"
        for name in {**was, **settings}
        if was.get(name) != settings.get(name)
    ]
    if other:
        raise ValueError(
            f"{out} was made with other settings: {'; '.join(other)}. Name another folder, or "
            "delete this one."
        )
    for name, (count, digest) in known.items():
        if _digest(episodes.get(name, [])[:count]) != digest:
            raise ValueError(
                f"The first {count} frames of episode {name!r} are not those that {out} was made "
                "from: files were added between them, removed or renamed, so their numbers "
                "changed. Name another folder, or delete this one. (Frames added at the end are "
                "fine.)"
            )
    counts = {name: count for name, (count, _) in known.items()}
    _check_added(out, str(settings["format"]), episodes, counts)
    return checksums


def _check_added(
    out: Path, form: str, episodes: dict[str, list[str]], counts: dict[str, int]
) -> None:
    """Refuse a frame that came later under the name that an earlier JPEG's result has."""
    made: dict[str, str] = {}
    for name, frames in episodes.items():
        for frame in frames[: counts.get(name, 0)]:
            made.setdefault(_output(Path(frame), form).as_posix(), frame)
    for name, frames in episodes.items():
        for frame in frames[counts.get(name, 0) :]:
            if frame in made:
                raise ValueError(
                    f"{frame} came after {out} was made, where {made[frame]} has taken its name. "
                    "Rename it, or name another folder with format=same."
                )


def _digest(names: list[str]) -> str:
    return _short_hash("\n".join(names))


def _short_hash(text: str) -> str:
    return blake2b(text.encode("utf-8", "surrogateescape"), digest_size=8).hexdigest()


def _write_summary(out: Path, summary: dict) -> None:
    write_bytes(out / SUMMARY, (json.dumps(summary, indent=1) + "\n").encode())


# ------------------------------------------------------------------------------- user mistakes


def _check_folders(source: Path, out: Path) -> None:
    if not source.is_dir():
        hint = " Put single files into a folder." if source.is_file() else " Check the path."
        raise FileNotFoundError(f"There is no folder {source}.{hint}")
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out} is a file: name a folder to write to.")
    inside, outside = source.resolve(), out.resolve()
    if inside == outside or inside in outside.parents or outside in inside.parents:
        raise ValueError(
            f"{out} and {source} must not be the same folder nor one inside the other: results "
            "would be read as frames, or overwrite them. Name a folder beside it."
        )


def _nothing(source: Path, wanted: str, settings: Settings, plan: Plan) -> str:
    takes = "8-bit RGB PNG or JPEG" if wanted == RGB else "16-bit grey PNG or NPY (metres)"
    other = (
        f"; {plan.other_modality} frames are of the other modality" if plan.other_modality else ""
    )
    other += f"; other files are not read: {told(plan.other_files)}" if plan.other_files else ""
    return (
        f"There is no {wanted} frame in {source}{other}. {settings.corruption} corrupts {wanted}: "
        f"{takes} files, in the folder or in folders inside it."
    )


def _check_counts(settings: Settings) -> None:
    most = max(settings.z_max, settings.missing)
    if most > MOST * settings.unit:
        raise ValueError(
            f"Depth up to {most:g} metres does not fit into a 16-bit PNG with {settings.unit:g} "
            f"metres a count: give z_max={MOST * settings.unit:g} or less, or another unit."
        )
