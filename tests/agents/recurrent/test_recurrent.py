"""Tests of the recurrent agent: batched decisions equal the decisions of single steps."""

from __future__ import annotations

from functools import partial
from itertools import product

import numpy as np
import pytest
import torch

from mitigate.agents.agent import Seeing, Trainable
from mitigate.agents.recurrent import RecurrentAgent
from mitigate.agents.recurrent.policy import State
from mitigate.agents.recurrent.rollout import INFLECTION
from mitigate.core.observation import DEPTH, FORWARD, RGB, STOP
from mitigate.core.seeding import generator, seed_everything
from mitigate.corruptions import CLEAN, Corruption
from mitigate.evaluation.episode import run_episode
from mitigate.evaluation.evaluator import evaluate
from mitigate.worlds.apartments import simulator
from mitigate.worlds.apartments.tasks import DrawnEpisodes, load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.world import Corrupted

SMALL = {"width": 32, "heads": 2, "text_layers": 1, "dropout": 0.0}
SIZE = 16
World = partial(ApartmentsWorld, SIZE, 2, 1)


def agent(*sensors: str, **settings) -> RecurrentAgent:
    seed_everything(0, "recurrent")
    new_agent = RecurrentAgent(sensors or (RGB, DEPTH), 8, 8, SMALL, size=SIZE, **settings).eval()
    with torch.no_grad():
        new_agent.policy.act[-1].bias[STOP] = -4.0  # an untrained agent would stop at once
    return new_agent


def walked(by: RecurrentAgent, count: int = 2, *, share: float = 0.5, clean: bool = False):
    rngs = [generator(0, "test", i) for i in range(count)]
    episodes = [DrawnEpisodes(2).draw(rng) for rng in rngs]
    worlds = [Corrupted(World(), Corruption("low_light", 0.8), 0, str(i)) for i in range(count)]
    with torch.no_grad():
        how = {"expert_share": share, "rngs": rngs, "clean": clean}
        return by.collect(worlds, episodes, **how)


@pytest.fixture
def short_episodes(monkeypatch):
    """World whose episodes end after 40 steps."""
    monkeypatch.setattr(simulator, "MAX_STEPS", 40)


def test_recurrent_agent_is_trainable_and_seeing():
    assert isinstance(agent(), Trainable) and isinstance(agent(), Seeing)
    assert set(agent().parts()) == {"rgb_encoder", "depth_encoder", "policy"}
    assert set(agent(RGB).parts()) == {"rgb_encoder", "policy"}


@pytest.mark.usefixtures("short_episodes")
def test_decide_equals_step_by_step_actions():
    new_agent, episode = agent(), load_episodes("val_seen")[0]
    with torch.no_grad():
        # the actions must not depend on the frames, so that both rollouts take the same route
        new_agent.policy.act[-1].bias[FORWARD] = 50.0
    how = {"expert_share": 0.0, "rngs": [generator(0, "same")]}
    piece = new_agent.collect([World()], [episode], **how)
    with torch.no_grad():
        batch = new_agent.decide(new_agent.join([piece])).features["state"]
    world = World()
    seen = world.reset(episode)
    new_agent.reset(episode.instruction.text)
    for state in batch:
        assert new_agent.act(seen) == FORWARD
        assert torch.allclose(new_agent._walk.state.hidden[0], state, atol=1e-4)
        seen = world.step(FORWARD)


@pytest.mark.slow
@pytest.mark.usefixtures("short_episodes")
def test_collect_keeps_rollouts_independent():
    new_agent = agent()
    together = new_agent.join([walked(new_agent, 2, share=1.0)])
    alone = new_agent.join([walked(new_agent, 1, share=1.0)])
    with torch.no_grad():
        both, one = new_agent.decide(together).logits, new_agent.decide(alone).logits
    assert torch.allclose(both[: len(one)], one, atol=1e-4)


def test_collect_never_takes_the_agents_stop():
    new_agent = agent()
    with torch.no_grad():
        new_agent.policy.act[-1].bias[STOP] = 50.0
    piece = walked(new_agent, 1, share=0.0)
    # if the agent's STOP were executed, the rollout would end at once
    assert piece["lengths"][0] > 1
    assert piece["answer"][-1] == STOP  # the expert's STOP ends the rollout


@pytest.mark.slow
@pytest.mark.usefixtures("short_episodes")
def test_collect_stores_features_of_frozen_encoders():
    new_agent = agent()
    new_agent.requires_grad_(False)
    new_agent.policy.requires_grad_(True)
    assert set(walked(new_agent)["seen"]) == {"views", "goal"}
    new_agent.rgb_encoder.requires_grad_(True)
    piece = walked(new_agent, clean=True)
    assert {RGB, DEPTH, "concepts", "free", "clean_rgb", "clean_depth"} <= set(piece["seen"])
    out = new_agent.decide(new_agent.join([piece]))
    assert {"concepts", "free", "distance", "grounding"} == set(out.losses)
    out.losses["concepts"].backward()
    assert new_agent.rgb_encoder.stem[0].weight.grad.abs().sum() > 0


@pytest.mark.usefixtures("short_episodes")
def test_precompute_keeps_the_clean_output():
    new_agent = agent()
    new_agent.requires_grad_(False)
    piece = walked(new_agent, clean=True)
    frames = new_agent.decide(new_agent.join([piece]), clean=True).logits
    known = new_agent.decide(
        new_agent.join([new_agent.precompute(piece, clean=True)]), clean=True
    ).logits
    assert torch.allclose(frames, known, atol=1e-5)
    corrupted = new_agent.decide(new_agent.join([piece])).logits
    assert not torch.allclose(frames, corrupted, atol=1e-5)


def test_collect_weights_changes_of_action():
    piece = walked(agent(), 1, share=1.0)
    changes = np.flatnonzero(np.diff(piece["answer"].numpy())) + 1
    heavy = np.flatnonzero(piece["weight"].numpy() > 1)
    assert np.array_equal(heavy, [0, *changes])
    assert piece["weight"][0] == pytest.approx(INFLECTION)


@pytest.mark.slow
def test_rgb_agent_ignores_depth(monkeypatch):
    # the untrained agent does not stop before this limit
    monkeypatch.setattr(simulator, "MAX_STEPS", 60)
    new_agent, episode = agent(RGB), load_episodes("val_seen")[1]
    clean = run_episode(new_agent, World(), episode, Corruption("clean", 0.0), 0)
    gone = run_episode(new_agent, World(), episode, Corruption("missing_data", 1.0), 0)
    assert clean == gone


@pytest.mark.parametrize("sense", [RGB, DEPTH, "instruction"])
def test_blind_agent_ignores_the_input(sense):
    new_agent = agent(blind=[sense])
    new_agent.reset("turn left" if sense == "instruction" else "go to the bed")
    world = World()
    seen = dict(world.reset(load_episodes("val_seen")[0]))
    new_agent.act(seen)
    first = new_agent._walk.state.hidden
    new_agent.reset("go to the bed")
    if sense != "instruction":
        seen[sense] = (seen[sense] * 0.5).astype(seen[sense].dtype)
    new_agent.act(seen)
    assert torch.equal(first, new_agent._walk.state.hidden)


def test_act_all_keeps_episodes_independent():
    new_agent, episodes = agent(), load_episodes("val_seen")[:3]
    seen = [World().reset(episode) for episode in episodes]
    memories = [new_agent.begin(episode.instruction.text) for episode in episodes]
    actions = new_agent.act_all(seen, memories)
    for number in (2, 0):  # run alone, an episode has a different batch index
        alone = new_agent.begin(episodes[number].instruction.text)
        assert new_agent.act_all([seen[number]], [alone]) == [actions[number]]
        assert torch.equal(alone.state.hidden, memories[number].state.hidden)
        new_agent.reset(episodes[number].instruction.text)
        assert new_agent.act(seen[number]) == actions[number]
        assert torch.allclose(new_agent._walk.state.hidden, alone.state.hidden, atol=1e-5)


def test_evaluation_of_many_episodes_gives_equal_rows(tmp_path):
    new_agent, episodes = agent(), load_episodes("val_seen")[:4]
    with torch.no_grad():
        # with this bias, the agent takes some steps before it stops
        new_agent.policy.act[-1].bias[STOP] = 0.1
    met = [CLEAN, Corruption("low_light", 0.8), Corruption("black_box", 1.0)]
    how = {"name": "test", "split": "val_seen"}
    records = evaluate(new_agent, World, episodes, met, out=tmp_path / "all.jsonl", **how)
    assert (
        evaluate(new_agent, World, episodes, met[1:2], out=tmp_path / "one.jsonl", **how)
        == records[1::3]
    )
    for row, (episode, corruption) in zip(records, product(episodes, met), strict=True):
        assert run_episode(new_agent, World(), episode, corruption, 0).items() <= row.items()


def test_constructor_rejects_invalid_arguments():
    with pytest.raises(ValueError, match="rgbd"):
        agent("rgbd")
    with pytest.raises(ValueError, match="depth"):
        agent(RGB, blind=["depth"])
    with pytest.raises(RuntimeError, match="reset"):
        agent().act({})
    panorama = ApartmentsWorld(SIZE).reset(load_episodes("val_seen")[0])
    new_agent = agent()
    new_agent.reset("go to the bed")
    with pytest.raises(ValueError, match="views=1"):
        new_agent.act(panorama)


def test_state_separates_last_and_summed_attention():
    """In an earlier version, ``last`` and ``sum`` shared a tensor. As a result, training rollouts
    followed a different policy."""
    new_agent = agent()
    state = State.start(new_agent.policy.read(new_agent.tokens(["go left", "go right"])))
    fresh = State(state.hidden[:1] + 1, state.last[:1] + 0.1, state.sum[:1] + 0.7)
    state.put(torch.tensor([0]), fresh)
    assert torch.all(state.last[0] == 0.1) and torch.all(state.sum[0] == 0.7)
    assert not state.last[1].any() and not state.sum[1].any()
