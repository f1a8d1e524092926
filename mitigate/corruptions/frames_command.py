"""Corrupt recorded frames: mitigate corrupt IN OUT corruption=... severity=...

  IN          folder of frames, which may contain subfolders and links to folders. RGB is 8-bit
              PNG or JPEG. Depth is 16-bit PNG, or NPY in metres (float, [H, W], [H, W, 1], or with
              views as the first axis). IN may also be the folder of a LeRobot dataset, version 3
              (pip install -e '.[lerobot]').
  OUT         folder for the corrupted frames; it gets the same subfolders and file names

  corruption  name of the corruption (see --list), or intermittent+NAME; frames of modalities that
              it does not corrupt are skipped
  severity    0 (clean) to 1 (worst)
  seed        corruption seed (0)
  episode     folder (default): each folder is an episode, with frames in the order of their names;
              all: all frames are one episode
  unit        unit of depth in 16-bit PNG: mm, cm, m, or metres per count, such as 0.00025. The
              default is mm. Without this option, the command first checks whether the values
              are plausible: as mm in PNG files, and as metres in NPY files. If the option is
              set, for example unit=m, nothing is checked.
  format      output format of a JPEG: png (default) keeps every pixel; same writes a JPEG with the
              same name, at quality 95. For the videos of a LeRobot dataset, png writes lossless
              H.264 in RGB, and same uses the codec of the original, which is lossy.
  z_max       maximum depth in metres (10); valid depth beyond it is clipped
  missing     value in metres that replaces missing depth (0: no reading)
  no_reading  pixel value of a 16-bit PNG that, like 0, means "no reading" (65535)
  hfov        horizontal field of view in degrees; camera faults need it
  cameras     cameras of a LeRobot dataset, separated by commas; the default is all cameras that the
              corruption applies to
  tolerance   maximum seconds between a row of a LeRobot dataset and its video frame (0.0001). The
              options episode, unit and no_reading do not apply to such a dataset.

  --list      list all corruptions with their modality, meaning of severity, randomness and source
  --help      this help

The same command resumes an interrupted run. It also rewrites frames whose input or output file has
changed. OUT/corrupt.json holds the settings, counts, skipped files with the reason, and a checksum
of each frame. Files of other formats are not read, but are counted by suffix. The exit status is 0
if the run is done, 1 if it is done but bad files were skipped, and 2 if it failed.

Example: mitigate corrupt recorded/ corrupted/ corruption=spatter severity=0.5
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from mitigate.core.errors import command
from mitigate.core.names import escaped, printable
from mitigate.core.options import asks_help, paths_and_options
from mitigate.corruptions import folders, lerobot, registry
from mitigate.corruptions.folders import UNITS, Settings
from mitigate.corruptions.frame_files import count_suffixes
from mitigate.corruptions.lerobot.dataset import TOLERANCE

DATASET_OPTIONS = ("cameras", "tolerance")  # options that apply only to LeRobot datasets
MAX_LISTED = 5  # number of skipped files that are printed; the summary lists all


def parse(arguments: Sequence[str]) -> tuple[str, str, Settings, dict[str, str]]:
    """Parse the arguments into IN, OUT, the settings, and the given ``DATASET_OPTIONS``.

    Raises:
        ValueError: If an argument is invalid.
    """
    known = [option.name for option in fields(Settings)]
    (source, out), options = paths_and_options(arguments, ("IN", "OUT"), [*known, *DATASET_OPTIONS])
    of_dataset = {name: options.pop(name) for name in DATASET_OPTIONS if name in options}
    for name in ("corruption", "severity"):
        if name not in options:
            raise ValueError(
                f"The option {name}= is missing. An example is corruption=spatter severity=0.5. "
                "The option --list lists the corruptions."
            )
    values: dict[str, Any] = {name: _value(name, text) for name, text in options.items()}
    return source, out, Settings(**values), of_dataset


def _value(name: str, text: str) -> str | int | float:
    if name in ("corruption", "episode", "format"):
        return text
    if name == "unit" and text in UNITS:
        return UNITS[text]
    try:
        return int(text) if name in ("seed", "no_reading") else float(text)
    except ValueError:
        kind = "a whole number" if name in ("seed", "no_reading") else "a number"
        units = f" or one of {', '.join(UNITS)}" if name == "unit" else ""
        raise ValueError(f"{name} must be {kind}{units}, got {text}.") from None


@command("corrupt")
def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if asks_help(arguments):
        print(__doc__)
        return 0 if arguments else 2
    if "--list" in arguments:
        print(registry.table())
        return 0
    try:
        source, out, settings, of_dataset = parse(arguments)
        if lerobot.is_dataset(source):
            return _corrupt_dataset(source, out, settings, of_dataset)
        if of_dataset:
            raise ValueError(
                f"{', '.join(of_dataset)} applies only to a LeRobot dataset, but {source} "
                "has no meta/info.json. Remove the option."
            )
        summary = folders.run(source, out, settings)
    except KeyboardInterrupt:
        print("\ninterrupted: run the same command to resume", file=sys.stderr)
        return 130
    return _report(summary, out)


def _corrupt_dataset(source: str, out: str, settings: Settings, options: dict[str, str]) -> int:
    from mitigate.corruptions.lerobot import copying

    cameras = [name for name in options.get("cameras", "").split(",") if name]
    tolerance = float(_value("tolerance", options.get("tolerance", str(TOLERANCE))))
    summary = copying.run(source, out, settings, cameras or None, tolerance)
    print(printable(copying.report(summary, out)))
    return 0


def _report(summary: dict, out: str) -> int:
    left_out = summary["left_out"]
    counts = [f"{summary['written']} frames written to {out}"]
    if summary["there"]:
        counts.append(f"{summary['there']} already existed")
    if summary["other_modality"]:
        counts.append(f"{summary['other_modality']} of the other modality skipped")
    if summary["other_files"]:
        counts.append(f"other files not read: {count_suffixes(summary['other_files'])}")
    print(printable("; ".join(counts)))
    replaced = summary["replaced"]
    if replaced:
        more = ", ..." if len(replaced) > MAX_LISTED else ""
        print(
            f"{len(replaced)} frames differed from the results of this command and were written "
            f"again: {', '.join(map(escaped, replaced[:MAX_LISTED]))}{more}",
            file=sys.stderr,
        )
    for entry in left_out[:MAX_LISTED]:
        print(
            f"left out: {escaped(entry['file'])} {escaped(entry['reason'], 500)}", file=sys.stderr
        )
    if left_out:
        print(f"{len(left_out)} files left out, see {out}/{folders.SUMMARY}", file=sys.stderr)
    return 1 if left_out else 0
