"""Which end of an episode counts, what its words are meanwhile, and by which rule it is judged."""

import pytest

from mitigate.bridge.results import read
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


def test_an_env_that_is_closed_in_the_middle_ends_no_episode(tmp_path):
    """As an evaluator does that stops after so many episodes of Envs side by side."""
    found, _ = told(tmp_path, STOPS)
    assert list(found.ends) == ["s0/0"] and found.lost == ["s0/2"]


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


@pytest.mark.parametrize("how", ["later", ["over"]])
def test_an_end_of_another_kind_is_refused(how):
    from mitigate.bridge.episodes import ended

    with pytest.raises(ValueError, match="it must be over or reset or close"):
        ended({"metrics": {}, "how": how}, "1")
