"""Rigid bodies of objects, both ways: the component ``rigid_bodies`` and Blender's rigid body world."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import bpy

from ..scene.component_table import Table, table
from ..scene.components import RIGID_BODIES
from ..scene.graph import SceneGraph

SHAPES = {
    "BOX": "box", "CONVEX_HULL": "hull", "MESH": "mesh", "SPHERE": "sphere", "CAPSULE": "capsule",
    "CYLINDER": "cylinder", "CONE": "cone", "COMPOUND": "hull",
}  # fmt: skip
BLENDER_SHAPES = {name: shape for shape, name in reversed(SHAPES.items())}
COLLECTION = "RigidBodyWorld"


def rigid_body_table(items: Sequence[bpy.types.Object]) -> Table:
    """What Blender's rigid body world takes objects for; an animated body is passive, it is moved by its keys."""
    rows = [row for row, item in enumerate(items) if item.rigid_body is not None]
    bodies = [items[row].rigid_body for row in rows]
    return table(
        rows,
        kind=["active" if body.type == "ACTIVE" and not body.kinematic else "passive" for body in bodies],
        shape=[SHAPES.get(body.collision_shape, "mesh") for body in bodies],
        **{name: _numbers(bodies, name) for name in ("mass", "friction", "restitution")},
    )


def _numbers(bodies: Sequence[bpy.types.RigidBodyObject], name: str) -> list[float]:
    return [float(getattr(body, name)) for body in bodies]


def set_rigid_bodies(graph: SceneGraph, objects: Mapping[int, bpy.types.Object], scene: bpy.types.Scene) -> None:
    """Make objects, by row, bodies of the scene's rigid body world, which is made if there is none."""
    found = graph.components.get(RIGID_BODIES)
    columns = () if found is None else tuple(found.columns)
    mine = [entry for entry in graph.entries(RIGID_BODIES, *columns) if entry[0] in objects]
    if not mine:
        return
    if scene.rigidbody_world is None:
        with bpy.context.temp_override(scene=scene):
            bpy.ops.rigidbody.world_add()
    world = scene.rigidbody_world
    if world.collection is None:
        world.collection = bpy.data.collections.new(COLLECTION)
    for row, *values in mine:
        entry, item = dict(zip(columns, values, strict=True)), objects[row]
        if item.type != "MESH":
            continue
        world.collection.objects.link(item)
        body = item.rigid_body
        body.type, body.collision_shape = str(entry["kind"]).upper(), BLENDER_SHAPES.get(str(entry["shape"]), "MESH")
        body.mass = max(float(entry["mass"]), 0.001)
        body.friction, body.restitution = float(entry["friction"]), float(entry["restitution"])
