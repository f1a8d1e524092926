"""Tests of how episodes end: which episodes count, and when the instruction is restored."""

import sys

import pytest

from mitigate.bridge.results import maybe_normalised, read
from mitigate.bridge.server import Listener

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


def run_env(tmp_path, code, settings=None):
    """Run a program on the fake lab; return its reports and its output."""
    with Listener(settings or condition(), tmp_path) as listener:
        process = python(listener, BEGIN + code)
    assert process.returncode == 0, process.stdout
    return read(tmp_path), process.stdout


STOPS = """
a, b = over(*episodes[:2]), over(*episodes[2:])
for env in (a, b):
    env.reset()
walk(a, [1, 0])
walk(b, [1])
a.close()
b.close()
"""


def test_close_drops_unfinished_episodes_of_parallel_envs(tmp_path):
    """An evaluator with parallel Envs stops after a given number of episodes, while others are
    unfinished."""
    reports, _ = run_env(tmp_path, STOPS)
    assert list(reports.ends) == ["s0/0"] and reports.lost == ["s0/2"]


def test_count_closed_keeps_unfinished_episodes_of_parallel_envs(tmp_path):
    run_env(tmp_path, STOPS)
    reports = read(tmp_path, count_closed=True)
    assert sorted(reports.ends) == ["s0/0", "s0/2"] and not reports.lost


def test_close_drops_unfinished_episodes_after_a_reset(tmp_path):
    reports, _ = run_env(tmp_path, STOPS.replace("walk(a, [1, 0])", "walk(a, [1]); a.reset()"))
    assert list(reports.ends) == ["s0/0"] and reports.lost == ["s0/2"]


LIMITS = ["[1, 0], [1, 1, 1], [1, 0]", "[1, 0], [1, 0], [1, 1]", "[1, 1], [1, 0], [1, 1]"]


@pytest.mark.parametrize("acts", LIMITS)
@pytest.mark.parametrize("each", [True, False])
def test_close_ends_the_episode_of_a_single_env(tmp_path, acts, each):
    """The program, and not the Env, limits the number of steps; closing a single Env ends its
    episode."""
    new = "env = over(one); env.reset()" if each else "env.reset()"
    code = (
        "env = over(*episodes[:3])\n"
        f"for one, some in zip(episodes, ({acts})):\n    {new}; walk(env, some)\n"
        f"    if {each}: env.close()\nenv.close()"
    )
    reports, _ = run_env(tmp_path, code)
    assert len(reports.ends) == 3 and not reports.lost


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
def test_end_ignores_exceptions_that_end_a_loop(tmp_path, how):
    reports, _ = run_env(tmp_path, f"env = over(*episodes[:2]); env.reset()\n{ORDERLY[how]}")
    assert sorted(reports.ends) == ["s0/0", "s1/1"] and not reports.lost


def test_run_names_the_exception_that_ended_an_episode(run, tmp_path):
    file = tmp_path / "nav.py"
    code = "class Done(Exception): pass\nenv = over(episodes[0]); env.reset()\nwalk(env, [1, 1])\n"
    file.write_text(f"{BEGIN}{code}try: raise Done('far')\nexcept Done: env.close()\n")
    result = run(tmp_path / "o", "conditions=[clean]", f"{sys.executable} {file}")
    line = file.read_text().count("\n") - 1
    assert f"s0/0: it was reset or closed during an exception, Done: far ({file}:{line})" in (
        result.stderr
    )


@pytest.mark.slow
def test_run_explains_closed_episodes(run, tmp_path):
    file, out = tmp_path / "nav.py", tmp_path / "o"
    file.write_text(BEGIN + STOPS)
    result = run(out, "conditions=[clean]", f"{sys.executable} {file}")
    assert "such as s0/2: its Env was closed before" in result.stderr
    assert "count_closed=true" in result.stderr
    counted = run(out, "conditions=[clean] count_closed=true", f"{sys.executable} {file}")
    assert "1 closed before the end (judged where they stopped)" in counted.stdout, counted.stderr
    again = run(out, "conditions=[clean]", f"{sys.executable} {file}")
    assert "measured again: 1 episode was left unfinished" in again.stdout and again.stderr


def test_close_ends_the_last_episode_of_unending_envs(tmp_path):
    code = "env = over(*episodes[:2])\nfor _ in range(2): env.reset(); walk(env, [1, 3])\n"
    reports, _ = run_env(tmp_path, f"{code}env.close()")
    assert sorted(reports.ends) == ["s0/0", "s1/1"] and not reports.lost


TRY = """
def attempt(one, broken):
    env = over(one)
    env.reset()
    try:
        walk(env, [1, 0] if not broken else [1, 1], broken)
    finally:
        env.close()
"""


def test_end_drops_the_episode_of_a_failed_worker(tmp_path):
    code = "try: attempt(episodes[0], True)\nexcept RuntimeError: pass\n"
    reports, _ = run_env(tmp_path, TRY + code)
    assert not reports.ends and reports.lost == ["s0/0"]


def test_end_counts_a_retry_inside_an_exception_handler(tmp_path):
    code = "try: attempt(episodes[0], True)\nexcept RuntimeError: attempt(episodes[0], False)\n"
    reports, _ = run_env(tmp_path, TRY + code)
    assert (
        reports.ends["s0/0"]["metrics"]["success"] == 1.0
        and not reports.lost
        and not reports.repeated
    )


def test_reset_inside_an_exception_handler_drops_the_episode(tmp_path):
    code = (
        "env = over(*episodes[:2])\nenv.reset()\n"
        "try: walk(env, [1], True)\nexcept RuntimeError: env.reset()\n"
        "walk(env, [1, 0])"
    )
    reports, _ = run_env(tmp_path, code)
    assert list(reports.ends) == ["s1/1"] and reports.lost == ["s0/0"]


def test_reports_prefer_an_end_that_was_over(tmp_path):
    code = (
        "env = over(episodes[0], *episodes[:2])\nenv.reset(); walk(env, [1])\n"
        "for _ in range(2): env.reset(); walk(env, [1, 0])\n"
    )
    reports, _ = run_env(tmp_path, code)
    assert reports.ends["s0/0"]["metrics"]["success"] == 1.0 and reports.repeated == 0


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


def test_hook_corrupts_a_shared_instruction_once(tmp_path):
    _, printed = run_env(tmp_path, HEARD, condition("friendly", 1.0))
    first, again, second, same, still, *own_value = printed.strip().split("|")
    assert first == again != own_value[0] == "Walk to the door 0."
    assert second == same == still != own_value[1] == "Walk to the door 1."


def test_hook_restores_an_instruction_that_the_program_changed(tmp_path):
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
    _, printed = run_env(tmp_path, code, condition("friendly", 1.0))
    first, second, again, beside, *own_value = printed.strip().split("|")
    assert own_value == ["Walk to the door 0.", "Walk to the door 1."]
    assert first == again == beside != own_value[0] and second != own_value[1]


@pytest.mark.parametrize("copied", ["copy.deepcopy(one)", "pickle.loads(pickle.dumps(one))"])
def test_hook_restores_copies_of_an_instruction(tmp_path, copied):
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
    _, printed = run_env(tmp_path, code, condition("friendly", 1.0))
    first, same, own_value = printed.strip().split("|")
    assert (
        first == same
        and own_value.startswith("Walk to the door 0. {")
        and "_mitigate" not in own_value
    )


@pytest.mark.parametrize("how", ["later", ["over"]])
def test_read_end_rejects_an_unknown_kind(how):
    from mitigate.bridge.events import read_end

    with pytest.raises(ValueError, match="it must be over or reset or close"):
        read_end({"metrics": {}, "how": how}, "1")


def test_maybe_normalised_ignores_declared_depth(tmp_path):
    assert (
        maybe_normalised(
            run_env(tmp_path, "env = over(episodes[0]); env.reset(); walk(env, [1, 0])")[0]
        )
        == []
    )
