"""Tests of row files: recovery after a killed process, merging, and clear errors."""

from __future__ import annotations

import gzip
import json

import numpy as np
import pytest

from mitigate.evaluation import rows
from tests.evaluation.made_rows import cell, row


def test_appended_rows_are_read_back_in_order(tmp_path):
    path = tmp_path / "deep/rows.jsonl"
    rows.append(path, cell(2, 3))
    rows.append(path, [])
    rows.append(path, [row(9, True, ndtw=0.25, extra="kept")])
    expected = [*cell(2, 3), row(9, True, ndtw=0.25, extra="kept")]
    assert rows.read(path) == expected
    rows.write(tmp_path / "rows.jsonl.gz", expected)
    assert rows.read(tmp_path / "rows.jsonl.gz") == expected


@pytest.mark.parametrize("cut", [1, 40, 200])
def test_append_repairs_an_interrupted_write(tmp_path, cut):
    path = tmp_path / "rows.jsonl"
    rows.append(path, cell(2, 3))
    path.write_bytes(path.read_bytes() + json.dumps(row(3, True)).encode()[:cut])
    assert rows.read(path) == cell(2, 3)
    rows.append(path, [row(3, True)])
    assert rows.read(path) == cell(4, 4)[:2] + [row(2, False), row(3, True)]


def test_append_repairs_an_interrupted_first_write(tmp_path):
    path = tmp_path / "rows.jsonl"
    path.write_text('{"agent": "0123')
    assert rows.read(path) == []
    rows.append(path, [row(0, True)])
    assert rows.read(path) == [row(0, True)]


def test_append_keeps_a_last_line_without_newline(tmp_path):
    path = tmp_path / "rows.jsonl"
    # the line is longer than the blocks that the reader reads
    path.write_text(json.dumps(row(0, True) | {"note": "x" * 9000}))
    rows.append(path, [row(1, False)])
    assert [r["episode_id"] for r in rows.read(path)] == ["0", "1"]


@pytest.mark.parametrize("packed", [False, True])
def test_read_skips_byte_order_marks(tmp_path, packed):
    path = tmp_path / ("rows.jsonl.gz" if packed else "rows.jsonl")
    raw = "".join(f"\ufeff{json.dumps(row(n, True))}\n" for n in (0, 1))  # two files, joined
    raw = raw.rstrip("\n").encode()
    path.write_bytes(gzip.compress(raw) if packed else raw)
    assert rows.read(path) == rows.gather([tmp_path]) == [row(0, True), row(1, True)]
    if not packed:
        rows.append(path, [row(2, False)])
        assert [r["episode_id"] for r in rows.read(path)] == ["0", "1", "2"]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('{"agent": "01', "line 2 is not a JSON object"),
        ("[1]", "line 2 is not a JSON object"),
        (json.dumps({k: v for k, v in row(0, 1).items() if k != "seed"}), "line 2 lacks seed"),
        (json.dumps(row(0, True, severity="0.6")), "line 2 has a wrong severity: '0.6'"),
    ],
)
def test_read_names_an_invalid_line(tmp_path, line, message):
    path = tmp_path / "rows.jsonl"
    path.write_text("\n".join([json.dumps(row(0, True)), line, json.dumps(row(1, True)), ""]))
    with pytest.raises(ValueError, match=message):
        rows.read(path)


def test_read_rejects_a_truncated_gzip(tmp_path):
    path = tmp_path / "rows.jsonl.gz"
    path.write_bytes(gzip.compress(b"".join(rows._line(r).encode() for r in cell(3)))[:-30])
    with pytest.raises(ValueError, match="is damaged"):
        rows.read(path)


def test_rows_that_json_cannot_hold_are_not_written(tmp_path):
    path = tmp_path / "rows.jsonl"
    for bad in ({"ndtw": float("nan")}, {"ndtw": np.float32(0.5)}, {"seed": None}):
        with pytest.raises(ValueError, match="A result row"):
            rows.append(path, [row(0, True), row(1, True, **bad)])
    assert not path.exists()


@pytest.mark.filterwarnings("ignore:.*differ")
def test_unique_keeps_the_last_row():
    old, new = cell(0, 3), [row(1, True), row(1, True, seed=1), row(1, True, suite="1.1")]
    joined = rows.unique([*old, *new])
    assert joined == [row(0, 0), row(1, True), row(2, 0), *new[1:]]
    assert rows.unique([row(1, 0, severity=0), row(1, 1, severity=0.0)]) == [row(1, 1)]


def test_files_and_folders_are_gathered(tmp_path):
    rows.append(tmp_path / "a/rows.jsonl", cell(1, 2))
    rows.append(tmp_path / "a/b/more.jsonl.gz", [row(2, True)])
    (tmp_path / "a/chat.jsonl").write_text('{"messages": []}\n')
    (tmp_path / "a/empty.jsonl").write_text("")
    rows.append(tmp_path / "c.jsonl", [row(0, False)])
    records = rows.gather([tmp_path / "a", tmp_path / "c.jsonl"])
    assert {r["episode_id"]: r["success"] for r in records} == {"0": 0, "1": 0, "2": 1}


def test_gather_names_a_path_without_rows(tmp_path):
    (tmp_path / "chat.jsonl").write_text('{"messages": []}\n')
    with pytest.raises(FileNotFoundError, match="No result rows under"):
        rows.gather([tmp_path])
    with pytest.raises(FileNotFoundError, match=r"nearest names there are chat\.jsonl"):
        rows.gather([tmp_path / "chats.jsonl"])


BAD_VALUES = [
    *(("success", value) for value in (5, -1, 233, 1e300, 10**400)),
    *(("spl", value) for value in (1e300, -0.1, 1.01, 10**400)),
    *(("severity", value) for value in (-1, 1.5, 1e300)),
    *(("ndtw", value) for value in (2.0, "0.5", [1])),
    *(("path_length", value) for value in (-1.0, 1e300, "long")),
    *(("steps", value) for value in (-5, 10**400, {})),
    *(("seed", value) for value in (10**30, -(10**30))),
    *(("corruption", value) for value in ("../../x", "/etc/passwd", "", "a b", "x\n", "..", "-o")),
    *(("agent", value) for value in ("a`b", "a b", "", "<b>", "x" * 500)),
    *(("name", value) for value in ("", "a\nb", "x" * 500, "\x1b[31m", "a\u202eb")),
    *(("split", value) for value in ("", "a\tb")),
    *(("rule", value) for value in ("", "x" * 5000, "a\r\nb")),
    *(("suite", value) for value in ("", "1\x00")),
    *(("episode_id", value) for value in ("", "e\n1", "x" * 500)),
    ("version", 7),
    *((key, value) for key in ("success", "spl", "severity", "seed") for value in (True, False)),
    *((key, True) for key in ("ndtw", "steps", "collisions", "path_length")),
]


@pytest.mark.parametrize(("key", "value"), BAD_VALUES, ids=lambda v: repr(v)[:24])
def test_read_and_write_reject_values_out_of_range(tmp_path, key, value):
    path = tmp_path / "rows.jsonl"
    bad = row(1, True) | {key: value}
    path.write_text(json.dumps(row(0, True)) + "\n" + json.dumps(bad) + "\n")
    with pytest.raises(ValueError, match=f"line 2 has a wrong '?{key}'?: ") as error:
        rows.read(path)
    assert "\n" not in str(error.value) and len(str(error.value)) < 600
    with pytest.raises(ValueError, match="A result row has a wrong"):
        rows.append(path, [bad])


def test_read_rejects_booleans_as_numbers(tmp_path):
    (tmp_path / "rows.jsonl").write_text(json.dumps(row(0, True) | {"success": True}))
    with pytest.raises(ValueError, match=r"wrong 'success': True \(a number: 1 for true, 0 for f"):
        rows.read(tmp_path / "rows.jsonl")
    assert rows._line(row(0, True, fell=True))  # a user's entry may have any name


BAD_LINES = {
    "deep": "[" * 60_000,
    "deep mappings": '{"a":' * 10_000,
    "not a number": json.dumps(row(1, True)).replace("0.5", "NaN"),
    "infinity": json.dumps(row(1, True)).replace("0.5", "1e999"),
    "digits": json.dumps(row(1, True)).replace("0.5", "9" * 5000),
    "long": json.dumps(row(1, True) | {"note": "x" * (1 << 20)}),
    "a text": '"row"',
    "null": "null",
    "control": "\x00\x01\x02",
}


@pytest.mark.parametrize("line", BAD_LINES.values(), ids=BAD_LINES)
@pytest.mark.parametrize("packed", [False, True])
def test_read_names_a_line_without_row(tmp_path, line, packed):
    path = tmp_path / ("rows.jsonl.gz" if packed else "rows.jsonl")
    raw = f"{json.dumps(row(0, True))}\n{line}\n{json.dumps(row(2, True))}\n".encode()
    path.write_bytes(gzip.compress(raw) if packed else raw)
    with pytest.raises(ValueError, match="line 2 ") as error:
        rows.read(path)
    assert len(str(error.value)) < 600


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("line", [b"\xff\xfe\n", b"\xed\xa0\x80\n"], ids=repr)
def test_read_names_a_line_that_is_not_utf8(tmp_path, line, packed):
    path = tmp_path / ("rows.jsonl.gz" if packed else "rows.jsonl")
    bad = rows._line(row(1, True, note="caf")).encode().replace(b"caf", b"caf\xe9")
    good = rows._line(row(0, True)).encode()
    for raw in (good + line, good + bad + good):
        path.write_bytes(gzip.compress(raw) if packed else raw)
        with pytest.raises(ValueError, match=r"line 2 .* UTF-8 .* Delete the line"):
            rows.read(path)


def test_damaged_gzip_and_a_bomb_are_refused(tmp_path):
    path = tmp_path / "rows.jsonl.gz"
    raw = gzip.compress(b"".join(rows._line(r).encode() for r in cell(3)))
    bomb = gzip.compress(rows._line(row(0, True, note="x" * 60_000)).encode() * 1000)
    for data in (raw[:40], raw[:30] + bytes(8) + raw[38:], raw[:-1], b"\x1f\x8b", bomb):
        path.write_bytes(data)
        with pytest.raises(ValueError, match="is damaged"):
            rows.read(path)
        with pytest.raises(ValueError, match="is damaged"):
            rows.gather([tmp_path])


def test_gather_warns_of_conflicting_rows(tmp_path, recwarn):
    first, second = cell(5), cell(7)
    rows.write(tmp_path / "a.jsonl", first)
    rows.write(tmp_path / "b.jsonl", second)
    assert rows.gather([tmp_path / "a.jsonl", tmp_path / "a.jsonl"]) == first and not recwarn.list
    with pytest.warns(UserWarning, match="2 rows have another success.*first base, episode 5"):
        assert rows.gather([tmp_path]) == second


def test_files_accepts_a_folder_named_like_rows(tmp_path):
    (tmp_path / "old.jsonl").mkdir()
    rows.write(tmp_path / "old.jsonl/rows.jsonl", cell(5))
    assert rows.gather([tmp_path]) == cell(5)


def test_gather_reads_files_with_a_damaged_first_line(tmp_path):
    rows.write(tmp_path / "a/rows.jsonl", cell(5))
    rows.write(tmp_path / "b/rows.jsonl", cell(5, name="hard"))
    file = tmp_path / "b/rows.jsonl"
    file.write_bytes(b"\0\0" + file.read_bytes()[2:])
    with pytest.raises(ValueError, match=r"b/rows\.jsonl, line 1 is not a JSON object"):
        rows.gather([tmp_path])
    file.write_bytes(b"")  # like an evaluation that has written no rows so far
    assert rows.gather([tmp_path]) == cell(5)


def test_write_rejects_fewer_rows_than_the_file_holds(tmp_path):
    file = tmp_path / "rows.jsonl"
    rows.write(file, cell(5))
    before = file.read_bytes()
    count = len(rows.read(file))
    with pytest.raises(ValueError, match=f"holds {count} rows, but only {count - 1} would"):
        rows.write(file, rows.read(file)[:-1])
    assert file.read_bytes() == before
    rows.write(file, rows.read(file)[:-1], fewer=True)
    assert len(rows.read(file)) == count - 1


def test_write_rejects_a_damaged_file(tmp_path):
    file = tmp_path / "rows.jsonl"
    rows.write(file, cell(5))
    file.write_bytes(b"[" + file.read_bytes()[1:])
    before = file.read_bytes()
    with pytest.raises(ValueError, match="line 1"):
        rows.write(file, cell(5))
    assert file.read_bytes() == before
