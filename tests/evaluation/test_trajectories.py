"""Tests that plots of episodes agree with their rows, and that the right episodes are plotted."""

from __future__ import annotations

import cv2
import pytest

from mitigate.core.observation import DEPTH, POSE, RGB, Observation
from mitigate.corruptions import Corruption
from mitigate.corruptions.registry import title
from mitigate.evaluation import trajectories
from mitigate.evaluation.trajectories import (
    draw_episode,
    first_sight,
    run_agents,
    won_back,
    write_pictures,
)
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.evaluation.made_rows import row
from tests.evaluation.straight import Straight


def cell(name: str, corruption: str, wins: str, episodes=("a", "b", "c")) -> list[dict]:
    severity = 0.0 if corruption == "clean" else 0.6
    return [
        row(episode, win == "1", name=name, corruption=corruption, severity=severity)
        for episode, win in zip(episodes, wins, strict=True)
    ]


def test_won_back_yields_each_episode_once():
    before = cell("before", "flare", "101") + cell("before", "spatter", "000")
    after = cell("x", "flare", "111") + cell("x", "spatter", "111")
    rows = sorted(before + after, key=lambda r: r["episode_id"])
    assert list(won_back(rows, "before", "x")) == [
        ("a", Corruption("spatter", 0.6)),
        ("b", Corruption("flare", 0.6)),
    ]


def test_won_back_ignores_clean_rows_and_single_agents():
    rows = cell("before", "clean", "000") + cell("x", "clean", "111")
    assert not list(won_back(rows, "before", "x"))
    assert not list(won_back(cell("before", "flare", "000"), "before", "x"))


@pytest.mark.parametrize("name", ["low_light", "missing_data"])
def test_draw_episode_draws_clean_and_corrupted_runs(tmp_path, monkeypatch, name):
    drawn = []
    monkeypatch.setattr(
        trajectories, "draw_path", lambda axes, path, *rest: drawn.append((path, rest))
    )
    agents = {"base": Straight(1), "hardened": Straight(3)}
    corruption = Corruption(name, 0.6)
    world = ApartmentsWorld(64)
    episode, out = load_episodes("val_seen")[0], tmp_path / "b.png"
    walks = list(run_agents(agents, world, episode, corruption, 0))
    draw_episode(walks, world, episode, corruption, 0).savefig(out)
    assert cv2.imread(str(out)).std() > 10
    labels = [rest[1].split(":")[0] for _, rest in drawn]
    displayed = title(name)
    assert labels == [
        "reference path",
        "base, clean",
        f"base, {displayed}",
        f"hardened, {displayed}",
    ]
    assert [len(path) for path, _ in drawn[1:]] == [2, 2, 4]
    assert all("fail" in rest[1] for _, rest in drawn[1:])


class Shows(ApartmentsWorld):
    """An apartment world that shows only RGB, only depth, or no frames."""

    only: tuple[str, ...] = ()

    def reset(self, episode):
        seen = super().reset(episode)
        return Observation({name: seen[name] for name in (POSE, *self.only)})


@pytest.mark.parametrize(("only", "entry"), [((DEPTH,), DEPTH), ((RGB,), RGB), ((), "")])
def test_first_sight_uses_available_frames(only, entry):
    world, episode = Shows(16, views=1), load_episodes("val_seen")[0]
    world.only = only
    matches, pictures = first_sight(world, episode, Corruption("black_box", 1.0), 0)
    assert matches == entry and [p.shape for p in pictures] == [(16, 16, 3)] * 2 * bool(entry)


def test_write_pictures_draws_the_episodes_won_back(tmp_path):
    episodes = load_episodes("val_seen")[:3]
    ids = [episode.episode_id for episode in episodes]
    rows = cell("before", "flare", "100", ids) + cell("x", "flare", "111", ids)
    agents = {"before": Straight(1), "x": Straight(2)}
    saved = write_pictures(agents, ApartmentsWorld(64), episodes, rows, tmp_path)
    assert [p.name for p in saved] == [f"{ids[1]}-flare.png"]


def test_write_pictures_draws_a_single_agent(tmp_path):
    (episode,), world = load_episodes("val_seen")[:1], ApartmentsWorld(64)
    rows = cell("x", "clean", "1", [episode.episode_id])
    assert write_pictures({"x": Straight(1)}, world, [episode], rows, tmp_path) == []
    rows += cell("x", "black_out", "1", [episode.episode_id])
    assert len(write_pictures({"x": Straight(1)}, world, [episode], rows, tmp_path)) == 1
