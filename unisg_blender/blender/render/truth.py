"""What a picture shows, pixel by pixel, by Blender's own passes: whose each pixel is, how far, how inclined."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...geometry.camera_view import CameraView
from ...runtime.output_capture import captured_output
from ...scene.graph import SceneGraph
from ..write.mesh_data import write_mesh
from .exr_layers import read_layers

MOST = 32767
"""The largest number that Blender gives an object for its pass; larger ones are rendered digit by digit."""

NARROW = 0.01
"""Width of the filter in pixels: every pixel is what is at its middle."""


@dataclass(frozen=True, eq=False)
class Truth:
    """What the pixels of a picture show, arrays (height, width), the upper row first.

    Attributes
    ----------
    row
        int32: row of the entity in the scenegraph, -1 for none.
    depth
        float32: metres along the camera's axis, infinite where nothing is.
    normal
        float32 (height, width, 3): of the surface in the world, towards the camera; zeros where nothing is.
    """

    row: NDArray[np.int32]
    depth: NDArray[np.float32]
    normal: NDArray[np.float32]


class TruthStage:
    """A scene of its own that shows the meshes of a scenegraph, in metres, all opaque; see :func:`truth_stage`."""

    def __init__(self, scene: bpy.types.Scene, numbers: dict[bpy.types.Object, int]) -> None:
        self.scene, self.numbers = scene, numbers

    def render(self, view: CameraView, hidden: NDArray[np.bool_] | None = None) -> Truth:
        """What a camera sees, without the rows (N,) that are ``hidden``.

        Raises
        ------
        UniSGError
            If Blender cannot render.
        """
        for item, own in self.numbers.items():
            item.hide_render = hidden is not None and bool(hidden[own - 1])
        camera = camera_for(view, self.scene)
        number = np.zeros(view.size[::-1], np.int64)
        most, unit = max(self.numbers.values(), default=0), 1
        while True:
            for item, own in self.numbers.items():
                item.pass_index = own // unit % (MOST + 1)
            layers = self._layers(view)
            number += unit * np.rint(_layer(layers, "IndexOB", "X")).astype(np.int64)
            unit *= MOST + 1
            if unit > most:
                break
        bpy.data.cameras.remove(camera.data)
        seen = number > 0
        depth = np.where(seen, _layer(layers, "Depth", "Z"), np.inf).astype(np.float32)
        normal = np.stack([_layer(layers, "Normal", axis) for axis in "XYZ"], axis=-1)
        return Truth((number - 1).astype(np.int32), depth, np.where(seen[..., None], normal, 0).astype(np.float32))

    def _layers(self, view: CameraView) -> dict[str, NDArray[np.float32]]:
        render = self.scene.render
        render.resolution_x, render.resolution_y = view.size
        with tempfile.TemporaryDirectory(prefix="unisg-") as folder:
            path = Path(folder, "truth.exr")
            render.filepath = str(path)
            try:
                with captured_output():
                    bpy.ops.render.render(write_still=True, scene=self.scene.name)
            except RuntimeError as error:
                raise UniSGError(f"Blender cannot render the ground truth: {str(error).strip()}") from None
            return read_layers(path)


@contextmanager
def truth_stage(graph: SceneGraph, shown: NDArray[np.bool_], threads: int = 1) -> Iterator[TruthStage]:
    """A stage with the entities ``shown`` (N,) of a scenegraph that have meshes; removed afterwards with all of it."""
    scene = bpy.data.scenes.new("unisg truth")
    _set_up(scene)
    use_threads(scene, threads)
    meshes: dict[int, bpy.types.Mesh] = {}
    numbers: dict[bpy.types.Object, int] = {}
    try:
        for row in np.flatnonzero(shown & (graph.mesh >= 0)).tolist():
            place = int(graph.mesh[row])
            if place not in meshes:
                meshes[place] = write_mesh(graph.meshes[place], {})
            item = bpy.data.objects.new("unisg truth", meshes[place])
            item.matrix_world = mathutils.Matrix(graph.world[row].tolist())
            scene.collection.objects.link(item)
            numbers[item] = row + 1
        yield TruthStage(scene, numbers)
    finally:
        for item in numbers:
            bpy.data.objects.remove(item)
        for mesh in meshes.values():
            bpy.data.meshes.remove(mesh)
        bpy.data.scenes.remove(scene)


def camera_for(view: CameraView, scene: bpy.types.Scene, unit: float = 1.0) -> bpy.types.Object:
    """A new camera that is the scene's from now on; ``unit`` is how many metres the scene's unit has."""
    data = bpy.data.cameras.new("unisg view")
    item = bpy.data.objects.new("unisg view", data)
    width = view.size[0]
    data.sensor_fit, data.sensor_width = "HORIZONTAL", 36.0
    if view.orthographic:
        data.type, data.ortho_scale = "ORTHO", width / view.focal / unit
    else:
        data.lens = view.focal / width * 36.0
    data.shift_x = (width / 2 - view.center[0]) / width
    data.shift_y = (view.center[1] - view.size[1] / 2) / width
    data.clip_start, data.clip_end = view.clip[0] / unit, view.clip[1] / unit
    world = view.world.copy()
    world[:3, 3] /= unit
    item.matrix_world = mathutils.Matrix(world.tolist())
    scene.collection.objects.link(item)
    scene.camera = item
    return item


def use_threads(scene: bpy.types.Scene, threads: int) -> None:
    """Let a scene be rendered by so many threads; what comes of it is the same."""
    scene.render.threads_mode, scene.render.threads = "FIXED", threads


def _set_up(scene: bpy.types.Scene) -> None:
    """One sample in the middle of each pixel, no light, exact numbers."""
    layer, cycles, render = scene.view_layers[0], scene.cycles, scene.render
    layer.use_pass_z = layer.use_pass_object_index = layer.use_pass_normal = True
    layer.use_pass_combined = False
    render.engine, render.resolution_percentage = "CYCLES", 100
    render.use_compositing = render.use_sequencer = render.use_motion_blur = False
    cycles.device, cycles.samples, cycles.max_bounces = "CPU", 1, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", NARROW
    settings = render.image_settings
    if hasattr(settings, "media_type"):  # from Blender 5.0 on
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth, settings.exr_codec = "32", "NONE"
    if hasattr(settings, "use_exr_interleave"):  # in newer Blenders: else each pass has a part of its own
        settings.use_exr_interleave = True


def _layer(layers: dict[str, NDArray[np.float32]], name: str, channel: str) -> NDArray[np.float32]:
    """The layer of a pass; Blender calls depth's channel Z or V."""
    channels = (channel, "V") if name == "Depth" else (channel,)
    known = {"IndexOB": ("IndexOB", "Object Index")}.get(name, (name,))
    for full, values in layers.items():
        if any(full.endswith(f".{each}.{one}") for each in known for one in channels):
            return values
    raise UniSGError(f"Blender rendered no pass {name}: it has {', '.join(sorted(layers))}")
