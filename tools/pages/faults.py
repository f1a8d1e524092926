"""The page ``docs/faults.md`` and its pictures: faults of time.

python -m tools.pages.faults
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from mitigate.core.conf import load_config
from mitigate.core.files import write_bytes
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.pictures import depth_picture
from mitigate.corruptions import CLEAN, Corruption, registry
from mitigate.evaluation import config  # noqa: F401 - registers the types of conf/evaluate.yaml
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.tasks import make_episode
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.world import Corrupted, World
from tools.pages.corruptions import formulas

DOCS = Path(__file__).resolve().parents[2] / "docs"
APARTMENT, SIZE = 200021, 72  # the apartment of the other pages; pixels of a view
FRAMES = 16  # instants per row
SEVERITY = 0.6
LABEL, GUTTER = 190, 3  # pixels: names of rows, between cells
JPEG_QUALITY = 80
FONT = cv2.FONT_HERSHEY_SIMPLEX
TIMELINE = "pictures/faults-temporal.jpg"
TEXT = """# Faults

Corruptions of the [standard suite](corruptions.md) act on single frames. Robots also fail over
time. A fault has a severity s from 0 (no fault) to 1, a key and its own version in result rows,
as an [unseen corruption](unseen-corruptions.md). Faults are not part of `suite=full` or
`suite=all`, and no recipe trains on them.

```bash
make evaluate ARGS="checkpoint=checkpoints/base suite=temporal"
```

Each family has its own table in the results. `python -m tools.pages.faults` writes this page and
its pictures.

## Time

![One view of {frames} steps, clean and under each temporal fault]({timeline})

The forward view at {frames} steps in apartment {apartment}, at s = {severity:g}. The last rows
show depth.

{temporal}
- A **frame** is an observation of the sequence: a step of `mitigate evaluate` (0.25 m or 15
  degrees in the apartments and in Habitat), also a step at which the agent reads no frames; a
  step of a gymnasium or torchrl environment; a file of a folder; a call of the agent's sensors
  under `mitigate run`.
- All views of a panorama and both sensors fail together, except under `depth_lag` and
  `exposure_flicker`. With one sensor, the fault affects that sensor. The pose is never delayed.
- In a pair, a late frame is corrupted as when it was taken: `low_light_noise+frame_delay` shows
  old noise on an old picture. The order does not matter.
- A frame of an interval is lost at every higher severity too, so the fault grows with s.
- Rows do not depend on resume, workers and parallel episodes: the frames are a function of the
  key and the earlier frames of the episode.

## Where they work

| entry point | temporal |
|---|---|
| `mitigate evaluate`, `mitigate.benchmark`, `mitigate replay` | yes |
| `mitigate run` | yes |
| `mitigate corrupt` | yes; a resumed run reads all files again |
| gymnasium wrapper, torchrl transform in an environment | yes, with a `Corruption` |
| torchrl transform in a replay buffer, `corrupt_habitat` | no: an error says why |
| schedules of trainings, habitat-baselines | no: an error says why |

In Python, a `FrameStream` corrupts the observations of a sequence in order:

```python
import numpy as np
from mitigate.corruptions import Corruption, FrameStream, Key

stream = FrameStream()
frozen = Corruption("frozen_frame", 0.6)
for step in range(20):
    observation = {{"rgb": np.full((64, 64, 3), step, np.uint8)}}
    corrupted = stream.corrupt(observation, frozen, Key(seed=0, episode="17", frame=step))
```
"""


def write_page(folder: Path = DOCS) -> None:
    """Write the page and its pictures into ``folder``."""
    _write_picture(folder / TIMELINE, timeline())
    text = TEXT.format(
        frames=FRAMES,
        timeline=TIMELINE,
        apartment=APARTMENT,
        severity=SEVERITY,
        temporal=formulas(registry.fault_names("temporal")),
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
    """Return the forward views of an episode that the expert walks."""
    world = ApartmentsWorld(SIZE, views=1)
    return [_picture(obs[entry]) for obs in _walk(world, Corrupted(world, corruption, seed=0))]


def _walk(world: ApartmentsWorld, corrupted: World) -> Iterator:
    """Yield the observations of ``FRAMES`` steps of the expert."""
    observation = corrupted.reset(make_episode(Apartment(APARTMENT), "vln", 0))
    for _ in range(FRAMES):
        yield observation
        observation = corrupted.step(world.expert().action())


def _picture(frame: np.ndarray) -> np.ndarray:
    return frame if frame.shape[-1] == 3 else depth_picture(frame[..., 0], 6.0)


def _sheet(rows: list[tuple[list[str], list[np.ndarray]]]) -> np.ndarray:
    """Draw rows of pictures with the lines of their names to the left."""
    side = SIZE + GUTTER
    columns = max(len(pictures) for _, pictures in rows)
    sheet = np.full((side * len(rows), LABEL + side * columns, 3), 255, np.uint8)
    for row, (lines, pictures) in enumerate(rows):
        for number, line in enumerate(lines):
            place = (6, row * side + SIZE // 2 + 16 * number)
            cv2.putText(sheet, line, place, FONT, 0.45, (0, 0, 0), 1, cv2.LINE_AA)
        for column, picture in enumerate(pictures):
            left = LABEL + column * side
            sheet[row * side : row * side + SIZE, left : left + SIZE] = picture
    return sheet


def _write_picture(path: Path, sheet: np.ndarray) -> None:
    _, encoded = cv2.imencode(".jpg", sheet[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    write_bytes(path, encoded.tobytes())


if __name__ == "__main__":
    write_page()
    print("Wrote docs/faults.md and its pictures")
