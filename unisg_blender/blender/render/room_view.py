"""A look into a room: without its ceiling, the roof and the walls in front, whatever meshes they are part of."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...scene.categories import STRUCTURE
from ...scene.properties import CATEGORY
from ..depsgraph import updated_depsgraph
from ..scene_units import metres_per_unit

BEFORE, STEPS = 4.0, 12
"""Metres before the room in which faces may hide it, and at how many places on the way of looking that is tested."""

EYE_HEIGHT, UNDER_CEILING = 2.6, 0.15
"""Metres of walls that are shown at most; and metres under the ceiling from which on faces are left out."""

WITH_WALLS = 1.06
"""How much larger than its outline a room is with its walls."""

AT_WALL, AROUND = 0.15, 0.5
"""Metres inside the outline up to which faces are those of a wall; and around it where things are shown."""

LOW, MUCH = 1.2, 0.25
"""Metres over the floor: a flat patch of a mesh that ends below that is no wall; and the share of one that hides a room
from which on it is left out as a whole."""

FROM_THE_RIGHT = (-0.55, 0.75, -0.75)
"""The way a camera looks from the front right corner, above."""

BUILDING = "Room"
"""What a building counts as: it is drawn in a pale colour."""

Points = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RoomView:
    """The room to look into: ``outline`` (K, 2) counter-clockwise, heights of ``floor`` and ``ceiling`` (inf for none),
    metres, the names of the objects that the ``building`` is made of, and the way ``toward`` (3,) that one looks."""

    outline: Points
    floor: float
    ceiling: float
    building: Collection[str]
    toward: tuple[float, float, float] = FROM_THE_RIGHT

    @property
    def points(self) -> Points:
        """What the picture has to show (2 K, 3)."""
        top = min(self.ceiling, self.floor + EYE_HEIGHT)
        return np.concatenate(
            [np.column_stack([self.outline, np.full(len(self.outline), z)]) for z in (self.floor, top)]
        )

    def beside(self, places: Points) -> tuple[Points, Points]:
        """How far places (N, 2) are outside of the nearest edge, negative inside, and the outward normal of that."""
        edge = np.roll(self.outline, -1, axis=0) - self.outline
        length = np.linalg.norm(edge, axis=1)
        offset = places[:, None] - self.outline
        share = ((offset * edge).sum(axis=2) / length**2).clip(0, 1)
        way = offset - share[..., None] * edge
        nearest = np.linalg.norm(way, axis=2).argmin(axis=1)
        normal = np.stack([edge[:, 1], -edge[:, 0]], axis=1)[nearest] / length[nearest, None]
        return (way[np.arange(len(places)), nearest] * normal).sum(axis=1), normal

    def hides(self, middles: Points, toward: Points) -> NDArray[np.bool_]:
        """Which faces with middles (N, 3) hide the room from a camera that looks along ``toward`` (3,).

        Those behind which, on the way of looking, is the room; and what is above its ceiling.
        """
        found = middles[:, 2] > self.ceiling - UNDER_CEILING
        low, high = self.outline.min(axis=0) - BEFORE, self.outline.max(axis=0) + BEFORE
        near = ((middles[:, :2] > low) & (middles[:, :2] < high)).all(axis=1) & (middles[:, 2] > self.floor + 0.02)
        near &= ~found
        near[near] = self.beside(middles[near, :2])[0] > -AT_WALL
        top = min(self.ceiling, self.floor + EYE_HEIGHT)
        for step in np.linspace(2 * AT_WALL, BEFORE, STEPS):
            behind = middles[near] + step * toward / np.linalg.norm(toward)
            within = (self.beside(behind[:, :2])[0] < 0) & (behind[:, 2] > self.floor) & (behind[:, 2] < top)
            found[np.flatnonzero(near)[within]] = True
        return found


@contextmanager
def opened(
    scene: bpy.types.Scene, items: Sequence[bpy.types.Object], room: RoomView, toward: Sequence[float]
) -> Iterator[list[bpy.types.Object]]:
    """Those objects of a scene that are in a room or near it, its building as copies without the faces that hide it."""
    _, depsgraph = updated_depsgraph(scene)
    metres = metres_per_unit(scene)
    shown: list[bpy.types.Object] = []
    copies: list[bpy.types.Object] = []
    try:
        for item in items:
            world = np.array(item.matrix_world)
            corners = np.array(item.bound_box) @ world[:3, :3].T + world[:3, 3]
            middle = (corners.min(axis=0) + corners.max(axis=0)) / 2 * metres
            at_wall = (room.beside(corners[:, :2] * metres)[0] > -AT_WALL).any()
            if item.type == "MESH" and (item.name in room.building or (at_wall and _may_be_building(item))):
                copies.append(_without_hiding(item.evaluated_get(depsgraph), room, np.array(toward), metres))
                shown.append(copies[-1])
            elif room.beside(middle[None, :2])[0][0] <= AROUND and room.floor - AROUND < middle[2] < room.ceiling:
                shown.append(item)
        yield shown
    finally:
        for copy in copies:
            mesh = copy.data
            bpy.data.objects.remove(copy)
            bpy.data.meshes.remove(mesh)


def _may_be_building(item: bpy.types.Object) -> bool:
    """Has nobody said that an object is anything but building? What is new says so."""
    return item.get(CATEGORY, "") in ("", *STRUCTURE)


def _without_hiding(item: bpy.types.Object, room: RoomView, toward: Points, metres: float) -> bpy.types.Object:
    import bmesh

    mesh = bpy.data.meshes.new_from_object(item)
    world = np.array(item.matrix_world)
    work = bmesh.new()
    work.from_mesh(mesh)
    work.faces.ensure_lookup_table()
    middles = np.array([face.calc_center_median() for face in work.faces]).reshape(-1, 3)
    hiding = room.hides((middles @ world[:3, :3].T + world[:3, 3]) * metres, toward)
    places = np.array([vertex.co for vertex in work.verts]).reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]
    hiding = _whole_patches(mesh, places * metres, hiding, room.floor + LOW)
    bmesh.ops.delete(work, geom=[work.faces[int(face)] for face in np.flatnonzero(hiding)], context="FACES")
    work.to_mesh(mesh)
    work.free()
    copy = bpy.data.objects.new("unisg picture", mesh)
    copy.matrix_world = item.matrix_world.copy()
    copy[CATEGORY] = BUILDING
    return copy


def _whole_patches(mesh: bpy.types.Mesh, points: Points, hiding: NDArray[np.bool_], low: float) -> NDArray[np.bool_]:
    """Which faces (F,) are left out where flat patches of them are left out whole, where much of one hides.

    So no half of a wall stays; and nothing goes that ends below the height ``low``: furniture that is of one mesh with
    its room. ``points`` (V, 3) are those of the mesh; in the very same place they are one: importers split them.
    """
    if not hiding.any():
        return hiding
    patch, corner, face = _flat_patches(mesh, points)
    area = np.empty(len(patch), np.float32)
    mesh.polygons.foreach_get("area", area)
    much = np.bincount(patch, area * hiding) > np.bincount(patch, area) * MUCH
    top = np.full(len(much), -np.inf)
    np.maximum.at(top, patch[face], points[corner, 2])
    return np.asarray((much & (top > low))[patch])


def _flat_patches(mesh: bpy.types.Mesh, points: Points) -> tuple[NDArray[np.integer], ...]:
    """The patch (F,) that each face is in with those beside it of the same normal; point and face of each corner."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(mesh.polygons)
    corner, sides = np.empty(len(mesh.loops), np.int32), np.empty(count, np.int32)
    normal = np.empty((count, 3), np.float32)
    mesh.loops.foreach_get("vertex_index", corner)
    mesh.polygons.foreach_get("loop_total", sides)
    mesh.polygons.foreach_get("normal", normal.reshape(-1))
    face = np.repeat(np.arange(count), sides)
    met = np.column_stack([points[corner].round(4), normal[face].round(2) + 0.0])
    knot = np.unique(met, axis=0, return_inverse=True)[1].reshape(-1)
    size = count + int(knot.max(initial=-1)) + 1
    links = coo_array((np.ones(len(face), bool), (face, count + knot)), shape=(size, size))
    _, patch = connected_components(links, directed=False)
    return np.unique(patch[:count], return_inverse=True)[1].reshape(-1), corner, face
