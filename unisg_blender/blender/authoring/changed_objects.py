"""Bring the objects of an open scene to a state of its scenegraph in which some are gone and others stand elsewhere."""

from __future__ import annotations

from collections.abc import Collection

import bpy
import mathutils

from ...scene import components
from ...scene.graph import SceneGraph
from ...scene.properties import RELATIONS, relations_of
from ...scene.relation import relations_to_json
from ..lookup import objects_by_uid
from ..scene_units import metres_per_unit, scale_translations
from .stored_behaviour import actions_of, lesson_of, store_actions, store_lesson


def remove_objects(uids: Collection[str], scene: bpy.types.Scene) -> None:
    """Remove objects; what hung under one of them and stays, stays where it is."""
    items = objects_by_uid(scene)
    gone = [items[uid] for uid in uids if uid in items]
    for item in gone:
        for child in item.children:
            if child not in gone:
                world = child.matrix_world.copy()
                child.parent = None
                child.matrix_world = world
    for item in gone:
        bpy.data.objects.remove(item)


def move_objects(graph: SceneGraph, uids: Collection[str], scene: bpy.types.Scene) -> None:
    """Put objects where a scenegraph has them."""
    items, units = objects_by_uid(scene), 1.0 / metres_per_unit(scene)
    for row in sorted(graph.row_of_uid[uid] for uid in uids):  # parents come first
        item = items.get(graph.uid[row])
        if item is not None:
            item.matrix_world = mathutils.Matrix(scale_translations(graph.world[row], units).tolist())
            bpy.context.view_layer.update()


def bring_behaviour(graph: SceneGraph, new: Collection[int], scene: bpy.types.Scene) -> None:
    """Bring actions and relations of the scene's objects to the state of the scenegraph, and take away lessons that it
    has not; its ``new`` rows are not written yet.

    Raises
    ------
    UniSGError
        If they belong to an object that may not be changed.
    """
    for uid, item in objects_by_uid(scene).items():
        row = graph.row_of_uid.get(uid, -1)
        if row in new or row < 0:
            continue
        actions = tuple(action for _, action in graph.entries(components.ACTIONS, "data", row=row))
        if actions_of(item) != actions:
            store_actions(item, actions)
        if lesson_of(item) is not None and not graph.entries(components.LSA, row=row):
            store_lesson(item, None)
        if RELATIONS in item:
            item[RELATIONS] = relations_to_json(relations_of(graph, row))
