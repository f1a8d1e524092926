"""An apartment as a GLB file (glTF 2.0, Khronos): its faces with colours and textures.

Coordinates are the plan's, z up, as Habitat reads a stage file without a config of its own; it
turns them into VLN-CE's frame. Materials are unlit (KHR_materials_unlit) and textures not filtered,
so that a renderer shows the colours that ours does.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import cv2
import numpy as np

from mitigate.worlds.apartments.faces import Faces
from mitigate.worlds.apartments.palette import PATTERNS, texture

MAGIC, VERSION = b"glTF", 2
FLOAT, BYTE, INT = 5126, 5121, 5125  # component types
VERTICES, INDICES = 34962, 34963  # buffer view targets
NEAREST, REPEAT = 9728, 10497  # of samplers
_CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
_TRIANGLES = np.array([0, 1, 2, 0, 2, 3], np.uint32)


class _Buffer:
    """Collects binary parts, aligned to 4 bytes, and what describes them."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def view(self, data: bytes, target: int | None = None) -> int:
        """Add bytes; return the number of their view."""
        self.data += b"\0" * (-len(self.data) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        if target is not None:
            self.views[-1]["target"] = target
        self.data += data
        return len(self.views) - 1

    def accessor(self, array: np.ndarray, kind: str, component: int, **more: Any) -> int:
        """Add an array [n, ...]; return the number of its accessor."""
        target = INDICES if kind == "SCALAR" else VERTICES
        view = self.view(np.ascontiguousarray(array).tobytes(), target)
        self.accessors.append(
            {"bufferView": view, "componentType": component, "count": len(array), "type": kind}
        )
        self.accessors[-1] |= more
        return len(self.accessors) - 1


def glb(faces: Faces) -> bytes:
    """Return the bytes of a GLB file with all faces: a mesh with a primitive for each texture."""
    buffer, primitives = _Buffer(), []
    used = [k for k in range(len(PATTERNS)) if (faces.pattern == k).any()]
    for number, pattern in enumerate(used):
        primitives.append(
            {**_primitive(buffer, faces, faces.pattern == pattern), "material": number}
        )
    pictures = [cv2.imencode(".png", texture(PATTERNS[k], 0))[1].tobytes() for k in used]
    document = {
        "asset": {"version": "2.0", "generator": "mitigate"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "apartment"}],
        "meshes": [{"primitives": primitives}],
        "materials": [_material(PATTERNS[k], number) for number, k in enumerate(used)],
        "textures": [{"sampler": 0, "source": number} for number in range(len(used))],
        "samplers": [
            {"magFilter": NEAREST, "minFilter": NEAREST, "wrapS": REPEAT, "wrapT": REPEAT}
        ],
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
    """The triangles of the chosen faces."""
    corners = faces.corners[chosen].reshape(-1, 3).astype(np.float32)
    count = int(chosen.sum())
    colours = np.full((4 * count, 4), 255, np.uint8)
    colours[:, :3] = np.rint(faces.colour[chosen].reshape(-1, 3) * 255)
    spots = (_CORNERS[None] * faces.repeat[chosen][:, None]).reshape(-1, 2).astype(np.float32)
    spots[:, 1] = 1 - spots[:, 1]  # glTF's textures begin at the top
    triangles = (4 * np.arange(count, dtype=np.uint32)[:, None] + _TRIANGLES).reshape(-1)
    limits = {"min": corners.min(0).tolist(), "max": corners.max(0).tolist()}
    return {
        "attributes": {
            "POSITION": buffer.accessor(corners, "VEC3", FLOAT, **limits),
            "COLOR_0": buffer.accessor(colours, "VEC4", BYTE, normalized=True),
            "TEXCOORD_0": buffer.accessor(spots, "VEC2", FLOAT),
        },
        "indices": buffer.accessor(triangles, "SCALAR", INT),
    }
