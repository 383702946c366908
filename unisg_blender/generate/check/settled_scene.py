"""Settle objects that a scene has already; what does not hold where it came to rest stays where it was, and is told."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from ...geometry.arrays import Floats
from ...scene import SceneGraph, placed
from ...spatial.structure.room_objects import room_objects
from ..place.instanced_scene import with_instances
from ..place.settle_existing import Settled, resting_places
from .mesh_check import BLOCKING, CUTTING, OUTSIDE, faults


def settle_rows(graph: SceneGraph, rows: Iterable[int]) -> list[Settled]:
    """Where the objects at some rows come to stand, each moved as little as need be; nothing else is moved.

    An object is put on the highest surface below its middle, or held as it is held by what it is
    parented to if it hangs there or is fixed to its side. Objects that stand on others come after
    them. What finds no free place, or none that holds by :func:`~.mesh_check.faults`, stays where it is, with a note;
    who was outside, or in the way, may stay there. Structure is left alone.
    """
    shown = with_instances(graph)
    if shown is not graph:
        found = settle_rows(shown, [shown.row_of_uid[graph.uid[row]] for row in rows])
        return [replace(item, row=graph.row_of_uid[shown.uid[item.row]]) for item in found]
    found = _in_their_rooms(graph, list(rows))
    moved = [item for item in found if not item.note]
    uids = [graph.uid[item.row] for item in moved]
    holders = {graph.uid[item.row]: item.holder for item in moved if item.holder >= 0}
    said = faults(_with(graph, moved), graph, uids, holders) if moved else {}
    allowed = [uid for uid, reason in said.items() if reason in (OUTSIDE, BLOCKING, CUTTING)]
    was = faults(graph, graph, allowed, holders) if allowed else {}
    said = {uid: reason for uid, reason in said.items() if uid not in allowed or was.get(uid) != reason}
    return [
        replace(item, world=graph.world[item.row], note=said[graph.uid[item.row]])
        if graph.uid[item.row] in said else item
        for item in found
    ]  # fmt: skip


def _in_their_rooms(graph: SceneGraph, rows: list[int]) -> list[Settled]:
    """Each object in the recognised room that it is in, or out of doors; where categories tell the room, all in it."""
    structure = room_objects(graph, graph.vocabulary).structure
    if structure is None:
        return resting_places(graph, rows)
    points = {row: _middle(graph, row) for row in rows}
    room_of = {row: structure.room_at(point) for row, point in points.items()}
    found = []
    for number in sorted(set(room_of.values())):
        mine = [row for row in rows if room_of[row] == number]
        found += resting_places(graph, mine, points[mine[0]], outdoors=number < 0)
    return found


def _middle(graph: SceneGraph, row: int) -> Floats:
    """The middle (3,) of an entity's points in the world, or its origin."""
    mesh = graph.meshes[graph.mesh[row]] if graph.mesh[row] >= 0 else None
    world = graph.world[row]
    if mesh is None or not len(mesh.points):
        return np.asarray(world[:3, 3])
    points = mesh.points.astype(np.float64) @ world[:3, :3].T + world[:3, 3]
    return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)


def settle(graph: SceneGraph, rows: Iterable[int]) -> SceneGraph:
    """The scenegraph with the objects at some rows settled as :func:`settle_rows` says: a system of the scenegraph."""
    return _with(graph, [each for each in settle_rows(graph, rows) if not each.note])


def _with(graph: SceneGraph, found: list[Settled]) -> SceneGraph:
    """The scenegraph with objects where they came to stand."""
    if not found:
        return graph
    return placed(graph, [each.row for each in found], np.array([each.world for each in found]))
