"""What a scenegraph cannot hold of an object, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import bpy

from .hierarchy import is_evaluated
from .materials import is_textured
from .report import ReadReport

NO_DATA = {
    "LATTICE": "a lattice keeps its place, not its points",
    "GREASEPENCIL": "strokes are not read",
    "GPENCIL": "strokes are not read",
    "CURVES": "hair curves are not read",
    "VOLUME": "the volume is not read",
    "SPEAKER": "the sound is not read",
    "LIGHT_PROBE": "the probe's settings are not read",
}


def report_losses(
    items: Sequence[bpy.types.Object],
    depsgraph: bpy.types.Depsgraph,
    evaluated: bool,
    instanced: bool,
    report: ReadReport,
) -> None:
    """Note for every object what its entity cannot hold; ``instanced``: the objects are those of a prototype."""
    materials: dict[bpy.types.ID, bool] = {}
    for item in items:
        for text in _losses(item, depsgraph, evaluated):
            report.add(item.name, text)
        if instanced and (item.instance_type in ("VERTS", "FACES") or _makes_instances(item)):
            report.add(item.name, "instances that it may draw inside an instanced collection are not read")
        for slot in item.material_slots:
            if slot.material is not None:
                if slot.material not in materials:
                    materials[slot.material] = is_textured(slot.material)
                if materials[slot.material]:
                    report.add(item.name, "materials keep one colour: textures and shader nodes are not read")


def _makes_instances(item: bpy.types.Object) -> bool:
    return len(item.particle_systems) > 0 or any(modifier.type == "NODES" for modifier in item.modifiers)


def _losses(item: bpy.types.Object, depsgraph: bpy.types.Depsgraph, evaluated: bool) -> Iterator[str]:
    kind = item.type
    if kind in NO_DATA:
        yield NO_DATA[kind]
    if kind in ("CURVE", "SURFACE", "FONT", "META"):
        yield "read as a mesh, not as a curve, surface, text or metaball" if evaluated else "its shape is not read"
    if item.library is not None:
        yield f"linked from {item.library.filepath}: kept as the object it is now"
    if len(item.constraints):
        yield "constraints: only their result is kept"
        if not is_evaluated(item, depsgraph):
            yield "constraints were not evaluated: the object is disabled or in an excluded collection"
    if len(item.modifiers):
        yield "modifiers: only their result is kept" if evaluated else "modifiers are not read"
    if kind == "MESH":
        yield from _mesh_losses(item, evaluated)
    if item.animation_data is not None and item.animation_data.drivers:
        yield "drivers: only their present result is kept"
    if item.rigid_body is not None or item.soft_body is not None:
        yield "physics settings are not read"
    if len(item.particle_systems):
        yield "particle systems: only their instances are kept"


def _mesh_losses(item: bpy.types.Object, evaluated: bool) -> Iterator[str]:
    if item.data.shape_keys is not None:
        yield "shape keys: only their present result is kept" if evaluated else "shape keys are not read"
    if len(item.vertex_groups):
        yield "vertex groups are not read"
    if len(item.data.color_attributes):
        yield "vertex colours are not read"
