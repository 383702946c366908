"""Parents and matrices of many Blender objects at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...scene.parents import compose_world, reachable
from ..depsgraph import is_evaluated
from ..trs import differ

STEP = 2e-6  # rounding that one product of Blender's float32 matrices may leave, relative
CHAIN = 5e-6  # ... and a whole chain of them
WITH_VERTICES = frozenset(("MESH", "CURVE", "SURFACE", "LATTICE"))
HAVE_PART = {4: frozenset(("ARMATURE", "LATTICE")), 5: WITH_VERTICES, 6: WITH_VERTICES, 7: frozenset(("ARMATURE",))}
"""Types of parents that have the part which a kind of parenting names: deformation, vertex, three vertices, bone.

With others, objects hang on the parent as a whole: Blender keeps the kind when the parent is exchanged.
"""


@dataclass(frozen=True)
class Hierarchy:
    """Who hangs on whom, and where.

    ``parent`` int32 (N,); ``local`` float64 (N, 4, 4); ``special`` rows that hang
    on a bone, on vertices or the like, with the frame of that part in its object
    (``frames``); ``moved`` rows whose evaluated world matrix, ``world`` float64
    (K, 4, 4), is not what the locals say; ``broken`` rows that stand nowhere and whose locals
    were replaced by the identity.
    """

    parent: NDArray[np.int32]
    local: NDArray[np.float64]
    special: NDArray[np.int64]
    frames: dict[int, NDArray[np.float64]]
    moved: NDArray[np.int64]
    world: NDArray[np.float64]
    broken: NDArray[np.int64]


def read_hierarchy(
    objects: bpy.types.bpy_prop_collection,
    items: Sequence[bpy.types.Object],
    depsgraph: bpy.types.Depsgraph,
) -> Hierarchy:
    """Hierarchy of all objects of a collection property.

    Parameters
    ----------
    objects, items
        The same objects as Blender's collection and as a list.
    depsgraph
        Where evaluated matrices come from; the objects' own ``matrix_world`` is not
        kept up to date in every scene.
    """
    rows: dict[bpy.types.Object | None, int] = {item: row for row, item in enumerate(items)}
    rows[None] = -1
    above = [item.parent for item in items]
    parent = np.array([rows.get(item, -1) for item in above], np.int32).reshape(len(items))
    hangs = np.array([item is not None for item in above], bool)
    local = read_matrices(objects, "matrix_basis", len(items))
    terms = np.abs(local)  # what the products sum up: their roundings are relative to this
    if hangs.any():  # the parent inverse of an object without a parent has no effect
        inverse = read_matrices(objects, "matrix_parent_inverse", len(items))[hangs]
        local[hangs], terms[hangs] = inverse @ local[hangs], np.abs(inverse) @ terms[hangs]
    kind = np.empty(len(items), np.int32)
    objects.foreach_get("parent_type", kind)
    special = np.array(
        [row for row in np.flatnonzero((kind != 0) & hangs) if above[row].type in HAVE_PART.get(int(kind[row]), ())],
        np.int64,
    )
    world, evaluated = _worlds(items, rows, depsgraph)
    frames = {int(row): frame_of_parent(items[row], depsgraph) for row in special}
    for row, frame in frames.items():
        local[row], terms[row] = frame @ local[row], np.abs(frame) @ terms[row]
    for row in np.flatnonzero((parent < 0) & hangs):  # the parent is not among the objects: stand where it stands
        frame = chain_matrix(above[row], depsgraph)
        local[row], terms[row] = frame @ local[row], np.abs(frame) @ terms[row]
    local, broken = reachable(local, parent)
    sound = evaluated & np.isfinite(world).all(axis=(1, 2))
    world[~sound] = 0
    moved = np.flatnonzero(_moved(parent, local, world, terms) & sound)
    return Hierarchy(parent, local, special, frames, moved, world[moved], broken)


def frame_of_parent(item: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> NDArray[np.float64]:
    """What stands between the parent's matrix and the parent inverse: float64 (4, 4); the identity for most."""
    kind = item.parent_type
    if kind == "BONE":
        pose = item.parent.evaluated_get(depsgraph).pose
        bone = pose.bones.get(item.parent_bone) if pose else None
        if bone is None:
            return np.eye(4)
        if bone.bone.use_relative_parent:
            return np.array(bone.matrix_channel, np.float64)
        matrix = np.array(bone.matrix, np.float64)
        matrix[:3, 3] += matrix[:3, 1] * bone.bone.length  # children hang at the bone's tail
        return matrix
    if kind in ("VERTEX", "VERTEX_3"):
        inner = np.array(item.matrix_parent_inverse, np.float64) @ np.array(item.matrix_basis, np.float64)
        world = np.array(item.evaluated_get(depsgraph).matrix_world, np.float64)
        above = np.array(item.parent.evaluated_get(depsgraph).matrix_world, np.float64)
        if min(abs(np.linalg.det(above)), abs(np.linalg.det(inner))) > 1e-12 and not item.constraints:
            return np.linalg.inv(above) @ world @ np.linalg.inv(inner)
    return np.eye(4)


def chain_matrix(item: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> NDArray[np.float64]:
    """World matrix of one object, evaluated where Blender evaluates it, else composed up its parents."""
    if is_evaluated(item, depsgraph):
        return np.array(item.evaluated_get(depsgraph).matrix_world, np.float64)
    basis = np.array(item.matrix_basis, np.float64)
    if item.parent is None:
        return basis
    local = frame_of_parent(item, depsgraph) @ np.array(item.matrix_parent_inverse, np.float64) @ basis
    return chain_matrix(item.parent, depsgraph) @ local


def read_matrices(objects: bpy.types.bpy_prop_collection, name: str, count: int) -> NDArray[np.float64]:
    """A matrix property of all objects, float64 (N, 4, 4)."""
    buffer = np.empty(16 * count, np.float32)
    objects.foreach_get(name, buffer)
    return buffer.reshape(-1, 4, 4).transpose(0, 2, 1).astype(np.float64)  # Blender's buffers are column-major


def _worlds(
    items: Sequence[bpy.types.Object], rows: Mapping[bpy.types.Object | None, int], depsgraph: bpy.types.Depsgraph
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Evaluated world matrices float64 (N, 4, 4), and bool (N,): False where Blender evaluates none."""
    world, evaluated = np.zeros((len(items), 4, 4)), np.zeros(len(items), bool)
    seen = np.array([rows.get(found.original, -1) for found in depsgraph.objects], np.int64)
    matrices = read_matrices(depsgraph.objects, "matrix_world", len(seen))
    world[seen[seen >= 0]], evaluated[seen[seen >= 0]] = matrices[seen >= 0], True
    for row in np.flatnonzero(~evaluated):  # hidden, or only in an instanced collection
        found = items[row].evaluated_get(depsgraph)
        if found.is_evaluated:
            world[row], evaluated[row] = np.array(found.matrix_world), True
    return world, evaluated


def _moved(
    parent: NDArray[np.int32], local: NDArray[np.float64], world: NDArray[np.float64], terms: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """bool (N,): rows that do not stand where parent and ``local`` put them, and rows where small roundings add up."""
    if not len(parent):
        return np.zeros(0, bool)
    above = np.where((parent >= 0)[:, None, None], world[parent], np.eye(4))
    terms = np.abs(above) @ terms
    moved = differ(above @ local, world, STEP, terms)
    fixed, root = np.where(moved[:, None, None], world, local), np.where(moved, -1, parent)
    return moved | differ(compose_world(fixed, root), world, CHAIN, terms)
