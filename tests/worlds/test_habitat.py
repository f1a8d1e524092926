"""Tests of the corruption of Habitat observations whose cameras together form one panorama."""

import numpy as np
import pytest

from mitigate.corruptions import NAMES, RGB, Corruption, DepthSensor, Key, corrupt
from mitigate.worlds.habitat import corrupt_habitat

KEY = Key(2, "71", 4)


def test_corrupt_habitat_equals_the_panorama(obs, panorama):
    for name in RGB:
        out = corrupt_habitat(obs, Corruption(name, 0.9), KEY, heading=0.4)
        expected = corrupt(panorama[0], name, 0.9, key=KEY, heading=0.4)
        assert np.array_equal(out["rgb"], expected[0])
        for step in range(1, 12):
            assert np.array_equal(out[f"rgb_{30 * step}"], expected[-step])


@pytest.mark.parametrize("name", NAMES)
def test_corrupt_habitat_preserves_the_format(obs, name):
    before = {k: v.tobytes() for k, v in obs.items() if isinstance(v, np.ndarray)}
    out = corrupt_habitat(obs, Corruption(name, 1.0), KEY, DepthSensor(0.5, 5.0))
    hurt = "rgb" if name in RGB else "depth"
    assert list(out) == list(obs) and out is not obs
    changed = 0
    for entry, value in obs.items():
        if entry.partition("_")[0] == hurt and entry[-1] in "bh0":
            assert out[entry].shape == value.shape and out[entry].dtype == value.dtype
            changed += not np.array_equal(out[entry], value)
        else:
            assert out[entry] is value
        if entry in before:
            assert value.tobytes() == before[entry]
    assert changed >= (3 if name == "flare" else 12)
    depth = np.stack([v for k, v in out.items() if k.startswith("depth") and k[-1] in "h0"])
    assert depth.min() >= 0 and depth.max() <= 1
    clean = np.stack([v for k, v in obs.items() if k.startswith("depth") and k[-1] in "h0"])
    assert (depth[clean == 0] == 0).all()  # holes stay holes


def test_corrupt_habitat_uses_the_turn(obs):
    flare = Corruption("flare", 1.0)

    def lit(turn):
        out = corrupt_habitat(obs, flare, KEY, heading=2.5, turn=turn)
        return {int(e[4:] or 0) for e in RGB_CAMERAS if not np.array_equal(out[e], obs[e])}

    left, right = lit("left"), lit("right")
    assert left != right and left == {-angle % 360 for angle in right}


RGB_CAMERAS = ["rgb", *(f"rgb_{30 * step}" for step in range(1, 12))]


def test_corrupt_habitat_flare_matches_a_left_turn(panorama):
    frame = panorama[0][0]
    flare = Corruption("flare", 1.0)
    for episode in range(6):
        key = Key(0, str(episode))
        ahead = corrupt_habitat({"rgb": frame}, flare, key, heading=0.2 + np.pi / 2)["rgb"]
        left = corrupt_habitat({"rgb": frame, "rgb_90": frame}, flare, key, heading=0.2)["rgb_90"]
        assert np.array_equal(ahead, left)


def test_corrupt_habitat_accepts_a_part_of_the_cameras(obs):
    some = {entry: obs[entry] for entry in ("rgb", "rgb_90", "depth_270", "depth_30")}
    for name in NAMES:
        hurt = Corruption(name, 0.8)
        all_of_them, few = corrupt_habitat(obs, hurt, KEY), corrupt_habitat(some, hurt, KEY)
        assert all(np.array_equal(few[entry], all_of_them[entry]) for entry in some)


def test_corrupt_habitat_explains_invalid_observations(obs):
    hurt = Corruption("spatter", 0.5)
    small = {**obs, "rgb_60": obs["rgb_60"][:4]}
    for options, part in (
        ({"rgb": obs["rgb"], "rgb_0": obs["rgb"]}, "'rgb' and 'rgb_0' face the same way"),
        (
            {"rgb": obs["rgb"], "rgb_45": obs["rgb"]},
            "multiple of 30 degrees below 360, got 'rgb_45'",
        ),
        ({"rgb_360": obs["rgb"]}, "below 360, got 'rgb_360'"),
        (small, "same dtype and shape, but 'rgb' is uint8.*'rgb_60'"),
        ({"depth": obs["depth"]}, r"has no camera named rgb.*its entries are \['depth'\]"),
        ({"rgb": obs["rgb"][None]}, "one time step of one environment"),
        ({"rgb": obs["rgb"] / np.float32(255)}, "RGB frames must be uint8"),
    ):
        with pytest.raises(ValueError, match=part):
            corrupt_habitat(options, hurt, KEY)
    with pytest.raises(ValueError, match="turn must be 'left' or 'right'"):
        corrupt_habitat(obs, hurt, KEY, turn="clockwise")
    with pytest.raises(ValueError, match="got 4"):
        corrupt_habitat(
            {"depth": np.full((4, 4, 1), 4, np.float32)}, Corruption("multipath", 1), KEY
        )
