"""Tests that untrusted episode files are read completely, or rejected with a message that names the
file, the entry and the requirement."""

from __future__ import annotations

import copy
import gzip
import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mitigate.guards.text.learning.data import read_chats
from mitigate.worlds import corrupt_episodes_command as episodes_command
from mitigate.worlds.episodes import read_episodes, read_extras
from tests.bad_input.named import refused

GOOD = {
    "episode_id": 1,
    "trajectory_id": 1,
    "scene_id": "apartments/000001",
    "start_position": [0.0, 0.0, 0.0],
    "start_rotation": [0.0, 0.0, 0.0, 1.0],
    "info": {"geodesic_distance": 3.0},
    "goals": [{"position": [1.0, 0.0, 1.0], "radius": 3.0}],
    "instruction": {"instruction_text": "Walk to the door.", "instruction_tokens": [1, 2]},
    "reference_path": [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0]],
}
NAN, HUGE = float("nan"), 10**400
CHANGES = {  # name of the test: dotted key, invalid value, and expected message
    "a huge integer": ("start_position", [HUGE, 0, 0], "'start_position'"),
    "far away": ("start_position", [1e300, 0, 0], "'start_position'"),
    "not a number": ("start_position", [NAN, 0, 0], "'start_position'"),
    "two numbers": ("start_position", [0, 0], "3 finite numbers"),
    "texts": ("start_position", ["0", "0", "0"], "'start_position'"),
    "a mapping": ("start_position", {"x": 0}, "'start_position'"),
    "an endless rotation": ("start_rotation", [float("inf")] * 4, "'start_rotation'"),
    "no rotation": ("start_rotation", None, "lacks the key 'start_rotation'"),
    "no scene": ("scene_id", None, "lacks the key 'scene_id'"),
    "a number of a scene": ("scene_id", 7, "'scene_id'"),
    "no goals": ("goals", [], "empty 'goals'"),
    "a goal that is none": ("goals", ["door"], "goals[0], is not a JSON object"),
    "a huge radius": ("goals", [{"position": [0, 0, 0], "radius": HUGE}], "'radius'"),
    "a radius of text": ("goals", [{"position": [0, 0, 0], "radius": "3"}], "'radius'"),
    "a goal far away": ("goals", [{"position": [HUGE, 0, 0]}], "'position'"),
    "no path": ("reference_path", [], "empty 'reference_path'"),
    "a path of numbers": ("reference_path", [1, 2], "'reference_path'"),
    "a path to infinity": ("reference_path", [[0, 0, HUGE]], "'reference_path'"),
    "no instruction": ("instruction", None, "lacks the key 'instruction'"),
    "an instruction of text": ("instruction", "go", "'instruction'"),
    "no words": ("instruction", {"instruction_text": None}, "'instruction_text'"),
    "a number of words": ("instruction", {"instruction_text": 5}, "'instruction_text'"),
    "endless words": ("instruction", {"instruction_text": "go " * 99_999}, "more than 100000"),
    "tokens of text": (
        "instruction",
        {"instruction_text": "go", "instruction_tokens": "1 2"},
        "'instruction_tokens'",
    ),
    "an id of two lines": ("episode_id", "1\n2", "'episode_id'"),
    "an empty id": ("episode_id", "", "'episode_id'"),
    "an endless id": ("episode_id", "x" * 10_000, "'episode_id'"),
    "an id of many digits": ("episode_id", 10**300, "'episode_id'"),
    "a truth as an id": ("episode_id", True, "'episode_id'"),
    "a list as an id": ("episode_id", [1], "'episode_id'"),
    "a text that reorders": ("trajectory_id", "a\u202eb", "'trajectory_id'"),
    "a huge distance": ("info", {"geodesic_distance": HUGE}, "'geodesic_distance'"),
    "an endless distance": ("info", {"geodesic_distance": float("inf")}, "'geodesic_distance'"),
    "a list of info": ("info", [1], "'info'"),
}


def write(path, *episodes):
    path.write_text(json.dumps({"episodes": list(episodes)}))
    return path


@pytest.mark.parametrize(("key", "value", "words"), CHANGES.values(), ids=CHANGES)
def test_read_episodes_names_wrong_value(tmp_path, key, value, words):
    path = write(tmp_path / "e.json", GOOD, {**copy.deepcopy(GOOD), key: value})
    message = refused(lambda: list(read_episodes(path)), words)
    assert str(path) in message and ("episode 1 of the list" in message or "whole JSON" in message)


FILES = {
    "nothing": b"",
    "an empty list": b"[]",
    "an empty mapping": b"{}",
    "a text": b'"episodes"',
    "half a file": b'{"episodes": [{"episode_id": 1, ',
    "episodes of text": b'{"episodes": "none"}',
    "an episode of null": b'{"episodes": [null]}',
    "an episode of lists": b'{"episodes": [[[]]]}',
    "deep lists": b'{"episodes": ' + b"[" * 200_000,
    "deep mappings": b'{"episodes": [' + b'{"a":' * 200_000,
    "many digits": b'{"episodes": [{"episode_id": ' + b"9" * 100_000 + b"}]}",
    "bytes": bytes(range(256)) * 10,
    "a byte order mark": b"\xef\xbb\xbf{}",
    "utf-16": json.dumps({"episodes": [GOOD]}).encode("utf-16"),
    "gzip of nothing": gzip.compress(b""),
    "half a gzip": gzip.compress(json.dumps({"episodes": [GOOD] * 50}).encode())[:-40],
    "two brackets": b"{{",
    "no colon": b'{"episodes" []}',
    "a comma too many": b'{"episodes": [,]}',
    "a gzip in a gzip": gzip.compress(gzip.compress(b"{}")),
    "a zip": b"PK\x03\x04" + bytes(100),
    "HTML": b"<!doctype html><html>404</html>",
    "an endless text": b'{"episodes": ["' + b"x" * (1 << 20),
}


@pytest.mark.parametrize("raw", FILES.values(), ids=FILES)
def test_read_episodes_rejects_other_files(tmp_path, raw):
    path = tmp_path / "e.json.gz"
    path.write_bytes(raw)
    assert str(path) in refused(lambda: list(read_episodes(path)))
    out = tmp_path / "out.json"
    assert episodes_command.main([str(path), str(out), "corruption=capitalize", "severity=1"]) == 2
    assert [p.name for p in tmp_path.iterdir()] == ["e.json.gz"]  # nothing half written
    if raw not in (b"{}", gzip.compress(b"{}"), FILES["episodes of text"]):
        try:
            read_extras(path)
        except ValueError as error:
            assert str(path) in str(error) and "\n" not in str(error)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3)
    ),
    max_leaves=8,
)
FAST = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@FAST
@given(st.sampled_from(sorted(GOOD)), JSON)
def test_read_episodes_reads_or_names_any_value(tmp_path, key, value):
    path = write(tmp_path / "e.json", {**GOOD, key: value})
    try:
        list(read_episodes(path, hidden_goals=True))
    except ValueError as error:
        assert str(path) in str(error) and "\n" not in str(error)


@FAST
@given(st.binary(max_size=200), st.booleans())
def test_read_episodes_reads_or_names_any_bytes(tmp_path, raw, packed):
    path = tmp_path / "e.json"
    path.write_bytes(gzip.compress(raw) if packed else raw)
    for read in (read_episodes, read_chats):
        try:
            list(read(path))
        except (ValueError, OSError) as error:
            assert str(error)


CHATS = {
    "no JSON": "{",
    "a list": "[]",
    "no messages": "{}",
    "messages of text": '{"messages": "hello"}',
    "a message of null": '{"messages": [null]}',
    "an unknown role": '{"messages": [{"role": "root", "content": "x"}]}',
    "no content": '{"messages": [{"role": "user"}]}',
    "two users": json.dumps({"messages": [{"role": "user", "content": "x"}] * 2}),
    "digits": "9" * 10_000,
}


@pytest.mark.parametrize("line", CHATS.values(), ids=CHATS)
def test_read_chats_names_invalid_chat(tmp_path, line):
    path = tmp_path / "chats.jsonl"
    path.write_text(line + "\n")
    refused(lambda: list(read_chats(path)), "line 1")
