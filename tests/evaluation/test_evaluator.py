"""Tests that rows do not depend on the number of processes, and that an evaluation can be
resumed."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import torch

from mitigate.core.observation import DEPTH, POSE, RGB, STOP, Observation
from mitigate.corruptions import (
    CLEAN,
    INSTRUCTION,
    NAMES,
    Corruption,
    Key,
    corrupt_instruction,
    inject_system_prompt,
)
from mitigate.evaluation import evaluator
from mitigate.evaluation import rows as result_rows
from mitigate.evaluation.episode import instruction, run_episode
from mitigate.evaluation.evaluator import EpisodeJob, EpisodeTask, _together, evaluate
from mitigate.guards.frames.restorer import Restorer
from mitigate.guards.guard import Guards
from mitigate.guards.opening import open_guards
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.agents.rooms import wanderer
from tests.evaluation.straight import Straight

CONDITIONS = [CLEAN, *(Corruption(name, 0.6) for name in NAMES[::5])]
SIZE = 16


def run(folder, workers=1, episodes=2, conditions=CONDITIONS, agent=None, **options):
    return evaluate(
        agent or wanderer(stop=0.0),
        partial(ApartmentsWorld, SIZE),
        load_episodes("val_seen")[:episodes],
        conditions,
        name="test",
        out=folder / "rows.jsonl",
        split="val_seen",
        workers=workers,
        **options,
    )


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("one")
    return folder, run(folder)


@pytest.mark.slow
def test_two_workers_give_the_rows_of_one(finished, tmp_path):
    folder, rows = finished
    assert run(tmp_path, workers=2) == rows
    assert (tmp_path / "rows.jsonl").read_bytes() == (folder / "rows.jsonl").read_bytes()


@pytest.mark.slow
def test_evaluate_rejects_workers_whose_classes_are_others(tmp_path, monkeypatch):
    agent = Straight(1)
    run(tmp_path / "equal", workers=2, agent=agent, conditions=[CLEAN])
    monkeypatch.setattr(Straight, "limit", 3, raising=False)
    with pytest.raises(ValueError, match=r"class attributes of Straight .* set workers=1"):
        run(tmp_path / "other", workers=2, agent=agent, conditions=[CLEAN])


def test_evaluate_warns_of_conflicting_rows(tmp_path):
    one = run(tmp_path, agent=Straight(1), conditions=[CLEAN])
    other = one[0] | {"success": 1 - one[0]["success"]}
    result_rows.append(tmp_path / "rows.jsonl", [other])
    with pytest.warns(UserWarning, match="1 rows have another success"):
        assert run(tmp_path, agent=Straight(1), conditions=[CLEAN]) == [other, one[1]]


@pytest.mark.slow
def test_rows_behind_a_restorer_are_of_another_agent(tmp_path):
    conditions = [CLEAN, Corruption("black_out", 0.9)]
    seen = []

    class Noted(Restorer):
        def observe(self, observation):
            seen.append(observation)
            return super().observe(observation)

    alone = run(tmp_path, episodes=1, conditions=conditions)
    restorer = Noted(width=4, depth_width=4)
    for net in restorer.parts().values():
        net.threshold.fill_(1e9)  # this restorer classifies every frame as clean
    behind = run(tmp_path, episodes=1, conditions=conditions, guards=Guards([restorer]))
    assert len(seen) == sum(row["decisions"] for row in behind) > 0
    assert {row["agent"] for row in alone}.isdisjoint(row["agent"] for row in behind)
    without = [{k: v for k, v in row.items() if k != "agent"} for row in alone]
    assert without == [{k: v for k, v in row.items() if k != "agent"} for row in behind]
    assert len((tmp_path / "rows.jsonl").read_text().splitlines()) == 4
    restorer.nets["rgb"].threshold.fill_(0.0)
    assert run(tmp_path, episodes=1, conditions=conditions, guards=Guards([restorer])) != behind


@pytest.mark.slow
def test_rows_with_a_callable_do_not_depend_on_workers(tmp_path):
    guards = open_guards("classifier", "tests.guards.filters:Brighter")
    conditions = [CLEAN, Corruption("low_light", 0.9), Corruption("black_box", 0.9)]
    one = run(tmp_path / "one", conditions=conditions, guards=guards)
    two = run(tmp_path / "two", workers=2, conditions=conditions, guards=guards)
    assert one == two
    alone = run(tmp_path / "alone", conditions=conditions)
    assert {row["agent"] for row in alone}.isdisjoint(row["agent"] for row in one)


def test_row_identifies_its_measurement(finished):
    _, rows = finished
    assert len(rows) == 2 * len(CONDITIONS)
    assert {(r["corruption"], r["severity"]) for r in rows} == {
        (c.name, c.severity) for c in CONDITIONS
    }
    for row in rows:
        assert row["name"] == "test" and row["split"] == "val_seen" and len(row["agent"]) == 12
        assert row["success"] in (0, 1) and 0 <= row["spl"] <= row["success"]
        assert 0 <= row["ndtw"] <= 1 and row["decisions"] <= 15 and row["steps"] <= 500
        assert "STOP" in row["rule"] and "2.0 m" in row["rule"]
        # the scene names equal those in older rows
        assert row["scene"] == row["episode_id"].partition("-")[0]


class Won(ApartmentsWorld):
    """A world that reports success as True instead of a number."""

    def measures(self) -> dict:
        return super().measures() | {"success": True, "spl": 1.0}


def test_row_stores_boolean_success_as_number(tmp_path):
    episodes = load_episodes("val_seen")[:1]
    options = {"name": "test", "out": tmp_path / "rows.jsonl", "split": "val_seen"}
    (records,) = evaluate(Straight(1), partial(Won, SIZE), episodes, [CLEAN], **options)
    assert records["success"] == 1 and type(records["success"]) is int


def test_progress_counts_one_rollout_per_condition(tmp_path, capsys):
    episodes, met = load_episodes("val_seen")[:1], [CLEAN, Corruption("flare", 0.6)]
    options = {"name": "test", "out": tmp_path / "rows.jsonl", "split": "val_seen"}
    evaluate(Straight(1), partial(Won, SIZE), episodes, met, **options)
    printed = capsys.readouterr().out
    assert "test, val_seen: 2 episodes" in printed and "episode 2/2, done in" in printed
    evaluate(Straight(1), partial(Won, SIZE), episodes, [*met, Corruption("flare", 0.3)], **options)
    assert "3 episodes, 2 already done" in capsys.readouterr().out


def test_corruptions_change_what_the_agent_does(finished):
    _, rows = finished
    paths = {(r["episode_id"], r["corruption"]): (r["path_length"], r["steps"]) for r in rows}
    clean = {e: paths[e, "clean"] for e, _ in paths}
    assert any(path != clean[episode] for (episode, _), path in paths.items())


def test_interrupted_evaluation_runs_only_missing_episodes(finished, tmp_path, monkeypatch):
    folder, rows = finished
    lines = (folder / "rows.jsonl").read_text().splitlines(keepends=True)
    (tmp_path / "rows.jsonl").write_text("".join(lines[:7]) + lines[7][:60])
    ran, real = [], evaluator.run_episode

    def counted(agent, world, episode, corruption, *others):
        ran.append((episode.episode_id, corruption.name))
        return real(agent, world, episode, corruption, *others)

    monkeypatch.setattr(evaluator, "run_episode", counted)
    assert run(tmp_path) == rows
    assert ran == [(row["episode_id"], row["corruption"]) for row in rows[7:]]
    assert run(tmp_path) == rows and len(ran) == len(rows) - 7


def test_result_does_not_depend_on_earlier_episodes(finished, tmp_path):
    _, rows = finished
    alone = run(tmp_path, conditions=CONDITIONS[-1:])
    assert alone == [row for row in rows if row["corruption"] == CONDITIONS[-1].name]


@pytest.mark.slow
def test_row_of_a_pair_holds_its_version(tmp_path):
    names = ("low_light+missing_data", "spatter+mask", "haze", "ripple+flare")
    records = run(tmp_path, episodes=1, conditions=[CLEAN, *(Corruption(n, 0.6) for n in names)])
    versions = {row["corruption"]: row.get("version") for row in records}
    assert versions == dict(zip(("clean", *names), (None, None, None, "1", "1"), strict=True))
    assert run(tmp_path, episodes=1, conditions=[Corruption("haze", 0.6)]) == records[3:4]


def test_pair_corrupts_sensors_and_instruction():
    episode, world, agent = load_episodes("val_seen")[5], ApartmentsWorld(SIZE), Watcher()
    looks = {}
    for name in ("low_light", "multipath", "low_light+multipath"):
        run_episode(agent, world, episode, Corruption(name, 0.8), 0)
        looks[name] = agent.seen
    for one, other, both in zip(*looks.values(), strict=True):
        assert (both[RGB] == one[RGB]).all() and (both[DEPTH] == other[DEPTH]).all()
    spoken = instruction(episode, Corruption("spatter+mask", 0.8), 0)
    assert spoken == instruction(episode, Corruption("mask", 0.8), 0) != episode.instruction.text


def test_other_weights_are_another_agent(finished, tmp_path):
    _, rows = finished
    others = run(tmp_path, conditions=[CLEAN], agent=wanderer(stop=50.0))  # stops at once
    assert others[0]["agent"] != rows[0]["agent"] and [r["steps"] for r in others] == [1, 1]


def test_frames_are_rendered_only_if_they_are_read():
    reads = []

    def frames() -> dict[str, np.ndarray]:
        reads.append(1)
        return {RGB: np.zeros(1), DEPTH: np.ones(1)}

    seen = Observation({POSE: np.zeros(3)}, frames, (RGB, DEPTH))
    assert list(seen) == [POSE, RGB, DEPTH] and len(seen) == 3 and seen[POSE].shape == (3,)
    assert not reads
    assert seen[RGB].sum() == 0 and seen[DEPTH].sum() == 1 and reads == [1]


class Watcher:
    """An agent that reads every frame, turns twice, stops, and stores its observations."""

    def reset(self, instruction: str) -> None:
        self.seen = []

    def act(self, observation) -> int:
        self.seen.append({name: observation[name].copy() for name in observation})
        return 2 if len(self.seen) < 3 else STOP


@pytest.mark.parametrize(
    ("name", "hurt", "whole"), [("low_light", RGB, DEPTH), ("multipath", DEPTH, RGB)]
)
def test_corruption_changes_every_observation(name, hurt, whole):
    episode, world, agent = load_episodes("val_seen")[5], ApartmentsWorld(SIZE), Watcher()
    run_episode(agent, world, episode, CLEAN, 0)
    clean = agent.seen
    measures = run_episode(agent, world, episode, Corruption(name, 0.8), 0)
    assert measures["decisions"] == 3 == len(agent.seen) and measures["success"] == 0
    for before, after in zip(clean, agent.seen, strict=True):
        assert np.array_equal(before[whole], after[whole])
        assert not np.array_equal(before[hurt], after[hurt])


class Listener:
    """An agent that stores its instruction and prompt, and stops at once."""

    def __init__(self, prompt: str | None = None) -> None:
        self.told: list[tuple[str, str | None]] = []
        if prompt is not None:
            self.system_prompt = prompt

    def reset(self, instruction: str) -> None:
        self.told.append((instruction, getattr(self, "system_prompt", None)))

    def act(self, observation) -> int:
        return STOP


@pytest.mark.parametrize("name", [name for name in INSTRUCTION if name != "white_box"])
def test_agent_receives_the_corrupted_instruction(name):
    world, agent = ApartmentsWorld(SIZE), Listener()
    for episode in load_episodes("val_seen")[:3]:
        run_episode(agent, world, episode, Corruption(name, 1.0), 7)
        clean, key = episode.instruction.text, Key(7, episode.episode_id)
        assert agent.told[-1][0] == corrupt_instruction(clean, name, 1.0, key) != clean


def test_white_box_changes_the_prompt_for_one_episode():
    episode, world, prompt = load_episodes("val_seen")[0], ApartmentsWorld(SIZE), "Do: {task}"
    agent = Listener(prompt)
    run_episode(agent, world, episode, Corruption("white_box", 0.5), 7)
    hurt = inject_system_prompt(prompt, 0.5, Key(7, episode.episode_id))
    assert agent.told == [(episode.instruction.text, hurt)] and agent.system_prompt == prompt
    with pytest.raises(ValueError, match="not applicable: the agent has no system prompt"):
        run_episode(Listener(), world, episode, Corruption("white_box", 0.5), 7)


@pytest.mark.slow
def test_evaluate_warns_about_white_box_without_prompt(tmp_path):
    conditions = [CLEAN, Corruption("black_box", 0.5), Corruption("white_box", 0.5)]
    with pytest.warns(UserWarning, match="white_box is not applicable to test"):
        rows = run(tmp_path, conditions=conditions)
    assert [(r["corruption"], r["severity"]) for r in rows] == [
        ("clean", 0.0),
        ("black_box", 0.5),
    ] * 2
    assert all(rows[0].keys() == row.keys() for row in rows)


def test_evaluate_warns_about_other_languages(tmp_path):
    hindi, english, untold = (
        replace(episode, instruction=replace(episode.instruction, language=language))
        for episode, language in zip(
            load_episodes("val_seen"), ("hi-IN", "EN-gb", None), strict=False
        )
    )
    conditions = [Corruption("mask", 1.0), Corruption("capitalize+low_light", 1.0)]
    for met in conditions:
        assert instruction(hindi, met, 0) == hindi.instruction.text
        assert instruction(english, met, 0) != english.instruction.text
        assert instruction(untold, met, 0) != untold.instruction.text
    with pytest.warns(UserWarning, match="passed through unchanged: 1 in hi-IN$") as caught:
        evaluate(
            Listener(), partial(ApartmentsWorld, SIZE), [hindi, english], conditions,
            name="test", out=tmp_path / "rows.jsonl", split="made",
        )  # fmt: skip
    assert len(caught) == 1


def test_weights_that_are_no_numbers_are_not_evaluated(tmp_path):
    agent = wanderer(stop=0.0)
    with torch.no_grad():
        next(agent.parameters()).view(-1)[0] = float("nan")
    with pytest.raises(ValueError, match="The weights of test hold NaN or infinity"):
        run(tmp_path, agent=agent)
    assert not list(tmp_path.iterdir())


class Prompted(Straight):
    """An agent that runs episodes in parallel and records its prompt at every step."""

    system_prompt, together = "You follow routes. {task}", 2

    def begin(self, instruction):
        self.reset(instruction)

    def act(self, observation):
        self.heard = getattr(self, "heard", set()) | {self.system_prompt}
        return super().act(observation)

    def act_all(self, observations, memories):
        return [self.act(seen) for seen in observations]


class Own(ApartmentsWorld):
    """A user's world that wraps a shipped one, with its own constructor and state."""

    def __init__(self, dark: float) -> None:
        super().__init__(16)
        self.dark = dark


class Around:
    """Delegates undefined attributes."""

    def __init__(self) -> None:
        self.world = ApartmentsWorld(16)

    def __getattr__(self, name):
        return getattr(self.world, name)


def test_side_by_side_uses_worlds_of_one_class():
    assert _together(Prompted(1), ApartmentsWorld(16)) == Prompted.together
    assert _together(Prompted(1), Own(0.7)) == _together(Prompted(1), Around()) == 1


def test_corrupted_prompt_disables_side_by_side():
    agent, conditions = Prompted(1), [CLEAN, Corruption("white_box", 1.0)]
    episode = load_episodes("val_seen")[0]
    task = EpisodeTask(agent, partial(ApartmentsWorld, 16))
    with task.ready():
        jobs = [EpisodeJob(episode, condition, {"seed": 0}) for condition in conditions]
        assert len([*task.work(jobs)]) == 2
    assert len(agent.heard) == 2 and agent.system_prompt == Prompted.system_prompt
