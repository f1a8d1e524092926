"""Tests of the renderer against ray casting: faces, depth, directions and several scenes."""

from __future__ import annotations

import numpy as np
import pytest

from mitigate.core.observation import VIEWS
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.layout import CATEGORIES
from mitigate.worlds.apartments.renderer import EYE, FARTHEST, Renderer
from tools.pages import apartment as show

SIZE = 48
SEEDS = (3, 100_002, 200_005)


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer(SIZE)


def pose(apartment: Apartment, number: int) -> tuple[float, float, float]:
    rng = np.random.default_rng([apartment.seed, number])
    x, y = apartment.space.centre(int(rng.integers(len(apartment.space.cells))))
    return float(x), float(y), float(rng.uniform(-np.pi, np.pi))


def rays(heading: float, view: int) -> np.ndarray:
    """Return the vectors [S * S, 3] from the camera to the pixel centres at a depth of 1 m."""
    row, column = np.mgrid[0:SIZE, 0:SIZE]
    up, right = 1 - (2 * row + 1) / SIZE, (2 * column + 1) / SIZE - 1
    yaw = heading - np.radians(30 * view)
    ahead, aside = (-np.sin(yaw), np.cos(yaw)), (np.cos(yaw), np.sin(yaw))
    parts = [ahead[0] + right * aside[0], ahead[1] + right * aside[1], up]
    return np.stack(parts, -1).reshape(-1, 3)


def cast(corners: np.ndarray, eye: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the distance and index of the nearest visible rectangle for every ray."""
    metres, hit = np.full(len(directions), np.inf), np.full(len(directions), -1)
    for index, (a, b, c, d) in enumerate(corners.astype(np.float64)):
        normal = np.cross(b - a, d - a)
        facing = directions @ normal
        with np.errstate(all="ignore"):
            t = ((a - eye) @ normal) / facing
            offset = eye + t[:, None] * directions - a
            u = offset @ (b - a) / ((b - a) @ (b - a))
            v = offset @ (d - a) / ((d - a) @ (d - a))
            inside = (facing < 0) & (t > 0.1) & (u >= 0) & (u <= 1) & (v >= 0) & (v <= 1)
        assert np.allclose(c, b + d - a, atol=1e-5)
        nearer = inside & (t < metres)
        metres[nearer], hit[nearer] = t[nearer], index
    return metres, hit


def inner(hit: np.ndarray) -> np.ndarray:
    """Return a mask of the pixels whose 8 neighbours show the same face."""
    grid = hit.reshape(SIZE, SIZE)
    same = np.zeros_like(grid, bool)
    neighbours = [np.roll(grid, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    same[1:-1, 1:-1] = np.all([n == grid for n in neighbours], axis=0)[1:-1, 1:-1]
    return same.ravel()


@pytest.mark.parametrize("seed", SEEDS)
def test_depth_and_ids_equal_ray_casting(renderer, seed):
    apartment = Apartment(seed)
    renderer.load(apartment)
    for number, view in enumerate((0, 4, 7)):
        x, y, heading = pose(apartment, number)
        _, depth, ids = renderer.render(x, y, heading)
        metres, hit = cast(apartment.faces.corners, np.array([x, y, EYE]), rays(heading, view))
        drawn, seen = ids[view].ravel(), depth[view].ravel()
        same = drawn == hit
        assert np.abs(seen - metres)[same].max() < 1e-5
        # The renderer rounds edges to the nearest pixel.
        # Far from the camera, it may confuse two faces that are 1 cm apart.
        assert same.mean() > 0.8
        assert same[inner(hit)].mean() > 0.98


def test_renderer_recovers_every_id(renderer):
    apartment = Apartment(200_005)
    renderer.load(apartment)
    for number in range(4):
        _, _, ids = renderer.render(*pose(apartment, number))
        raw = np.frombuffer(renderer.image.get_ram_image(), np.uint8).reshape(-1, 4 * SIZE, 4)
        codes = raw[3 * SIZE :, :, :3]
        drawn = codes.any(-1)
        assert (codes[drawn] % 8 == 4).all()  # an unblended id colour
        assert drawn.mean() > 0.999 and ids.max() < len(apartment.faces.plane)
        assert (ids < 0).sum() == (~drawn).sum()


def test_labels_name_visible_furniture(renderer):
    apartment = Apartment(3)
    renderer.load(apartment)
    faces = apartment.faces
    for index, piece in enumerate(apartment.furniture):
        categories = {int(c) for c in faces.category[faces.instance == index]}
        assert categories == {CATEGORIES.index(piece.category)}


def test_view_k_faces_30_k_degrees_right(renderer):
    apartment = Apartment(3)
    renderer.load(apartment)
    x, y, heading = pose(apartment, 0)
    rgb, depth, ids = renderer.render(x, y, heading)
    for k in (1, 3, 8):
        # this turns clockwise, which is to the right
        turned = renderer.render(x, y, heading - np.radians(30 * k))
        for before, after in zip((rgb, depth, ids), turned, strict=True):
            assert np.mean(np.roll(before, -k, axis=0) == after) > 0.99


def test_views_overlap_by_30_degrees(renderer):
    apartment = Apartment(3)
    renderer.load(apartment)
    middle, offset = SIZE // 2, np.tan(np.radians(30)) * SIZE / 2
    gaps = {"right": [], "left": []}
    for number in range(5):
        _, depth, _ = renderer.render(*pose(apartment, number))
        metres = depth[:, middle, :, 0]
        for k in range(VIEWS):
            ahead = metres[(k + 1) % VIEWS, middle]
            for side, column in (("right", middle + offset), ("left", middle - offset)):
                gaps[side].append(abs(metres[k, int(column)] / np.cos(np.radians(30)) / ahead - 1))
    assert np.median(gaps["right"]) < 0.05 < 0.2 < np.median(gaps["left"])


def test_first_view_faces_the_heading(renderer):
    """The depth in the middle of view 0 equals the distance to the wall ahead."""
    apartment = Apartment(200_001)
    renderer.load(apartment)
    for number in range(6):
        x, y, _ = pose(apartment, number)
        for heading, (dx, dy) in ((0, (0, 1)), (np.pi / 2, (-1, 0)), (np.pi, (0, -1))):
            _, depth, ids = renderer.render(x, y, heading)
            face = ids[0, SIZE // 2 - 2, SIZE // 2]
            axis, at = apartment.faces.plane[face]
            if axis == (0 if dx else 1):
                expected = (at - x) * dx if dx else (at - y) * dy
                assert expected > 0
                assert depth[0, SIZE // 2 - 2, SIZE // 2, 0] == pytest.approx(expected, rel=0.05)


def test_panorama_is_reproducible_after_other_scenes():
    renderer = Renderer(32, scenes=2)
    apartments = [Apartment(seed) for seed in SEEDS]
    target = pose(apartments[0], 1)
    renderer.load(apartments[0])
    first = renderer.render(*target)
    for again in zip(first, renderer.render(*target), strict=True):
        assert np.array_equal(*again)
    # there are more scenes than the cache holds, so the first scene is built again
    for other in apartments[1:]:
        renderer.load(other)
        assert not np.array_equal(renderer.render(*pose(other, 0))[0], first[0])
    renderer.load(apartments[0])
    for again in zip(first, renderer.render(*target), strict=True):
        assert np.array_equal(*again)


def test_all_renderers_draw_the_same():
    """The order of equally distant faces must not depend on memory addresses."""
    apartments, first, alive = [Apartment(100_000), Apartment(100_001)], None, []
    for _ in range(6):
        alive.append(Renderer(24))
        drawn = []
        for apartment in apartments:
            alive[-1].load(apartment)
            drawn += [alive[-1].render(*pose(apartment, number))[0] for number in range(4)]
        first = first or drawn
        assert all(map(np.array_equal, first, drawn))


def test_depth_lies_within_an_apartment(renderer):
    apartment = Apartment(200_005)
    renderer.load(apartment)
    for number in range(12):
        _, depth, _ = renderer.render(*pose(apartment, number))
        assert depth.min() >= 0 and depth.max() <= FARTHEST and (depth > 0).mean() > 0.999


def test_render_returns_documented_shapes(renderer):
    apartment = Apartment(3)
    renderer.load(apartment)
    rgb, depth, ids = renderer.render(*pose(apartment, 2))
    assert (rgb.shape, rgb.dtype) == ((VIEWS, SIZE, SIZE, 3), np.uint8)
    assert (depth.shape, depth.dtype) == ((VIEWS, SIZE, SIZE, 1), np.float32)
    assert (ids.shape, ids.dtype) == ((VIEWS, SIZE, SIZE), np.int32)


@pytest.mark.parametrize(
    ("setting", "part"),
    [
        ("size=0", "at least 4 pixels"),
        ("size=-3", "a whole number"),
        ("seed=x", "a whole number"),
    ],
)
def test_show_explains_an_invalid_setting(setting, part, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["apartments", "show", setting])
    with pytest.raises(SystemExit):
        show.main()
    assert part in capsys.readouterr().err
