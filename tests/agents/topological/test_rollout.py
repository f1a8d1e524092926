"""Tests of rollouts for imitation: the oracle's answers, scheduled sampling, and stored
features."""

from __future__ import annotations

import json
from functools import partial

import numpy as np
import pytest
import torch

from mitigate.agents.text import Vocabulary
from mitigate.agents.topological.perception import select
from mitigate.agents.topological.rollout import STOP_BEST, LiveWalk, roll_out
from mitigate.agents.topological.stored import SPACING, ScenePoses, Store, StoredWalk
from mitigate.core.observation import VIEWS
from mitigate.corruptions import CLEAN
from mitigate.worlds.apartments import simulator
from mitigate.worlds.apartments.apartment import apartment_of
from mitigate.worlds.apartments.renderer import Renderer
from mitigate.worlds.apartments.tasks import load_episodes, make_episode
from mitigate.worlds.apartments.world import ApartmentsWorld
from mitigate.worlds.world import Corrupted
from tests.agents.rooms import Corner, room, sure, wanderer

SIZE, SCENE = 16, "apartments/train/000000"


class RoomWorld:
    """An empty room whose views are noise; every route is one step long."""

    rule_metres = 2.0
    done = False
    expert = property(lambda self: self)

    def __init__(self, number: int, width: int) -> None:
        rng = np.random.default_rng(number)
        self.episode, self.space = load_episodes("val_seen")[number], room(7, 7)
        self.xy, self.heading = rng.uniform(1, 6, 2), rng.uniform(-3, 3)
        self.goal = np.array([6.0, 6.0]) if self.xy.sum() < 7 else np.array([1.0, 1.0])
        self.views = rng.normal(size=(VIEWS, width)).astype(np.float32)

    def pose(self) -> np.ndarray:
        return np.array([*self.xy, self.heading])

    def go(self, route: list[np.ndarray]) -> None:
        dx, dy = route[-1] - self.xy
        self.xy, self.heading = route[-1], float(np.arctan2(-dx, dy))

    def distance(self, xy: np.ndarray) -> float:
        return float(np.hypot(*(xy - self.goal)))

    def counts(self, metres: float) -> bool:
        return metres < self.rule_metres


def perceive(worlds: list[RoomWorld]) -> list[tuple[torch.Tensor, np.ndarray]]:
    return [(w.views, select(sure(w.space, w.xy, w.heading))) for w in worlds]


def traces_of(expert_share: float, seed: int = 0, limit: int = 12):
    agent = wanderer()
    worlds = [RoomWorld(n, sum(agent.planner.widths)) for n in range(5)]
    tokens = Vocabulary().batch([w.episode.instruction.text for w in worlds])
    rngs = [np.random.default_rng([seed, i]) for i in range(len(worlds))]
    output = roll_out(
        agent.planner, tokens, worlds, perceive, expert_share=expert_share, rngs=rngs, limit=limit
    )
    return output, worlds


@pytest.mark.parametrize("expert_share", [1.0, 0.3, 0.0])
def test_oracle_targets_sum_to_one(expert_share):
    traces, _ = traces_of(expert_share)
    assert len(traces) == 5
    for trace in traces:
        assert len(trace.views) == len(trace.steps) > 0
        for step in trace.steps:
            nodes, ghosts = len(step.decision.nodes), len(step.decision.ghosts)
            assert step.target.shape == (1 + ghosts,) and step.metres.shape == (1 + nodes + ghosts,)
            assert step.target.sum() == pytest.approx(1) and (step.target >= 0).all()
            assert step.target[0] in (0.0, 1.0)


def test_oracle_stops_at_the_goal():
    traces, worlds = traces_of(1.0)
    for trace, world in zip(traces, worlds, strict=True):
        assert trace.steps[-1].target[0] == 1.0
        assert world.distance(world.xy) <= STOP_BEST
        assert all(step.target[0] == 0.0 for step in trace.steps[:-1])


@pytest.mark.parametrize("metres", [0.2, 0.5, 1.5])
def test_oracle_stops_only_where_it_counts(monkeypatch, metres):
    """The oracle continues until its distance to the goal counts as success."""
    free, _ = traces_of(1.0)
    monkeypatch.setattr(RoomWorld, "rule_metres", metres)
    bound, _ = traces_of(1.0)
    for before, after in zip(free, bound, strict=True):
        own_value = [step for step in after.steps if step.target[0] == 1.0]
        assert all(step.metres[0] < metres for step in own_value)
        if before.steps[-1].metres[0] < metres:
            assert len(before.steps) == len(after.steps)
        else:
            assert len(after.steps) > len(before.steps)


def test_roll_out_ends_at_the_limit():
    traces, _ = traces_of(0.0, limit=2)
    assert max(len(trace.steps) for trace in traces) <= 2


def test_roll_out_ends_with_the_episode(monkeypatch):
    """A rollout ends with the episode, even in the middle of a route, because worlds reject steps
    after the last one."""
    monkeypatch.setattr(simulator, "MAX_STEPS", 12)
    worlds, episodes = [ApartmentsWorld(SIZE) for _ in range(3)], load_episodes("val_seen")[:3]
    rngs = [np.random.default_rng(n) for n in range(3)]
    piece = wanderer().collect(worlds, episodes, expert_share=0.5, rngs=rngs)
    assert [world.measures()["steps"] for world in worlds] == [12, 12, 12]
    for trace in piece.traces:
        assert len(trace.views) == len(trace.steps) > 0


@pytest.mark.slow
def test_roll_out_depends_only_on_its_generator():
    def walked(seed):
        return [world.xy.tolist() for world in traces_of(0.2, seed)[1]]

    assert walked(1) == walked(1) != walked(2)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Return an untrained agent, and its stored features of the first training apartment."""
    agent = wanderer()
    store = Store(agent, partial(ApartmentsWorld, SIZE, 1), tmp_path_factory.mktemp("stored"))
    store.build()
    return agent, store.features(SCENE), store


def test_stored_views_equal_rendered_views(stored):
    agent, features, _ = stored
    apartment, renderer = apartment_of("apartments/train/000000"), Renderer(SIZE)
    renderer.load(apartment)
    world = StoredWalk(make_episode(apartment, "vln", 0), features, ApartmentsWorld(SIZE))
    for turn in (0, 1, 4, 11):
        world.turn, world.index = turn, 7 * turn
        x, y, heading = world.pose()
        assert heading == pytest.approx(np.radians(30 * turn))
        rgb, depth, _ = renderer.render(x, y, heading)
        with torch.no_grad():
            seen, _, _ = agent.perceive(*(torch.from_numpy(a)[None] for a in (rgb, depth)))
        views, _ = world.perceive()
        errors = [
            float(np.abs(np.roll(views, k, 0) - seen[0].float().numpy()).mean())
            for k in range(VIEWS)
        ]
        assert int(np.argmin(errors)) == 0 and errors[0] < 0.2 * np.median(errors[1:])


def test_stored_waypoints_do_not_depend_on_the_heading(stored):
    _, features, _ = stored
    episode = make_episode(apartment_of(SCENE), "vln", 1)
    world = StoredWalk(episode, features, ApartmentsWorld(SIZE))

    def ends() -> np.ndarray:
        _, waypoints = world.perceive()
        angles = world.pose()[2] - waypoints[:, 0]
        return waypoints[:, 1:] * np.stack([-np.sin(angles), np.cos(angles)], 1)

    world.turn = 0
    expected = ends()
    for turn in (1, 5, 9):
        world.turn = turn
        assert np.allclose(ends(), expected, atol=1e-5) and len(expected) > 0


def test_store_holds_free_lattice_poses(stored):
    _, features, _ = stored
    apartment = apartment_of("apartments/train/000000")
    world = StoredWalk(make_episode(apartment, "vln", 0), features, ApartmentsWorld(SIZE))
    world.go([apartment.space.centre(10), apartment.space.centre(200)])
    assert np.hypot(*(world.pose()[:2] - apartment.space.centre(200))) < SPACING
    assert apartment.space.index[tuple((features.xy.T[::-1] / 0.1).astype(int))].min() >= 0


def test_store_builds_only_missing_scenes(stored):
    _, _, store = stored
    before = store.path(SCENE).stat().st_mtime_ns
    store.build()
    assert store.path(SCENE).stat().st_mtime_ns == before


@pytest.mark.slow
def test_store_does_not_depend_on_the_process_count(tmp_path):
    agent = wanderer()
    one, two = (Store(agent, partial(Corner, SIZE, 2), tmp_path / name) for name in ("1", "2"))
    one.build()
    two.build(workers=2)
    assert len(one.world.scenes) == 2
    for scene in one.world.scenes:
        before, after = one.features(scene), two.features(scene)
        for name in ("xy", "views", "waypoints", "seen"):
            assert np.array_equal(getattr(before, name), getattr(after, name))
    assert {path.name for path in two.folder.iterdir()} == {
        two.path(scene).name for scene in two.world.scenes
    }


class Unguided(ApartmentsWorld):
    def expert(self):
        return None


def test_live_walk_requires_an_expert():
    with pytest.raises(ValueError, match="Unguided has no expert"):
        # the message contains the class of the user's world
        world = Corrupted(Unguided(SIZE), CLEAN, 0)
        LiveWalk(world, load_episodes("val_seen")[0])


def test_stored_folders_keep_the_class_name(tmp_path):
    """tensordict stores a class name in the folder and imports the class when it loads the
    folder."""
    arrays = {
        "xy": torch.rand(2, 2),
        "views": torch.rand(2, VIEWS, 4).half(),
        "waypoints": torch.rand(2, 6, 2),
        "seen": torch.zeros(2, VIEWS, dtype=torch.int64),
    }
    ScenePoses(**arrays, batch_size=[2]).memmap(tmp_path, num_threads=0)
    name = json.loads((tmp_path / "meta.json").read_text())["_type"]
    assert name == "<class 'mitigate.agents.topological.stored_walk.ScenePoses'>"
    assert torch.equal(ScenePoses.load_memmap(tmp_path).xy, arrays["xy"])
