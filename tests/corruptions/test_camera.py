"""Tests of faults of the camera's mounting: their geometry, and their agreement with the
renderer."""

from __future__ import annotations

import math
from dataclasses import astuple, replace
from types import SimpleNamespace

import numpy as np
import pytest

from mitigate.bridge.cameras import Rig
from mitigate.bridge.condition import why_not_applicable
from mitigate.core import conf
from mitigate.core.observation import DEPTH, RGB
from mitigate.corruptions import (
    Corruption,
    DepthSensor,
    FrameStream,
    Key,
    corrupt,
    corrupt_normalised,
    corrupt_observation,
    folders,
    frame_files,
    registry,
)
from mitigate.corruptions.faults.camera import (
    FOV,
    HEIGHT,
    PITCH,
    ROLL,
    YAW,
    Mount,
    random_mount,
    warp,
)
from mitigate.corruptions.folders import Settings
from mitigate.corruptions.stream import mount_of
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.tasks import make_episode
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.world import Corrupted, World

NAMES = registry.fault_names("camera")
WARPED = NAMES[1:]  # without camera_height
KEY = Key(3, "episode", 4)
HFOV = {RGB: 90.0, DEPTH: 90.0}
EPISODE = make_episode(Apartment(200021), "vln", 0)


@pytest.fixture(scope="module")
def world() -> ApartmentsWorld:
    return ApartmentsWorld(48)


@pytest.fixture
def clean(world) -> dict[str, np.ndarray]:
    return dict(world.reset(EPISODE))


def test_suite_lists_every_fault():
    suite = conf.load_config("evaluate", ["suite=camera"]).suite.conditions
    assert suite == ["clean", *NAMES] and all(registry.version(name) for name in NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_fault_is_the_identity_at_zero_and_grows_with_severity(name, clean):
    same = FrameStream(hfov=HFOV).corrupt(clean, Corruption(name, 0.0), KEY)
    assert all(np.array_equal(same[entry], clean[entry]) for entry in (RGB, DEPTH))
    half, full = (mount_of(Corruption(name, severity), KEY) for severity in (0.5, 1.0))
    assert sum(map(abs, vars(half).values())) > 0
    assert all(math.isclose(2 * getattr(half, f), getattr(full, f)) for f in vars(full))
    later = mount_of(Corruption(name, 0.5), replace(KEY, frame=9))
    assert later == half  # constant in the episode
    signs = {sum(vars(mount_of(Corruption(name, 1.0), Key(s, "e"))).values()) > 0 for s in range(9)}
    assert signs == {True, False}


def test_rotation_turns_the_forward_axis_as_documented():
    right, forward, up = np.eye(3)
    assert (Mount(yaw=90).rotation() @ forward).tolist() == (-right).tolist()  # left
    assert (Mount(pitch=90).rotation() @ forward).tolist() == up.tolist()
    assert (Mount(roll=90).rotation() @ up).tolist() == right.tolist()  # clockwise


@pytest.mark.parametrize(
    "mount",
    [
        Mount(pitch=15.0),
        Mount(roll=-12.0),
        Mount(yaw=20.0),
        Mount(fov=-20.0),
        Mount(fov=18.0),
        Mount(pitch=-10.0, roll=5.0, yaw=8.0, fov=10.0),
    ],
    ids=str,
)
def test_warped_panorama_agrees_with_the_renderer(mount, world, clean):
    rendered = world.displaced(mount)
    rgb = warp(clean[RGB], mount, 90.0)
    depth = warp(clean[DEPTH][..., 0], mount, 90.0, DepthSensor())[..., None]
    seen = warp(np.ones(depth.shape[:3], np.float32), mount, 90.0, DepthSensor())[..., None] > 0
    assert seen.mean() > 0.3 and (mount == Mount(fov=-20.0)) == bool(seen.all())
    assert np.median(np.abs(depth - rendered[DEPTH])[seen]) < 0.02
    assert (np.abs(depth - rendered[DEPTH])[seen] > 0.1).mean() < 0.06  # edges: nearest neighbour
    assert np.median(np.abs(rgb.astype(int) - rendered[RGB])[seen[..., 0]]) <= 2
    assert not rgb[~seen[..., 0]].any()  # lost borders


def test_renderer_shows_the_height(world, clean):
    low, high = (world.displaced(Mount(height=metres))[DEPTH] for metres in (-0.6, 0.6))
    # at the lower edge of the view, 45 degrees down, the depth of the floor is the camera's height
    below = np.s_[:, -1, 24, 0]
    # the centre of the last of 48 rows is half a pixel above the lower edge of the view
    edge = 48 / 47
    floor = np.isclose(clean[DEPTH][below], 1.25 * edge, atol=1e-3)
    assert floor.sum() >= 3
    assert np.allclose(low[below][floor], 0.65 * edge, atol=1e-3)
    assert np.isclose(high[below], 1.85 * edge, atol=1e-3).sum() >= 3  # or furniture behind


def test_rendered_world_returns_to_the_level_camera(world, clean):
    world.displaced(Mount(0.3, 10.0, 5.0, 7.0, 20.0))
    assert all(np.array_equal(world.reset(EPISODE)[e], clean[e]) for e in (RGB, DEPTH))


@pytest.mark.parametrize("name", NAMES)
def test_corrupted_world_renders_the_fault(name, world, clean):
    corruption = Corruption(name, 0.6)
    observation = Corrupted(world, corruption, 3).reset(EPISODE)
    mount = mount_of(corruption, Key(3, EPISODE.episode_id))
    expected = world.displaced(mount)
    assert all(np.array_equal(observation[entry], expected[entry]) for entry in (RGB, DEPTH))
    assert np.array_equal(observation.clean[RGB], clean[RGB])
    assert not np.array_equal(observation[RGB], clean[RGB])


def test_camera_fault_is_first_in_a_pair_and_can_be_intermittent(world):
    pair = Corruption("foreign_object+camera_roll", 0.6)
    assert [part.name for part in pair.parts] == ["camera_roll", "foreign_object"]
    observation = Corrupted(world, pair, 3).reset(EPISODE)
    key = Key(3, EPISODE.episode_id)
    rendered = world.displaced(mount_of(pair, key))
    expected = corrupt(rendered[RGB], "foreign_object", 0.6, key=key)
    assert np.array_equal(observation[RGB], expected)
    gated = Corrupted(world, Corruption("intermittent+camera_roll", 0.6), 3)
    states = []
    observation = gated.reset(EPISODE)
    for _ in range(25):
        states.append(np.array_equal(observation[RGB], observation.clean[RGB]))
        observation = gated.step(2)
    assert 5 < sum(states) < 20


def test_world_without_rendering_is_warped():
    class Plain(World):
        rule, done = "none", False

        def __init__(self, hfov):
            self.inner = ApartmentsWorld(32, views=1)
            self.sensors = {n: replace(s, hfov=hfov) for n, s in self.inner.sensors.items()}

        def reset(self, episode):
            return self.inner.reset(episode)

    pitched = Corruption("camera_pitch", 0.6)
    observation = Corrupted(Plain(90.0), pitched, 3).reset(EPISODE)
    key = Key(3, EPISODE.episode_id)
    expected = corrupt_observation(dict(observation.clean), pitched, key, hfov=HFOV)
    assert all(np.array_equal(observation[entry], expected[entry]) for entry in (RGB, DEPTH))
    with pytest.raises(ValueError, match="needs the horizontal field of view"):
        Corrupted(Plain(None), pitched, 3).reset(EPISODE)[RGB]
    with pytest.raises(ValueError, match="can render from a different camera height"):
        Corrupted(Plain(90.0), Corruption("camera_height", 0.6), 3).reset(EPISODE)[RGB]


@pytest.mark.parametrize("name", WARPED)
def test_entry_points_warp_alike(name, clean, tmp_path):
    corruption, key = Corruption(name, 0.6), Key(3, "5-0")
    one = {entry: clean[entry][0] for entry in (RGB, DEPTH)}
    expected = corrupt_observation(one, corruption, key, hfov=HFOV)
    shapes = [(RGB, "uint8"), (DEPTH, "float32")]
    rig = Rig(
        [
            {"name": k, "type": k, "shape": list(one[k].shape), "dtype": d, "hfov": 90}
            for k, d in shapes
        ]
    )
    offsets, size = rig.lay_out((RGB, DEPTH))
    memory = bytearray(size)
    for camera in rig.cameras:
        start = offsets[camera.name]
        memory[start : start + camera.bytes] = np.ascontiguousarray(one[camera.kind]).tobytes()
    rig.corrupt(memory, offsets, corruption, key, None)
    (tmp_path / "in/5-0").mkdir(parents=True)
    np.save(tmp_path / "in/5-0/0.npy", one[DEPTH])
    folders.run(tmp_path / "in", tmp_path / "out", Settings(name, 0.6, seed=3, hfov=90.0))
    for camera in rig.cameras:
        assert np.array_equal(camera.read(memory, offsets), expected[camera.kind])
    stored = frame_files.read(tmp_path / "out/5-0/0.npy", 0.001)
    assert np.array_equal(stored, expected[DEPTH])
    sensor = DepthSensor(0.0, 10.0)
    unit = {DEPTH: np.minimum(one[DEPTH] / 10, 1).astype(np.float32)}
    normalised = corrupt_normalised(unit, corruption, key, sensor, HFOV)[DEPTH]
    assert np.allclose(normalised * 10, np.minimum(expected[DEPTH], 10), atol=1e-3)


def test_files_need_a_field_of_view():
    with pytest.raises(ValueError, match="hfov=90"):
        Settings("camera_yaw", 0.5)
    with pytest.raises(ValueError, match="cannot show another height"):
        Settings("camera_height", 0.5, hfov=90.0)
    with pytest.raises(ValueError, match="hfov must be between 10 and 150"):
        corrupt(np.zeros((4, 4, 3), np.uint8), "camera_yaw", 0.5, key=0, hfov=180.0)


def test_bridge_skips_faults_that_it_cannot_show():
    def reason(name, hfov):
        reports = SimpleNamespace(cameras=[{"type": RGB, "hfov": hfov}], unread=[], first={})
        return why_not_applicable(Corruption(name, 0.6), reports)

    assert reason("camera_roll", 90.0) == reason("frozen_frame", None) == ""
    assert "no hfov" in reason("camera_roll", None)
    assert "another height" in reason("camera_height", 90.0)
    assert reason("depth_lag", 90.0) == "the agent has no depth camera"


def test_wrappers_take_the_field_of_view(clean):
    gymnasium = pytest.importorskip("gymnasium")
    from mitigate.worlds.wrappers import CorruptObservation

    frame = clean[RGB][0]

    class Env(gymnasium.Env):
        action_space = gymnasium.spaces.Discrete(2)
        observation_space = gymnasium.spaces.Box(0, 255, frame.shape, np.uint8)

        def reset(self, *, seed=None, options=None):
            return frame, {}

    corruption = Corruption("camera_fov", 0.6)
    observation, _ = CorruptObservation(Env(), corruption, 3, hfov=90.0).reset(seed=5)
    expected = corrupt(frame, "camera_fov", 0.6, key=Key(3, "5-0"), hfov=90.0)
    assert np.array_equal(observation, expected)
    with pytest.raises(ValueError, match="Pass hfov=DEGREES"):
        CorruptObservation(Env(), corruption, 3).reset(seed=5)


def test_random_mounts_have_one_or_two_faults_within_their_ranges():
    mounts = [random_mount(Key(0, f"e{i}", 0)) for i in range(400)]
    sizes = [sum(value != 0 for value in astuple(mount)) for mount in mounts]
    assert set(sizes) == {1, 2} and 0.2 < sizes.count(2) / len(sizes) < 0.4
    largest = np.abs([astuple(mount) for mount in mounts]).max(0)
    limits = np.array([HEIGHT, PITCH, ROLL, YAW, FOV])
    assert (largest <= limits).all() and (largest > 0.9 * limits).all()
    assert random_mount(Key(0, "e1", 0)) == mounts[1]
