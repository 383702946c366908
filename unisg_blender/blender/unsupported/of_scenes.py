"""What a scenegraph cannot hold of a scene as a whole, in words."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ...runtime.read_report import ReadReport
from ..id_properties import property_names
from .changed_settings import SAME, changed_settings, listed

HELD = frozenset((
    "camera", "frame_current", "frame_float", "frame_subframe", "frame_start", "frame_end", "fps", "fps_base",
    "threads", "world", "cursor",
))  # fmt: skip
GROUPS = {"render": "render", "view_settings": "colour management"}
GREY, PLAIN_NODES = 0.05087609, {"BACKGROUND", "OUTPUT_WORLD"}
"""Each channel of the world that every new file has, and the nodes of it."""

UNREAD_VIEWS = ("white_balance_whitepoint", "curve_mapping")


def report_scene_losses(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer, report: ReadReport) -> None:
    """Note what is lost of world, rendering, view layers, collections and the like."""
    for text in _scene_texts(scene, view_layer):
        report.add("", text)
    _report_collections(view_layer.layer_collection, report)


def _scene_texts(scene: bpy.types.Scene, view_layer: bpy.types.ViewLayer) -> Iterator[str]:
    if scene.world is not None and not _is_plain(scene.world):
        yield f"the world {scene.world.name!r} is not read"
    if getattr(scene, "compositing_node_group", None) or getattr(scene, "node_tree", None):
        yield "compositing nodes are not read"
    if len(scene.view_layers) > 1:
        others = ", ".join(repr(layer.name) for layer in scene.view_layers if layer != view_layer)
        yield f"only the view layer {view_layer.name!r} is read, not {others}"
    sequence = scene.sequence_editor
    if sequence is not None and len(sequence.strips_all if hasattr(sequence, "strips_all") else sequence.sequences_all):
        yield "the video sequence is not read"
    if len(scene.timeline_markers):
        yield "timeline markers are not read"
    if scene.rigidbody_world is not None:
        yield "settings of the rigid body world are not read"
    if len(scene.keying_sets):
        yield "keying sets are not read"
    yield from listed("custom properties of the scene are not read", property_names(scene))
    yield from listed("scene settings that are not read", changed_settings(scene, HELD, inner=False))
    for name, word in GROUPS.items():
        changed = changed_settings(getattr(scene, name), HELD.union(UNREAD_VIEWS), inner=False)
        yield from listed(f"{word} settings that are not read", changed)
    if scene.animation_data is not None and (scene.animation_data.action or scene.animation_data.drivers):
        yield "animation of the scene's settings is not read"
    if len(bpy.data.texts):
        yield "text blocks are not read"


def _is_plain(world: bpy.types.World) -> bool:
    """Whether a world is the grey one that Blender's startup file has: nobody has made it."""
    shades = [world.color]
    if world.use_nodes and world.node_tree is not None:
        if not {node.type for node in world.node_tree.nodes} <= PLAIN_NODES:
            return False
        lights = [node.inputs for node in world.node_tree.nodes if node.type == "BACKGROUND"]
        if any(inputs["Color"].is_linked or abs(inputs["Strength"].default_value - 1) > SAME for inputs in lights):
            return False
        shades += [inputs["Color"].default_value for inputs in lights]
    return all(abs(value - GREY) < SAME for shade in shades for value in shade[:3])


def _report_collections(top: bpy.types.LayerCollection, report: ReadReport) -> None:
    """Collections keep their names, what is in them, and the offset of their instances."""
    stack = list(top.children)
    while stack:
        layer = stack.pop()
        stack += layer.children
        collection = layer.collection
        found = [
            *(["excluded"] if layer.exclude else []),
            *(["hidden"] if layer.hide_viewport else []),
            *changed_settings(layer, ("exclude", "hide_viewport", "collection"), inner=False),
            *changed_settings(collection, ("instance_offset", "active_exporter_index"), inner=False),
        ]
        for text in listed("settings of the collection that are not read", found):
            report.add(collection.name, text)
        if property_names(collection):
            report.add(collection.name, "custom properties of the collection are not read")
