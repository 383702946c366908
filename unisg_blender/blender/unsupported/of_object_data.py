"""What a scenegraph cannot hold of object data and materials, in words.

Settings of editing tools that meshes carry (remeshing, mirroring, masks) are no
part of a scene and are not told.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..id_properties import addon_settings, property_names
from ..materials import PLAIN_NODES, surface_inputs
from .changed_settings import changed_by_row, changed_settings, listed

HELD = {
    "CAMERA": frozenset((
        "type", "lens", "lens_unit", "angle", "angle_x", "angle_y", "sensor_fit", "sensor_width", "sensor_height",
        "ortho_scale", "clip_start", "clip_end", "shift_x", "shift_y", "use_dof", "focus_distance", "aperture_fstop",
        "fisheye_polynomial_k0", "fisheye_polynomial_k1", "fisheye_polynomial_k2", "fisheye_polynomial_k3",
        "fisheye_polynomial_k4",
    )),
    "LIGHT": frozenset((
        "type", "color", "energy", "shadow_soft_size", "shape", "size", "size_y", "angle", "spot_size", "spot_blend",
        "use_shadow", "diffuse_factor", "specular_factor", "spread", "exposure", "normalize", "use_temperature",
        "temperature",
    )),
    "ARMATURE": frozenset(("pose_position",)),
    "POINTCLOUD": frozenset(),
}  # fmt: skip
HELD_BONE = frozenset((
    "use_connect", "use_deform", "use_relative_parent", "select", "select_head", "select_tail",
))  # fmt: skip
HELD_POSE = frozenset((
    "location", "scale", "rotation_quaternion", "rotation_axis_angle", "rotation_euler", "rotation_mode", "matrix",
    "matrix_basis", "head", "tail", "select",
))  # fmt: skip
HELD_ATTRIBUTES = frozenset(("position", "material_index", "sharp_face", "custom_normal"))


def data_losses(item: bpy.types.Object, evaluated: bool) -> Iterator[str]:
    """What is lost of an object's data, whose users share it."""
    data = item.data
    held = HELD.get(item.type)
    if held is not None:
        yield from listed("settings of its data that are not read", changed_settings(data, held))
    yield from listed("settings of add-ons in its data are not read", addon_settings(data))
    yield from listed("custom properties of its data are not read", property_names(data))
    moved = getattr(data, "animation_data", None)
    if moved is not None and (moved.action or moved.drivers or len(moved.nla_tracks)):
        yield "animation and drivers of its data: only their present result is kept"
    if item.type in _KINDS:
        yield from _KINDS[item.type](item, evaluated)


def _camera_losses(item: bpy.types.Object, evaluated: bool) -> Iterator[str]:
    if len(item.data.background_images):
        yield "background images are not read"
    if item.data.dof.focus_object is not None:
        yield "the object in focus is not kept, only the focus distance"


def _light_losses(item: bpy.types.Object, evaluated: bool) -> Iterator[str]:
    tree = item.data.node_tree
    if tree is not None and item.data.use_nodes and any(node.type not in _LIGHT_NODES for node in tree.nodes):
        yield "light nodes are not read"


_LIGHT_NODES = {"EMISSION", "OUTPUT_LIGHT", "FRAME", "REROUTE"}


def _mesh_losses(item: bpy.types.Object, evaluated: bool) -> Iterator[str]:
    if not item.data.use_auto_texspace:
        yield "its own texture space is not read"
    if item.data.shape_keys is not None:
        yield "shape keys: only their present result is kept" if evaluated else "shape keys are not read"
    if len(item.vertex_groups):
        yield "vertex groups are not read"
    if len(item.data.color_attributes):
        yield "vertex colours are not read"
    colours = {layer.name for layer in item.data.color_attributes}
    known = HELD_ATTRIBUTES | colours | {layer.name for layer in item.data.uv_layers}
    names = [layer.name for layer in item.data.attributes if layer.name not in known and layer.name[0] != "."]
    if "sharp_edge" in names:
        names.remove("sharp_edge")
        yield "sharp edges: only the normals that they make are kept"
    yield from listed("mesh attributes that are not read", names)


def _point_losses(item: bpy.types.Object, evaluated: bool) -> Iterator[str]:
    names = [layer.name for layer in item.data.attributes if layer.name != "position" and layer.name[0] != "."]
    yield from listed("attributes of points that are not read", names)


def _armature_losses(item: bpy.types.Object, evaluated: bool) -> Iterator[str]:
    if item.pose is None:
        return
    bones = item.pose.bones
    if any(len(bone.constraints) for bone in bones):
        yield "constraints of bones: only their result is kept"
    if any(bone.custom_shape is not None for bone in bones):
        yield "custom shapes of bones are not read"
    if len(item.data.collections_all if hasattr(item.data, "collections_all") else item.data.collections):
        yield "bone collections are not read"
    changed: dict[str, None] = {}
    for found in (changed_by_row(item.data.bones, HELD_BONE), changed_by_row(bones, HELD_POSE)):
        changed |= dict.fromkeys(label for labels in found.values() for label in labels)
    yield from listed("settings of bones that are not read", list(changed))
    if any(property_names(bone) for part in (item.data.bones, bones) for bone in part):
        yield "custom properties of bones are not read"


_KINDS = {
    "CAMERA": _camera_losses,
    "LIGHT": _light_losses,
    "MESH": _mesh_losses,
    "POINTCLOUD": _point_losses,
    "ARMATURE": _armature_losses,
}


def material_losses(material: bpy.types.Material) -> Iterator[str]:
    """What is lost of a material that an object has."""
    tree = material.node_tree
    nodes = [] if tree is None else list(tree.nodes)
    if any(node.type not in PLAIN_NODES for node in nodes):
        yield "materials keep one colour: textures and shader nodes are not read"
    yield from listed("surface properties of materials that are not read", surface_inputs(material))
    held = ("diffuse_color", "metallic", "roughness", "active_texture_index", "grease_pencil", "texture_paint_images")
    yield from listed("settings of materials that are not read", changed_settings(material, held, inner=False))
    animated = (material.animation_data, None if tree is None else tree.animation_data)
    if any(found is not None and (found.action or found.drivers) for found in animated):
        yield "animation of materials: only its present result is kept"
    if property_names(material) or addon_settings(material):
        yield "custom properties of materials are not read"
