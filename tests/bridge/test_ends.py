"""Which end of an episode counts, and what its words are meanwhile."""

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


def test_close_drops_unfinished_episodes_of_parallel_envs(tmp_path):
    """As an evaluator does that stops after so many episodes of Envs side by side."""
    found, _ = told(tmp_path, STOPS)
    assert list(found.ends) == ["s0/0"] and found.lost == ["s0/2"]


def test_count_closed_keeps_unfinished_episodes_of_parallel_envs(tmp_path):
    told(tmp_path, STOPS)
    found = read(tmp_path, count_closed=True)
    assert sorted(found.ends) == ["s0/0", "s0/2"] and not found.lost


def test_close_drops_unfinished_episodes_after_a_reset(tmp_path):
    found, _ = told(tmp_path, STOPS.replace("walk(a, [1, 0])", "walk(a, [1]); a.reset()"))
    assert list(found.ends) == ["s0/0"] and found.lost == ["s0/2"]


LIMITS = ["[1, 0], [1, 1, 1], [1, 0]", "[1, 0], [1, 0], [1, 1]", "[1, 1], [1, 0], [1, 1]"]


@pytest.mark.parametrize("acts", LIMITS)
@pytest.mark.parametrize("each", [True, False])
def test_close_ends_the_episode_of_a_single_env(tmp_path, acts, each):
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
def test_end_ignores_exceptions_that_end_a_loop(tmp_path, how):
    found, _ = told(tmp_path, f"env = over(*episodes[:2]); env.reset()\n{ORDERLY[how]}")
    assert sorted(found.ends) == ["s0/0", "s1/1"] and not found.lost


def test_run_names_the_exception_that_ended_an_episode(run, tmp_path):
    file = tmp_path / "nav.py"
    code = "class Done(Exception): pass\nenv = over(episodes[0]); env.reset()\nwalk(env, [1, 1])\n"
    file.write_text(f"{BEGIN}{code}try: raise Done('far')\nexcept Done: env.close()\n")
    ran = run(tmp_path / "o", "conditions=[clean]", f"{sys.executable} {file}")
    line = file.read_text().count("\n") - 1
    assert f"s0/0: it was reset or closed during an exception, Done: far ({file}:{line})" in (
        ran.stderr
    )


def test_run_explains_closed_episodes(run, tmp_path):
    file, out = tmp_path / "nav.py", tmp_path / "o"
    file.write_text(BEGIN + STOPS)
    lost = run(out, "conditions=[clean]", f"{sys.executable} {file}")
    assert "such as s0/2: its Env was closed before" in lost.stderr
    assert "count_closed=true" in lost.stderr
    counts = run(out, "conditions=[clean] count_closed=true", f"{sys.executable} {file}")
    assert "1 closed before the end (judged where they stopped)" in counts.stdout, counts.stderr
    again = run(out, "conditions=[clean]", f"{sys.executable} {file}")
    assert "measured again: 1 episode was left unfinished" in again.stdout and again.stderr


def test_close_ends_the_last_episode_of_unending_envs(tmp_path):
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


def test_end_drops_the_episode_of_a_failed_worker(tmp_path):
    code = "try: attempt(episodes[0], True)\nexcept RuntimeError: pass\n"
    found, _ = told(tmp_path, TRY + code)
    assert not found.ends and found.lost == ["s0/0"]


def test_end_counts_a_retry_inside_an_exception_handler(tmp_path):
    code = "try: attempt(episodes[0], True)\nexcept RuntimeError: attempt(episodes[0], False)\n"
    found, _ = told(tmp_path, TRY + code)
    assert found.ends["s0/0"]["metrics"]["success"] == 1.0 and not found.lost and not found.repeated


def test_reset_inside_an_exception_handler_drops_the_episode(tmp_path):
    code = (
        "env = over(*episodes[:2])\nenv.reset()\n"
        "try: walk(env, [1], True)\nexcept RuntimeError: env.reset()\n"
        "walk(env, [1, 0])"
    )
    found, _ = told(tmp_path, code)
    assert list(found.ends) == ["s1/1"] and found.lost == ["s0/0"]


def test_reports_prefer_an_end_that_was_over(tmp_path):
    code = (
        "env = over(episodes[0], *episodes[:2])\nenv.reset(); walk(env, [1])\n"
        "for _ in range(2): env.reset(); walk(env, [1, 0])\n"
    )
    found, _ = told(tmp_path, code)
    assert found.ends["s0/0"]["metrics"]["success"] == 1.0 and found.repeated == 0


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
    _, printed = told(tmp_path, HEARD, condition("friendly", 1.0))
    first, again, second, same, still, *own = printed.strip().split("|")
    assert first == again != own[0] == "Walk to the door 0."
    assert second == same == still != own[1] == "Walk to the door 1."


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
    _, printed = told(tmp_path, code, condition("friendly", 1.0))
    first, second, again, beside, *own = printed.strip().split("|")
    assert own == ["Walk to the door 0.", "Walk to the door 1."]
    assert first == again == beside != own[0] and second != own[1]


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
    _, printed = told(tmp_path, code, condition("friendly", 1.0))
    first, same, own = printed.strip().split("|")
    assert first == same and own.startswith("Walk to the door 0. {") and "_mitigate" not in own


@pytest.mark.parametrize("how", ["later", ["over"]])
def test_read_end_rejects_an_unknown_kind(how):
    from mitigate.bridge.events import read_end

    with pytest.raises(ValueError, match="it must be over or reset or close"):
        read_end({"metrics": {}, "how": how}, "1")


def test_maybe_normalised_ignores_declared_depth(tmp_path):
    assert (
        maybe_normalised(
            told(tmp_path, "env = over(episodes[0]); env.reset(); walk(env, [1, 0])")[0]
        )
        == []
    )
