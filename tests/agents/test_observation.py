"""Tests of observation checks: invalid observations are rejected, others are converted."""

import numpy as np
import pytest
import torch
from torch import nn

from mitigate.agents.observation import check_fits
from mitigate.agents.topological import TopologicalAgent
from mitigate.core.observation import DEPTH, cameras


@pytest.fixture(scope="module")
def agent():
    torch.manual_seed(0)
    agent = TopologicalAgent().eval()
    agent.reset("walk to the red sofa")
    return agent


def seen(**changed):
    rng = np.random.default_rng(0)
    plain = {
        "rgb": rng.integers(0, 256, (12, 64, 64, 3)).astype(np.uint8),
        "depth": rng.uniform(0.5, 6.0, (12, 64, 64, 1)).astype(np.float32),
        "pose": np.zeros(3, np.float32),
    }
    return {**plain, **changed}


@pytest.mark.parametrize(
    ("name", "value", "kind", "text"),
    [
        ("rgb", seen()["rgb"] / 255.0, TypeError, r"\* 255"),
        ("rgb", seen()["rgb"][:4], ValueError, "12 square views"),
        ("rgb", np.moveaxis(seen()["rgb"], -1, 1), ValueError, r"\[12, H, H, 3\]"),
        ("rgb", np.zeros((12, 48, 64, 3), np.uint8), ValueError, "square"),
        ("rgb", np.zeros((12, 0, 0, 3), np.uint8), ValueError, "H > 0"),
        ("depth", (seen()["depth"] * 1000).astype(np.uint16), TypeError, "/ 1000"),
        ("depth", seen()["depth"] * 1000, ValueError, "divide by 1000"),
        ("depth", seen()["depth"][..., 0], ValueError, r"\[12, H, H, 1\]"),
        ("pose", np.array([0, 0, np.nan]), ValueError, "three finite numbers"),
        ("pose", np.zeros(2), ValueError, "three finite numbers"),
    ],
)
def test_frame_rejects_invalid_arrays(agent, name, value, kind, text):
    with pytest.raises(kind, match=text):
        agent.act(seen(**{name: value}))


def test_frame_names_a_missing_entry(agent):
    with pytest.raises(KeyError, match="no entry 'depth'; it holds rgb, pose"):
        agent.act({k: v for k, v in seen().items() if k != "depth"})


def test_frame_warns_of_normalised_depth(agent, recwarn):
    agent.act(seen())
    assert not recwarn.list
    with pytest.warns(UserWarning, match="normalised"):
        agent.act(seen(depth=seen()["depth"] / 10))


def test_frame_rejects_millimetres_with_a_small_reading(agent):
    depth = seen()["depth"] * 1000
    depth[0, 0, 0] = 30
    with pytest.raises(ValueError, match="must be in metres, but its median"):
        agent.act(seen(depth=depth))


def test_reset_warns_about_words_that_are_not_read(agent):
    with pytest.warns(UserWarning, match="reads only the first 80"):
        agent.reset("walk on " * 41)


def test_frame_accepts_depth_without_readings(agent):
    assert agent.act(seen(depth=np.full((12, 64, 64, 1), np.nan, np.float32))) is not None


def test_agents_require_reset_with_a_string():
    agent = TopologicalAgent().eval()
    with pytest.raises(RuntimeError, match="agent.reset"):
        agent.act(seen())
    with pytest.raises(TypeError, match="must be a string, got a bytes"):
        agent.reset(b"walk to the sofa")
    with pytest.warns(UserWarning, match="knows no word"):
        agent.reset("走过红色沙发")


def test_frame_accepts_any_memory_layout(agent):
    flipped = seen()["rgb"][..., ::-1]
    locked = flipped.copy()
    locked.flags.writeable = False
    scores = []
    for rgb in (flipped, locked):
        agent.reset("walk to the red sofa")
        agent.act(seen(rgb=rgb))
        scores.append(agent._stop_scores)
    assert scores[0] == scores[1]


def test_agents_resize_views_of_any_size():
    """Repeating each pixel 3 x 3 times does not change the image, so the features must be equal."""
    torch.manual_seed(0)
    agent = TopologicalAgent(size=32).eval()
    rgb = torch.randint(0, 256, (1, 12, 32, 32, 3), dtype=torch.uint8)
    depth = torch.rand(1, 12, 32, 32, 1) * 5
    depth[..., :4, :, :] = 0  # a hole in depth keeps its sharp edge
    large = [x.repeat_interleave(3, 2).repeat_interleave(3, 3) for x in (rgb, depth)]
    with torch.no_grad():
        for own_value, other in zip(
            agent.perceive(rgb, depth), agent.perceive(*large), strict=True
        ):
            torch.testing.assert_close(own_value, other)
    with pytest.raises(ValueError, match="multiple of 16"):
        TopologicalAgent(size=50)


def test_check_fits_rejects_missing_sensors(agent):
    observed = cameras(64)
    check_fits(agent, observed, "Hall")
    alone = {name: sensor for name, sensor in observed.items() if name != DEPTH}
    with pytest.raises(ValueError, match="reads depth, which the world Hall does not have. .*rgb"):
        check_fits(agent, alone, "Hall")
    check_fits(nn.Linear(1, 1), alone, "Hall")  # this agent does not declare its sensors
