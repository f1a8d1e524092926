"""Tests that each message is answered, rejected with an error, or ends the connection."""

from __future__ import annotations

import json
import os
import socket
import struct
import subprocess
import sys
import threading
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mitigate.bridge.connection import Connection
from mitigate.bridge.events import EVENTS
from mitigate.bridge.hook import mitigate_hook
from mitigate.bridge.hook.mitigate_hook import (
    HEADER,
    MAGIC,
    MAX_MESSAGE,
    MAX_TEXT,
    PROTOCOL,
    receive,
    send,
)
from mitigate.bridge.results import OWN, read, rows
from mitigate.bridge.server import Listener
from mitigate.corruptions import Corruption

from .conftest import condition

TOKEN = "0123456789abcdef"
HELLO = {"kind": "hello", "protocol": PROTOCOL, "token": TOKEN, "pid": 1}
CAMERA = {"name": "rgb", "type": "rgb", "shape": [8, 8, 3], "dtype": "uint8", "hfov": 90}
SPEC = {"kind": "spec", "cameras": [CAMERA]}
EPISODE = {"kind": "episode", "scene": "a.glb", "id": "1", "text": "go left"}


class Peer:
    """A connection that is served by a thread of this process."""

    def __init__(self, folder):
        self.folder = folder
        self.channel, served = socket.socketpair()
        self.channel.settimeout(5.0)
        connection = Connection(served, condition("spatter"), folder, TOKEN, folder)
        self.failure = None
        self.thread = threading.Thread(target=self._serve, args=(connection, served), daemon=True)
        self.thread.start()

    def _serve(self, connection, served):
        try:
            connection.serve()
        except Exception as error:
            self.failure = error
        finally:
            served.close()

    def ask(self, message):
        """Send a message; return the answer, or None if the server closed the connection."""
        try:
            if isinstance(message, bytes):
                self.channel.sendall(message)
                self.channel.shutdown(socket.SHUT_WR)
            else:
                send(self.channel, message)
            return receive(self.channel)
        except OSError:
            return None

    def close(self):
        self.channel.close()
        self.thread.join(5.0)
        assert not self.thread.is_alive(), "the server hangs"
        assert self.failure is None, repr(self.failure)


@pytest.fixture
def peer(tmp_path):
    peer = Peer(tmp_path)
    yield peer
    peer.close()


def cameras(*descriptions):
    return {"kind": "spec", "cameras": list(descriptions)}


def camera(**changes):
    return cameras(CAMERA | changes)


MESSAGES = {
    "no kind": {},
    "an unknown kind": {"kind": "__init__"},
    "a kind of a list": {"kind": ["spec"]},
    "an endless kind": {"kind": "x" * 10_000},
    "serve": {"kind": "serve"},
    "no cameras": {"kind": "spec"},
    "cameras of null": {"kind": "spec", "cameras": None},
    "cameras of text": {"kind": "spec", "cameras": "rgb"},
    "a camera of null": cameras(None),
    "a camera of nothing": cameras({}),
    "a camera twice": cameras(CAMERA, CAMERA),
    "too many cameras": cameras(*(CAMERA | {"name": str(n)} for n in range(300))),
    "too many pixels": cameras(
        *(CAMERA | {"name": str(n), "shape": [65535, 65535, 3]} for n in range(9))
    ),
    "no shape": camera(shape=None),
    "a shape of a number": camera(shape=8),
    "a shape of texts": camera(shape=["8", "8", "3"]),
    "a negative shape": camera(shape=[-8, 8, 3]),
    "four channels": camera(shape=[8, 8, 4]),
    "an endless shape": camera(shape=[10**30, 8, 3]),
    "objects": camera(dtype="object"),
    "a name that is a number": camera(name=0),
    "a name of a list": camera(name=["rgb", 0]),
    "a type of a list": camera(dtype=["uint8"]),
    "no kind of camera": camera(type="../../etc"),
    "a position of text": camera(position="here"),
    "a field of view of text": camera(hfov="wide"),
    "an orientation of text": camera(orientation=["a", "b", "c"]),
    "an episode without a scene": {"kind": "episode", "id": "1"},
    "an episode without an id": {"kind": "episode", "scene": "a.glb"},
    "a frame without cameras": {"kind": "frame", "call": 0},
    "an end without an episode": {"kind": "end"},
    "a data set of null": {"kind": "adapted"},
    "a reason of nothing": {"kind": "stopped"},
}


@pytest.mark.parametrize("message", MESSAGES.values(), ids=MESSAGES)
def test_connection_rejects_invalid_messages(peer, message):
    assert peer.ask(HELLO) == {}
    error = peer.ask(message)["error"]
    assert error and "\n" not in error and len(error) < 1500
    peer.close()
    events = [json.loads(line) for line in (peer.folder / EVENTS).read_text().splitlines()]
    assert [event["event"] for event in events[-2:]] == ["refused", "bye"]
    assert events[-2]["problem"] == error


FRAMES = {
    "no number": {"kind": "frame"},
    "a number of text": {"kind": "frame", "call": "first"},
    "an endless number": {"kind": "frame", "call": 1e999},
    "a heading of text": {"kind": "frame", "call": 0, "heading": "north"},
    "metrics of a list": {"kind": "end", "metrics": [1]},
    "depth of a list": {"kind": "frame", "call": 0, "depth": [1]},
    "depth of text": {"kind": "frame", "call": 0, "depth": {"rgb": "far"}},
    "an end before a frame": {"kind": "end", "metrics": {"success": 1}},
}


ENDS = {
    "success in words": {"metrics": {"success": "yes"}},
    "success of a list": {"metrics": {"success": [1]}},
    "more digits than a number has": {"metrics": {"success": 10**400}},
    "an endless metric": {"metrics": {"collisions": 1e999}},
    "SPL above 1": {"metrics": {"success": 1, "spl": 7}},
    "steps in words": {"steps": "many"},
    "a path of text": {"path": "abc"},
    "a ragged path": {"path": [[0, 0], [0, 0, 1]]},
    "a path of one number": {"path": [[1]]},
    "a distance in words": {"distance": "far"},
    "an endless path": {"path": [[0, 0], [1e308, 0]]},
    "a longer way than there is": {"path": [[0, 0], [9e8, 0], [0, 0]]},
    "a negative start": {"start_distance": -1.0},
    "a negative length": {"metrics": {"success": 1, "path_length": -2.0}},
    "a negative shortest way": {"metrics": {"success": 1, "geodesic_distance": -1.0}},
    "a distance of ages": {"distance": 1e12},
}


@pytest.mark.parametrize("fields", ENDS.values(), ids=ENDS)
def test_connection_rejects_invalid_ends(peer, fields):
    for good in (HELLO, SPEC, EPISODE, {"kind": "frame", "call": 0}):
        assert "error" not in peer.ask(good)
    error = peer.ask({"kind": "end", "metrics": {"success": 1.0}} | fields)["error"]
    assert "episode '1' ended with " in error
    peer.close()
    assert not read(peer.folder).ends


def test_rows_accept_infinite_distances(peer):
    """Infinite distances are valid, and the SPL that the agent reports needs no start distance."""
    for good in (HELLO, SPEC, EPISODE, {"kind": "frame", "call": 0}):
        assert "error" not in peer.ask(good)
    far = {"start_distance": float("inf"), "distance": float("inf"), "path": [[0, 0, 0], [1, 0, 0]]}
    metrics = {"success": 1.0, "spl": 0.5, "distance_to_goal": float("inf")}
    assert "error" not in peer.ask({"kind": "end", "metrics": metrics} | far)
    peer.close()
    label = {"agent": "abc", "name": "nav", "split": "val", "seed": 0}
    by_rule = {
        row["rule"]: row for row in rows(read(peer.folder), Corruption("spatter", 0.6), label, None)
    }
    assert by_rule[OWN]["spl"] == 0.5 and [row["success"] for row in by_rule.values()] == [1.0, 0.0]


@pytest.mark.parametrize(
    "unknown",
    [{"distance": float("nan")}, {"start_distance": float("nan")}, {"path": [[0, float("nan")]]}],
    ids=lambda fields: next(iter(fields)),
)
def test_rows_leave_out_unknown_values(peer, unknown):
    for good in (HELLO, SPEC, EPISODE, {"kind": "frame", "call": 0}):
        assert "error" not in peer.ask(good)
    end = {"start_distance": 4.0, "distance": 2.0, "path": [[0, 0], [0, 8]]} | unknown
    assert "error" not in peer.ask({"kind": "end", "metrics": {"success": 1.0}} | end)
    peer.close()
    label = {"agent": "abc", "name": "nav", "split": "val", "seed": 0}
    result_rows = rows(read(peer.folder), Corruption("spatter", 0.6), label, None)
    assert len(result_rows) == (1 if "distance" in unknown else 2)
    assert {row["spl"] for row in result_rows} == ({0.5} if "distance" in unknown else {1.0})


@pytest.mark.parametrize("name", ["\ud800", "", "a\nb", "9" * 201])
def test_connection_rejects_names_that_rows_cannot_hold(peer, name):
    assert "error" not in peer.ask(HELLO)
    error = peer.ask({"kind": "episode", "scene": "", "id": name, "text": "go left"})["error"]
    assert "an episode's name (its scene file and its id) must be" in error
    peer.close()


@pytest.mark.parametrize("message", FRAMES.values(), ids=FRAMES)
def test_connection_rejects_invalid_frames(peer, message):
    for good in (HELLO, SPEC, EPISODE):
        assert "error" not in peer.ask(good)
    assert peer.ask(message)["error"]


def packed(body: bytes, magic: bytes = MAGIC, size: int | None = None) -> bytes:
    return HEADER.pack(magic, len(body) if size is None else size) + body


RAW = {
    "nothing": b"",
    "half a head": MAGIC[:2],
    "HTTP": b"GET / HTTP/1.1\r\nHost: x\r\n\r\n",
    "another magic": packed(b"{}", b"evil"),
    "too large": packed(b"", size=MAX_MESSAGE + 1),
    "far too large": struct.pack("!4sI", MAGIC, 0xFFFFFFFF),
    "less than said": packed(b"{}", size=100),
    "a list": packed(b"[]"),
    "null": packed(b"null"),
    "half JSON": packed(b'{"kind": '),
    "bytes": packed(bytes(range(256))),
    "deep": packed(b'{"a":' * 100_000),
    "deep lists": packed(b"[" * 1_000_000),
    "many digits": packed(b'{"kind": ' + b"9" * 100_000 + b"}"),
    "no token": packed(json.dumps(HELLO | {"token": None}).encode()),
    "a token of a list": packed(json.dumps(HELLO | {"token": [TOKEN]}).encode()),
    "another token": packed(json.dumps(HELLO | {"token": TOKEN[:-1]}).encode()),
    "a token in other letters": packed(json.dumps(HELLO | {"token": "ä" * 16}).encode()),
}


@pytest.mark.parametrize("raw", RAW.values(), ids=RAW)
def test_connection_does_not_answer_without_protocol_and_token(peer, raw):
    assert peer.ask(raw) is None
    assert not (peer.folder / EVENTS).exists()


def test_connection_shortens_the_reason_of_a_stop(peer):
    assert peer.ask(HELLO) == {}
    assert peer.ask({"kind": "stopped", "problem": "a\x1b[31m\nb" + "x" * 9000}) == {}
    problem = read(peer.folder).problems[0]
    assert problem.startswith("a [31m b") and len(problem) == MAX_TEXT


def test_connection_rejects_an_episode_without_the_corrupted_camera(peer):
    depth = CAMERA | {"name": "depth", "type": "depth", "shape": [8, 8, 1], "dtype": "float32"}
    frame, end = {"kind": "frame", "call": 0}, {"kind": "end", "metrics": {"success": 1}}
    for message in (HELLO, cameras(depth), EPISODE, frame, SPEC, frame | {"call": 1}, end):
        assert "error" not in peer.ask(message)
    for message in (cameras(depth), EPISODE | {"id": "2"}, frame):
        assert "error" not in peer.ask(message)
    assert "corrupts rgb, but no call of episode 2 had such a camera" in peer.ask(end)["error"]


def test_connection_rejects_another_version(peer):
    assert "another version" in peer.ask(HELLO | {"protocol": PROTOCOL + 1})["error"]


@pytest.mark.parametrize("name", ["too large", "deep", "half JSON", "less than said"])
def test_connection_ends_after_invalid_bytes(peer, name):
    assert peer.ask(HELLO) == {} and peer.ask(RAW[name]) is None


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=9),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=9), inner),
    max_leaves=6,
)


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    st.sampled_from([SPEC, EPISODE, {"kind": "frame"}, {"kind": "end"}, {"kind": "dataset"}]),
    st.sampled_from(
        ["cameras", "scene", "id", "text", "tokens", "call", "metrics", "keys", "depth", "loop"]
    ),
    VALUES,
)
def test_connection_answers_any_value(tmp_path, message, key, value):
    peer = Peer(tmp_path)
    assert peer.ask(HELLO) == {}
    answer = peer.ask(message | {key: value})
    assert answer is not None and "\n" not in answer.get("error", "")
    peer.close()


CONNECT = (
    "import os, socket, sys\nos.setgid(65534); os.setuid(65534)\n"
    "try:\n    socket.socket(socket.AF_UNIX).connect(sys.argv[1])\n"
    "except PermissionError:\n    sys.exit(7)"
)


@pytest.mark.skipif(os.getuid() != 0, reason="only root may become another user")
def test_server_excludes_other_users(tmp_path):
    with Listener(condition("spatter"), tmp_path) as listener:
        command = [sys.executable, "-S", "-c", CONNECT, listener.address]
        assert subprocess.run(command, cwd="/", check=False).returncode == 7
        assert os.stat(listener.memory).st_mode & 0o077 == 0


def test_server_answers_despite_silent_connections(tmp_path):
    with Listener(condition("spatter"), tmp_path) as listener:
        silent = []
        for _ in range(40):
            silent.append(socket.socket(socket.AF_UNIX))
            silent[-1].connect(listener.address)
        with socket.socket(socket.AF_UNIX) as channel:
            channel.settimeout(10.0)
            channel.connect(listener.address)
            began = time.monotonic()
            send(channel, HELLO | {"token": listener.token})
            assert receive(channel) == {} and time.monotonic() - began < 9
        for channel in silent:
            channel.close()


def test_send_rejects_a_message_that_is_too_large(peer):
    with pytest.raises(ValueError, match="must be <="):
        send(peer.channel, {"kind": "episode", "text": "x" * MAX_MESSAGE})
    assert mitigate_hook.MAX_MESSAGE == MAX_MESSAGE
