"""The recurrent agent: what it decides in a batch is what it does step by step."""

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
    made = RecurrentAgent(sensors or (RGB, DEPTH), 8, 8, SMALL, size=SIZE, **settings).eval()
    with torch.no_grad():
        made.policy.act[-1].bias[STOP] = -4.0  # untrained, it would stop at once
    return made


def walked(by: RecurrentAgent, count: int = 2, *, share: float = 0.5, clean: bool = False):
    rngs = [generator(0, "test", i) for i in range(count)]
    episodes = [DrawnEpisodes(2).draw(rng) for rng in rngs]
    worlds = [Corrupted(World(), Corruption("low_light", 0.8), 0, str(i)) for i in range(count)]
    with torch.no_grad():
        how = {"expert_share": share, "rngs": rngs, "clean": clean}
        return by.collect(worlds, episodes, **how)


@pytest.fixture
def short_episodes(monkeypatch):
    """Episodes end after 40 steps."""
    monkeypatch.setattr(simulator, "MAX_STEPS", 40)


def test_it_is_trainable_and_sees():
    assert isinstance(agent(), Trainable) and isinstance(agent(), Seeing)
    assert set(agent().parts()) == {"rgb_encoder", "depth_encoder", "policy"}
    assert set(agent(RGB).parts()) == {"rgb_encoder", "policy"}


@pytest.mark.usefixtures("short_episodes")
def test_a_batch_answers_as_the_agent_does_step_by_step():
    made, episode = agent(), load_episodes("val_seen")[0]
    with torch.no_grad():
        made.policy.act[-1].bias[FORWARD] = 50.0  # whatever it sees, so both take the same way
    how = {"expert_share": 0.0, "rngs": [generator(0, "same")]}
    piece = made.collect([World()], [episode], **how)
    with torch.no_grad():
        batch = made.decide(made.join([piece])).features["state"]
    world = World()
    seen = world.reset(episode)
    made.reset(episode.instruction.text)
    for state in batch:
        assert made.act(seen) == FORWARD
        assert torch.allclose(made._walk.state.hidden[0], state, atol=1e-4)
        seen = world.step(FORWARD)


@pytest.mark.usefixtures("short_episodes")
def test_walks_of_a_batch_do_not_depend_on_each_other():
    made = agent()
    together = made.join([walked(made, 2, share=1.0)])
    alone = made.join([walked(made, 1, share=1.0)])
    with torch.no_grad():
        both, one = made.decide(together).logits, made.decide(alone).logits
    assert torch.allclose(both[: len(one)], one, atol=1e-4)


def test_its_own_stop_is_not_taken_in_training():
    made = agent()
    with torch.no_grad():
        made.policy.act[-1].bias[STOP] = 50.0
    piece = walked(made, 1, share=0.0)
    assert piece["lengths"][0] > 1  # with its own STOP the walk would end at once
    assert piece["answer"][-1] == STOP  # the expert's ends it


@pytest.mark.usefixtures("short_episodes")
def test_frozen_encoders_give_features_and_training_ones_frames():
    made = agent()
    made.requires_grad_(False)
    made.policy.requires_grad_(True)
    assert set(walked(made)["seen"]) == {"views", "goal"}
    made.rgb_encoder.requires_grad_(True)
    piece = walked(made, clean=True)
    assert {RGB, DEPTH, "concepts", "free", "clean_rgb", "clean_depth"} <= set(piece["seen"])
    out = made.decide(made.join([piece]))
    assert {"concepts", "free", "distance", "grounding"} == set(out.losses)
    out.losses["concepts"].backward()
    assert made.rgb_encoder.stem[0].weight.grad.abs().sum() > 0


@pytest.mark.usefixtures("short_episodes")
def test_clean_frames_and_their_features_give_the_same_answer():
    made = agent()
    made.requires_grad_(False)
    piece = walked(made, clean=True)
    frames = made.decide(made.join([piece]), clean=True).logits
    known = made.decide(made.join([made.precompute(piece, clean=True)]), clean=True).logits
    assert torch.allclose(frames, known, atol=1e-5)
    corrupted = made.decide(made.join([piece])).logits
    assert not torch.allclose(frames, corrupted, atol=1e-5)


def test_steps_at_which_the_expert_turns_count_more():
    piece = walked(agent(), 1, share=1.0)
    changes = np.flatnonzero(np.diff(piece["answer"].numpy())) + 1
    heavy = np.flatnonzero(piece["weight"].numpy() > 1)
    assert np.array_equal(heavy, [0, *changes])
    assert piece["weight"][0] == pytest.approx(INFLECTION)


def test_with_rgb_alone_depth_does_not_matter(monkeypatch):
    monkeypatch.setattr(simulator, "MAX_STEPS", 60)  # untrained, it does not stop before
    made, episode = agent(RGB), load_episodes("val_seen")[1]
    clean = run_episode(made, World(), episode, Corruption("clean", 0.0), 0)
    gone = run_episode(made, World(), episode, Corruption("missing_data", 1.0), 0)
    assert clean == gone


@pytest.mark.parametrize("sense", [RGB, DEPTH, "instruction"])
def test_what_it_is_blind_to_changes_nothing(sense):
    made = agent(blind=[sense])
    made.reset("turn left" if sense == "instruction" else "go to the bed")
    world = World()
    seen = dict(world.reset(load_episodes("val_seen")[0]))
    made.act(seen)
    first = made._walk.state.hidden
    made.reset("go to the bed")
    if sense != "instruction":
        seen[sense] = (seen[sense] * 0.5).astype(seen[sense].dtype)
    made.act(seen)
    assert torch.equal(first, made._walk.state.hidden)


def test_side_by_side_no_answer_depends_on_the_others():
    made, episodes = agent(), load_episodes("val_seen")[:3]
    seen = [World().reset(episode) for episode in episodes]
    memories = [made.begin(episode.instruction.text) for episode in episodes]
    actions = made.act_all(seen, memories)
    for number in (2, 0):  # alone, in another place of the batch
        alone = made.begin(episodes[number].instruction.text)
        assert made.act_all([seen[number]], [alone]) == [actions[number]]
        assert torch.equal(alone.state.hidden, memories[number].state.hidden)
        made.reset(episodes[number].instruction.text)
        assert made.act(seen[number]) == actions[number]
        assert torch.allclose(made._walk.state.hidden, alone.state.hidden, atol=1e-5)


def test_side_by_side_in_an_evaluation_every_episode_has_the_row_that_it_has_alone(tmp_path):
    made, episodes = agent(), load_episodes("val_seen")[:4]
    with torch.no_grad():
        made.policy.act[-1].bias[STOP] = 0.1  # it goes some steps
    met = [CLEAN, Corruption("low_light", 0.8), Corruption("black_box", 1.0)]
    how = {"name": "test", "split": "val_seen"}
    found = evaluate(made, World, episodes, met, out=tmp_path / "all.jsonl", **how)
    assert (
        evaluate(made, World, episodes, met[1:2], out=tmp_path / "one.jsonl", **how) == found[1::3]
    )
    for row, (episode, corruption) in zip(found, product(episodes, met), strict=True):
        assert run_episode(made, World(), episode, corruption, 0).items() <= row.items()


def test_mistakes_say_what_is_wrong():
    with pytest.raises(ValueError, match="rgbd"):
        agent("rgbd")
    with pytest.raises(ValueError, match="depth"):
        agent(RGB, blind=["depth"])
    with pytest.raises(RuntimeError, match="reset"):
        agent().act({})
    panorama = ApartmentsWorld(SIZE).reset(load_episodes("val_seen")[0])
    made = agent()
    made.reset("go to the bed")
    with pytest.raises(ValueError, match="views=1"):
        made.act(panorama)


def test_the_memory_keeps_the_last_attention_and_the_sum_of_all_apart():
    """They were one tensor at the start: walks of a training followed another policy."""
    made = agent()
    state = State.start(made.policy.read(made.tokens(["go left", "go right"])))
    fresh = State(state.hidden[:1] + 1, state.last[:1] + 0.1, state.sum[:1] + 0.7)
    state.put(torch.tensor([0]), fresh)
    assert torch.all(state.last[0] == 0.1) and torch.all(state.sum[0] == 0.7)
    assert not state.last[1].any() and not state.sum[1].any()
