"""RGB-D views a second: the renderer of ``apartments`` against MiniWorld.

Both renderers run in this process, in turns, at the same size, and give an RGB and a depth image of
each view; the best round of each counts, so that a busy machine disturbs less. MiniWorld draws
through pyglet and EGL (Mesa's llvmpipe where there is no GPU, on all cores); ours on one core.
"""

from __future__ import annotations

import contextlib
import io
import itertools
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from mitigate.core.observation import VIEWS
from mitigate.core.seeding import generator
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.renderer import Renderer

ROUNDS = 4
OURS = "apartments"
SCENES = ("Maze", "FourRooms")  # many rooms as ours have, and four bare ones
_POSES = 40  # of MiniWorld's agent


def ours(size: int) -> Callable[[], int]:
    """A function that renders a panorama at a random free pose and returns its number of views."""
    apartment, renderer = Apartment(7), Renderer(size)
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
            "with `pip install -e '.[bench]'`; it draws with libEGL, libGL and libGLU of the "
            "system (Debian: libegl1 libgl1 libglu1-mesa libgl1-mesa-dri)."
        )
        return {}
