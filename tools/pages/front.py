"""Create the pictures at the top of the README: ``python -m tools.pages.front``.

``docs/pictures/corrupted.jpg`` shows corruptions of the example frames that the package ships.
``docs/pictures/episode.gif`` shows two agents in the same episode, with the same foreign object on
the lens.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

import mitigate
from mitigate.core.files import write_figure
from mitigate.core.observation import POSE, RGB, Observation
from mitigate.core.pictures import depth_picture, draw_path, strip
from mitigate.corruptions import Corruption, Key, corrupt, example_depth, example_rgb
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.episodes import Episode, from_vlnce, read_episodes
from mitigate.worlds.world import Corrupted

PICTURES = Path(__file__).resolve().parents[2] / "docs/pictures"
SEVERITY = 0.6
RGB_NAMES = ("motion_blur", "spatter", "foreign_object")
DEPTH_NAMES = ("gaussian_noise", "missing_data", "multipath")
EPISODES = "mitigate/worlds/apartments/episodes/val_unseen_vln.json.gz"
AGENTS = {"base agent": "checkpoints/base", "after `harden`": "checkpoints/hardened/harden"}
# font size in points; smaller labels of the floor plan are not legible in the animation
SMALL_TEXT = 8
FRAMES, MILLISECONDS = 36, 160  # number of pictures in the animation, and the duration of each
PAPER, INK = "#21252b", "#ebebeb"  # as in tools/pages/gallery.py
COLOURS = ("#d55e00", "#0072b2")  # colours that colour-blind readers can distinguish


def draw_corrupted(path: Path) -> None:
    """Plot the example photograph and the example depth image, each clean and under three
    corruptions.
    """
    key = Key(seed=0, episode="demo", frame=0)
    figure = Figure(figsize=(12, 5), layout="constrained")
    axes = figure.subplots(2, 4)
    depth = example_depth()
    far = float(depth.max())
    rows = (
        (example_rgb(), ("clean RGB", *RGB_NAMES), lambda frame: frame),
        (depth, ("clean depth", *DEPTH_NAMES), lambda frame: depth_picture(frame[..., 0], far)),
    )
    for row, (frame, names, picture) in zip(axes, rows, strict=True):
        for axis, name in zip(row, names, strict=True):
            clean = name.startswith("clean")
            image = frame if clean else corrupt(frame, name, SEVERITY, key=key)
            axis.imshow(picture(image))
            axis.set_title(name if clean else name.replace("_", " "), fontsize=14, color=INK)
            axis.axis("off")
    write_figure(path, figure, dpi=80, facecolor=PAPER)


def record(agent_folder: str, episode: Episode) -> tuple[list[Observation], bool]:
    """Run one corrupted episode; return its observations, and whether the agent succeeded."""
    agent = mitigate.load(agent_folder)
    world = Corrupted(ApartmentsWorld(), Corruption("foreign_object", SEVERITY), seed=0)
    observations = [world.reset(episode)]
    agent.reset(episode.instruction.text)
    while not world.done:
        observations.append(world.step(agent.act(observations[-1])))
    return observations, bool(world.measures()["success"])


def first_contrast() -> tuple[Episode, list[list[Observation]]]:
    """Return the first episode in which only the hardened agent succeeds, and the observations of
    both agents.
    """
    for episode in read_episodes(EPISODES):
        runs = [record(folder, episode) for folder in AGENTS.values()]
        if [success for _, success in runs] == [False, True]:
            return episode, [observations for observations, _ in runs]
    raise ValueError("No episode separates the two agents.")


def animation_frames() -> Iterator[np.ndarray]:
    """Yield the pictures of the animation, with each agent's view and its path on the floor
    plan."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    episode, runs = first_contrast()
    world = ApartmentsWorld()
    world.reset(episode)
    goal = from_vlnce(episode.goals[0].position)
    longest = max(len(run) for run in runs)
    for step in np.linspace(0, longest - 1, FRAMES).round().astype(int):
        figure = Figure(figsize=(8, 4.3), layout="constrained", dpi=80)
        axes = figure.subplots(2, 2, height_ratios=(1, 4))
        for column, (name, run) in enumerate(zip(AGENTS, runs, strict=True)):
            now = min(step, len(run) - 1)
            view, plan = axes[0, column], axes[1, column]
            view.imshow(strip(run[now][RGB]))
            view.axis("off")
            ended = ("", ": stopped too early", ": reached the goal")[
                (now == len(run) - 1) * (1 + column)
            ]
            view.set_title(name.replace("`", "") + ended, fontsize=12)
            world.draw(plan)
            for text in [text for text in plan.texts if text.get_fontsize() < SMALL_TEXT]:
                text.remove()
            draw_path(plan, [o[POSE][:2] for o in run[: now + 1]], COLOURS[column])
            plan.plot(*goal, "*", color="#ffbf00", mec="black", ms=15, zorder=9)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        yield np.asarray(canvas.buffer_rgba())[..., :3]


def draw_episode(path: Path) -> None:
    """Write the animation."""
    pictures = [
        Image.fromarray(picture).quantize(128, Image.Quantize.FASTOCTREE)
        for picture in animation_frames()
    ]
    # the last picture is repeated as a pause before the animation starts again
    last = [pictures[-1]] * 8
    pictures[0].save(
        path, save_all=True, append_images=[*pictures[1:], *last], duration=MILLISECONDS, loop=0
    )


if __name__ == "__main__":
    draw_corrupted(PICTURES / "corrupted.jpg")
    draw_episode(PICTURES / "episode.gif")
