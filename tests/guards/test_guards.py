"""Tests of the guard interface, of chains of guards, and of users' callables."""

from __future__ import annotations

import pickle
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mitigate.core.observation import DEPTH, RGB, Observation
from mitigate.corruptions import CLEAN, Key
from mitigate.evaluation.episode import run_episode, run_side_by_side
from mitigate.guards.frames.callables import FramesCallable, open_callable
from mitigate.guards.frames.choices import callable_of, label
from mitigate.guards.guard import NO_GUARDS, EpisodeStart, Guard, Guards, guarded
from mitigate.guards.opening import TextGuard, labels, open_guards, open_restorer
from mitigate.worlds.episodes import Episode, Instruction
from tests.evaluation.straight import Straight
from tests.guards import filters

FILTERS = "tests.guards.filters"
START = EpisodeStart(Key(0, "1"), "Go ahead.")


class Shouts(Guard):
    label = "shouts"

    def begin(self, episode):
        return episode.instruction.upper()


class Dark(Guard):
    label = "dark"
    frames = (RGB,)

    def observe(self, observation):
        return {**observation, RGB: observation[RGB] // 2}


class Room:
    """A world that provides frames. Its episodes end with the action 0 (STOP)."""

    rule, sensors, done = "STOP", {}, False

    def reset(self, episode):
        self.done = False
        return self.seen()

    def step(self, action):
        self.done = action == 0
        return self.seen()

    def seen(self):
        return Observation({"pose": 1}, lambda: {RGB: np.full((4, 4, 3), 90, np.uint8)}, (RGB,))

    def measures(self):
        return {"success": 1, "spl": 1.0}


EPISODE = Episode("1", "0", "room", (0, 0, 0), (0, 0, 0, 1), (), Instruction("Go."), ())


# the contract ------------------------------------------------------------------------------------


def test_guard_defaults_change_nothing():
    guard, observation = Guard(), {RGB: np.zeros((2, 2, 3), np.uint8)}
    assert guard.begin(START) == "Go ahead." and guard.begin_all([START]) == ["Go ahead."]
    assert guard.observe(observation) is observation
    assert guard.for_episode() is guard and not Guards([guard]).remembers
    assert guard.prepared([START]) is guard
    guard.check_shown([], "nothing")
    with guard.attach("agent"):
        pass
    world = Room()
    assert guarded(world, Guards([guard])) is world


def test_guards_apply_each_in_turn():
    chain = Guards([Shouts(), Dark(), Dark(), filters.Politely()])
    assert chain.begin(START) == "please GO AHEAD." == chain.begin_all([START])[0]
    observed = chain.observe({RGB: np.full((2, 2, 3), 200), "pose": 1})
    assert observed[RGB].max() == 50 and observed["pose"] == 1
    assert chain.label == "shouts+dark+dark" and chain.frames == (RGB,) and chain.adapts
    assert chain.prepared([START]).begin(START) == chain.begin(START)


def test_guards_reject_a_world_without_their_frames():
    Guards([Shouts(), Dark()]).check_shown([RGB], "the world")
    with pytest.raises(ValueError, match="dark is for rgb, but the world shows depth: omit"):
        Guards([Shouts(), Dark()]).check_shown([DEPTH], "the world")


def test_fingerprint_of_guards_is_what_rows_hold():
    assert NO_GUARDS.fingerprint() == "none" and NO_GUARDS.frames_hash() is None
    text = open_guards("classifier", None)
    assert text.fingerprint() == text.guards[0].safeguard.identity
    restorer = open_restorer("checkpoints/restorer")
    assert open_guards("none", "checkpoints/restorer").fingerprint() == (
        f"none+restorer-{restorer.hash}"
    )
    both = open_guards("classifier", "checkpoints/restorer")
    assert both.fingerprint() == f"{text.fingerprint()}+restorer-{restorer.hash}"
    assert both.frames_hash() == restorer.hash
    assert (
        both.label
        == "classifier+restorer"
        == "+".join(labels("classifier", "checkpoints/restorer"))
    )
    assert labels("none", "none") == labels(None, None) == []


def test_fingerprint_of_a_guard_covers_its_attributes_and_version():
    one, other, third = Dark(), Dark(), Dark()
    other.step = 3
    third.version = "2"
    assert len({guard.fingerprint() for guard in (one, other, third)}) == 3
    assert Dark().fingerprint() == one.fingerprint() != Shouts().fingerprint()
    one.opaque = iter([1])
    with pytest.raises(ValueError, match="opaque.* cannot be read. Give the guard a `version`"):
        one.fingerprint()
    one.version = "3"
    assert one.fingerprint().startswith("Dark-")


def test_guarded_world_changes_frames_when_they_are_read():
    world = guarded(Room(), Guards([Dark()]))
    observation = world.reset(EPISODE)
    assert observation["pose"] == 1 and observation._frame_data is None
    assert observation[RGB].max() == 45 and observation.clean[RGB].max() == 90


class Lower:
    """A fake safeguard."""

    identity = "lower 1"

    def canonicalise_all(self, texts):
        return [SimpleNamespace(text=text.lower()) for text in texts]


def test_text_guard_answers_before_workers_start():
    guard = TextGuard(Lower(), "lower")
    noisy = EpisodeStart(Key(0, "1"), "WALK TO THE SOFA.")
    answers = guard.begin_all([START, noisy])
    assert answers == ["go ahead.", "walk to the sofa."] and guard.begin(noisy) == answers[1]
    prepared = pickle.loads(pickle.dumps(Guards([guard]).prepared([START, noisy])))
    assert [prepared.begin(start) for start in (START, noisy)] == answers
    assert prepared.fingerprint() == guard.fingerprint()
    unknown = EpisodeStart(Key(0, "2"), "Another text.")
    assert prepared.begin(unknown) == "Another text."


def test_run_episode_attaches_guards_for_one_episode():
    agent, guards = Straight(2), Guards([filters.Politely()])
    measured = run_episode(agent, Room(), EPISODE, CLEAN, 0, guards)
    assert measured["success"] == 1 and agent.left == -1
    assert agent.steps == 2, "the agent is as it was"

    class Broken(Straight):
        def act(self, observation):
            raise RuntimeError("stopped")

    agent = Broken(2)
    with pytest.raises(RuntimeError):
        run_episode(agent, Room(), EPISODE, CLEAN, 0, guards)
    assert agent.steps == 2


def test_run_side_by_side_gives_each_episode_its_guards():
    heard, seen = [], []

    class Together:
        def begin(self, instruction):
            heard.append(instruction)

        def act_all(self, observations, memories):
            seen.extend(observation[RGB].max() for observation in observations)
            return [0] * len(observations)

    jobs = [(EPISODE, CLEAN, 0)] * 3
    chain = Guards([Shouts(), Dark()])
    assert len(list(run_side_by_side(Together(), [Room(), Room()], jobs, chain))) == 3
    assert heard == ["GO."] * 3 and seen == [45] * 3


# restore=module:callable -------------------------------------------------------------------------


def frames():
    rng = np.random.default_rng(0)
    depth = rng.uniform(1, 9, (4, 4, 1)).astype(np.float32)
    return {RGB: rng.integers(0, 200, (4, 4, 3), np.uint8), DEPTH: depth, "pose": 1}


def test_callable_of_tells_callables_from_folders(tmp_path, monkeypatch):
    assert callable_of("a.b:c") == ("a.b", "c", None)
    assert callable_of("a:c@1.2-x") == ("a", "c", "1.2-x")
    for folder in ("checkpoints/restorer", "restorer", "restorer:rgb", "runs/a:b", "a:b:c", ""):
        assert callable_of(folder) is None
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a:c").mkdir()
    assert callable_of("a:c") is None
    assert label(f"{FILTERS}:median@a b") == "filters.median@a-b"


def test_callable_changes_only_what_it_returns():
    guard = open_restorer(f"{FILTERS}:median", [RGB])
    observed = frames()
    output = guard.observe(observed)
    assert np.array_equal(output[RGB], filters.median({RGB: observed[RGB]})[RGB])
    assert output[DEPTH] is observed[DEPTH] and output["pose"] == 1
    assert guard.label == "filters.median" and guard.frames == (RGB,)
    only_depth = {DEPTH: observed[DEPTH]}
    assert guard.observe(only_depth) is only_depth


def test_callable_that_changes_nothing_leaves_the_same_objects():
    observed = frames()
    observed[DEPTH][0, 0] = np.nan  # real sensors return this value for holes
    assert open_callable(f"{FILTERS}:unchanged").observe(observed)[RGB] is observed[RGB]
    before = {name: np.array(frame) for name, frame in observed.items()}
    output = open_callable(f"{FILTERS}:in_place").observe(observed)
    assert not output[RGB].any() and np.array_equal(observed[RGB], before[RGB])


def test_callable_class_is_built_once_and_guard_is_unchanged():
    guard = open_callable(f"{FILTERS}:Brighter")
    assert isinstance(guard.call, filters.Brighter) and guard.frames == (RGB,)
    for _ in range(2):
        assert guard.observe(frames())[RGB].min() >= 100
    assert guard.call.calls == 2
    settings = open_restorer(f"{FILTERS}:Politely@2")
    assert isinstance(settings, filters.Politely) and settings.version == "2"
    assert settings.label == "filters.Politely@2"


def test_callable_is_imported_again_by_a_worker_process():
    guard = open_callable(f"{FILTERS}:median@7")
    copied = pickle.loads(pickle.dumps(guard))
    assert isinstance(copied, FramesCallable) and copied.choice == guard.choice
    assert copied.fingerprint() == guard.fingerprint()


def test_fingerprint_of_a_callable_follows_source_and_version(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    source = "def f(frames):\n    return {}\n\ndef g(frames):\n    return {}\n"
    for name, text in (("one", source), ("two", source), ("three", source + "#\n")):
        (tmp_path / f"callable_{name}.py").write_text(text)
    choices = ("callable_one:f", "callable_one:g", "callable_one:f@2", "callable_three:f")
    loaded = [open_callable(choice).fingerprint() for choice in choices]
    assert len(set(loaded)) == 4 and all(part.startswith("restorer-") for part in loaded)
    assert open_callable("callable_one:f").fingerprint() == loaded[0]
    assert open_callable(f"{FILTERS}:median").version == "3 pixels"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("not_a_dict", "returned a list, not a dict. Return a dict of the changed frames"),
        ("wrong_key", "returned an entry 'sound', but it was given rgb, depth"),
        ("wrong_type", r"returned rgb as a list, not uint8 \[4, 4, 3\]"),
        ("wrong_shape", r"returned rgb as uint8 \[2, 2, 3\], not uint8 \[4, 4, 3\]"),
        ("wrong_dtype", r"returned rgb as float32 \[4, 4, 3\], not uint8"),
        ("not_a_number", "returned depth with NaN or infinity; 0 means no reading"),
        ("broken", f"restore={FILTERS}:broken failed with RuntimeError: out of memory"),
    ],
)
def test_observe_rejects_what_is_no_frame(name, words):
    guard = open_callable(f"{FILTERS}:{name}")
    with pytest.raises(ValueError, match=words):
        guard.observe(frames())


@pytest.mark.parametrize(
    ("choice", "words"),
    [
        ("no_such_module:f", "No module named 'no_such_module'. It must be module:callable"),
        (f"{FILTERS}.py:median", f"Write {FILTERS}:median."),
        (f"{FILTERS}:medain", "There is no object of .* 'medain'. Did you mean median?"),
        (f"{FILTERS}:NUMBER", "a int cannot be called with frames"),
        ("builtins:abs", "builtins has no source file, .* restore=builtins:NAME@VERSION"),
    ],
)
def test_open_callable_rejects_what_is_no_callable(choice, words):
    with pytest.raises(ValueError, match=words):
        open_restorer(choice)


def test_callable_rejects_wrong_frames(monkeypatch):
    monkeypatch.setattr(filters.Brighter, "frames", ("rgb", "sound"))
    with pytest.raises(ValueError, match="frames must name rgb, depth or both, got"):
        open_callable(f"{FILTERS}:Brighter")
    with pytest.raises(ValueError, match="filters.median is for rgb, but the world shows depth"):
        open_restorer(f"{FILTERS}:median", [DEPTH])


def test_documented_example_runs(tmp_path, monkeypatch):
    page = (Path(__file__).parents[2] / "docs/restoration.md").read_text(encoding="utf-8")
    code = page.partition("```python\n# filters.py\n")[2].partition("```")[0]
    (tmp_path / "documented_filters.py").write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    output = open_restorer("documented_filters:median").observe(frames())
    assert output[RGB].shape == (4, 4, 3)
