"""Measure the renderer against MiniWorld, and the corruptions: ``make bench``.

Both renderers run in this process, in turns, at the same size, and give an RGB and a depth image of
each view; the best round of each counts, so that a busy machine disturbs less. MiniWorld draws
through pyglet and EGL (Mesa's llvmpipe where there is no GPU, on all cores); ours on one core.
``--write`` puts the tables into ``docs/benchmarks.md``.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import itertools
import os
import platform
import time
from collections.abc import Callable
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.corruptions import NAMES, SUITE_VERSION, Key, corrupt
from mitigate.corruptions.suite import RGB as RGB_NAMES
from mitigate.envs.apartments.apartment import Apartment
from mitigate.envs.apartments.renderer import Renderer
from mitigate.keys import VIEWS
from mitigate.seeding import generator

ROUNDS = 4
OURS = "apartments"
SCENES = ("Maze", "FourRooms")  # many rooms as ours have, and four bare ones
SEVERITY = 0.6  # the paper's for R2R
PAGE = Path(__file__).parent.parent / "docs" / "benchmarks.md"
_POSES = 40  # of MiniWorld's agent
_FRAMES = 7  # panoramas whose corruption is timed


def ours(size: int, pipe: str = "p3tinydisplay") -> Callable[[], int]:
    """A function that renders a panorama at a random free pose and returns its number of views."""
    apartment, renderer = Apartment(7), Renderer(size, pipe)
    renderer.load(apartment)
    space, rng = apartment.space, generator("bench", "apartments")

    def panorama() -> int:
        x, y = space.centre(int(rng.integers(len(space.cells))))
        renderer.render(float(x), float(y), float(rng.uniform(-np.pi, np.pi)))
        return VIEWS

    return panorama


def miniworld(scene: str, size: int) -> dict[str, Callable[[], int]]:
    """The same for one view of a MiniWorld scene, in two ways.

    Its public calls, ``render_obs`` and ``render_depth``, draw a view twice; no public call draws
    it once and reads both images, as the second way does. Only the scene opened last can be drawn:
    MiniWorld keeps each in OpenGL's display list 1. Raises ImportError if the package is missing,
    and what pyglet raises if the libraries that it draws with are.
    """
    import pyglet

    pyglet.options["headless"] = True
    from miniworld import envs

    with contextlib.redirect_stdout(io.StringIO()):
        world = getattr(envs, scene)(obs_width=size, obs_height=size)
    world.reset(seed=0)
    poses = itertools.cycle([_placed(world) for _ in range(_POSES)])

    def view(depth: Callable[[], np.ndarray]) -> int:
        world.agent.pos, world.agent.dir = next(poses)
        world.render_obs()
        depth()
        return 1

    read = partial(world.obs_fb.get_depth_map, 0.04, 100.0)  # the planes of render_obs
    return {
        f"MiniWorld {scene}, its public calls": partial(view, world.render_depth),
        f"MiniWorld {scene}, drawn once": partial(view, read),
    }


def _placed(world: Any) -> tuple[np.ndarray, float]:
    world.place_agent()
    return world.agent.pos.copy(), world.agent.dir


def views_per_second(draw: Callable[[], int], seconds: float) -> tuple[float, float]:
    """Views a second of wall time, and of CPU time of all threads, over about ``seconds``."""
    wall, cpu, views = time.perf_counter(), time.process_time(), 0
    while time.perf_counter() - wall < seconds:
        views += draw()
    return views / (time.perf_counter() - wall), views / (time.process_time() - cpu)


def compare(size: int, seconds: float) -> dict[str, tuple[float, float]]:
    """Best round of each renderer, taken in turns; MiniWorld only if it is there."""
    mine = {OURS: ours(size)}
    best: dict[str, tuple[float, float]] = {}
    for scene in SCENES:
        drawers = mine | _miniworld_or_reason(scene, size)
        for draw in drawers.values():
            views_per_second(draw, 0.2)
        for _, (name, draw) in itertools.product(range(ROUNDS), drawers.items()):
            found = views_per_second(draw, seconds)
            best[name] = max(best.get(name, found), found)
    return best


def _miniworld_or_reason(scene: str, size: int) -> dict[str, Callable[[], int]]:
    try:
        return miniworld(scene, size)
    except Exception as error:  # whatever pyglet, EGL or the driver raise
        print(
            f"MiniWorld's {scene} is not measured: {type(error).__name__}: {error}. Install it "
            "with `pip install -e .[bench]`; it draws with libEGL, libGL and libGLU of the system "
            "(Debian: libegl1 libgl1 libglu1-mesa libgl1-mesa-dri)."
        )
        return {}


def corruption_milliseconds(size: int) -> dict[str, tuple[float, float]]:
    """Milliseconds to corrupt one rendered panorama at ``SEVERITY``, best of ``_FRAMES``: in the
    course of an episode, and when every frame draws a new one (the per-frame schedule)."""
    apartment, renderer = Apartment(7), Renderer(size)
    renderer.load(apartment)
    x, y = apartment.space.centre(len(apartment.space.cells) // 2)
    rgb, depth, _ = renderer.render(float(x), float(y), 0.3)
    frames = {name: rgb if name in RGB_NAMES else depth for name in NAMES}
    return {
        name: (_fastest(name, frame, False), _fastest(name, frame, True))
        for name, frame in frames.items()
    }


def _fastest(name: str, frame: np.ndarray, fresh: bool) -> float:
    times = []
    for number in range(_FRAMES):  # the first call compiles
        key = Key(0, f"bench {number}" if fresh else "bench", number)
        started = time.perf_counter()
        corrupt(frame, name, SEVERITY, key=key, heading=0.3)
        times.append(1e3 * (time.perf_counter() - started))
    return min(times)


def machine() -> str:
    """Processor, cores, load, Python and date of this measurement."""
    names = [
        line.split(":")[1].strip()
        for line in _lines("/proc/cpuinfo")
        if line.startswith("model name")
    ]
    processor = names[0] if names else platform.processor() or platform.machine()
    software = f"load {os.getloadavg()[0]:.1f}, Python {platform.python_version()}"
    return f"{processor}, {os.cpu_count()} cores, {software}, {date.today()}"


def _lines(path: str) -> list[str]:
    try:
        return Path(path).read_text().splitlines()
    except OSError:
        return []


def report(
    size: int, rates: dict[str, tuple[float, float]], times: dict[str, tuple[float, float]]
) -> str:
    """The measurements as Markdown."""
    lines = ["# Benchmarks", "", f"`make bench` on {machine()}.", ""]
    lines += [f"## RGB-D rendering, {size} x {size} pixels", ""]
    lines += ["One process, one run, in turns; the best of several rounds.", ""]
    lines += [
        "| renderer | RGB-D views/s | per CPU second | panoramas (12 views)/s | ours is faster |",
        "| --- | --- | --- | --- | --- |",
    ]
    fastest = rates[OURS][0]
    lines += [
        f"| {name} | {wall:.0f} | {cpu:.0f} | {wall / VIEWS:.0f} | {fastest / wall:.1f} times |"
        for name, (wall, cpu) in rates.items()
    ]
    lines += [
        "",
        f"## Corruptions, suite {SUITE_VERSION}, severity {SEVERITY}",
        "",
        f"One panorama, 12 x {size} x {size}.",
        "",
    ]
    lines += [
        "| corruption | ms a panorama | ms if each starts an episode |",
        "| --- | --- | --- |",
    ]
    lines += [f"| {name} | {same:.2f} | {new:.2f} |" for name, (same, new) in times.items()]
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=64, help="pixels of a view (default 64)")
    parser.add_argument(
        "--seconds", type=float, default=1.0, help="of a round of each renderer (default 1)"
    )
    parser.add_argument("--write", action="store_true", help="write docs/benchmarks.md")
    args = parser.parse_args()
    text = report(args.size, compare(args.size, args.seconds), corruption_milliseconds(args.size))
    print(text)
    if args.write:
        PAGE.write_text(text, encoding="utf-8")
        print(f"wrote {PAGE.relative_to(PAGE.parent.parent)}")


if __name__ == "__main__":
    main()
