"""Tests of schedules, which choose the corruption of each frame."""

import json
from collections import Counter

import pytest

from mitigate.corruptions import CLEAN, DEPTH, NAMES, RGB, Key, Schedule

SUCCESS = {name: 0.1 * (i % 10) for i, name in enumerate(NAMES)}


def names_of(schedule, count=6000, frames=1):
    return Counter(schedule.draw(0, f"e{i // frames}", i % frames)[0].name for i in range(count))


def test_clean_hurts_nothing():
    schedule = Schedule("clean", 0.6)
    assert {schedule.draw(1, "e", i) for i in range(9)} == {
        (CLEAN, Key(1, "e", i)) for i in range(9)
    }


@pytest.mark.parametrize("mode, frames", [("per_frame", 10), ("per_episode", 1)])
def test_shares_are_those_asked_for(mode, frames):
    result = names_of(Schedule(mode, 0.6, clean_share=0.4), frames=frames)
    assert result["clean"] / 6000 == pytest.approx(0.4, abs=0.03)
    for name in NAMES:
        assert result[name] / 6000 == pytest.approx(0.6 / 12, abs=0.012)


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_clean_share_can_be_zero_or_one(share):
    result = names_of(Schedule("per_frame", 0.6, clean_share=share), 500, frames=5)
    assert result["clean"] == 500 * share


def test_per_episode_keeps_corruption_and_episode_state():
    schedule = Schedule("per_episode", 0.6)
    draws = [schedule.draw(4, "e", i) for i in range(50)]
    assert len({corruption for corruption, _ in draws}) == 1
    assert [key for _, key in draws] == [Key(4, "e", i) for i in range(50)]


def test_per_frame_draws_corruption_and_episode_state_anew():
    schedule = Schedule("per_frame", 0.6)
    draws = [schedule.draw(4, "e", i) for i in range(50)]
    assert len({key.episode for _, key in draws}) == 50
    assert len({corruption.name for corruption, _ in draws}) > 6


def test_draw_depends_on_its_arguments_only():
    for mode in ("per_frame", "per_episode", "success_distributed"):
        one, other = Schedule(mode, 0.6), Schedule(mode, 0.6)
        order = [(s, f"e{e}", f) for s in range(2) for e in range(20) for f in range(3)]
        drawn = {args: one.draw(*args) for args in order}
        assert {args: other.draw(*args) for args in reversed(order)} == drawn
        assert len({one.draw(s, "e1", 0) for s in range(20)}) > 5


def test_depth_has_its_own_severity():
    schedule = Schedule("per_frame", 0.9, severity_depth=0.8, clean_share=0.0)
    for i in range(300):
        corruption, _ = schedule.draw(0, "e", i)
        assert corruption.severity == (0.9 if corruption.name in RGB else 0.8)
    assert Schedule("per_frame", 0.9, 0.0, 0.0, DEPTH).draw(0, "e", 0)[0].severity == 0.0


def test_severity_range_is_sampled_evenly():
    schedule = Schedule("per_episode", [0.2, 1.0], severity_depth=(0.5, 0.5), clean_share=0.0)
    drawn = [schedule.draw(0, f"e{i}", 0)[0] for i in range(3000)]
    rgb = sorted(c.severity for c in drawn if c.name in RGB)
    assert 0.2 <= rgb[0] < 0.21 and 0.99 < rgb[-1] <= 1.0
    assert rgb[len(rgb) // 2] == pytest.approx(0.6, abs=0.02)
    assert {c.severity for c in drawn if c.name in DEPTH} == {0.5}
    assert len({schedule.draw(0, "e", i)[0] for i in range(9)}) == 1  # one an episode
    assert schedule.corruption("flare").severity == pytest.approx(0.6)


def test_severity_range_draws_the_same_corruptions_and_keys():
    one, range_ = Schedule("per_frame", 0.6), Schedule("per_frame", [0.3, 1.0])
    for i in range(200):
        (a, key), (b, same) = one.draw(5, "e", i), range_.draw(5, "e", i)
        assert (a.name, key) == (b.name, same)


def test_names_restrict_the_draw():
    matches = names_of(Schedule("per_frame", 0.6, names=("flare", "multipath")), 400, frames=4)
    assert set(matches) == {"clean", "flare", "multipath"}


def test_weights_follow_one_minus_success():
    schedule = Schedule("success_distributed", 0.6, alpha=2.0, floor=0.1, success=SUCCESS)
    raw = {name: (1 - SUCCESS[name]) ** 2 + 0.1 for name in NAMES}
    total = sum(raw.values())
    assert schedule.weights == pytest.approx({name: w / total for name, w in raw.items()})
    matches = names_of(schedule, 12000)
    for name in NAMES:
        assert matches[name] / 12000 == pytest.approx(0.75 * schedule.weights[name], abs=0.012)


def test_weights_are_uniform_before_a_refresh():
    uniform = pytest.approx(dict.fromkeys(NAMES, 1 / 12))
    assert Schedule("success_distributed", 0.6).weights == uniform
    schedule = Schedule("per_episode", 0.6)
    schedule.refresh(SUCCESS)
    assert schedule.weights == uniform


def test_refresh_updates_weights_and_keeps_absent_rates():
    schedule = Schedule("success_distributed", 0.6, success=SUCCESS)
    before = schedule.weights["flare"]
    schedule.refresh({"flare": 0.0, "clean": 0.9})
    assert schedule.weights["flare"] > before
    assert schedule.success == {**SUCCESS, "flare": 0.0}


def test_perfect_success_without_a_floor_leaves_uniform_weights():
    perfect = dict.fromkeys(NAMES, 1.0)
    schedule = Schedule("success_distributed", 0.6, floor=0.0, success=perfect)
    assert schedule.weights == pytest.approx(dict.fromkeys(NAMES, 1 / 12))


def test_zero_weight_is_never_drawn():
    success = {**dict.fromkeys(NAMES, 1.0), "flare": 0.2}
    schedule = Schedule("success_distributed", 0.6, clean_share=0, floor=0, success=success)
    assert set(names_of(schedule, 500)) == {"flare"}


def test_state_survives_json_and_gives_the_same_draws():
    schedule = Schedule("success_distributed", 0.6, success=SUCCESS)
    state = json.loads(json.dumps(schedule.state_dict()))
    resumed = Schedule("success_distributed", 0.6)
    resumed.load_state_dict(state)
    assert resumed.weights == schedule.weights
    assert [resumed.draw(0, f"e{i}", 0) for i in range(200)] == [
        schedule.draw(0, f"e{i}", 0) for i in range(200)
    ]
    resumed.load_state_dict(Schedule("success_distributed", 0.6).state_dict())
    assert resumed.weights == Schedule("success_distributed", 0.6).weights


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"mode": "per_step"}, "must be one of clean, per_frame"),
        ({"severity": 1.2}, "from 0 .clean. to 1"),
        ({"severity_depth": -1.0}, "from 0 .clean. to 1"),
        ({"severity": [0.3, 1.1]}, "from 0 .clean. to 1"),
        ({"severity": [1.0, 0.3]}, "low <= high"),
        ({"severity": [0.3]}, "low, high"),
        ({"severity": "worst"}, "from 0 .clean. to 1"),
        ({"clean_share": 1.5}, "clean_share must be in"),
        ({"mode": "clean", "broad_share": 0.5}, "corrupts nothing.*schedule=per_episode"),
        ({"clean_share": float("nan")}, "clean_share must be in"),
        ({"names": ("spater",)}, "mean spatter"),
        ({"names": ()}, "at least one corruption"),
        ({"names": ("flare", "flare")}, "only once"),
        ({"alpha": -1.0}, "alpha and floor"),
        ({"floor": float("nan")}, "alpha and floor"),
        ({"success": {"flare": 0.5}}, "motion_blur.* have none"),
        ({"success": {**SUCCESS, "flare": 55.0}}, "shares in .0, 1."),
    ],
)
def test_wrong_settings_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Schedule(**{"mode": "success_distributed", "severity": 0.6, **arguments})


def test_foreign_state_is_rejected():
    with pytest.raises(ValueError, match="must have the entry 'success'"):
        Schedule("clean", 0.6).load_state_dict({"weights": [1]})


def test_single_name_instead_of_a_list_is_rejected():
    with pytest.raises(ValueError, match=r"names must be a list of .*such as \['spatter'\]"):
        Schedule("per_episode", 0.6, names="spatter")
