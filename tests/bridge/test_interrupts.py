"""Tests of the hook and the server under interrupts, threads and forks.

All frames must be corrupted, and the hook must reject the answer to another message.
"""

import signal
import time

import pytest

from mitigate.bridge import connection
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.results import read
from mitigate.bridge.server import Listener

from .conftest import condition, python
from .test_loops import BEGIN, run_loop
from .test_messages import EPISODE, HELLO, SPEC, Peer

BROKEN_OFF = """
class Timeout(BaseException):  # as those of gevent, func_timeout and asyncio are
    pass
def interrupted(name):
    original = getattr(mitigate_hook, name)
    def call(*given):
        setattr(mitigate_hook, name, original)
        raise Timeout("the time is up")
    setattr(mitigate_hook, name, call)
episode = mitigate_hook.connect('a')
episode.corrupt({'rgb': rgb})
interrupted(sys.argv[1])
try:
    episode.corrupt({'rgb': rgb})
except BaseException:
    pass
print('went on')
"""


@pytest.mark.parametrize(
    "where", ["send", "receive", "_describe_array", "_median_and_maximum", "_find_cameras"]
)
def test_corrupt_stops_when_interrupted(tmp_path, where):
    code = BROKEN_OFF.replace("{'rgb': rgb}", "{'rgb': rgb, 'depth': depth}")
    if where == "_median_and_maximum":  # the answer to the first frame
        code = code.replace("episode.corrupt({'rgb': rgb, 'depth': depth})\ninter", "inter")
    with Listener(condition("low_light"), tmp_path) as listener:
        process = python(listener, BEGIN + code, where)
    assert process.returncode == 97 and "went on" not in process.stdout, process.stdout
    assert "Timeout: the time is up" in read(tmp_path).problems[0]


def test_connect_stops_when_interrupted(tmp_path):
    code = BROKEN_OFF.replace("episode.corrupt({'rgb': rgb})\n", "mitigate_hook.connect('b')\n")
    with Listener(condition("low_light"), tmp_path) as listener:
        process = python(listener, BEGIN + code, "receive")
    assert process.returncode == 97 and "went on" not in process.stdout, process.stdout


def test_hook_stops_for_the_answer_to_another_message(tmp_path):
    code = (
        "episode = mitigate_hook.connect('a')\nepisode.corrupt({'rgb': rgb})\n"
        "frame = {'kind': 'frame', 'call': 1, 'number': 2}\n"
        "mitigate_hook.send(episode._session.channel.socket, frame)\n"
        "episode.corrupt({'rgb': rgb})\nprint('went on')"
    )
    process, reports = run_loop(tmp_path, code)
    assert process.returncode == 97 and "went on" not in process.stdout
    assert "answered another message" in reports.problems[0]


def test_hook_stops_for_a_nested_call(tmp_path):
    """Calls are nested if, for example, a signal handler or a greenlet calls ``corrupt``."""
    code = (
        "episode = mitigate_hook.connect('a')\nreceive = mitigate_hook.receive\n"
        "def again(channel):\n    mitigate_hook.receive = receive\n"
        "    episode.corrupt({'rgb': rgb})\n    return receive(channel)\n"
        "mitigate_hook.receive = again\n"
        "episode.corrupt({'rgb': rgb})\nprint('went on')"
    )
    process, reports = run_loop(tmp_path, code)
    assert (
        process.returncode == 97 and "another call of the same environment" in reports.problems[0]
    )


def test_episode_stops_in_another_thread(tmp_path):
    code = (
        "import threading\nepisode = mitigate_hook.connect('a')\nepisode.corrupt({'rgb': rgb})\n"
        "def go():\n    episode.corrupt({'rgb': rgb})\n    print('went on')\n"
        "thread = threading.Thread(target=go)\nthread.start()\nthread.join()"
    )
    process, reports = run_loop(tmp_path, code)
    assert process.returncode == 97 and "in the thread that runs the episode" in reports.problems[0]


THREADS = """
import threading
from habitat.core.env import Env, make_dataset
env = Env(config={}, dataset=make_dataset(1))
env.reset()
shades = []
def look():
    for _ in range(40):
        shades.append(env.sim.get_observations_at([0.0, 0.0, 0.0], 0.0, True)["rgb"].mean())
threads = [threading.Thread(target=look) for _ in range(3)]
for thread in threads: thread.start()
for thread in threads: thread.join()
clean = mitigate_hook._call_clean(env.sim.get_observations_at, [0.0, 0.0, 0.0], 0.0)["rgb"].mean()
env.step(0)
print(len(shades), max(shades) < 0.8 * clean)
"""


def test_hook_corrupts_frames_of_all_threads(tmp_path):
    process, reports = run_loop(tmp_path, THREADS, condition("low_light"))
    assert process.stdout.strip() == "120 True" and reports.ends["s0/0"]["calls"] == 122


FORK = """
from habitat.core.env import Env, make_dataset
env = Env(config={}, dataset=make_dataset(2))
env.reset()
env.step(1)
if os.fork() == 0:
    CHILD
    os._exit(0)
os.wait()
env.step(1)
env.step(0)
env.close()
"""


def test_fork_does_not_end_the_episode_of_its_parent(tmp_path):
    process, reports = run_loop(tmp_path, FORK.replace("CHILD", "env.close()"))
    assert process.returncode == 0, process.stdout
    assert {name: end["steps"] for name, end in reports.ends.items()} == {"s0/0": 3}
    assert not reports.repeated and not reports.problems


def test_fork_stops_if_it_continues_its_parents_episode(tmp_path):
    _, reports = run_loop(tmp_path, FORK.replace("CHILD", "env.step(1)"))
    assert (
        len(reports.problems) == 1 and "Reset the environment in the process" in reports.problems[0]
    )


def test_fork_begins_its_own_episode_by_a_reset(tmp_path):
    _, reports = run_loop(tmp_path, FORK.replace("CHILD", "env.reset(); env.step(0); env.close()"))
    assert not reports.problems and not reports.lost
    assert {name: end["steps"] for name, end in reports.ends.items()} == {"s0/0": 3, "s1/1": 1}


def test_fork_gets_its_own_lock(tmp_path):
    code = (
        "walk = mitigate_hook.connect('a')._session\nwalk.lock.acquire()\n"
        "import threading\n"
        "def go():\n    mitigate_hook._thread.session = walk\n    if os.fork() == 0:\n"
        "        mitigate_hook.connect('b').corrupt({'rgb': rgb})\n        os._exit(0)\n"
        "    print(os.wait()[1])\n"
        "thread = threading.Thread(target=go)\nthread.start()\nthread.join()"
    )
    process, _ = run_loop(tmp_path, code)
    assert process.stdout.strip() == "0"


@pytest.mark.parametrize("stream", ["None", "5", "open(os.devnull)"])
def test_stop_works_without_standard_error(tmp_path, stream):
    code = (
        f"sys.stderr = {stream}\n"
        "try:\n    mitigate_hook.connect('a').corrupt({'rgb': rgb, 'left': rgb})\n"
        "except BaseException:\n    pass\nprint('went on')"
    )
    process, reports = run_loop(tmp_path, code)
    assert process.returncode == 97 and "went on" not in process.stdout
    assert "the entry left" in process.stdout and "the entry left" in reports.problems[0]


DIES = (
    BEGIN
    + """
episode = mitigate_hook.connect('a')
episode.corrupt({'rgb': rgb})
send = mitigate_hook.send
def last(channel, message):
    send(channel, message)
    os.kill(os.getpid(), 9)  # as the kernel does where memory runs out
mitigate_hook.send = last
episode.corrupt({'rgb': rgb})
"""
)


def test_server_drops_the_episode_of_a_dead_worker(tmp_path):
    with Listener(condition("low_light"), tmp_path) as listener:
        assert python(listener, DIES).returncode == -signal.SIGKILL
        until = time.monotonic() + 5.0
        while read(tmp_path).connected and time.monotonic() < until:
            time.sleep(0.02)
    reports = read(tmp_path)
    assert reports.lost == ["a"] and reports.connected == 0


def test_server_ends_if_its_answer_is_not_received(tmp_path, monkeypatch):
    """The client closed the connection before the answer was sent."""
    output = Peer(tmp_path)
    for message in (HELLO, SPEC, EPISODE, {"kind": "frame", "call": 0}):
        assert "error" not in output.ask(message)

    def broken(*_):
        raise BrokenPipeError

    monkeypatch.setattr(connection, "send", broken)
    mitigate_hook.send(output.channel, {"kind": "frame", "call": 1})
    output.thread.join(5.0)
    reports = read(tmp_path)
    assert reports.lost == ["a/1"] and reports.connected == 0
    output.close()


def test_answer_repeats_the_number_of_its_message(tmp_path):
    output = Peer(tmp_path)
    assert output.ask(HELLO | {"number": 7}) == {"number": 7}
    assert output.ask({"kind": "dataset", "keys": [], "number": 8}) == {"keep": None, "number": 8}
    output.close()
