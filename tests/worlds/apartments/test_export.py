"""Tests of exporting apartments for Habitat."""

import gzip
import json
import struct

import numpy as np
import pytest

from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.export_command import glb, main, parse
from mitigate.worlds.apartments.tasks import load_episodes
from mitigate.worlds.episodes import read_episodes


def chunks(data):
    """Return the JSON document and the binary part of a GLB file."""
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    document = json.loads(data[20 : 20 + size])
    binary, kind = struct.unpack_from("<I4s", data, 20 + size)
    assert kind == b"BIN\0" and 0 <= binary - document["buffers"][0]["byteLength"] < 4
    return document, data[28 + size :]


def accessor(document, binary, number, dtype, width):
    reported = document["accessors"][number]
    view = document["bufferViews"][reported["bufferView"]]
    raw = binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    return np.frombuffer(raw, dtype).reshape(reported["count"], width)


def test_glb_contains_every_face_with_colours():
    faces = Apartment(7).faces
    document, binary = chunks(glb(faces))
    corners, colours, triangles = [], [], 0
    for primitive in document["meshes"][0]["primitives"]:
        own_value = primitive["attributes"]
        corners.append(accessor(document, binary, own_value["POSITION"], np.float32, 3))
        colours.append(accessor(document, binary, own_value["COLOR_0"], np.uint8, 4))
        index = accessor(document, binary, primitive["indices"], np.uint32, 1)
        triangles += len(index) // 3
        assert index.max() == len(corners[-1]) - 1
        material = document["materials"][primitive["material"]]
        assert "KHR_materials_unlit" in material["extensions"]
    assert triangles == 2 * len(faces.corners)
    results = np.concatenate(corners)
    assert sorted(map(tuple, results)) == sorted(map(tuple, faces.corners.reshape(-1, 3)))
    assert np.concatenate(colours)[:, 3].min() == 255


def test_glb_is_deterministic():
    assert glb(Apartment(7).faces) == glb(Apartment(7).faces)


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    out = tmp_path_factory.mktemp("exported")
    assert main([str(out), "split=val_unseen", "scenes=2"]) == 0
    return out


def test_export_writes_vln_ce_episodes(exported):
    path = exported / "datasets" / "vln" / "val_unseen.json.gz"
    stored = json.loads(gzip.decompress(path.read_bytes()))
    assert len(stored["episodes"]) == 20
    words = stored["instruction_vocab"]["word_list"]
    for episode in stored["episodes"]:
        assert set(episode["instruction"]) == {"instruction_text", "instruction_tokens"}
        tokens = episode["instruction"]["instruction_tokens"]
        assert len(tokens) == 200 and max(tokens) < len(words) and 1 not in tokens
        assert (exported / "scenes" / episode["scene_id"]).is_file()
    ours = {episode.episode_id: episode for episode in load_episodes("val_unseen")}
    for episode in read_episodes(path):
        assert episode.start_position == ours[episode.episode_id].start_position


def test_export_writes_view_points(exported):
    folder = exported / "datasets" / "objectnav" / "val_unseen"
    assert (
        json.loads(gzip.decompress((folder / "val_unseen.json.gz").read_bytes()))["episodes"] == []
    )
    files = sorted((folder / "content").glob("*.json.gz"))
    assert len(files) == 2
    for file in files:
        stored = json.loads(gzip.decompress(file.read_bytes()))
        for episode in stored["episodes"]:
            name = episode["scene_id"].rpartition("/")[2]
            goals = stored["goals_by_category"][f"{name}_{episode['object_category']}"]
            assert goals and all(goal["view_points"] for goal in goals)
            assert episode["object_category"] in stored["category_to_task_category_id"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "takes 1 path, OUT"),
        (["a", "b"], "takes 1 path, OUT"),
        (["a", "splitt=train"], "There is no option 'splitt'"),
        (["a", "split=test"], "There is no split 'test'"),
        (["a", "scenes=-1"], "must be a whole number"),
        (["a", "--all"], "no option --all"),
    ],
)
def test_parse_explains_invalid_arguments(arguments, words):
    with pytest.raises(ValueError, match=words):
        parse(arguments)
