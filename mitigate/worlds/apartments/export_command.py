"""Export apartments and their episodes for Habitat.

  mitigate export_scene OUT split=val_unseen scenes=3

  OUT      folder for scenes, episodes and configs
  split    train, val_seen or val_unseen (default)
  scenes   number of apartments (null: all of the shipped episode list; 100 for train)
  task     vln, ogn or both (default)

OUT/scenes/apartments/<split>/<seed>.glb      the apartments, z up, unlit
OUT/datasets/vln/<split>.json.gz              the shipped episodes in the format R2RVLN-v1 of
                                              habitat-lab and VLN-CE, with tokens
OUT/datasets/objectnav/<split>/...            the format ObjectNav-v1, with view points
OUT/navmesh.json                              the size of the agent, for recompute_navmesh

The same command always writes the same bytes. docs/habitat.md explains how to use the files.
"""

from __future__ import annotations

import json
import re
import struct
import sys
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from mitigate.core.errors import command
from mitigate.core.files import atomic_text, write_bytes, write_json
from mitigate.core.names import unknown
from mitigate.core.options import asks_help, paths_and_options
from mitigate.core.output import output_folder
from mitigate.worlds.apartments.apartment import apartment_of
from mitigate.worlds.apartments.faces import Faces, texture_coordinates
from mitigate.worlds.apartments.layout import CATEGORIES
from mitigate.worlds.apartments.navigation import RADIUS
from mitigate.worlds.apartments.palette import PATTERNS, SPLITS, texture
from mitigate.worlds.apartments.renderer import EYE
from mitigate.worlds.apartments.tasks import (
    PER_APARTMENT,
    fixed_episodes,
    landmarks,
    load_episodes,
    to_vlnce,
    view_cells,
)
from mitigate.worlds.episodes import Episode, to_json

TRAIN = 100  # default number of apartments for the train split (heuristic)
# arguments of habitat_sim.NavMeshSettings; Habitat places the agent cell_height above the floor
NAVMESH = {
    "agent_radius": RADIUS,
    "agent_height": 1.5,
    "agent_max_climb": 0.05,
    "cell_size": 0.02,
    "cell_height": 0.01,
    "include_static_objects": False,
    "camera_height": EYE,
}
PAD, UNKNOWN = "<pad>", "<unk>"
TOKENS = 200  # number of tokens per instruction after padding, as in the files of R2R-CE
DEFAULTS = {"split": "val_unseen", "scenes": "null", "task": "both"}
ALLOWED = {"split": SPLITS, "task": ("vln", "ogn", "both")}


def export(out: Path, split: str, scenes: int | None, tasks: Sequence[str]) -> list[Path]:
    """Write apartments and their episodes to ``out``, and return the paths of the episode lists."""
    episodes = {task: _episodes(split, task, scenes) for task in tasks}
    places = sorted({episode.scene_id for listed in episodes.values() for episode in listed})
    with output_folder(out):
        for number, scene in enumerate(places):
            write_bytes(out / "scenes" / f"{scene}.glb", glb(apartment_of(scene).faces))
            print(f"scene {number + 1}/{len(places)}: {scene}", flush=True)
        write_json(out / "navmesh.json", NAVMESH, indent=1)
        writers = {"vln": write_vln, "ogn": write_objectnav}
        return [writers[task](out, split, listed) for task, listed in episodes.items()]


def _episodes(split: str, task: str, scenes: int | None) -> list[Episode]:
    """Return the episodes of the first ``scenes`` apartments of a split."""
    if split == "train":
        return list(fixed_episodes(split, task, PER_APARTMENT * (scenes or TRAIN)))
    episodes = load_episodes(split, task)
    selected = sorted({episode.scene_id for episode in episodes})[:scenes]
    return [episode for episode in episodes if episode.scene_id in selected]


def write_vln(out: Path, split: str, episodes: Sequence[Episode]) -> Path:
    """Write episodes in the format of R2R-CE, with the vocabulary that defines the tokens."""
    words = sorted({w for e in episodes for w in _words(e.instruction.text)})
    vocabulary = [PAD, UNKNOWN, *words]
    numbers = {word: number for number, word in enumerate(vocabulary)}
    entries = []
    for episode in episodes:
        tokens = [numbers[word] for word in _words(episode.instruction.text)][:TOKENS]
        entry = to_json(episode)
        entry["scene_id"] = f"{episode.scene_id}.glb"
        entry["instruction"] = {
            "instruction_text": episode.instruction.text,
            "instruction_tokens": tokens + [0] * (TOKENS - len(tokens)),
        }
        entries.append(entry)
    stored = {
        "word_list": vocabulary,
        "word2idx_dict": numbers,
        "stoi": numbers,
        "itos": vocabulary,
        "num_vocab": len(vocabulary),
        "PAD_INDEX": 0,
        "UNK_INDEX": 1,
    }
    path = out / "datasets" / "vln" / f"{split}.json.gz"
    with atomic_text(path) as file:
        json.dump({"episodes": entries, "instruction_vocab": stored}, file)
    return path


def _words(text: str) -> list[str]:
    return re.findall(r"[a-z]+|[^\w\s]", text.lower())


def write_objectnav(out: Path, split: str, episodes: Sequence[Episode]) -> Path:
    """Write episodes in the ObjectNav format of HM3D.

    There is one file per scene, and an index file without episodes. Return the path of the index.
    """
    ids = {category: number for number, category in enumerate(CATEGORIES)}
    category_ids = {
        "category_to_task_category_id": ids,
        "category_to_scene_annotation_category_id": ids,
    }
    by_scene: dict[str, list[Episode]] = defaultdict(list)
    for episode in episodes:
        by_scene[episode.scene_id].append(episode)
    folder = out / "datasets" / "objectnav" / split
    for scene, scene_episodes in by_scene.items():
        name = Path(scene).name
        goals = {f"{name}.glb_{e.info['category']}": _goals(e) for e in scene_episodes}
        entries = [_objectnav(episode) for episode in scene_episodes]
        with atomic_text(folder / "content" / f"{name}.json.gz") as file:
            json.dump({"episodes": entries, "goals_by_category": goals, **category_ids}, file)
    path = folder / f"{split}.json.gz"
    with atomic_text(path) as file:
        json.dump({"episodes": [], **category_ids}, file)
    return path


def _objectnav(episode: Episode) -> dict[str, Any]:
    entry = to_json(episode)
    return {
        **{name: entry[name] for name in ("episode_id", "start_position", "start_rotation")},
        "scene_id": f"{episode.scene_id}.glb",
        "info": {"geodesic_distance": episode.geodesic_distance},
        "goals": [],
        "object_category": episode.info["category"],
    }


def _goals(episode: Episode) -> list[dict[str, Any]]:
    """Return all objects of the goal category.

    The view points of an object are the free cells next to it.
    """
    apartment = apartment_of(episode.scene_id)
    goals = []
    for thing in landmarks(episode):
        piece = apartment.furniture[thing]
        cells = map(apartment.space.centre, view_cells(apartment, thing))
        states = [{"position": to_vlnce(xy), "rotation": [0.0, 0.0, 0.0, 1.0]} for xy in cells]
        goals.append(
            {
                "position": to_vlnce(piece.centre),
                "object_id": thing,
                "object_name": f"{piece.category}_{thing}",
                "object_category": piece.category,
                "view_points": [{"agent_state": state, "iou": 1.0} for state in states],
            }
        )
    return goals


def parse(arguments: Sequence[str]) -> tuple[Path, str, int | None, tuple[str, ...]]:
    """Return OUT, split, scenes and tasks; raise ValueError for invalid arguments."""
    (out,), overrides = paths_and_options(arguments, ("OUT",), DEFAULTS)
    options = {**DEFAULTS, **overrides}
    for name, allowed in ALLOWED.items():
        if options[name] not in allowed:
            raise ValueError(unknown(name, options[name], allowed))
    if options["scenes"] != "null" and not options["scenes"].isdecimal():
        raise ValueError(f"scenes must be a whole number or null, got {options['scenes']!r}.")
    scenes = None if options["scenes"] == "null" else max(1, int(options["scenes"]))
    tasks = ("vln", "ogn") if options["task"] == "both" else (options["task"],)
    return Path(out), options["split"], scenes, tasks


@command("export-scene")
def main(argv: Sequence[str] | None = None) -> int:
    """Run from the command line; return the exit status."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if asks_help(arguments):
        print(__doc__)
        return 0 if arguments else 2
    paths = export(*parse(arguments))
    print("\n".join(f"wrote {path}" for path in paths))
    return 0


MAGIC, VERSION = b"glTF", 2
FLOAT, BYTE, INT = 5126, 5121, 5125  # component types of glTF accessors
VERTICES, INDICES = 34962, 34963  # targets of glTF buffer views
# sample the nearest pixel, and repeat textures
SAMPLER = {"magFilter": 9728, "minFilter": 9728, "wrapS": 10497, "wrapT": 10497}
_TRIANGLES = np.array([0, 1, 2, 0, 2, 3], np.uint32)


class _Buffer:
    """The binary data of a glTF file, aligned to 4 bytes, with its buffer views and accessors."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def view(self, data: bytes, target: int | None = None) -> int:
        """Add bytes to the binary data, and return the index of their glTF buffer view."""
        self.data += b"\0" * (-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        self.views.append(view if target is None else {**view, "target": target})
        self.data += data
        return len(self.views) - 1

    def accessor(self, array: np.ndarray, kind: str, component: int, **more: Any) -> int:
        """Add an array of shape [n, ...], and return the index of its glTF accessor."""
        target = INDICES if kind == "SCALAR" else VERTICES
        view = self.view(np.ascontiguousarray(array).tobytes(), target)
        entry = {"bufferView": view, "componentType": component, "count": len(array), "type": kind}
        self.accessors.append({**entry, **more})
        return len(self.accessors) - 1


def glb(faces: Faces) -> bytes:
    """Return the bytes of a GLB file (glTF 2.0, Khronos) with all faces of an apartment.

    Coordinates are plan coordinates, with z up. Habitat expects these coordinates in a scene file
    that has no config, and converts them to the coordinate frame of VLN-CE. Materials are unlit
    (KHR_materials_unlit) and textures are not filtered, so that other renderers show the same
    colours.
    """
    buffer = _Buffer()
    used = [k for k in range(len(PATTERNS)) if (faces.pattern == k).any()]
    primitives = [
        {**_primitive(buffer, faces, faces.pattern == pattern), "material": number}
        for number, pattern in enumerate(used)
    ]
    pictures = [cv2.imencode(".png", texture(PATTERNS[k]))[1].tobytes() for k in used]
    document = {
        "asset": {"version": "2.0", "generator": "mitigate"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "apartment"}],
        "meshes": [{"primitives": primitives}],
        "materials": [_material(PATTERNS[k], number) for number, k in enumerate(used)],
        "textures": [{"sampler": 0, "source": number} for number in range(len(used))],
        "samplers": [SAMPLER],
        "images": [{"bufferView": buffer.view(p), "mimeType": "image/png"} for p in pictures],
    }
    document |= {"accessors": buffer.accessors, "bufferViews": buffer.views}
    document["buffers"] = [{"byteLength": len(buffer.data)}]
    text = json.dumps(document, separators=(",", ":")).encode()
    chunks = _chunk(b"JSON", text, b" ") + _chunk(b"BIN\0", bytes(buffer.data), b"\0")
    return struct.pack("<4sII", MAGIC, VERSION, 12 + len(chunks)) + chunks


def _chunk(kind: bytes, data: bytes, filler: bytes) -> bytes:
    data += filler * (-len(data) % 4)
    return struct.pack("<I4s", len(data), kind) + data


def _material(name: str, number: int) -> dict[str, Any]:
    return {
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": number},
            "metallicFactor": 0.0,
            "roughnessFactor": 1.0,
        },
        "extensions": {"KHR_materials_unlit": {}},
    }


def _primitive(buffer: _Buffer, faces: Faces, chosen: np.ndarray) -> dict[str, Any]:
    """Add the triangles of the chosen faces, and return a glTF primitive that refers to them."""
    corners = faces.corners[chosen].reshape(-1, 3).astype(np.float32)
    count = int(chosen.sum())
    colours = np.full((4 * count, 4), 255, np.uint8)
    colours[:, :3] = np.rint(faces.colour[chosen].reshape(-1, 3) * 255)
    uv = texture_coordinates(faces, np.flatnonzero(chosen))
    uv[:, 1] = 1 - uv[:, 1]  # glTF stores texture rows from top to bottom
    triangles = (4 * np.arange(count, dtype=np.uint32)[:, None] + _TRIANGLES).reshape(-1)
    limits = {"min": corners.min(0).tolist(), "max": corners.max(0).tolist()}
    return {
        "attributes": {
            "POSITION": buffer.accessor(corners, "VEC3", FLOAT, **limits),
            "COLOR_0": buffer.accessor(colours, "VEC4", BYTE, normalized=True),
            "TEXCOORD_0": buffer.accessor(uv, "VEC2", FLOAT),
        },
        "indices": buffer.accessor(triangles, "SCALAR", INT),
    }
