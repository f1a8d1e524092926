"""Tests of self-distillation: the loss is zero if the answers are equal, and the operations of a
training step have the right order."""

import numpy as np
import pytest
import torch
from torch import nn

from mitigate.agents.policies.policy import last_convolution
from mitigate.agents.policies.wrapping import as_policy
from mitigate.corruptions import Schedule
from mitigate.recipes import self_distil
from mitigate.recipes.self_distil import SelfDistil
from mitigate.shipping.harden import _Training
from mitigate.worlds.gym import GymWorld
from tests.shipping.test_harden import Lights, Net


def objective(tmp_path, schedule=None, net=None, recurrent=False, **options):
    world = lambda: GymWorld(Lights())  # noqa: E731
    agent = as_policy(net or Net(), world(), recurrent=recurrent)
    schedule = schedule or Schedule("per_episode", (0.3, 1.0), names=("spatter",))
    settings = {"steps": 100, "every": 50, "episodes": 2, "batch": 8} | options
    return SelfDistil(agent, world, _Training(None, []), schedule, tmp_path, **settings)


def test_self_distil_loss_is_zero_for_clean_frames(tmp_path):
    task = objective(tmp_path, Schedule("clean", 0.0), curriculum=False)
    values = task(task.batch(0))
    # cross-entropy between the policy and its own actions
    imitation = values.pop("imitation").item()
    assert values.pop("loss").item() == pytest.approx(imitation)
    assert {name: value.item() for name, value in values.items()} == dict.fromkeys(values, 0.0)


def test_self_distil_loss_is_positive_for_corrupted_frames(tmp_path):
    task = objective(tmp_path, Schedule("per_frame", 1.0, names=("black_out",), clean_share=0.0))
    values = task(task.batch(90))
    assert values["policy"].item() > 0 and values["feat"].item() > 0


def test_self_distil_batch_depends_on_seed_and_step_alone(tmp_path):
    one, other = objective(tmp_path / "a"), objective(tmp_path / "b")
    one.batch(0)
    for name, frames in one.batch(7)["first"].items():
        assert np.array_equal(frames, other.batch(7)["first"][name])


def test_self_distil_severity_rises_and_ends_with_clean_frames(tmp_path):
    task = objective(tmp_path)
    assert task.schedule_at(0).severity == (0.3, 0.3)
    assert task.schedule_at(60).severity == (0.3, 1.0)
    assert task.schedule_at(84).clean_share == 0.25
    assert task.schedule_at(85).clean_share == 0.75


def test_self_distil_trains_the_student_only(tmp_path):
    task = objective(tmp_path)
    task(task.batch(0))["loss"].backward()
    assert all(p.grad is not None for p in task.agent.parameters())
    assert all(p.grad is None for p in task.teacher.parameters())


class Counting(nn.Module):
    """A recurrent policy that counts its frames, so that its output shows its memory."""

    def __init__(self):
        super().__init__()
        self.scale = nn.Linear(1, 2)

    def forward(self, frames, memory=None):
        memory = torch.zeros(len(frames), 1) if memory is None else memory + 1
        return self.scale(memory), memory


def test_self_distil_gives_a_recurrent_policy_windows(tmp_path):
    task = objective(tmp_path, net=Counting(), recurrent=True, window=4, module="scale")
    batch = task.batch(0)
    assert batch["clean"]["rgb"].shape == (8, 16, 16, 3)  # two windows of four frames
    answers = task.agent.answers(batch["clean"], 4)
    expected = task.agent.network.scale(torch.arange(4.0)[:, None]).log_softmax(-1)
    for place, (distribution,) in enumerate(answers):
        torch.testing.assert_close(distribution.logits, expected[place].expand(2, 2))


def test_memory_keeps_at_most_the_given_number_of_frames(tmp_path):
    task = objective(tmp_path, frames=3)
    task.batch(0)
    # 32 short episodes instead of 2
    assert task._stored[0]["rgb"].shape == (96, 1, 16, 16, 3)


def test_round_of_short_episodes_has_more_of_them(tmp_path, monkeypatch):
    monkeypatch.setattr(self_distil, "ROUND_FRAMES", 20)
    lengths = []
    task = objective(tmp_path)
    rollout = task._rollout

    def counted(step, number):
        frames, length = rollout(step, number)
        lengths.append(length)
        return frames, length

    monkeypatch.setattr(task, "_rollout", counted)
    task.batch(0)
    assert len(lengths) > 2 and sum(lengths[:-1]) < 20 <= sum(lengths)
    monkeypatch.setattr(self_distil, "ROUND_FRAMES", 1)
    lengths.clear()
    task.batch(50)
    assert len(lengths) == 2


def test_last_convolution_falls_back_to_the_first_layer():
    world = GymWorld(Lights())
    assert last_convolution(as_policy(Net(), world)) == "conv"
    flat = nn.Sequential(nn.Flatten(), nn.Linear(768, 4), nn.Linear(4, 2))
    assert last_convolution(as_policy(flat, world)) == "1"


def test_self_distil_rejects_a_policy_without_frames(tmp_path):
    world = GymWorld(Lights())
    agent = as_policy(Net(), world)
    agent.native = type(agent.native)({"goal": "goal"}, {"goal": "float32"})
    with pytest.raises(ValueError, match="no rgb and no depth"):
        SelfDistil(agent, lambda: world, _Training(None, []), Schedule("clean", 0.0), tmp_path, 10)


def test_self_distil_stores_clean_frames(tmp_path):
    task = objective(tmp_path, Schedule("per_frame", 1.0, names=("black_out",), clean_share=0.0))
    task.batch(0)
    assert np.isin(task._stored[0]["rgb"], [90, 40, 220]).all()
