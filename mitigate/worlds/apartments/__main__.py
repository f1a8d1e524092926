"""Look at the world: ``python -m mitigate.worlds.apartments show seed=7`` writes a picture.

``seed`` is the apartment's seed (0-99999 training, 100000- val_seen, 200000- val_unseen),
``episode`` the number of the episode in it, ``task`` vln or ogn, ``size`` pixels of a view.
"""

from __future__ import annotations

import argparse
import textwrap
from pathlib import Path

import numpy as np

from mitigate.core.files import write_figure
from mitigate.core.observation import DEPTH, RGB
from mitigate.core.pictures import draw_path, strip
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.drawing import draw_plan
from mitigate.worlds.apartments.simulator import Simulator
from mitigate.worlds.apartments.tasks import TASKS, make_episode
from mitigate.worlds.episodes import from_vlnce


def show(seed: int, episode: int, task: str, size: int, out: Path) -> None:
    """Write a PNG with the panorama, its depth, the reference path on the plan and the text."""
    from matplotlib.figure import Figure

    drawn = make_episode(Apartment(seed), task, episode)
    simulator = Simulator(size)
    simulator.reset(drawn)
    observation = simulator.observe()
    figure = Figure(figsize=(10, 11.5), layout="constrained")
    axes = figure.subplots(3, 1, height_ratios=(1, 1, 3.2))
    axes[0].imshow(strip(observation[RGB]))
    axes[0].set_title(
        f"panorama at the start, straight ahead in the middle ({drawn.scene_id})",
        fontsize=10,
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
    figure.suptitle("\n".join(textwrap.wrap(drawn.instruction.text, 100)), fontsize=11)
    write_figure(out, figure, dpi=80, facecolor="white")
    print(
        f"{drawn.episode_id}: {drawn.geodesic_distance:.1f} m. {drawn.instruction.text}\n"
        f"wrote {out}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m mitigate.worlds.apartments",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("command", choices=["show"])
    parser.add_argument(
        "settings",
        nargs="*",
        metavar="key=value",
        help="seed=7 episode=0 task=vln size=192 out=runs/show/vln-7-0.png",
    )
    args = parser.parse_args()
    values = {"seed": "7", "episode": "0", "task": "vln", "size": "192", "out": ""}
    for setting in args.settings:
        key, _, value = setting.partition("=")
        if key not in values or not value:
            parser.error(
                f"{setting!r} is not a setting; write key=value with a key of {', '.join(values)}"
            )
        values[key] = value
    for key in ("seed", "episode", "size"):
        if not values[key].removeprefix("-").isdecimal():
            parser.error(f"{key}={values[key]} has the wrong type: it must be a whole number")
    if values["task"] not in TASKS:
        parser.error(f"task={values['task']} is unknown; choose one of {', '.join(TASKS)}")
    out = Path(
        values["out"] or f"runs/show/{values['task']}-{values['seed']}-{values['episode']}.png"
    )
    try:
        show(int(values["seed"]), int(values["episode"]), values["task"], int(values["size"]), out)
    except ValueError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
