"""Compare the renderer of ``apartments`` with MiniWorld in RGB-D views per second.

Both renderers run alternately in this process, at the same size, and return an RGB and a depth
image of each view. Only the best round of each renderer counts, which reduces the influence of
other programs. MiniWorld renders with pyglet and EGL; without a GPU, EGL uses Mesa's llvmpipe on
all cores. ``apartments`` renders on one core.
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
# an environment with many rooms, like apartments, and an environment with four empty rooms
SCENES = ("Maze", "FourRooms")
_POSES = 40  # number of random poses of MiniWorld's agent


def ours(size: int) -> Callable[[], int]:
    """Return a function that renders a panorama at a random free pose.

    The returned function returns the number of views that it rendered.
    """
    apartment = Apartment(7)
    renderer = Renderer(size)
    renderer.load(apartment)
    space = apartment.space
    rng = generator("bench", "apartments")

    def panorama() -> int:
        x, y = space.centre(int(rng.integers(len(space.cells))))
        renderer.render(float(x), float(y), float(rng.uniform(-np.pi, np.pi)))
        return VIEWS

    return panorama


def miniworld(scene: str, size: int) -> dict[str, Callable[[], int]]:
    """Return two functions that each render one view of a MiniWorld scene.

    The first function uses the public calls ``render_obs`` and ``render_depth``, which render a
    view twice. The second function renders a view once and reads RGB and depth from it, for which
    MiniWorld has no public call. MiniWorld stores every scene in OpenGL's display list 1, so only
    the scene that was opened last can be rendered.

    Raises:
        ImportError: If MiniWorld is not installed. If system libraries are missing, pyglet raises
            other errors.
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

    # the near and far clipping planes of render_obs
    read = partial(world.obs_fb.get_depth_map, 0.04, 100.0)
    return {
        f"MiniWorld {scene}, its public calls": partial(view, world.render_depth),
        f"MiniWorld {scene}, rendered once": partial(view, read),
    }


def _placed(world: Any) -> tuple[np.ndarray, float]:
    world.place_agent()
    return world.agent.pos.copy(), world.agent.dir


def views_per_second(draw: Callable[[], int], seconds: float) -> tuple[float, float]:
    """Return views per second of wall time, and of CPU time of all threads."""
    wall = time.perf_counter()
    cpu = time.process_time()
    views = 0
    while time.perf_counter() - wall < seconds:
        views += draw()
    return views / (time.perf_counter() - wall), views / (time.process_time() - cpu)


def compare(size: int, seconds: float) -> dict[str, tuple[float, float]]:
    """Return the best round of each renderer, with MiniWorld only if it is installed."""
    this_package = {OURS: ours(size)}
    best: dict[str, tuple[float, float]] = {}
    for scene in SCENES:
        drawers = this_package | _try_miniworld(scene, size)
        for draw in drawers.values():
            views_per_second(draw, 0.2)
        for _, (name, draw) in itertools.product(range(ROUNDS), drawers.items()):
            rate = views_per_second(draw, seconds)
            best[name] = max(best.get(name, rate), rate)
    return best


def _try_miniworld(scene: str, size: int) -> dict[str, Callable[[], int]]:
    """Return the functions of :func:`miniworld`; print the reason if they are not available."""
    try:
        return miniworld(scene, size)
    except Exception as error:  # pyglet, EGL or the driver may raise any error
        print(
            f"MiniWorld's {scene} is not measured: {type(error).__name__}: {error}. Install it "
            "with `pip install -e '.[bench]'`. It needs libEGL, libGL and libGLU of the system "
            "(Debian: libegl1 libgl1 libglu1-mesa libgl1-mesa-dri)."
        )
        return {}
