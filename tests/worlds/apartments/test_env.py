"""Tests of the apartments as a torchrl environment with the corruption transform: specs, rewards
and pixels."""

from __future__ import annotations

import pytest
import torch
from torchrl.data import LazyTensorStorage, ReplayBuffer
from torchrl.envs import SerialEnv, TransformedEnv, check_env_specs

from mitigate.core.observation import DEPTH, MAX_STEPS, POSE, RGB
from mitigate.core.seeding import generator
from mitigate.corruptions import Key, Schedule, corrupt_observation
from mitigate.worlds.apartments.env import ApartmentsEnv
from mitigate.worlds.apartments.tasks import episode_file, load_episodes
from mitigate.worlds.transforms import CorruptObservation

SIZE = 16
HURT = Schedule("per_episode", 0.8, clean_share=0.0)


@pytest.fixture(scope="module")
def episodes():
    return load_episodes("val_seen")[:80:10]


def actions_for(name: str, count: int) -> list[int]:
    """Return random actions, seeded by the name of an episode's run.

    About every tenth action is STOP.
    """
    return [int(a) for a in generator("walk", name).choice(4, count, p=[0.1, 0.5, 0.2, 0.2])]


def walk(env: ApartmentsEnv | TransformedEnv, steps: int) -> dict[tuple[str, int], torch.Tensor]:
    """Step through several episodes, and return RGB and depth, keyed by (episode, frame)."""
    seen = {}

    def note(data) -> None:
        for instant in data.reshape(-1).unbind(0):
            frames = (instant[RGB].clone(), instant[DEPTH].clone())
            seen[instant["episode"], int(instant["frame"])] = frames

    data = env.reset()
    note(data)
    for _ in range(steps):
        flat = data.reshape(-1).unbind(0)
        chosen = [actions_for(i["episode"], MAX_STEPS)[int(i["frame"])] for i in flat]
        data["action"] = torch.tensor(chosen).reshape(data.batch_size)
        stepped, data = env.step_and_maybe_reset(data)
        note(stepped["next"])
        note(data)
    return seen


@pytest.fixture(scope="module")
def clean(episodes):
    """Return the clean frames of 60 steps."""
    return walk(ApartmentsEnv(episodes, size=SIZE), 60)


def four(**options) -> SerialEnv:
    makers = [
        lambda i=i: ApartmentsEnv(worker=i, workers=4, size=SIZE, **options) for i in range(4)
    ]
    return SerialEnv(4, makers)


def test_env_passes_the_spec_check(episodes):
    check_env_specs(ApartmentsEnv(episodes, size=SIZE))
    check_env_specs(ApartmentsEnv(size=SIZE, apartments=2), seed=3)
    check_env_specs(TransformedEnv(ApartmentsEnv(episodes, size=SIZE), CorruptObservation(HURT)))


def test_env_repeats_the_episodes_of_a_file():
    env = ApartmentsEnv(episode_file("val_seen"), size=SIZE)
    expected = load_episodes("val_seen")
    first = env.reset()
    assert first["instruction"] == expected[0].instruction.text
    assert [first["episode"], env.reset()["episode"]] == [e.episode_id for e in expected[:2]]
    env = ApartmentsEnv(expected[:2], size=SIZE)
    names = [env.reset()["episode"] for _ in range(4)]
    # each name with "@1" is a second run of the same episode
    assert names[2:] == [f"{name}@1" for name in names[:2]]


def test_env_rewards_the_expert_at_stop(episodes):
    env = ApartmentsEnv(episodes[:1], size=SIZE)
    data, rewards = env.reset(), []
    expert = env.world.expert()
    while not data["done"]:
        data["action"] = torch.tensor(expert.action())
        data = env.step(data)["next"]
        rewards.append(float(data["reward"]))
    assert rewards[-1] == 1.0 and sum(rewards) == 1.0
    assert data["terminated"] and not data["truncated"] and int(data["frame"]) == len(rewards)


def test_env_gives_no_reward_far_from_the_goal(episodes):
    env = ApartmentsEnv(episodes[:1], size=SIZE)
    ended = env.step(env.reset().set("action", torch.tensor(0)))["next"]
    assert ended["reward"] == 0.0 and ended["terminated"] and ended["done"]


def test_env_truncates_at_the_step_limit(episodes):
    env = ApartmentsEnv(episodes[:1], size=SIZE)
    data = env.reset()
    env.world.simulator.steps = MAX_STEPS - 1
    ended = env.step(data.set("action", torch.tensor(2)))["next"]
    assert ended["truncated"] and ended["done"] and not ended["terminated"]


def test_drawn_episodes_depend_only_on_the_seed():
    def names(seed, **options):
        env = ApartmentsEnv(size=SIZE, apartments=2, **options)
        env.set_seed(seed)
        return [env.reset()["episode"] for _ in range(4)]

    assert names(1) == names(1) != names(2)
    assert names(1, worker=1, workers=2)[:1] == names(1)[1:2]


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["per_episode", "per_frame"])
def test_pixels_do_not_depend_on_parallel_environments(episodes, clean, mode):
    schedule = Schedule(mode, 0.8, clean_share=0.2)
    one = walk(TransformedEnv(ApartmentsEnv(episodes, size=SIZE), CorruptObservation(schedule)), 60)
    many = walk(TransformedEnv(four(episodes=episodes), CorruptObservation(schedule)), 15)
    common = one.keys() & many.keys()
    assert len(common) > 30 and len({name for name, _ in common}) >= 4
    for place in common:
        assert all(torch.equal(a, b) for a, b in zip(one[place], many[place], strict=True))
    hurt = [not all(map(torch.equal, one[place], clean[place])) for place in common]
    assert sum(hurt) > 0.5 * len(hurt)


def test_transform_equals_the_suite(episodes):
    env = TransformedEnv(ApartmentsEnv(episodes, size=SIZE), CorruptObservation(HURT, seed=5))
    for _ in range(4):
        data = env.reset()
        seen = env.base_env.world.simulator.observe()
        frames = {name: seen[name] for name in (RGB, DEPTH, POSE)}
        corruption, key = HURT.draw(5, data["episode"], 0)
        assert key == Key(5, data["episode"], 0)
        expected = corrupt_observation(frames, corruption, key)
        assert torch.equal(data[RGB], torch.from_numpy(expected[RGB]))
        assert torch.equal(data[DEPTH], torch.from_numpy(expected[DEPTH]))


def test_replay_buffer_of_clean_frames_gives_the_same(episodes):
    steps = 6
    torch.manual_seed(0)
    clean = ApartmentsEnv(episodes, size=SIZE).rollout(steps, break_when_any_done=False)
    torch.manual_seed(0)
    env = TransformedEnv(ApartmentsEnv(episodes, size=SIZE), CorruptObservation(HURT))
    expected = env.rollout(steps, break_when_any_done=False)
    buffer = ReplayBuffer(storage=LazyTensorStorage(steps), batch_size=steps)
    buffer.append_transform(CorruptObservation(HURT))
    buffer.extend(clean)
    drawn = buffer[:]
    assert not torch.equal(drawn[RGB], clean[RGB]) or not torch.equal(drawn[DEPTH], clean[DEPTH])
    for name in (RGB, DEPTH, ("next", RGB), ("next", DEPTH)):
        assert torch.equal(drawn[name], expected[name])
    assert torch.equal(buffer[:][RGB], drawn[RGB])  # stored frames stay clean


def test_env_explains_invalid_use(episodes):
    with pytest.raises(ValueError, match="The list must contain at least one episode"):
        ApartmentsEnv([])
    with pytest.raises(ValueError, match="worker must be 0 to 1"):
        ApartmentsEnv(episodes, worker=2, workers=2)
    data = ApartmentsEnv(episodes, size=SIZE).reset().exclude("episode")
    with pytest.raises(ValueError, match="The data must have 'episode'"):
        CorruptObservation(HURT)(data)
