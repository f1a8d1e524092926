"""Tests of reading and writing VLN-CE episode files: round trips, memory use and error messages."""

from __future__ import annotations

import dataclasses
import gzip
import json
import subprocess
import sys
import tracemalloc
from pathlib import Path

import pytest

from mitigate.core import json_files
from mitigate.worlds.episodes import (
    Goal,
    read_episodes,
    read_extras,
    write_episodes,
)
from mitigate.worlds.seeded import seeded_episodes
from tests.r2r_ce import FOLDER, ROOT, needs_r2r_ce

R2R = {
    "episode_id": 7,
    "trajectory_id": 4,
    "scene_id": "mp3d/a/a.glb",
    "start_position": [1.5, 0.25, -3],
    "start_rotation": [-0.0, 0.6, 0.0, -0.8],
    "info": {"geodesic_distance": 6.5, "difficulty": "easy"},
    "goals": [{"position": [2.0, 0.25, -6.0], "radius": 3.0, "object_id": 12}],
    "instruction": {"instruction_text": "Go \u00e0 droite.", "instruction_tokens": [982, 141, 0]},
    "reference_path": [[1.5, 0.25, -3.0], [2.0, 0.25, -6.0]],
    "start_room": None,
}
RXR = {
    **R2R,
    "episode_id": "0041",
    "trajectory_id": "13",
    "info": {"geodesic_distance": 9.0, "role": "guide"},
    "instruction": {
        "instruction_id": "41",
        "instruction_text": "\u0926\u093e\u090f\u0902 \u092e\u0941\u0921\u093c\u0947\u0902",
        "language": "hi-IN",
        "annotator_id": "0",
        "timed_instruction": [{"word": "\u0906\u092a", "start_time": 0.5}],
    },
}


def write_json(path: Path, value: object) -> Path:
    text = json.dumps(value, ensure_ascii=False)
    path.write_bytes(gzip.compress(text.encode()) if path.suffix == ".gz" else text.encode())
    return path


def load(path: Path) -> object:
    return json.loads(gzip.decompress(path.read_bytes()))


def episode_file(path: Path, **changes: object) -> Path:
    """Write two valid episodes and a third episode with ``changes``; a key with the value ``...``
    is removed."""
    third = {key: value for key, value in (R2R | changes).items() if value is not ...}
    return write_json(path / "bad.json.gz", {"episodes": [R2R, RXR, third]})


def test_read_episodes_reads_r2r_and_rxr(tmp_path):
    path = write_json(tmp_path / "two.json", {"episodes": [R2R, RXR], "instruction_vocab": {}})
    r2r, rxr = read_episodes(path)
    assert (r2r.episode_id, r2r.trajectory_id, rxr.episode_id) == ("7", "4", "0041")
    assert r2r.start_rotation == (0.0, 0.6, 0.0, -0.8)
    assert r2r.goals == (Goal((2.0, 0.25, -6.0), 3.0, {"object_id": 12}),)
    assert r2r.geodesic_distance == 6.5
    assert r2r.instruction.tokens == (982, 141, 0)
    assert r2r.instruction.language is None
    assert rxr.instruction.tokens is None
    assert rxr.instruction.language == "hi-IN"
    assert rxr.instruction.extra["timed_instruction"][0]["start_time"] == 0.5
    assert len({r2r, rxr}) == 2  # hashable


@pytest.mark.parametrize("suffix", [".json", ".json.gz"])
def test_write_episodes_preserves_keys_and_id_types(tmp_path, suffix):
    original = {"instruction_vocab": {"num_vocab": 2504}, "episodes": [R2R, RXR], "tag": [1, None]}
    source = write_json(tmp_path / f"a{suffix}", original)
    copy = tmp_path / f"b{suffix}"
    write_episodes(copy, read_episodes(source), read_extras(source))
    text = load(copy) if suffix.endswith("gz") else json.loads(copy.read_text("utf-8"))
    assert text == original
    assert list(read_episodes(copy)) == list(read_episodes(source))


def test_write_episodes_writes_a_replaced_id(tmp_path):
    source = write_json(tmp_path / "a.json", {"episodes": [R2R]})
    renamed = (dataclasses.replace(e, episode_id="7/mask") for e in read_episodes(source))
    write_episodes(tmp_path / "b.json.gz", renamed)
    (saved,) = load(tmp_path / "b.json.gz")["episodes"]
    assert (saved["episode_id"], saved["trajectory_id"]) == ("7/mask", 4)


def test_write_episodes_is_deterministic(tmp_path):
    source = write_json(tmp_path / "a.json", {"episodes": [R2R, RXR]})
    first = write_episodes(tmp_path / "b.json.gz", read_episodes(source)).read_bytes()
    second = write_episodes(tmp_path / "c.json.gz", read_episodes(source)).read_bytes()
    assert first == second


def test_failed_write_keeps_the_old_file(tmp_path):
    path = write_json(tmp_path / "a.json", {"episodes": [R2R]})
    before = path.read_bytes()
    bad = [dataclasses.replace(e, geodesic_distance=float("nan")) for e in read_episodes(path)]
    with pytest.raises(ValueError, match="episode 7 has a value that JSON cannot"):
        write_episodes(path, bad)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]


def test_read_episodes_joins_values_across_buffers(tmp_path):
    numbers = list(range(10**5, 10**5 + 40_000))  # 320 kB of text, which needs many buffers
    many = [R2R | {"episode_id": i, "blob": '\u00e9\\"]}' * (i % 50)} for i in range(700)]
    path = write_json(tmp_path / "a.json", {"x": 12345, "episodes": many, "vocab": numbers})
    assert [e.episode_id for e in read_episodes(path)] == [str(i) for i in range(700)]
    assert read_extras(path) == {"x": 12345, "vocab": numbers}


@pytest.mark.parametrize("size", [1, 2, 5])
def test_read_episodes_works_for_every_buffer_size(tmp_path, monkeypatch, size):
    monkeypatch.setattr(json_files, "CHUNK", size)
    path = write_json(tmp_path / "a.json", {"x": 12345, "episodes": [R2R, RXR], "y": -1.5e3})
    assert [e.episode_id for e in read_episodes(path)] == ["7", "0041"]
    assert read_extras(path) == {"x": 12345, "y": -1500.0}


def test_read_episodes_accepts_an_empty_list(tmp_path):
    path = write_json(tmp_path / "a.json", {"episodes": []})
    assert list(read_episodes(path)) == []


def test_read_episodes_accepts_hidden_goals(tmp_path):
    hidden = {k: v for k, v in R2R.items() if k not in ("goals", "reference_path")}
    path = write_json(tmp_path / "a.json", {"episodes": [hidden]})
    with pytest.raises(ValueError, match=r"lacks the key 'goals'.*hidden_goals=True"):
        list(read_episodes(path))
    (episode,) = read_episodes(path, hidden_goals=True)
    assert (episode.goals, episode.reference_path) == ((), ())
    write_episodes(tmp_path / "b.json.gz", [episode])
    assert load(tmp_path / "b.json.gz") == {"episodes": [hidden]}


@pytest.mark.parametrize(
    "key",
    [
        *("episode_id", "trajectory_id", "scene_id", "start_position", "start_rotation"),
        *("goals", "instruction", "reference_path"),
    ],
)
def test_read_episodes_names_a_missing_key(tmp_path, key):
    path = episode_file(tmp_path, **{key: ...})
    with pytest.raises(ValueError) as error:
        list(read_episodes(path))
    text = str(error.value)
    identity = "None" if key == "episode_id" else "7"
    assert f"{path}: episode 2 of the list (episode_id {identity}) lacks the key '{key}'" in text
    assert "An episode needs episode_id" in text
    assert "\n" not in text


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"start_position": [1, 2]}, "invalid 'start_position': it must be 3 finite numbers"),
        (
            {"start_rotation": [0, 0, 0, "w"]},
            "invalid 'start_rotation': it must be 4 finite numbers",
        ),
        ({"start_rotation": [0.8, 0, 0.6, 0]}, r"\[0.8, 0.0, 0.6, 0.0\] \(is it \[w, x, y, z\]"),
        ({"start_rotation": [0, 0, 0, 0]}, "unit quaternion"),
        ({"start_rotation": [0, 0.9, 0, 0.9]}, "unit quaternion"),
        ({"start_rotation": [0.2, 0, 0, 0.98]}, "about the vertical"),
        ({"reference_path": []}, "has an empty 'reference_path'"),
        ({"reference_path": [[0, 0, None]]}, "invalid 'reference_path'"),
        ({"goals": []}, "has an empty 'goals'"),
        ({"goals": [{"radius": 3.0}]}, r"goals\[0\], lacks the key 'position'"),
        ({"instruction": {}}, "instruction, lacks the key 'instruction_text'"),
        ({"instruction": "go"}, "invalid 'instruction': 'go'"),
        ({"scene_id": 5}, "invalid 'scene_id': 5"),
        ({"info": {"geodesic_distance": "far"}}, "info, has an invalid 'geodesic_distance'"),
        ({"info": {"geodesic_distance": -1.5}}, "it must be metres >= 0, got -1.5"),
    ],
)
def test_read_episodes_names_an_invalid_value(tmp_path, changes, message):
    with pytest.raises(ValueError, match=message):
        list(read_episodes(episode_file(tmp_path, **changes)))


def test_read_episodes_yields_episodes_before_an_error(tmp_path):
    episodes = read_episodes(episode_file(tmp_path, scene_id=...))
    assert [next(episodes).episode_id, next(episodes).episode_id] == ["7", "0041"]


def test_read_episodes_rejects_damaged_files(tmp_path):
    whole = gzip.compress(json.dumps({"episodes": [R2R] * 500}).encode())
    cases = {
        "cut.json.gz": whole[: len(whole) // 2],
        "cut.json": json.dumps({"episodes": [R2R, R2R]}).encode()[:-40],
        "list.json": b'[{"path_id": 1}]',
        "picture.json": bytes(range(128, 256)),
        "empty.json": b"",
        "comma.json": b'{"episodes": [{} {}]}',
        "deep.json": b'{"episodes": [' + b"[" * 200_000,
        "two.json": json.dumps({"episodes": [R2R]}).encode() + b'\n{"episodes": []}',
    }
    for name, content in cases.items():
        (tmp_path / name).write_bytes(content)
        problem = r"(: episode 0| is not complete JSON| must hold a JSON object)"
        with pytest.raises(ValueError, match=f"{name}{problem}"):
            list(read_episodes(tmp_path / name))


@pytest.mark.parametrize("document", [None, {}, "none", 3])
def test_read_episodes_requires_a_list(tmp_path, document):
    path = write_json(tmp_path / "a.json", {"episodes": document})
    with pytest.raises(ValueError, match=r"a\.json: 'episodes' must be a list, got"):
        list(read_episodes(path))


def test_read_episodes_accepts_rounded_rotations(tmp_path):
    path = episode_file(tmp_path, start_rotation=[0.01, -0.38, -0.02, 0.92])
    assert list(read_episodes(path))[2].start_rotation == (0.01, -0.38, -0.02, 0.92)


def test_read_episodes_explains_other_files(tmp_path):
    truth = write_json(tmp_path / "val_gt.json", {"7": {"locations": [[0, 0, 0]], "actions": [0]}})
    with pytest.raises(ValueError, match="ground truth .* is not read"):
        list(read_episodes(truth))


def test_read_episodes_suggests_a_file_name(tmp_path):
    write_json(tmp_path / "val_seen.json.gz", {"episodes": []})
    with pytest.raises(FileNotFoundError, match=r"nearest names there are val_seen\.json\.gz"):
        list(read_episodes(tmp_path / "val_sen.json.gz"))


@pytest.mark.slow
def test_read_episodes_memory_does_not_grow(tmp_path):
    def peak(count: int) -> int:
        path = tmp_path / f"{count}.json.gz"
        sample = R2R | {"blob": "x" * 8000}
        write_json(path, {"episodes": [sample] * count})
        tracemalloc.start()
        try:
            assert sum(1 for _ in read_episodes(path)) == count
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    # the peak rises by less than 2 MB, although the larger file has 15 MB more text
    assert peak(2000) < peak(125) + 2_000_000


PEAK = """
import resource, sys
from mitigate.worlds.episodes import read_episodes
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
count = sum(1 for _ in read_episodes(sys.argv[1]))
print(count, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


@needs_r2r_ce
@pytest.mark.parametrize(("name", "count"), [("train", 10_819), ("val_seen", 778)])
def test_real_episodes_need_little_memory(name, count):
    file = str(FOLDER / f"{name}.json.gz")
    command = [sys.executable, "-c", PEAK, file]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    episodes, grown = map(int, done.stdout.split())
    assert episodes == count
    # maximum growth of the memory in kB after the imports; train.json contains 18 MB of text
    assert grown < 8 * 1024


@needs_r2r_ce
def test_real_file_survives_a_round_trip(tmp_path):
    source = FOLDER / "val_seen.json.gz"
    write_episodes(tmp_path / "copy.json.gz", read_episodes(source), read_extras(source))
    assert load(tmp_path / "copy.json.gz") == load(source)


def test_read_episodes_accepts_seeded_episodes(tmp_path):
    listed = seeded_episodes(range(3), "Find the lamp.")
    saved = write_episodes(tmp_path / "val.json", listed)
    assert list(read_episodes(saved)) == [
        dataclasses.replace(one, extra=results.extra)
        for one, results in zip(listed, read_episodes(saved), strict=True)
    ]
    least = {"episode_id": "a", "info": {"seed": 7}, "instruction": {"instruction_text": "Go."}}
    (one,) = read_episodes(write_json(tmp_path / "least.json", {"episodes": [least]}))
    assert (one.episode_id, one.info, one.instruction.text) == ("a", {"seed": 7}, "Go.")
    wrong = {"episodes": [{**least, "info": {"seed": "abc"}}]}
    with pytest.raises(ValueError, match="episode 0 .* has an invalid 'seed' in info"):
        list(read_episodes(write_json(tmp_path / "wrong.json", wrong)))
    del least["info"]
    with pytest.raises(ValueError, match="lacks the key"):
        list(read_episodes(write_json(tmp_path / "none.json", {"episodes": [least]})))
