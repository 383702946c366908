"""What a scenegraph cannot hold of objects, in words; what their data and scenes lose is told beside this module.

Whatever Blender lets a user set and no component holds is told by comparing it
with Blender's defaults, so that a setting nobody thought of is told as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import bpy

from ...runtime.read_report import ReadReport
from ..depsgraph import is_evaluated
from ..fcurves import curves_of
from ..helper_objects import HELPER, TYPE
from ..id_properties import addon_settings, property_names
from .changed_settings import changed_by_row, listed
from .of_object_data import data_losses, material_losses

NO_DATA = {
    "LATTICE": "a lattice keeps its place, not its points",
    "GREASEPENCIL": "strokes are not read",
    "GPENCIL": "strokes are not read",
    "CURVES": "hair curves are not read",
    "VOLUME": "the volume is not read",
    "SPEAKER": "the sound is not read",
    "LIGHT_PROBE": "the probe's settings are not read",
}
HELD = frozenset((
    "location", "rotation_mode", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale",
    "delta_location", "delta_rotation_euler", "delta_rotation_quaternion", "delta_scale", "matrix_world",
    "matrix_local", "matrix_basis", "matrix_parent_inverse", "dimensions", "parent_type", "parent_vertices",
    "use_parent_final_indices", "hide_viewport", "hide_render", "empty_display_type", "empty_display_size",
    "empty_image_offset", "instance_type", "track_axis", "up_axis", "visible_camera", "is_shadow_catcher",
    "active_material_index", "active_shape_key_index", "lock_rotations_4d",
))  # fmt: skip
TRANSFORMS = ("location", "rotation", "scale", "delta_")


def report_losses(
    objects: bpy.types.bpy_prop_collection,
    items: Sequence[bpy.types.Object],
    depsgraph: bpy.types.Depsgraph,
    evaluated: bool,
    instanced: bool,
    sampled: bool,
    report: ReadReport,
) -> None:
    """Note for every object what its entity cannot hold.

    Parameters
    ----------
    objects, items
        The same objects as Blender's collection and as a list.
    evaluated
        Whether meshes are read as modifiers leave them.
    instanced
        The objects are those of a prototype.
    sampled
        Whether the motion of the objects is read as well.
    """
    materials: dict[bpy.types.ID, list[str]] = {}
    data: dict[bpy.types.ID, list[str]] = {}
    settings = changed_by_row(objects, HELD)
    for row, item in enumerate(items):
        for text in (*_losses(item, depsgraph, evaluated, sampled), *_setting_losses(item, settings.get(row, []))):
            report.add(item.name, text)
        if instanced and (item.instance_type in ("VERTS", "FACES") or _makes_instances(item)):
            report.add(item.name, "instances that it may draw inside an instanced collection are not read")
        if item.data is not None:
            if item.data not in data:
                data[item.data] = list(data_losses(item, evaluated))
            for text in data[item.data]:
                report.add(item.name, text)
        for slot in item.material_slots:
            if slot.material is not None:
                if slot.material not in materials:
                    materials[slot.material] = list(material_losses(slot.material))
                for text in materials[slot.material]:
                    report.add(item.name, text)


def _makes_instances(item: bpy.types.Object) -> bool:
    return len(item.particle_systems) > 0 or any(modifier.type == "NODES" for modifier in item.modifiers)


def _losses(item: bpy.types.Object, depsgraph: bpy.types.Depsgraph, evaluated: bool, sampled: bool) -> Iterator[str]:
    kind = item.type
    if kind in NO_DATA:
        yield NO_DATA[kind]
    if kind in ("CURVE", "SURFACE", "FONT", "META"):
        yield "read as a mesh, not as a curve, surface, text or metaball" if evaluated else "its shape is not read"
    if kind == "EMPTY" and item.data is not None:
        yield "the image that it shows is not read"
    if item.library is not None:
        yield f"linked from {item.library.filepath}: kept as the object it is now"
    if item.override_library is not None:
        yield "a library override: kept as the object it is now"
    if len(item.constraints):
        yield "constraints: only their result is kept"
        if not is_evaluated(item, depsgraph):
            yield "constraints were not evaluated: the object is disabled or in an excluded collection"
    if len(item.modifiers):
        yield "modifiers: only their result is kept" if evaluated else "modifiers are not read"
    if item.animation_data is not None:
        yield from _animation_losses(item, sampled)
    if len(item.particle_systems):
        yield "particle systems: only their instances are kept"


def _setting_losses(item: bpy.types.Object, changed: list[str]) -> Iterator[str]:
    """Settings of the object itself; lights have some defaults of their own."""
    changed = list(changed)
    if item.type == "CAMERA" and item.display_type == "WIRE":  # as Blender's startup file has it: it shows no faces
        changed.remove("Display As")
    if item.type != "LIGHT":
        changed += ["Camera Visibility"] * (not item.visible_camera) + ["Shadow Catcher"] * item.is_shadow_catcher
    changed += ["Line Art"] * (item.lineart.usage != "INHERIT")
    changed += ["Shadow of Display"] * (not item.display.show_shadows)
    changed += ["Light Group"] * bool(item.lightgroup)
    linking = item.light_linking
    if linking is not None and (linking.receiver_collection is not None or linking.blocker_collection is not None):
        changed.append("Light Linking")
    yield from listed("settings that are not read", changed)
    field = item.field is not None and item.field.type != "NONE"
    collides = item.collision is not None and item.collision.use
    if field or collides or item.rigid_body_constraint or item.soft_body:
        yield "physics settings are not read"
    if item.asset_data is not None:
        yield "that it is an asset is not kept"
    yield from listed("settings of add-ons are not read", addon_settings(item))
    if any(_has_limits(item, key) for key in property_names(item) if key not in (HELPER, TYPE)):
        yield "custom properties: limits and descriptions are not read"


def _has_limits(item: bpy.types.Object, key: str) -> bool:
    """Whether a custom property has a range, a description or the like."""
    try:
        looks = item.id_properties_ui(key).as_dict()
    except TypeError:  # a kind of value that has none
        return False
    ends = (-(2**31), 2**31 - 1)
    free = not isinstance(looks.get("min"), int | float) or (
        looks["min"] <= ends[0] and looks["max"] >= ends[1] and looks["soft_min"] <= ends[0]
    )
    return not free or bool(looks.get("description")) or looks.get("subtype", "NONE") != "NONE"


def _animation_losses(item: bpy.types.Object, sampled: bool) -> Iterator[str]:
    found = item.animation_data
    if found.drivers:
        yield "drivers: only their result is kept"
    if len(found.nla_tracks):
        yield "NLA tracks: only their result is kept"
    paths = {curve.data_path for curve in curves_of(item) or ()}
    bones = {path for path in paths if path.startswith("pose.")}
    moves = {path for path in paths if path.startswith(TRANSFORMS)}
    if bones:
        yield "animation of bones: only the present pose is kept"
    if moves and not sampled:
        yield "animation: only the place at the present frame is kept"
    yield from listed("animation that is not read", sorted(paths - bones - moves))
