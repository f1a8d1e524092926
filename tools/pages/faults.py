"""The page ``docs/faults.md`` and its pictures: faults of time, of the camera and of motion.

python -m tools.pages.faults
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from matplotlib.figure import Figure

from mitigate.core.conf import load_config
from mitigate.core.files import write_bytes, write_figure
from mitigate.core.observation import DEPTH, HFOV_DEGREES, POSE, RGB, STOP
from mitigate.core.pictures import depth_picture, draw_path
from mitigate.corruptions import CLEAN, Corruption, Key, corrupt, registry
from mitigate.evaluation import config  # noqa: F401 - registers the types of conf/evaluate.yaml
from mitigate.worlds import motion
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.tasks import make_episode
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import Corrupted, World
from tools.pages.corruptions import formulas

DOCS = Path(__file__).resolve().parents[2] / "docs"
APARTMENT, SIZE = 200021, 72  # the apartment of the other pages; pixels of a view
FRAMES = 16  # instants per row
SEVERITY = 0.6
COLOURS = ("#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8c564b")
LABEL, GUTTER = 190, 3  # pixels: names of rows, between cells
JPEG_QUALITY = 80
FONT = cv2.FONT_HERSHEY_SIMPLEX
PICTURES = {
    "temporal": "pictures/faults-temporal.jpg",
    "camera": "pictures/faults-camera.jpg",
    "motion": "pictures/faults-motion.png",
}
TEXT = """# Faults

Corruptions of the [standard suite](corruptions.md) act on single frames. A robot also fails over
time, its camera may be mounted wrongly, and its motion is not exact. A fault has a severity s
from 0 (no fault) to 1, a key and its own version in result rows, as an [unseen
corruption](unseen-corruptions.md). Faults are not part of `suite=full` or `suite=all`, and no
recipe trains on them.

```bash
make evaluate ARGS="checkpoint=checkpoints/base suite=temporal"
make evaluate ARGS="checkpoint=checkpoints/base suite=camera"
make evaluate ARGS="checkpoint=checkpoints/base suite=motion"
```

Each family has its own table in the results. [The base agent](results/faults.md) was measured under
all faults. `python -m tools.pages.faults` writes this page and its pictures.

## Time

![One view of {frames} steps, clean and under each temporal fault]({temporal_picture})

The forward view at {frames} steps in apartment {apartment}, at s = {severity:g}. The last rows
show depth.

{temporal}
- A **frame** is an observation of the sequence: a step of `mitigate evaluate` (0.25 m or 15
  degrees in the apartments and in Habitat), also a step at which the agent reads no frames; a step
  of a gymnasium or torchrl environment; a file of a folder; a call of the agent's sensors under
  `mitigate run`.
- All views of a panorama and both sensors fail together, except under `depth_lag` and
  `exposure_flicker`. With one sensor, the fault affects that sensor. The pose is never delayed.
- In a pair, a late frame is corrupted as when it was taken: `low_light_noise+frame_delay` shows
  old noise on an old picture. The order does not matter.
- A frame that is lost at one severity is lost at every higher severity too.
- Rows do not depend on resume, workers and parallel episodes: the frames are a function of the key
  and the earlier frames of the episode.

## Camera

![The forward view under each fault of the camera, rendered and warped]({camera_picture})

The forward view: clean, rendered from the displaced camera at s = 0.5 and 1, and warped from the
clean frame at s = 0.5 and 1, which is what other worlds and files get.

{camera}
- The displacement is constant in an episode. Its direction is drawn.
- **Rendered**: the apartments render again (`World.displaced`), so nothing is lost.
- **Warped**: in all other worlds and entry points. A rotation and a field of view are exact
  homographies of a pinhole camera with square pixels. What the camera did not see is black, or
  without a reading. RGB is interpolated bilinearly; depth is the nearest reading, converted to
  depth along the new optical axis. The horizontal field of view must be known: `hfov` of the
  world's sensors, of the cameras under `mitigate run`, or the argument `hfov=`.
- `camera_height` needs rendering. A frame does not show what is behind an edge.
- A **panorama** is one rigid rig: pitch of the rig is roll for a view to the side.
- In a pair, the camera comes first: `spatter+camera_roll` has level dirt on a tilted view.
- The pose is that of the robot. The agent does not know that its camera has moved.

## Motion

![Paths of one list of commands under each fault of motion]({motion_picture})

Paths of the expert's commands in apartment {apartment}, at s = {severity:g}, executed open loop.

{motion}
- **Steps of 0.25 m and 15 degrees** (apartments, Habitat): slip and gain scale both, drift turns
  the robot after each forward step, a dropped action is a step without movement, and a repeated
  action replaces the command by the previous one. STOP is always executed.
- **Continuous actions** (a `Box`): slip and gain scale the action, drift adds a bias to all its
  elements (up to {bias:g} of half their range), a dropped action is zero. The result is clipped.
- **Other actions**: `repeated_action` only; the others raise an error.
- The pose sensor reports where the robot really is. An agent with poses can correct its path.
- The code for Habitat is tested with a replacement of the simulator only.

## Where they work

| entry point | temporal | camera | motion |
|---|---|---|---|
| `mitigate evaluate`, `mitigate.benchmark` | yes | yes | yes |
| `mitigate replay` | yes | warped | no |
| `mitigate run` | yes | warped | no |
| `mitigate corrupt` | yes; a resumed run reads all files again | warped, `hfov=` | no |
| gymnasium wrapper, torchrl transform | yes | warped, `hfov=` | no |
| torchrl transform in a replay buffer | no | warped | no |
| `corrupt`, `corrupt_observation` | no | warped, `hfov=` | no |
| `corrupt_habitat`, habitat-baselines, schedules of trainings | no | no | no |

"No" is an error that says why. The wrappers need a `Corruption`, not a `Schedule`.

In Python, a `FrameStream` corrupts the observations of a sequence in order:

```python
import numpy as np
from mitigate.corruptions import Corruption, FrameStream, Key

stream = FrameStream(hfov={{"rgb": 90.0}})
frozen = Corruption("frozen_frame+camera_roll", 0.6)
for step in range(20):
    observation = {{"rgb": np.full((64, 64, 3), step, np.uint8)}}
    corrupted = stream.corrupt(observation, frozen, Key(seed=0, episode="17", frame=step))
```

A world of yours gets rendered camera faults with a method `displaced(mount)`, which returns the
frames of a displaced camera, and motion faults with a method `move(metres, degrees)`, which takes a
step of any size (`mitigate/worlds/world.py`, `mitigate/worlds/motion.py`).
"""


def write_page(folder: Path = DOCS) -> None:
    """Write the page and its pictures into ``folder``."""
    _write_picture(folder / PICTURES["temporal"], timeline())
    _write_picture(folder / PICTURES["camera"], camera_sheet())
    write_figure(folder / PICTURES["motion"], paths(), dpi=70, facecolor="white")
    text = TEXT.format(
        frames=FRAMES,
        apartment=APARTMENT,
        severity=SEVERITY,
        bias=motion.BIAS,
        **{f"{family}_picture": picture for family, picture in PICTURES.items()},
        **{family: formulas(registry.fault_names(family)) for family in PICTURES},
    )
    write_bytes(folder / "faults.md", text.encode())


def timeline() -> np.ndarray:
    """Draw the forward view of each step, clean and under each temporal fault, uint8 RGB."""
    names = load_config("evaluate", ["suite=temporal"]).suite.conditions[1:]
    faults = [Corruption(name, SEVERITY) for name in names]
    depth_only = [fault for fault in faults if fault.modalities == (DEPTH,)]
    rows = [(fault, RGB) for fault in (CLEAN, *faults) if fault not in depth_only]
    rows += [(fault, DEPTH) for fault in (CLEAN, *depth_only)]
    return _sheet([(fault.name.split("+"), _views(fault, entry)) for fault, entry in rows])


def _views(corruption: Corruption, entry: str) -> list[np.ndarray]:
    """Return the forward views of an episode in which the expert acts."""
    world = ApartmentsWorld(SIZE, views=1)
    return [_picture(obs[entry]) for obs in _walk(world, Corrupted(world, corruption, seed=0))]


def _walk(world: ApartmentsWorld, corrupted: World) -> Iterator[Any]:
    """Yield the observations of ``FRAMES`` steps of the expert."""
    observation = corrupted.reset(make_episode(Apartment(APARTMENT), "vln", 0))
    for _ in range(FRAMES):
        yield observation
        observation = corrupted.step(world.expert().action())


def camera_sheet() -> np.ndarray:
    """Draw the forward view under each fault of the camera, uint8 RGB."""
    world = ApartmentsWorld(2 * SIZE, views=1)
    episode = make_episode(Apartment(APARTMENT), "vln", 0)
    clean = world.reset(episode)[RGB]
    key = Key(0, episode.episode_id)
    rows = []
    for name in registry.fault_names("camera"):
        severities = (0.5, 1.0)
        pictures = [clean]
        faults = [Corruption(name, severity) for severity in severities]
        pictures += [Corrupted(world, fault, 0).reset(episode)[RGB] for fault in faults]
        if name != "camera_height":
            pictures += [corrupt(clean, name, s, key=key, hfov=HFOV_DEGREES) for s in severities]
        rows.append(([name], pictures))
    return _sheet(rows, 2 * SIZE)


def paths() -> Figure:
    """Draw the paths of the expert's commands, clean and under each fault of motion."""
    world = ApartmentsWorld(16)
    episode = make_episode(Apartment(APARTMENT), "vln", 0)
    commands = list(_commands(world, episode))
    figure = Figure(figsize=(9, 6), layout="constrained")
    axes = figure.subplots()
    for name, colour in zip(("clean", *registry.fault_names("motion")), COLOURS, strict=True):
        corruption = CLEAN if name == "clean" else Corruption(name, SEVERITY)
        faulty = motion.with_motion(world, corruption, seed=0)
        poses = [faulty.reset(episode), *(faulty.step(command) for command in commands)]
        draw_path(axes, np.stack([pose[POSE][:2] for pose in poses]), colour, name)
    world.draw(axes)
    axes.set_aspect("equal")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _commands(world: ApartmentsWorld, episode: Episode) -> Iterator[int]:
    """Yield the commands of the expert in an episode, without STOP."""
    world.reset(episode)
    while (action := world.expert().action()) != STOP:
        yield action
        world.step(action)


def _picture(frame: np.ndarray) -> np.ndarray:
    return frame if frame.shape[-1] == 3 else depth_picture(frame[..., 0], 6.0)


def _sheet(rows: Sequence[tuple[list[str], list[np.ndarray]]], size: int = SIZE) -> np.ndarray:
    """Draw rows of pictures with the lines of their names to the left."""
    side = size + GUTTER
    columns = max(len(pictures) for _, pictures in rows)
    sheet = np.full((side * len(rows), LABEL + side * columns, 3), 255, np.uint8)
    for row, (lines, pictures) in enumerate(rows):
        for number, line in enumerate(lines):
            place = (6, row * side + size // 2 + 16 * number)
            cv2.putText(sheet, line, place, FONT, 0.45, (0, 0, 0), 1, cv2.LINE_AA)
        for column, picture in enumerate(pictures):
            left = LABEL + column * side
            sheet[row * side : row * side + size, left : left + size] = picture
    return sheet


def _write_picture(path: Path, sheet: np.ndarray) -> None:
    _, encoded = cv2.imencode(".jpg", sheet[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    write_bytes(path, encoded.tobytes())


if __name__ == "__main__":
    write_page()
    print("Wrote docs/faults.md and its pictures")
