"""Tests of faults in the server and the connection.

A fault must soon stop the program with an error. The program must not receive a clean frame.
"""

import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

from mitigate.bridge.hook.mitigate_hook import HEADER, MAGIC, receive, send
from mitigate.bridge.server import Listener

from .conftest import LAB, condition


def start(listener, folder, *options):
    """Start the agent's program on the fake lab, connected to a listener."""
    environment = {**os.environ, **listener.environment()}
    environment["PYTHONPATH"] += os.pathsep + str(LAB)
    return subprocess.Popen(
        [sys.executable, str(LAB / "agent.py"), str(folder / "seen"), *map(str, options)],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def wait_for(folder, word, seconds=20.0):
    """Wait until the event file of a condition contains ``word``."""
    until = time.monotonic() + seconds
    events = folder / "events.jsonl"
    while not (events.is_file() and word in events.read_text()):
        assert time.monotonic() < until, f"no {word!r} in {seconds} s"
        time.sleep(0.02)


def test_hook_stops_if_the_server_is_killed(tmp_path):
    with Listener(condition("spatter"), tmp_path, patience=5.0) as listener:
        agent = start(listener, tmp_path, "--pause", 0.2, "--steps", 100)
        wait_for(tmp_path, '"spec"')
        os.killpg(listener.pid, signal.SIGKILL)
        output, _ = agent.communicate(timeout=15)
    assert agent.returncode == 97 and "server" in output


@pytest.mark.slow
def test_hook_stops_if_the_server_does_not_answer(tmp_path):
    with Listener(condition("spatter"), tmp_path, patience=1.0) as listener:
        agent = start(listener, tmp_path, "--pause", 0.2, "--steps", 100)
        wait_for(tmp_path, '"spec"')
        os.killpg(listener.pid, signal.SIGSTOP)
        output, _ = agent.communicate(timeout=15)
    assert agent.returncode == 97 and "did not answer within 1 s" in output


def test_hook_stops_without_a_server(command, tmp_path):
    result = command(condition("spatter"), MITIGATE_BRIDGE=str(tmp_path / "nobody"))
    assert result.status == 97 and "cannot be reached" in result.output


def test_server_rejects_a_wrong_token(command):
    result = command(condition("spatter"), MITIGATE_TOKEN="guessed")
    assert result.status == 97 and "gone" in result.output
    assert not result.reports.hellos


def test_server_reports_missing_space_for_frames(command, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", full)  # the server is a fork of this process
    result = command(condition("spatter"))
    assert result.status == 97
    assert "no room for" in result.output and "--shm-size" in result.output
    assert "no room for" in result.reports.problems[0]


def test_hook_cannot_be_caught_by_the_agent(tmp_path):
    """An error must end the process, because WMNav's loop catches every exception and continues
    with the next step."""
    code = (
        "import mitigate_hook, numpy\n"
        "episode = mitigate_hook.connect('7')\n"
        "try:\n    episode.corrupt({'rgb': numpy.zeros((4, 4, 3))})\n"
        "except BaseException:\n    pass\n"
        "print('went on')"
    )
    with Listener(condition("spatter"), tmp_path) as listener:
        result = subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, **listener.environment()},
            capture_output=True,
            text=True,
            timeout=20,
            check=False,
        )
    assert (
        result.returncode == 97
        and "must be uint8" in result.stderr
        and "went on" not in result.stdout
    )


def test_server_removes_its_folders(command):
    command(condition("spatter"), "--episodes", 1)
    with Listener(condition("spatter"), command.__closure__[0].cell_contents / "x") as listener:
        content = (listener.socket_folder, listener.memory)
        assert all(place.is_dir() for place in content)
        assert oct(os.stat(listener.address).st_mode & 0o777) == "0o600"
        assert oct(os.stat(listener.socket_folder).st_mode & 0o777) == "0o700"
    assert not any(place.exists() for place in content)


@pytest.fixture
def pair():
    """Return both ends of a socket connection."""
    ends = socket.socketpair()
    for end in ends:
        end.settimeout(5.0)
    yield ends
    for end in ends:
        end.close()


def test_receive_returns_the_sent_message(pair):
    threading.Thread(target=send, args=(pair[0], {"kind": "frame", "call": 3})).start()
    assert receive(pair[1]) == {"kind": "frame", "call": 3}


@pytest.mark.parametrize(
    "raw",
    [
        b"GET / HTTP/1.1\r\n\r\n",
        HEADER.pack(MAGIC, 1 << 31),
        HEADER.pack(MAGIC, 2) + b"[]",
        HEADER.pack(MAGIC, 3) + b"nan",
    ],
)
def test_receive_rejects_invalid_messages(pair, raw):
    pair[0].sendall(raw)
    with pytest.raises(ValueError):
        receive(pair[1])


def test_receive_returns_none_for_a_cut_message(pair):
    pair[0].sendall(HEADER.pack(MAGIC, 100) + b"{")
    pair[0].close()
    assert receive(pair[1]) is None
