"""Render with Panda3D into one off-screen buffer, which holds 12 RGB views and 12 face-id views.

Rendering uses Panda3D's ``p3tinydisplay`` on the CPU, without GPU, GL or display. Because the depth
buffer of ``p3tinydisplay`` cannot be read, a second pass draws every planar face in a flat colour
that encodes the face id. The face id gives the semantic label, and intersecting the pixel's ray
with the plane of the face gives the exact depth in metres.
"""

from __future__ import annotations

import math
import weakref
from collections import OrderedDict
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np
from numba import njit

from mitigate.core.observation import HFOV_DEGREES, VIEW_STEP_DEGREES, VIEWS
from mitigate.core.signals import uninterrupted
from mitigate.corruptions.faults.camera import Mount
from mitigate.worlds.apartments.apartment import Apartment
from mitigate.worlds.apartments.faces import Faces, texture_coordinates
from mitigate.worlds.apartments.palette import PATTERNS, TEXTURE_PIXELS, texture

EYE = 1.25  # height of the camera in metres, as in VLN-CE
LEVEL = Mount()
FARTHEST = 17.0  # distance in metres that is longer than any straight line through an apartment
LEAST = 4  # minimum size of a view in pixels (heuristic)
# number of cached scenes per renderer (heuristic); a scene takes 0.35 MB, and 6 ms to build
SCENES = 128
PIPE = "p3tinydisplay"
SETTINGS = f"""
window-type offscreen
notify-level error
notify-level-x11display fatal
notify-level-display fatal
textures-power-2 none
audio-library-name null
framebuffer-srgb 0
load-display {PIPE}
"""
_COLUMNS, _ROWS = 4, 3  # the 12 views are arranged as tiles in the buffer
# This is the distance of the near clipping plane in metres.
# In a 90-degree view, the agent's radius keeps walls at a depth of at least 0.127 m.
_NEAR = 0.1


def _panda() -> Any:
    # signals are delayed, because an error in the first import ends the process (panda3d 1.10.16)
    with uninterrupted():
        from panda3d import core

    core.load_prc_file_data("mitigate", SETTINGS)
    return core


class Renderer:
    """Render RGB and face ids of apartments. The geometry of the last ``scenes`` scenes is cached.

    Raises ValueError if ``size`` is below ``LEAST`` pixels.
    """

    def __init__(self, size: int = 64, scenes: int = SCENES) -> None:
        if size < LEAST:
            raise ValueError(f"size must be at least {LEAST} pixels, got {size}.")
        self.size, self.core = size, _panda()
        core = self.core
        self.engine = core.GraphicsEngine.get_global_ptr()
        self.pipe = _make_pipe(core)
        properties = core.FrameBufferProperties()
        properties.set_rgb_color(True)
        properties.set_rgba_bits(8, 8, 8, 8)
        properties.set_depth_bits(16)
        window = core.WindowProperties.size(_COLUMNS * size, 2 * _ROWS * size)
        flags = core.GraphicsPipe.BF_refuse_window
        self.buffer = self.engine.make_output(self.pipe, "panorama", 0, properties, window, flags)
        if self.buffer is None:
            raise RuntimeError(
                f"Panda3D could not open an off-screen buffer with {PIPE}; run `make doctor`."
            )
        # inactive by default, because render_frame draws every active buffer of the process
        self.buffer.set_active(False)
        weakref.finalize(self, self.engine.remove_window, self.buffer)
        self.image = core.Texture()
        self.buffer.add_render_texture(self.image, core.GraphicsOutput.RTM_copy_ram)
        self.buffer.set_clear_color((0, 0, 0, 1))
        self.textures = [self._texture(pattern) for pattern in PATTERNS]
        # one list of display regions for the RGB views, and one for the id views
        self.regions: list[list[Any]] = []
        self.lenses: list[Any] = []
        self.hfov = HFOV_DEGREES  # horizontal field of view of all lenses, in degrees
        self.rig_rgb, self.rig_ids = self._rig(0), self._rig(1)
        self.scenes: OrderedDict[int, tuple[Any, Any, Faces]] = OrderedDict()
        self.capacity = scenes

    def load(self, apartment: Apartment) -> None:
        """Make an apartment the current scene. Its geometry is built at first use."""
        if apartment.seed not in self.scenes:
            self.scenes[apartment.seed] = self._scene(apartment.faces)
            if len(self.scenes) > self.capacity:
                _, (old_rgb, old_ids, _) = self.scenes.popitem(last=False)
                old_rgb.remove_node()
                old_ids.remove_node()
        self.scenes.move_to_end(apartment.seed)
        rgb, ids, self.faces = self.scenes[apartment.seed]
        self.rig_rgb.reparent_to(rgb)
        self.rig_ids.reparent_to(ids)

    def render(
        self,
        x: float,
        y: float,
        heading: float,
        *,
        views: Iterable[int] = range(VIEWS),
        rgb: bool = True,
        mount: Mount = LEVEL,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Render the current scene at a pose.

        Args:
            x: plan position in metres.
            y: plan position in metres.
            heading: heading in counter-clockwise radians.
            views: indices of the views to render. In all other views, the colours and the depth are
                0, and the face ids are -1. The choice does not change the pixels of the drawn
                views.
            rgb: whether to render colours. If false, the colours are 0.
            mount: displacement of the cameras.

        Returns:
            rgb (uint8 [12, S, S, 3]), depth in metres (float32 [12, S, S, 1]) and face ids (int32
            [12, S, S]), where S is ``size``.
        """
        eye = EYE + mount.height
        for rig in (self.rig_rgb, self.rig_ids):
            rig.set_pos(x, y, eye)
            rig.set_hpr(np.degrees(heading) + mount.yaw, mount.pitch, mount.roll)
        hfov = mount.hfov(HFOV_DEGREES)
        if hfov != self.hfov:
            for lens in self.lenses:
                lens.set_fov(hfov, hfov)
            self.hfov = hfov
        is_drawn = np.zeros(VIEWS, np.bool_)
        is_drawn[list(views)] = True
        for layer, drawn in zip(self.regions, (is_drawn & rgb, is_drawn), strict=True):
            for region, active in zip(layer, drawn, strict=True):
                region.set_active(bool(active))
        self.buffer.set_active(True)
        self.engine.render_frame()
        self.buffer.set_active(False)
        raw = np.frombuffer(self.image.get_ram_image(), np.uint8)
        frame = raw.reshape(2 * _ROWS * self.size, _COLUMNS * self.size, 4)
        plane = self.faces.plane
        edge = 1.0 if hfov == HFOV_DEGREES else math.tan(math.radians(hfov) / 2)
        turn = _turn(mount, heading)
        return _split(frame, self.size, plane, x, y, eye, heading, turn, edge, _NEAR, is_drawn, rgb)

    def _rig(self, layer: int) -> Any:
        core = self.core
        rig = core.NodePath(f"rig{layer}")
        regions = []
        for k in range(VIEWS):
            lens = core.PerspectiveLens()
            lens.set_fov(HFOV_DEGREES, HFOV_DEGREES)
            lens.set_near_far(_NEAR, 40.0)
            self.lenses.append(lens)
            camera = rig.attach_new_node(core.Camera(f"view{k}", lens))
            camera.set_h(-VIEW_STEP_DEGREES * k)
            column, row = k % _COLUMNS, layer * _ROWS + k // _COLUMNS
            left, bottom = column / _COLUMNS, row / (2 * _ROWS)
            right, top = left + 1 / _COLUMNS, bottom + 0.5 / _ROWS
            region = self.buffer.make_display_region(left, right, bottom, top)
            region.set_camera(camera)
            region.set_clear_depth_active(True)
            regions.append(region)
        self.regions.append(regions)
        return rig

    def _texture(self, pattern: str) -> Any:
        core = self.core
        image = core.Texture(pattern)
        image.setup_2d_texture(
            TEXTURE_PIXELS, TEXTURE_PIXELS, core.Texture.T_unsigned_byte, core.Texture.F_rgb
        )
        image.set_ram_image(np.repeat(texture(pattern)[:, :, None], 3, 2).tobytes())
        image.set_minfilter(core.SamplerState.FT_nearest)
        image.set_magfilter(core.SamplerState.FT_nearest)
        return image

    def _scene(self, faces: Faces) -> tuple[Any, Any, Faces]:
        rgb, ids = self.core.NodePath("rgb"), self.core.NodePath("ids")
        for room in range(int(faces.room.max()) + 1):
            here = faces.room == room
            # faces are grouped by room, because Panda3D can then skip rooms that are not visible
            group = rgb.attach_new_node(f"room{room}")
            for pattern, image in enumerate(self.textures):
                chosen = np.flatnonzero(here & (faces.pattern == pattern))
                if len(chosen):
                    shape = self._geometry(faces, chosen, faces.colour[chosen])
                    node = group.attach_new_node(shape)
                    node.set_texture(image)
                    node.set_bin("fixed", room * len(self.textures) + pattern)
            chosen = np.flatnonzero(here)
            flat = np.repeat(_id_colours(chosen)[:, None, :], 4, 1)
            ids.attach_new_node(self._geometry(faces, chosen, flat)).set_bin("fixed", room)
        return rgb, ids, faces

    def _geometry(self, faces: Faces, chosen: np.ndarray, colour: np.ndarray) -> Any:
        core = self.core
        n = len(chosen)
        packed = np.zeros((n * 4, 6), np.float32)
        packed[:, :3] = faces.corners[chosen].reshape(-1, 3)
        packed[:, 4:] = texture_coordinates(faces, chosen)
        bytes_ = np.zeros((n * 4, 4), np.uint8)
        bytes_[:, :3] = np.rint(colour.reshape(-1, 3) * 255)
        bytes_[:, 3] = 255
        packed[:, 3] = np.ascontiguousarray(bytes_).view(np.float32)[:, 0]
        layout = core.GeomVertexFormat.get_v3c4t2()  # position, colour and texture coordinates
        data = core.GeomVertexData("faces", layout, core.Geom.UH_static)
        data.unclean_set_num_rows(n * 4)
        data.modify_array_handle(0).copy_data_from(packed.tobytes())
        triangles = core.GeomTriangles(core.Geom.UH_static)
        for first in range(0, 4 * n, 4):
            triangles.add_vertices(first, first + 1, first + 2)
            triangles.add_vertices(first, first + 2, first + 3)
        geometry = core.Geom(data)
        geometry.add_primitive(triangles)
        node = core.GeomNode("faces")
        node.add_geom(geometry)
        return node


@lru_cache(maxsize=4)
def shared_renderer(size: int) -> Renderer:
    """Return this process's renderer for views of ``size`` pixels.

    All users of this renderer share its cache of ``SCENES`` scenes.
    """
    return Renderer(size)


def _make_pipe(core: Any) -> Any:
    selection = core.GraphicsPipeSelection.get_global_ptr()
    selection.make_module_pipe(PIPE)
    for index in range(selection.get_num_pipe_types()):
        if str(selection.get_pipe_type(index)) == "TinyOffscreenGraphicsPipe":
            return selection.make_pipe(selection.get_pipe_type(index))
    return selection.make_module_pipe(PIPE)


def _id_colours(ids: np.ndarray) -> np.ndarray:
    """Encode face ids as colours, float32 [n, 3].

    Face id + 1 is written in base 32, so that rounding does not change the decoded id.
    """
    code = ids + 1
    digits = np.stack([code % 32, code // 32 % 32, code // 1024 % 32], 1)
    return (digits * 8 + 4).astype(np.float32) / 255


def _turn(mount: Mount, heading: float) -> np.ndarray:
    """Return the rotation matrix [3, 3] that applies ``mount`` to the directions of a camera rig.

    The matrix maps the directions of a level rig with ``heading`` to those of the mounted rig. All
    directions are in the plan frame.
    """
    if (mount.pitch, mount.roll, mount.yaw) == (0.0, 0.0, 0.0):
        return np.eye(3)
    cos, sin = math.cos(heading), math.sin(heading)
    level = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return level @ mount.rotation() @ level.T


@njit(inline="always")
def _turned(turn, x, y, z):
    return (
        turn[0, 0] * x + turn[0, 1] * y + turn[0, 2] * z,
        turn[1, 0] * x + turn[1, 1] * y + turn[1, 2] * z,
        turn[2, 0] * x + turn[2, 1] * y + turn[2, 2] * z,
    )


@njit(cache=True)
def _split(frame, size, plane, x, y, z, heading, turn, edge, near, is_drawn, colours):
    """Split the rendered buffer into views, and compute the depth of each pixel. The buffer is BGRA
    with the bottom row first, and its upper half contains the face ids.

    ``turn`` is the rotation of the level views, and ``edge`` is the tangent of half the field of
    view.
    """
    rgb = np.zeros((12, size, size, 3), np.uint8)
    depth = np.zeros((12, size, size, 1), np.float32)
    ids = np.full((12, size, size), -1, np.int32)
    for k in range(12):
        if not is_drawn[k]:
            continue
        angle = heading - k * np.pi / 6
        fx, fy, fz = _turned(turn, -np.sin(angle), np.cos(angle), 0.0)
        rx, ry, rz = _turned(turn, np.cos(angle), np.sin(angle), 0.0)
        ux, uy, uz = _turned(turn, 0.0, 0.0, 1.0)
        row0, column0 = (k // 4) * size, (k % 4) * size
        for i in range(size):
            up = edge * (1 - (2 * i + 1) / size)
            r1 = row0 + size - 1 - i
            for j in range(size):
                right = edge * ((2 * j + 1) / size - 1)
                if colours:
                    for c in range(3):
                        rgb[k, i, j, c] = frame[r1, column0 + j, 2 - c]
                r2, c2 = r1 + 3 * size, column0 + j
                blue, green, red = frame[r2, c2, 0], frame[r2, c2, 1], frame[r2, c2, 2]
                code = (red >> 3) + 32 * (green >> 3) + 1024 * (blue >> 3)
                face = np.int32(code) - 1
                ids[k, i, j] = face
                if face < 0 or face >= plane.shape[0]:
                    continue
                axis = int(plane[face, 0])
                if axis == 0:
                    t = (plane[face, 1] - x) / (fx + right * rx + up * ux)
                elif axis == 1:
                    t = (plane[face, 1] - y) / (fy + right * ry + up * uy)
                else:
                    t = (plane[face, 1] - z) / (fz + right * rz + up * uz)
                # for a face that is seen edge-on, use the face of the pixel to the left
                if not near <= t <= FARTHEST:
                    t = depth[k, i, j - 1, 0] if j > 0 else 0.0
                depth[k, i, j, 0] = t
    return rgb, depth, ids
