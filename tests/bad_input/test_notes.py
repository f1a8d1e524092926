"""Tests of damaged files next to result rows: the error names the file, and the file is kept."""

import pytest

from mitigate.bridge.events import read_events
from mitigate.cluster import slurm_jobs
from mitigate.core.json_files import read_object
from mitigate.evaluation import provenance
from mitigate.worlds import habitat_world

NO_OBJECTS = ["null", "[]", '"x"', "3", "true", "", "{"]


@pytest.mark.parametrize("text", NO_OBJECTS)
def test_read_object_rejects_what_is_no_object(tmp_path, text):
    file = tmp_path / "note.json"
    file.write_text(text)
    with pytest.raises(ValueError, match=r"note\.json .*Delete it\."):
        read_object(file, "Delete it.")
    assert file.read_text() == text


@pytest.mark.parametrize(
    "text",
    [
        *NO_OBJECTS,
        '{"a": 3}',
        '{"a": {"worlds": []}}',
        '{"a": {"worlds": {"k": null}}}',
        '{"a": {"list": 3}}',
    ],
)
def test_walked_rejects_a_damaged_note(tmp_path, text):
    note = tmp_path / provenance.NOTE
    note.write_text(text)
    with pytest.raises(ValueError, match=r"walked\.json"):
        provenance._read(note)


@pytest.mark.parametrize("text", NO_OBJECTS)
def test_habitat_world_rejects_a_damaged_navmesh(tmp_path, text):
    (tmp_path / "navmesh.json").write_text(text)
    with pytest.raises(ValueError, match=r"navmesh\.json"):
        habitat_world._navmesh_settings(None, tmp_path / "scenes")


@pytest.mark.parametrize("line", [b"null", b"[]", b'{"job": 1}', b"{", b"\xff"])
def test_slurm_jobs_rejects_a_damaged_result(tmp_path, line):
    with pytest.raises(ValueError, match=r"out\.jsonl has a damaged line"):
        slurm_jobs._parse(line, tmp_path / "out.jsonl")


def test_events_are_read_line_by_line(tmp_path):
    """Issue T2, item 8."""
    with open(tmp_path / "events.jsonl", "wb") as file:
        file.write(b'{"event": "hello"}\n')
        file.truncate(8 << 30)
    events = read_events(tmp_path)
    assert next(events)[1] == {"event": "hello"}
    with pytest.raises(ValueError, match="line 2 is damaged"):
        next(events)
