"""Which end of an episode counts, what its words are meanwhile, and by which rule it is judged."""

import json
import sys

import pytest

from mitigate.bridge.results import COMMON, OWN, near, read, rows, unjudged, without_path
from mitigate.bridge.server import Listener
from mitigate.corruptions import CLEAN
from mitigate.evaluation.metrics import RULES

from .conftest import condition, python

BEGIN = """
from habitat.core.env import Dataset, Env, make_dataset
episodes = make_dataset(4).episodes

def walk(env, actions, broken=False):
    for action in actions:
        env.step(action)
    if broken:
        raise RuntimeError("the simulator died")

def over(*some):
    return Env(None, Dataset(list(some)))

"""


def told(tmp_path, code, met=None):
    """What was told of a program on the stand-in lab, and what it printed."""
    with Listener(met or condition(), tmp_path) as listener:
        ended = python(listener, BEGIN + code)
    assert ended.returncode == 0, ended.stdout
    return read(tmp_path), ended.stdout


STOPS = """
a, b = over(*episodes[:2]), over(*episodes[2:])
for env in (a, b):
    env.reset()
walk(a, [1, 0])
walk(b, [1])
a.close()
b.close()
"""


def test_an_env_that_is_closed_in_the_middle_ends_no_episode(tmp_path):
    """As an evaluator does that stops after so many episodes of Envs side by side."""
    found, _ = told(tmp_path, STOPS)
    assert list(found.ends) == ["s0/0"] and found.lost == ["s0/2"]


def test_a_close_in_the_middle_counts_though_envs_are_side_by_side_where_that_is_asked(tmp_path):
    told(tmp_path, STOPS)
    found = read(tmp_path, count_closed=True)
    assert sorted(found.ends) == ["s0/0", "s0/2"] and not found.lost


def test_a_reset_does_not_have_the_envs_count_that_an_evaluator_cuts_off(tmp_path):
    found, _ = told(tmp_path, STOPS.replace("walk(a, [1, 0])", "walk(a, [1]); a.reset()"))
    assert list(found.ends) == ["s0/0"] and found.lost == ["s0/2"]


LIMITS = ["[1, 0], [1, 1, 1], [1, 0]", "[1, 0], [1, 0], [1, 1]", "[1, 1], [1, 0], [1, 1]"]


@pytest.mark.parametrize("acts", LIMITS)
@pytest.mark.parametrize("each", [True, False])
def test_an_env_that_walks_alone_ends_its_episode_by_a_close(tmp_path, acts, each):
    """A program has a limit of steps of its own; whether others were over changes nothing."""
    new = "env = over(one); env.reset()" if each else "env.reset()"
    code = (
        "env = over(*episodes[:3])\n"
        f"for one, some in zip(episodes, ({acts})):\n    {new}; walk(env, some)\n"
        f"    if {each}: env.close()\nenv.close()"
    )
    found, _ = told(tmp_path, code)
    assert len(found.ends) == 3 and not found.lost


ORDERLY = {
    "the end of an iterator": """
for acts in ([1, 3], [1, 3]):
    some = iter(acts)
    try:
        while True: env.step(next(some))
    except StopIteration:
        if acts and env.current_episode is episodes[1]: env.close()
        else: env.reset()
""",
    "a generator that is left": """
def frames():
    try:
        for _ in range(2):
            for _ in range(2): yield env.step(1)
            if env.current_episode is episodes[0]: env.reset()
    finally: env.close()
for number, _ in enumerate(frames()):
    if number == 3: break
""",
    "an exit without a fault": """
import sys
try:
    walk(env, [1, 3]); env.reset(); walk(env, [1, 3])
    sys.exit(0)
finally: env.close()
""",
}


@pytest.mark.parametrize("how", ORDERLY)
def test_an_exception_that_only_says_that_a_loop_is_at_its_end_is_no_fault(tmp_path, how):
    found, _ = told(tmp_path, f"env = over(*episodes[:2]); env.reset()\n{ORDERLY[how]}")
    assert sorted(found.ends) == ["s0/0", "s1/1"] and not found.lost


def test_another_exception_is_named_with_its_file_and_line(run, tmp_path):
    file = tmp_path / "nav.py"
    code = "class Done(Exception): pass\nenv = over(episodes[0]); env.reset()\nwalk(env, [1, 1])\n"
    file.write_text(f"{BEGIN}{code}try: raise Done('far')\nexcept Done: env.close()\n")
    ran = run(tmp_path / "o", "conditions=[clean]", f"{sys.executable} {file}")
    line = file.read_text().count("\n") - 1
    assert f"s0/0: it was reset or closed as an exception went by, Done: far ({file}:{line})" in (
        ran.stderr
    )


def test_a_run_says_what_was_closed_and_how_to_count_it(run, tmp_path):
    file, out = tmp_path / "nav.py", tmp_path / "o"
    file.write_text(BEGIN + STOPS)
    lost = run(out, "conditions=[clean]", f"{sys.executable} {file}")
    assert "such as s0/2: its Env was closed before" in lost.stderr
    assert "count_closed=true" in lost.stderr
    counts = run(out, "conditions=[clean] count_closed=true", f"{sys.executable} {file}")
    assert "1 closed before the end (counted as it stood)" in counts.stdout, counts.stderr
    again = run(out, "conditions=[clean]", f"{sys.executable} {file}")
    assert "measured anew: 1 episode was left in the middle" in again.stdout and again.stderr


def test_a_close_ends_the_last_episode_of_a_program_whose_envs_are_never_over(tmp_path):
    code = "env = over(*episodes[:2])\nfor _ in range(2): env.reset(); walk(env, [1, 3])\n"
    found, _ = told(tmp_path, f"{code}env.close()")
    assert sorted(found.ends) == ["s0/0", "s1/1"] and not found.lost


TRY = """
def attempt(one, broken):
    env = over(one)
    env.reset()
    try:
        walk(env, [1, 0] if not broken else [1, 1], broken)
    finally:
        env.close()
"""


def test_a_worker_that_raises_leaves_its_episode_in_the_middle(tmp_path):
    code = "try: attempt(episodes[0], True)\nexcept RuntimeError: pass\n"
    found, _ = told(tmp_path, TRY + code)
    assert not found.ends and found.lost == ["s0/0"]


def test_a_retry_within_the_handler_of_its_exception_is_the_result(tmp_path):
    code = "try: attempt(episodes[0], True)\nexcept RuntimeError: attempt(episodes[0], False)\n"
    found, _ = told(tmp_path, TRY + code)
    assert found.ends["s0/0"]["metrics"]["success"] == 1.0 and not found.lost and not found.again


def test_a_reset_within_the_handler_of_an_exception_ends_no_episode(tmp_path):
    code = (
        "env = over(*episodes[:2])\nenv.reset()\n"
        "try: walk(env, [1], True)\nexcept RuntimeError: env.reset()\n"
        "walk(env, [1, 0])"
    )
    found, _ = told(tmp_path, code)
    assert list(found.ends) == ["s1/1"] and found.lost == ["s0/0"]


def test_an_end_that_was_over_is_in_place_of_a_try_that_was_given_up(tmp_path):
    code = (
        "env = over(episodes[0], *episodes[:2])\nenv.reset(); walk(env, [1])\n"
        "for _ in range(2): env.reset(); walk(env, [1, 0])\n"
    )
    found, _ = told(tmp_path, code)
    assert found.ends["s0/0"]["metrics"]["success"] == 1.0 and found.again == 0


HEARD = """
a, b = over(*episodes[:2]), over(*episodes[:2])
for env in (a, b, a, b):
    print(env.reset()["instruction"]["text"], end="|")
    if env is b: walk(env, [1, 0])
a.close()
print(b.step(1)["instruction"]["text"], end="|")
b.close()
print(*(one.instruction.instruction_text for one in episodes[:2]), sep="|")
"""


def test_words_that_two_envs_share_are_corrupted_once_and_put_back_by_the_last(tmp_path):
    _, printed = told(tmp_path, HEARD, condition("friendly", 1.0))
    first, again, second, same, still, *own = printed.strip().split("|")
    assert first == again != own[0] == "Walk to the door 0."
    assert second == same == still != own[1] == "Walk to the door 1."


def test_words_that_the_program_changes_in_place_are_corrupted_once_and_put_back(tmp_path):
    code = """
env, other = over(episodes[0], episodes[1], episodes[0]), over(episodes[0])
for number in range(3):
    print(env.reset()["instruction"]["text"], end="|")
    words = env.current_episode.instruction
    words.instruction_text = words.instruction_text.lower()
    if number == 2: print(other.reset()["instruction"]["text"], end="|")
    walk(env, [1, 0])
other.close()
env.close()
print(*(one.instruction.instruction_text for one in episodes[:2]), sep="|")
"""
    _, printed = told(tmp_path, code, condition("friendly", 1.0))
    first, second, again, beside, *own = printed.strip().split("|")
    assert own == ["Walk to the door 0.", "Walk to the door 1."]
    assert first == again == beside != own[0] and second != own[1]


@pytest.mark.parametrize("copied", ["copy.deepcopy(one)", "pickle.loads(pickle.dumps(one))"])
def test_copies_of_words_that_are_on_are_corrupted_once_and_put_back(tmp_path, copied):
    code = f"""
import copy, pickle
a, one = over(episodes[0]), episodes[0]
print(a.reset()["instruction"]["text"], end="|")
one = {copied}
a.close()
b = over(one)
print(b.reset()["instruction"]["text"], end="|")
b.close()
print(one.instruction.instruction_text, vars(one.instruction))
"""
    _, printed = told(tmp_path, code, condition("friendly", 1.0))
    first, same, own = printed.strip().split("|")
    assert first == same and own.startswith("Walk to the door 0. {") and "_mitigate" not in own


@pytest.mark.parametrize("how", ["later", ["over"]])
def test_an_end_of_another_kind_is_refused(how):
    from mitigate.bridge.episodes import ended

    with pytest.raises(ValueError, match="it must be over or reset or close"):
        ended({"metrics": {}, "how": how}, "1")


LABEL = {"agent": "a", "name": "n", "split": "s", "seed": 0}
LOOP = """
import numpy, mitigate_hook
rgb, depth = numpy.full((8, 8, 3), 90, "u1"), numpy.full((8, 8, 1), 0.4, "f4")
for name in "ab":
    episode = mitigate_hook.connect(name, instruction="go")
    episode.corrupt({"rgb": rgb, "depth": depth})
    %s
"""


def judged(tmp_path, finish, rule):
    """(success, SPL) of a loop's first episode by each rule, and what else was told."""
    with Listener(condition(), tmp_path) as listener:
        ended = python(listener, LOOP % finish)
    found = read(tmp_path)
    made = [row for row in rows(found, CLEAN, LABEL, rule) if row["episode_id"] == "a"]
    return {row["rule"]: (row["success"], row["spl"]) for row in made}, found, ended.stdout


@pytest.mark.parametrize(
    ("said", "wanted"), [("", None), (", stopped=True", 1.0), (", stopped=0", 0.0)]
)
def test_a_rule_by_stop_judges_whom_it_is_told_of(tmp_path, said, wanted):
    finish = f"episode.finish(success=True, spl=1, distance_to_goal=0.05{said})"
    found, told, printed = judged(tmp_path, finish, "objectnav")
    assert not printed and "stopped" not in told.ends["a"]["metrics"]
    assert found.get(str(RULES["objectnav"]), (None,))[0] == wanted
    assert unjudged(told, "objectnav") == ({} if said else {"stopped": 2})
    assert unjudged(told, "etpnav") == {}


@pytest.mark.parametrize("far", [", distance_to_goal=9.0", ""])
def test_a_failure_is_one_by_every_rule_though_it_tells_no_stop(run, tmp_path, far):
    file, out = tmp_path / "nav.py", tmp_path / "o"
    won = "episode.finish(success=True, stopped=True, distance_to_goal=0.05, spl=0.9)"
    lost = f"episode.finish(success=False{far})"
    file.write_text(LOOP % f"{won} if name == 'a' or 'clean' in __import__('sys').argv else {lost}")
    ran = run(out, "conditions=[spatter] rule=objectnav", f"{sys.executable} {file} {{condition}}")
    assert f"success 50.0 ({RULES['objectnav']})" in ran.stdout, ran.stderr
    made = [json.loads(line) for line in (out / "rows.jsonl").read_text().splitlines()]
    for rule in (RULES["objectnav"], COMMON["words"]):
        found = [
            r["success"] for r in made if (r["rule"], r["corruption"]) == (str(rule), "spatter")
        ]
        assert sorted(found) == [0.0, 1.0]


@pytest.mark.parametrize("first", ["rule=objectnav", ""])
def test_a_rule_that_judges_some_episodes_of_a_condition_alone_is_refused(run, tmp_path, first):
    file = tmp_path / "nav.py"
    known = "stopped=True if name == 'a' or 'clean' in __import__('sys').argv else None"
    file.write_text(LOOP % f"episode.finish(success=True, distance_to_goal=0.05, {known})")
    for options in (first, "rule=objectnav"):  # not measured, and measured without the rule
        options = f"conditions=[spatter] {options}"
        ran = run(tmp_path / "o", options, f"{sys.executable} {file} {{condition}}")
    assert "spatter-s0.6: rule=objectnav needs to know whether the agent said STOP" in ran.stderr
    assert "1 of 2 episodes did not tell: finish(stopped=...)" in ran.stderr


def test_the_common_rule_is_left_out_where_it_would_judge_some_episodes_alone(tmp_path):
    known = "distance_to_goal=0.05 if name == 'a' else None"
    found, _, _ = judged(tmp_path, f"episode.finish(success=True, {known})", None)
    assert list(found) == [OWN]


def test_failures_without_a_distance_are_of_the_common_rule_where_clean_tells_one(tmp_path):
    _, clean, _ = judged(tmp_path / "c", "episode.finish(success=True, distance_to_goal=1)", None)
    _, told, _ = judged(tmp_path / "t", "episode.finish(success=False)", None)
    common = str(COMMON["words"])
    assert common not in {row["rule"] for row in rows(told, CLEAN, LABEL, None)}
    found = rows(told, CLEAN, LABEL, None, clean)
    assert [row["success"] for row in found if row["rule"] == common] == [0.0, 0.0]


def test_stop_is_yes_or_no(tmp_path):
    _, _, printed = judged(tmp_path, "episode.finish(success=True, stopped='maybe')", None)
    assert "finish(stopped='maybe')" in printed


def test_an_spl_that_was_told_is_that_of_the_common_rule_where_both_call_it_a_success(tmp_path):
    finish = "episode.finish(success=True, spl=0.5, distance_to_goal=2.0)"
    found, told, _ = judged(tmp_path, finish, None)
    assert set(found.values()) == {(1.0, 0.5)} and not without_path(told, None)


def test_an_spl_that_nobody_told_is_counted_by_rule(tmp_path):
    finish = "episode.finish(success=False, distance_to_goal=2.0)"
    found, told, _ = judged(tmp_path, finish, None)
    assert found == {OWN: (0.0, 0.0), str(RULES["etpnav"]): (1.0, 1.0)}
    assert without_path(told, None) == {str(RULES["etpnav"]): 2}


@pytest.mark.parametrize(
    ("finish", "cameras"),
    [
        ("episode.finish(success=True)", ["depth"]),
        ("episode.corrupt({'depth': depth}); episode.finish(success=True)", ["depth"]),
        ("depth[:] = 2; episode.finish(success=True)", []),
    ],
)
def test_depth_that_reads_no_more_than_one_in_any_episode_may_be_normalised(
    tmp_path, finish, cameras
):
    _, told, _ = judged(tmp_path, finish, None)
    assert near(told) == cameras


def test_depth_that_is_said_to_be_normalised_is_not_strange(tmp_path):
    assert near(told(tmp_path, "env = over(episodes[0]); env.reset(); walk(env, [1, 0])")[0]) == []


def test_a_run_says_what_depth_may_be_and_by_which_rule_spl_is_success(run, tmp_path):
    file = tmp_path / "nav.py"
    file.write_text(LOOP % "episode.finish(success=name == 'a', distance_to_goal=2.0)")
    ran = run(tmp_path / "o", "conditions=[spatter]", f"{sys.executable} {file}")
    assert ran.returncode == 0 and ran.stdout.count("is it normalised? Say so") == 2
    assert f"1 without a path by {OWN}: SPL is success" in ran.stdout
    assert f"2 without a path by {RULES['etpnav']}: SPL is success" in ran.stdout


@pytest.mark.parametrize("rule", ["etpnav", "objectnav"])
def test_a_rule_that_nothing_tells_of_is_refused(run, tmp_path, rule):
    file, out = tmp_path / "nav.py", tmp_path / "o"
    file.write_text(LOOP % "episode.finish(success=True)")
    for before in ("", "conditions=[clean]"):  # not measured, and measured without the rule
        if before:
            assert run(out, before, f"{sys.executable} {file}").returncode == 0
        ran = run(out, f"conditions=[clean] rule={rule}", f"{sys.executable} {file}")
        assert f"rule={rule} needs to know how far the goal is" in ran.stderr
        assert "finish(distance_to_goal=...), or leave rule= out" in ran.stderr
    assert (out / "conditions/clean/done.json").exists()
