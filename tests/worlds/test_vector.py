"""Tests of the wrapper for vector environments that return tensors."""

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from mitigate.corruptions import Corruption, Key, Schedule, corrupt
from mitigate.worlds.vector import CorruptVectorObservation

SCHEDULE = Schedule("per_episode", 0.9, clean_share=0.2)
ENDLESS = [("1", frame) for frame in range(4)]
# (episode, frame) at each step: environment 0 ends after 2 steps, and environment 1 never ends
EPISODES = {
    AutoresetMode.SAME_STEP: ([("0", 0), ("0", 1), ("2", 0), ("2", 1)], ENDLESS),
    AutoresetMode.NEXT_STEP: ([("0", 0), ("0", 1), ("0", 2), ("2", 0)], ENDLESS),
}


class Cameras(VectorEnv):
    """Two environments with constant frames; the first one ends after two steps."""

    num_envs = 2

    def __init__(self, mode: AutoresetMode | None) -> None:
        self.metadata = {} if mode is None else {"autoreset_mode": mode}
        box = gymnasium.spaces.Box(0, 255, (16, 20, 3), np.uint8)
        self.single_observation_space = gymnasium.spaces.Dict({"rgb": box})
        self.observation_space = batch_space(self.single_observation_space, 2)
        self.single_action_space = gymnasium.spaces.Discrete(2)
        self.action_space = batch_space(self.single_action_space, 2)
        self.frames = {
            "rgb": torch.arange(2 * 960, dtype=torch.uint8).reshape(2, 16, 20, 3),
            "depth": torch.linspace(0.5, 6.0, 640).reshape(2, 16, 20, 1),
            "state": torch.ones(2, 3),
        }
        self.clock = 0

    def reset(self, *, seed=None, options=None):
        self.clock = 0
        return dict(self.frames), {}

    def step(self, actions):
        self.clock += 1
        over = torch.tensor([self.clock == 2, False])
        return dict(self.frames), torch.zeros(2), over, torch.zeros(2, dtype=torch.bool), {}


@pytest.mark.parametrize("mode", EPISODES)
def test_vector_wrapper_keys_episodes_and_frames(mode):
    env = CorruptVectorObservation(Cameras(mode), SCHEDULE, seed=5)
    clean = Cameras(mode).frames
    outputs = [env.reset(seed=3)[0], *(env.step(torch.zeros(2))[0] for _ in range(3))]
    changed = 0
    for row, instants in enumerate(EPISODES[mode]):
        for output, (episode, frame) in zip(outputs, instants, strict=True):
            corruption, key = SCHEDULE.draw(5, episode, frame)
            expected = {name: clean[name][row].numpy() for name in ("rgb", "depth")}
            if corruption.modality != "none":
                name = corruption.modality
                expected[name] = corrupt(
                    expected[name], corruption.name, corruption.severity, key=key
                )
                changed += 1
            for name in expected:
                assert np.array_equal(output[name][row], expected[name])
            assert output["state"] is not None
    assert changed > 4
    assert list(outputs[0]) == list(clean)


def test_vector_wrapper_resets_the_rows_of_a_mask():
    spatter = Corruption("spatter", 0.8)
    env = CorruptVectorObservation(Cameras(AutoresetMode.DISABLED), spatter)
    first = env.reset()[0]["rgb"]
    second = env.reset(options={"reset_mask": np.array([False, True])})[0]["rgb"]
    assert torch.equal(first[0], second[0]) and not torch.equal(first[1], second[1])
    expected = corrupt(env.env.frames["rgb"][1].numpy(), "spatter", 0.8, key=Key(0, "3", 0))
    assert np.array_equal(second[1], expected)
    assert torch.equal(env.reset(seed=1)[0]["rgb"], first)


def test_vector_wrapper_explains_invalid_use():
    with pytest.raises(ValueError, match="autoreset_mode must be"):
        CorruptVectorObservation(Cameras(None), SCHEDULE)
    mode = AutoresetMode.SAME_STEP
    CorruptVectorObservation(Cameras(None), SCHEDULE, autoreset_mode=mode).reset()
    with pytest.raises(ValueError, match="the observation has no depth"):
        CorruptVectorObservation(Cameras(mode), SCHEDULE, depth="range").reset()
    with pytest.raises(ValueError, match="got the temporal fault"):
        CorruptVectorObservation(Cameras(mode), Corruption("frozen_frame", 0.5)).reset()
