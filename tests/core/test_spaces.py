"""Tests of action spaces: their actions, random actions, and gymnasium's counterparts."""

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces

from mitigate.core.spaces import from_gymnasium

SPACES = [
    spaces.Discrete(4),
    spaces.Discrete(3, start=-1),
    spaces.Box(-1.0, 2.0, (2, 3), np.float32),
    spaces.Box(-np.inf, np.inf, (2,), np.float64),
    spaces.MultiDiscrete([2, 5]),
    spaces.MultiBinary(3),
    spaces.Dict({"move": spaces.Discrete(2), "arm": spaces.Box(0.0, 1.0, (1,), np.float32)}),
]


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_samples_and_checked_actions_are_in_gymnasiums_space(space):
    ours = from_gymnasium(space)
    for seed in range(20):
        sample = ours.sample(np.random.default_rng(seed))
        assert space.contains(ours.check(sample)) or isinstance(space, spaces.MultiBinary)
        ours.check(space.sample())


@pytest.mark.parametrize(
    ("space", "action"),
    [
        (SPACES[0], 4),
        (SPACES[0], 1.5),
        (SPACES[0], "left"),
        (SPACES[1], 2),
        (SPACES[2], np.zeros(6)),
        (SPACES[2], np.full((2, 3), 2.1)),
        (SPACES[3], [0.0, np.nan]),
        (SPACES[4], [0, 5]),
        (SPACES[4], [0.0, 1.0]),
        (SPACES[6], {"move": 1}),
        (SPACES[6], {"move": 2, "arm": [0.5]}),
    ],
)
def test_check_names_what_is_allowed(space, action):
    with pytest.raises(ValueError, match="must be"):
        from_gymnasium(space).check(action)


def test_from_gymnasium_rejects_text():
    with pytest.raises(ValueError, match="Discrete, Box"):
        from_gymnasium(gymnasium.spaces.Text(5))
