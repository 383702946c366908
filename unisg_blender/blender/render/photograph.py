"""Pictures of the open scene as it would be rendered, by a camera that is given as numbers."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...geometry.camera_view import CameraView
from ...runtime.atomic_files import replacing
from ...runtime.output_capture import captured_output
from ...scene.graph import SceneGraph
from ..lookup import objects_by_uid
from ..scene_units import metres_per_unit
from .picture_faults import BLACK, picture_fault
from .png_chunks import remove_words
from .truth import camera_for, use_threads

ENGINES = {"cycles": ("CYCLES",), "workbench": ("BLENDER_WORKBENCH",), "eevee": ("BLENDER_EEVEE_NEXT", "BLENDER_EEVEE")}
"""Blender's names of each engine, in the versions that know it."""

SKY, LAMP, BESIDE = 0.7, 120.0, (0.3, 0.3, 0.2)
"""Where a scene has no light: strength of the sky, watts of the lamp, and where that is beside the camera."""

DIM = 0.1
"""A plain sky up to this bright lights no room: Blender gives every new scene one of 0.05."""


def show_as_rendered(scene: bpy.types.Scene) -> None:
    """Let what is evaluated be what is rendered: what is hidden, and modifiers; for files that are thrown away."""
    for collection in bpy.data.collections:
        collection.hide_viewport = collection.hide_render
    for layer in _layers_below(scene.view_layers[0].layer_collection):
        layer.hide_viewport = False
    for item in scene.objects:
        item.hide_viewport = item.hide_render
        if item.name in scene.view_layers[0].objects:
            item.hide_set(False)
        for modifier in item.modifiers:
            modifier.show_viewport = modifier.show_render
            if hasattr(modifier, "render_levels"):
                modifier.levels = modifier.render_levels
    scene.view_layers[0].update()


def _layers_below(layer: bpy.types.LayerCollection) -> list[bpy.types.LayerCollection]:
    found = [layer]
    for each in found:
        found += list(each.children)
    return found


def rendered_rows(graph: SceneGraph, scene: bpy.types.Scene) -> NDArray[np.bool_]:
    """Which rows (N,) of a scenegraph that was read of the scene are rendered; what instances show, as these are."""
    found = np.zeros(len(graph), bool)
    items = objects_by_uid(scene)
    for row, uid in enumerate(graph.uid):  # parents come first
        item = items.get(uid)
        if item is None:
            found[row] = graph.parent[row] >= 0 and _owner_shows(graph, row, items, found)
        else:
            found[row] = item.visible_get() and not item.hide_render and item.visible_camera
    return found


def _owner_shows(graph: SceneGraph, row: int, items: dict[str, bpy.types.Object], found: NDArray[np.bool_]) -> bool:
    parent = int(graph.parent[row])
    owner = items.get(graph.uid[parent])
    if owner is None:
        return bool(found[parent])
    return bool(owner.visible_get() and not owner.hide_render)


class Photographer:
    """Takes pictures of the open scene with an engine.

    A scene without light gets some, and what its own light leaves black is taken again with a lamp; ``note`` says so.
    """

    def __init__(self, scene: bpy.types.Scene, engine: str, samples: int, threads: int) -> None:
        self.scene = scene
        lit = engine == "workbench" or _has_light(scene)
        self._unlit = "" if lit else "the scene has no light: it got a sky, and a lamp beside each camera"
        self._dark: list[str] = []
        self._blank: list[str] = []
        use_threads(scene, threads)
        self._set_up(engine, samples)
        self._lamp = None if lit else _add_light(scene)

    def take(self, view: CameraView, path: Path, hidden: Collection[str] = ()) -> None:
        """Write a picture as PNG, without objects of some uids.

        Raises
        ------
        UniSGError
            If the engine cannot render, or the file cannot be written.
        """
        items = objects_by_uid(self.scene)
        left_out = [items[uid] for uid in hidden if uid in items and not items[uid].hide_render]
        camera = camera_for(view, self.scene, metres_per_unit(self.scene))
        if self._lamp is not None:
            _place_beside(self._lamp, camera)
        render = self.scene.render
        render.resolution_x, render.resolution_y = view.size
        try:
            for item in left_out:
                item.hide_render = True
            with replacing(path) as unfinished:
                self._render(unfinished)
                fault = picture_fault(unfinished)
                if fault == BLACK and self._lamp is None:
                    lamp = _add_lamp(self.scene)
                    _place_beside(lamp, camera)
                    self._render(unfinished)
                    bpy.data.lights.remove(lamp.data)
                    self._dark.append(view.name)
                    fault = picture_fault(unfinished)
                remove_words(unfinished)
            self._blank += [view.name] if fault else []
        except RuntimeError as error:
            raise UniSGError(f"Blender cannot render {path.name}: {str(error).strip()}; try another --engine") from None
        finally:
            for item in left_out:
                item.hide_render = False
            bpy.data.cameras.remove(camera.data)

    @property
    def note(self) -> str:
        """What is to be said of the pictures, "" for nothing."""
        notes = [self._unlit] if self._unlit else []
        if self._dark:
            notes.append(f"black by the scene's own light, and taken with a lamp: {', '.join(self._dark)}")
        if self._blank:
            notes.append(f"nothing is to be seen in {', '.join(self._blank)}")
        return "; ".join(notes)

    def _render(self, path: Path) -> None:
        self.scene.render.filepath = str(path)
        with captured_output():
            bpy.ops.render.render(write_still=True, scene=self.scene.name)

    def _set_up(self, engine: str, samples: int) -> None:
        render = self.scene.render
        _set_engine(render, engine)
        render.resolution_percentage, render.pixel_aspect_x, render.pixel_aspect_y = 100, 1.0, 1.0
        render.use_border = render.use_sequencer = render.use_compositing = render.use_motion_blur = False
        render.film_transparent = render.use_stamp = False
        if engine == "cycles":
            cycles = self.scene.cycles
            cycles.device, cycles.samples, cycles.seed = "CPU", samples, 0
            cycles.use_adaptive_sampling, cycles.use_denoising = False, True
        elif engine == "workbench":
            shading = self.scene.display.shading
            shading.light, shading.color_type, shading.show_cavity = "STUDIO", "MATERIAL", True
        settings = render.image_settings
        if hasattr(settings, "media_type"):  # from Blender 5.0 on
            settings.media_type = "IMAGE"
        settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "8"


def _set_engine(render: bpy.types.RenderSettings, name: str) -> None:
    """Choose an engine; UniSGError if this Blender has it not."""
    for identifier in ENGINES[name]:
        try:
            render.engine = identifier
        except TypeError:  # no such choice
            continue
        return
    raise UniSGError(f"this Blender has no render engine {name}: choose another --engine")


def _has_light(scene: bpy.types.Scene) -> bool:
    """Whether a scene has a lamp, a sky that shines, or a material that does."""
    lamps = any(item.type == "LIGHT" and not item.hide_render for item in scene.objects)
    return lamps or _brightness(scene.world) > DIM or any(_brightness(material) > 0 for material in bpy.data.materials)


def _brightness(owner: bpy.types.World | bpy.types.Material | None) -> float:
    """How bright the brightest node of a world or a material is; infinite where an image or other nodes say it."""
    if owner is None:
        return 0.0
    if isinstance(owner, bpy.types.World) and not owner.use_nodes:
        return max(owner.color)
    nodes = owner.node_tree.nodes if owner.use_nodes and owner.node_tree else ()
    return max(map(_strength, nodes), default=0.0)


def _strength(node: bpy.types.Node) -> float:
    """How bright a node shines: a background, an emission, a principled shader."""
    names = {"BACKGROUND": ("Strength", "Color"), "EMISSION": ("Strength", "Color")}
    names["BSDF_PRINCIPLED"] = ("Emission Strength", "Emission Color")
    if node.type not in names:
        return 0.0
    strength, color = (node.inputs.get(name) for name in names[node.type])
    if strength is None or color is None:
        return 0.0
    bright = np.inf if color.is_linked else max(list(color.default_value)[:3])
    power = np.inf if strength.is_linked else strength.default_value
    return float(bright * power) if bright and power else 0.0


def _place_beside(lamp: bpy.types.Object, camera: bpy.types.Object) -> None:
    lamp.matrix_world = camera.matrix_world @ mathutils.Matrix.Translation(BESIDE)


def _add_light(scene: bpy.types.Scene) -> bpy.types.Object:
    """Give a scene a sky; returns a lamp for beside the camera."""
    world = bpy.data.worlds.new("unisg sky")
    world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (1, 1, 1, 1)
    background.inputs["Strength"].default_value = SKY
    scene.world = world
    return _add_lamp(scene)


def _add_lamp(scene: bpy.types.Scene) -> bpy.types.Object:
    data = bpy.data.lights.new("unisg lamp", "POINT")
    data.energy, data.shadow_soft_size = LAMP, 0.3
    lamp = bpy.data.objects.new("unisg lamp", data)
    scene.collection.objects.link(lamp)
    return lamp
