"""Measure the errors of a restorer, and how often its gate restores, on frames of unseen scenes.

    python -m mitigate.training.reports.restorer checkpoints/restorer --suite unseen_val

Errors are means over pixels. RGB errors are in 8-bit grey levels (0 to 255), and depth errors are
in centimetres. A pixel is correct if its error is below ``TOLERANCE`` times the range of values.
`python -m mitigate.evaluate restore=FOLDER` measures the success of an agent with the restorer.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
from torch import nn

from mitigate.core import conf
from mitigate.core.build import maker
from mitigate.core.files import find, write_bytes, write_text
from mitigate.core.markdown import markdown_table
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, POSE, RGB
from mitigate.core.options import positive
from mitigate.core.pictures import depth_picture
from mitigate.core.progress import Progress
from mitigate.core.seeding import generator
from mitigate.corruptions import CLEAN, Corruption, DepthSensor, Key, corrupt_observation
from mitigate.corruptions.registry import title
from mitigate.corruptions.suite import SENSOR
from mitigate.encoders.sources import UNSEEN, Source, collect
from mitigate.evaluation.bootstrap import NO_INTERVAL, Estimate, mean, share
from mitigate.evaluation.conditions import conditions
from mitigate.guards.frames.restorer import Restorer, load_restorer
from mitigate.guards.frames.sensor import TOLERANCE
from mitigate.training.config import TrainConfig
from mitigate.worlds.episodes import read_episodes
from mitigate.worlds.world import depth_sensor

# factors that convert errors to grey levels (RGB) and centimetres (depth)
UNITS = {RGB: 1.0, DEPTH: 100.0}
SHOWN = (0, 1, 2)  # indices of the views that the picture shows
# width in pixels of a view in the picture, and of the column of names next to the views
SIDE, LABEL = 96, 130
GAP, HEAD = 6, 20  # height in pixels of the gaps between blocks, and of the block headings


class Score(NamedTuple):
    """Scores of a restorer for one sensor under one condition.

    Mean errors and fractions of correct pixels are given before and after restoration. ``restored``
    is the fraction of time steps that the restorer changed.
    """

    before: Estimate
    after: Estimate
    right_before: Estimate
    right_after: Estimate
    restored: Estimate


class Instants(NamedTuple):
    """Clean observations, and the properties of their depth sensor."""

    clean: list[dict[str, np.ndarray]]
    depth: DepthSensor = SENSOR

    def corrupted(self, number: int, corruption: Corruption, seed: int) -> dict[str, np.ndarray]:
        """Return the corrupted frames of an observation."""
        seen = self.clean[number]
        frames = {name: seen[name] for name in seen if name in (RGB, DEPTH, POSE)}
        key = Key(seed, f"instant {number}", 0)
        return corrupt_observation(frames, corruption, key, self.depth)


def before_after(config: TrainConfig, base: Any, trained: nn.Module, folder: Path) -> None:
    """Measure a trained restorer, print the results, and write ``restoration.md`` and
    ``restoration.jpg``.

    The restorer is measured on ``evaluation.episodes`` random time steps of unseen scenes, under
    the conditions of the suite. ``base`` is not used, because "before" means without a restorer.
    """
    assert isinstance(trained, Restorer)
    quick = config.evaluation
    met = conditions(config.suite.conditions, config.severity, config.severity_depth)
    seen = instants(config.env, quick.split, quick.episodes or 300, config.seed, trained)
    write(trained, seen, met, config.seed, folder, f"{quick.split}, severity {config.severity:g}")


def instants(env: Any, split: str, count: int, seed: int, restorer: Restorer) -> Instants:
    """Return ``count`` clean observations, from random poses in scenes of ``env`` or from unseen
    frames.

    Raises ValueError for an unknown split.
    """
    world = maker(env.world)()
    if isinstance(world, Source):
        sensor, part = next(iter(restorer.parts().items()))
        frames = collect(world, UNSEEN, count, seed).frames
        clean = [{sensor: frame[None]} for frame in frames]
        return Instants(clean, replace(SENSOR, z_max=part.far))
    if split not in env.episodes:
        raise ValueError(unknown("split", split, env.episodes))
    scenes = sorted({e.scene_id for e in read_episodes(find(env.episodes[split]))})
    observations = []
    for number in range(count):
        rng = generator(seed, "restoration report", number)
        world.enter(scenes[number * len(scenes) // count])
        observation, _ = world.put(
            world.point(rng), float(rng.uniform(-np.pi, np.pi)), views=None, rgb=True
        )
        observations.append({name: np.copy(value) for name, value in observation.items()})
    return Instants(observations, depth_sensor(world.sensors))


def measure(
    restorer: Restorer, data: Instants, corruptions: Sequence[Corruption], seed: int
) -> dict[tuple[str, str], Score]:
    """Return scores by sensor and condition.

    A corruption is scored only for the sensors that it changes.
    """
    scores: dict[tuple[str, str], Score] = {}
    sensors = [sensor for sensor in restorer.nets if sensor in data.clean[0]]
    pairs = [(s, c) for c in corruptions for s in sensors if c is CLEAN or s in c.modalities]
    with Progress("restoration", len(pairs), unit="condition") as progress:
        for sensor, corruption in pairs:
            rows = []
            for number, clean in enumerate(data.clean):
                frames = data.corrupted(number, corruption, seed)[sensor]
                restored = restorer.restore(sensor, frames)
                far = restorer.parts()[sensor].range
                off = [_off(part, clean[sensor], far) for part in (frames, restored)]
                errors = [float(part.mean()) * far * UNITS[sensor] for part in off]
                right = [float((part < TOLERANCE).mean()) for part in off]
                rows.append((*errors, *right, restored is not frames))
            *means, was_restored = np.array(rows, float).T
            scores[sensor, corruption.name] = Score._make([*map(mean, means), share(was_restored)])
            progress.advance(note=corruption.name)
    return scores


def _off(frames: np.ndarray, clean: np.ndarray, far: float) -> np.ndarray:
    """Return the error of each valid pixel as a fraction of ``far``, averaged over colour channels.

    If the clean frame has no valid pixel, the result is [0].
    """
    valid = np.isfinite(clean) & (clean > 0) if clean.dtype != np.uint8 else True
    values = np.nan_to_num(frames.astype(np.float64), posinf=0.0)
    off = np.abs(values - np.where(valid, clean, 0)).mean(-1) / far
    errors = off[np.broadcast_to(valid, clean.shape)[..., 0]]
    return errors if errors.size else np.zeros(1)


def table(scores: dict[tuple[str, str], Score], about: str) -> str:
    """Return the Markdown table, with one row per condition and one block per sensor."""
    parts = [f"# Frames before and after restoration\n\n{about}. In brackets 95 % intervals.\n"]
    for sensor in dict.fromkeys(sensor for sensor, _ in scores):
        unit = "levels of 255" if sensor == RGB else "cm"
        head = [f"{sensor}: mean error, {unit}; right pixels, %", "before", "after"]
        head += ["right before", "right after", "instants restored, %"]
        rows = []
        for (row_sensor, name), score in scores.items():
            if row_sensor == sensor:
                shares = (score.right_before, score.right_after, score.restored)
                cells = [_text(score.before), _text(score.after), *(_text(s, 100) for s in shares)]
                rows.append([title(name), *cells])
        parts.append(markdown_table(head, rows) + "\n")
    if any(NO_INTERVAL in part for part in parts):
        parts.append(f"{NO_INTERVAL}: no interval, as all instants are alike.\n")
    return "\n".join(parts)


def _text(e: Estimate, scale: float = 1.0) -> str:
    return f"{scale * e.value:.1f} {e.interval('.1f', scale)}"


def sheet(
    restorer: Restorer, seen: Instants, met: Sequence[Corruption], seed: int
) -> np.ndarray | None:
    """Plot three views of one time step in their corrupted, restored and clean versions.

    The time step with the largest :func:`_far` is plotted, to avoid views that show mostly a nearby
    wall.

    Returns:
        A uint8 RGB picture with one row per corruption, or None if no corruption applies to the
        sensors.
    """
    number = max(range(len(seen.clean)), key=lambda n: _far(seen.clean[n]))
    clean = seen.clean[number]
    rows: list[np.ndarray] = []
    for corruption in met:
        sensor = next((s for s in corruption.modalities if s in restorer.nets and s in clean), None)
        if sensor is None:
            continue
        frames = seen.corrupted(number, corruption, seed)[sensor]
        versions = (frames, restorer.restore(sensor, frames), clean[sensor])
        views = [_views(sensor, part) for part in versions]
        rows.append(_row_of(_label(title(corruption.name)[:18], LABEL, SIDE), views))
    if not rows:
        return None
    width = (rows[0].shape[1] - LABEL) // 3 - GAP
    heads = [_label(head, width, HEAD) for head in ("corrupted", "restored", "clean")]
    return np.vstack([_row_of(_label("", LABEL, HEAD), heads), *rows])


def _far(frames: dict[str, np.ndarray]) -> float:
    """Return the smallest mean depth of the plotted views.

    If it is small, a view shows mostly a nearby wall.
    """
    depth = frames.get(DEPTH)
    return 0.0 if depth is None or depth.ndim < 4 else float(depth[[*SHOWN]].mean((1, 2, 3)).min())


def _row_of(name: np.ndarray, parts: Sequence[np.ndarray]) -> np.ndarray:
    gap = np.full((len(name), GAP, 3), 255, np.uint8)
    return np.hstack([name, *(piece for part in parts for piece in (gap, part))])


def _label(text: str, width: int, height: int) -> np.ndarray:
    """Return a white image with ``text`` on it."""
    field = np.full((height, width, 3), 255, np.uint8)
    place, font = (4, height // 2 + 4), cv2.FONT_HERSHEY_SIMPLEX
    return cv2.putText(field, text, place, font, 0.42, (0, 0, 0), 1, cv2.LINE_AA)


def _views(sensor: str, frames: np.ndarray) -> np.ndarray:
    views = frames if frames.ndim == 4 else frames[None]
    chosen = [views[k] for k in SHOWN if k < len(views)]
    pictures = chosen if sensor == RGB else [depth_picture(view[..., 0]) for view in chosen]
    nearest = cv2.INTER_NEAREST
    return np.hstack([cv2.resize(view, (SIDE, SIDE), interpolation=nearest) for view in pictures])


def write(
    restorer: Restorer,
    seen: Instants,
    met: Sequence[Corruption],
    seed: int,
    folder: Path,
    about: str,
) -> None:
    """Measure the restorer, print the results, and write a table and a picture into ``folder``.

    There is no picture if no frame is corrupted.
    """
    scores = measure(restorer.eval(), seen, met, seed)
    about = f"{len(seen.clean)} instants of {about}, seed {seed}, restorer {restorer.hash}"
    text = table(scores, about)
    write_text(folder / "restoration.md", text)
    print(f"{text}\nwrote {folder / 'restoration.md'}")
    picture = sheet(restorer, seen, [c for c in met if c is not CLEAN], seed)
    if picture is not None:
        encoded = cv2.imencode(".jpg", picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 88])[1]
        write_bytes(folder / "restoration.jpg", encoded.tobytes())
        print(f"wrote {folder / 'restoration.jpg'}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog="mitigate.training.reports.restorer", description=__doc__)
    parser.add_argument("folder", help="folder of the restorer")
    parser.add_argument("--split", default="val_seen")
    parser.add_argument("--suite", default="full")
    parser.add_argument("--count", type=positive, default=40, help="random instants (default 40)")
    parser.add_argument("--severity", type=float, default=0.6)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", default="runs/restoration", help="folder of table and picture")
    options = parser.parse_args(arguments)
    cfg = conf.composed("evaluate", [f"suite={options.suite}"])
    met = conditions(list(cfg.suite.conditions), options.severity, None)
    restorer = load_restorer(options.folder)
    if not any({*corruption.modalities} & {*restorer.nets} for corruption in met):
        raise ValueError(
            f"suite={options.suite} corrupts no frames of {', '.join(restorer.nets)}. Choose "
            "another suite, such as full or unseen_val."
        )
    seen = instants(cfg.env, options.split, options.count, options.seed, restorer)
    about = f"{options.split}, suite {options.suite}, severity {options.severity:g}"
    write(restorer, seen, met, options.seed, Path(options.out), about)


if __name__ == "__main__":
    try:
        main()
    except (ValueError, OSError) as error:
        sys.exit(f"error: {conf.error_message(error)}")
