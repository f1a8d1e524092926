"""Draw an apartment: ``python -m tools.pages.apartment show seed=7`` writes a picture.

seed     seed of the apartment (0-99999 train, 100000- val_seen, 200000- val_unseen; default 7)
episode  index of the episode in it (default 0)
task     vln (default) or ogn
size     pixels of a view (default 192)
out      the picture (default runs/show/<task>-<seed>-<episode>.png)
"""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mitigate.core.files import write_figure
from mitigate.core.names import unknown
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.options import asks_help, paths_and_options
from mitigate.core.pictures import draw_path, strip
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.drawing import draw_plan
from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.apartments.tasks import TASKS, make_episode
from mitigate.worlds.episodes import from_vlnce


def show(seed: int, episode: int, task: str, size: int, out: Path) -> None:
    """Write a PNG with the panorama, its depth, the floor plan with the reference path, and the
    instruction.
    """
    from matplotlib.figure import Figure

    drawn = make_episode(Apartment(seed), task, episode)
    simulator = Simulator(size)
    simulator.reset(drawn)
    observation = simulator.observe()
    figure = Figure(figsize=(9, 13.5), layout="constrained")
    axes = figure.subplots(3, 1, height_ratios=(1, 1, 4))
    axes[0].imshow(strip(observation[RGB]))
    axes[0].set_title(
        f"panorama at the start, straight ahead in the middle ({drawn.scene_id})",
        fontsize=11,
    )
    depth = axes[1].imshow(strip(observation[DEPTH])[..., 0], cmap="viridis_r")
    figure.colorbar(depth, ax=list(axes[:2]), label="depth [m]", fraction=0.03, pad=0.01)
    for axis in axes[:2]:
        axis.axis("off")
    draw_plan(axes[2], simulator.apartment)
    draw_path(
        axes[2],
        np.stack([from_vlnce(p) for p in drawn.reference_path]),
        "#d62728",
        "reference path",
    )
    arrow = 0.6 * np.array([-np.sin(simulator.heading), np.cos(simulator.heading)])
    axes[2].arrow(*simulator.xy, *arrow, width=0.05, color="#1f77b4", zorder=8)
    figure.suptitle("\n".join(textwrap.wrap(drawn.instruction.text, 90)), fontsize=12)
    write_figure(out, figure, dpi=90, facecolor="white")
    print(
        f"{drawn.episode_id}: {drawn.geodesic_distance:.1f} m. {drawn.instruction.text}\n"
        f"wrote {out}"
    )


DEFAULTS = {"seed": "7", "episode": "0", "task": "vln", "size": "192", "out": ""}


def parse(arguments: Sequence[str]) -> tuple[int, int, str, int, Path]:
    """Return the arguments of :func:`show`; raise ValueError for invalid options."""
    (command,), options = paths_and_options(arguments, ("show",), DEFAULTS)
    if command != "show":
        raise ValueError(unknown("command", command, ["show"]))
    values = {**DEFAULTS, **options}
    for name in ("seed", "episode", "size"):
        if not values[name].isdecimal():
            raise ValueError(f"{name} must be a whole number >= 0, got {values[name]!r}.")
    task = values["task"]
    if task not in TASKS:
        raise ValueError(unknown("task", task, TASKS))
    out = values["out"] or f"runs/show/{task}-{values['seed']}-{values['episode']}.png"
    return int(values["seed"]), int(values["episode"]), task, int(values["size"]), Path(out)


def main() -> None:
    """Run from the command line."""
    arguments = sys.argv[1:]
    if asks_help(arguments):
        print(__doc__)
        sys.exit(0 if arguments else 2)
    try:
        show(*parse(arguments))
    except ValueError as error:
        print(f"apartments: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
