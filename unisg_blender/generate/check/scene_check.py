"""Does what a scene has hold: each thing's state in words, with how deep and how high, judged by triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.boxes import orthonormal_axes
from ...geometry.corner_ends import corner_ends
from ...geometry.triangle_crossings import crossings
from ...scene import SceneGraph
from ...scene.categories import STRUCTURE, has_category
from ...scene.component_table import table
from ...scene.components import RELATIONS
from ...scene.hierarchy import subtree, world_matrices
from ...spatial.object_rows import find_objects, object_rows
from ...spatial.objects import SceneObjects, scene_objects
from ...spatial.structure import recognise_structure
from ...spatial.structure.scan import world_triangles
from ...words import thing_table, understand
from .mesh_check import ASIDE, BUILT, DEEPEST, FLOATING, HELD, MOUNTED, OUTSIDE, faults, meets, smaller

COLLIDES, FLOATS, IS_OUTSIDE, BLOCKS = "collides", "floats", "outside", "blocks"
STATES = (COLLIDES, FLOATS, BLOCKS, IS_OUTSIDE)
"""What may be wrong, in the order in which it is told."""

WOULD_BLOCK, WOULD_BE_IN = "it would block", "it would be in "
"""How the last check's reasons begin that something is in the way, or within something."""

FARTHEST, DEEP = 5.0, 0.3
"""Metres below a thing in which what is under it is looked for, and to which the depth of a collision is measured."""

HANGING = frozenset(("Ceiling Lamp", "Surgical Lamp", "Curtain", "Chandelier"))
"""What is fine without anything below it in a room without a ceiling, from which it would hang."""

HUNG, LEVEL = 0.3, 0.5
"""Metres over what is below it from which on what touches the building hangs there; the upward part of the normal of
faces that something stands on."""

STEPS, POINTS = 10, 400
"""Halvings of a measured length, and corners of a thing at most from which one looks down."""


@dataclass(frozen=True)
class Fault:
    """What is wrong with the thing at a row: a ``state`` of :data:`STATES`, a ``text``, and of a collision the row of
    the ``other`` thing, -1 for none, and the ``depth`` in metres."""

    row: int
    state: str
    text: str
    other: int = -1
    depth: float = 0.0


@dataclass(frozen=True)
class SceneCheck:
    """How many things were ``checked``, and what is wrong: collisions first."""

    checked: int
    faults: tuple[Fault, ...]

    @property
    def summary(self) -> str:
        """All in a line: "12 things: 10 fine, 1 in collision, 1 floating"."""
        count = {state: sum(fault.state == state for fault in self.faults) for state in STATES}
        told = [f"{self.checked - len(self.faults)} fine"]
        words = {COLLIDES: "in collision", FLOATS: "floating", BLOCKS: "in the way", IS_OUTSIDE: "outside"}
        told += [f"{many} {words[state]}" for state, many in count.items() if many]
        return f"{self.checked} thing{'s' * (self.checked != 1)}: {', '.join(told)}"


@dataclass(frozen=True, eq=False)
class SceneShapes:
    """The triangles (M, 3, 3) of a scene in the world, metres, whose each is, which look up, and their ends (M, 3);
    which rows (N,) are building, and the row of the ``whole`` object that each is of."""

    graph: SceneGraph
    triangles: Floats
    owner: Ints
    looks_up: Bools
    building: Bools
    whole: Ints
    low: Floats
    high: Floats

    @staticmethod
    def of(graph: SceneGraph) -> SceneShapes:
        """Those of a scene."""
        triangles, owner = world_triangles(graph)
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        looks_up = normal[:, 2] > LEVEL * np.linalg.norm(normal, axis=1)
        building = has_category(graph, STRUCTURE)
        building[list(recognise_structure(graph).parts)] = True
        low, high = corner_ends(triangles)
        return SceneShapes(graph, triangles, owner, looks_up, building, object_rows(graph), low, high)

    def roofless(self, mine: Floats) -> bool:
        """Is a thing in a room without a ceiling?"""
        structure = recognise_structure(self.graph)
        number = structure.room_at(mine.mean(axis=(0, 1)))
        return number >= 0 and not np.isfinite(structure.rooms[number].ceiling)


def check_scene(graph: SceneGraph) -> SceneCheck:
    """Judge all things of a scene as the last check of what is generated does, see :func:`~.mesh_check.faults`.

    Of two that are in each other the smaller one is told. What is building is not judged: by its category, by
    its name, by what is recognised, or because it has no name and is as large as a building.
    """
    read = understand(graph, tuple(thing_table().things)).graph
    objects = scene_objects(read, ())
    around = SceneShapes.of(read)
    rows = _things(read, around.building, objects)
    judged = _with_holders(read, objects)
    found = faults(judged, read, [read.uid[row] for row in rows])
    told = [_told(around, read.row_of_uid[uid], reason) for uid, reason in found.items()]
    kept = [fault for fault in told if fault is not None and not _is_held(objects, fault)]
    return SceneCheck(len(rows), tuple(sorted(kept, key=lambda fault: (STATES.index(fault.state), fault.row))))


def _things(read: SceneGraph, building: Bools, objects: SceneObjects) -> list[int]:
    """The rows of what is to be judged, the largest first."""
    with_mesh = find_objects(read, empty=False).rows
    size = 2 * objects.half
    huge = (size[:, 2] >= BUILT) & (size[:, :2].max(axis=1) >= BUILT)
    judged = np.isin(objects.row, with_mesh) & ~building[objects.row]
    judged &= ~(huge & (read.category[objects.row] < 0))
    order = np.argsort(-size.prod(axis=1), kind="stable")
    return [int(objects.row[number]) for number in order if judged[number]]


def _with_holders(read: SceneGraph, objects: SceneObjects) -> SceneGraph:
    """The scene with the relations to what holds things without carrying them, as geometry tells it."""
    held = [number for number, kind in enumerate(objects.relation) if kind in HELD and objects.support[number] >= 0]
    targets = [read.uid[objects.row[objects.support[number]]] for number in held]
    kinds = [objects.relation[number] for number in held]
    return read.with_component(RELATIONS, table(objects.row[held], kind=kinds, target=targets))


def _told(around: SceneShapes, row: int, reason: str) -> Fault | None:
    """A reason of the last check of the thing at a row with what is measured."""
    own = np.isin(around.owner, subtree(around.graph, row))
    category = around.graph.category_name(row)
    return measured(around, row, category, around.triangles[own], world_matrices(around.graph)[row], own, reason)


def measured(
    around: SceneShapes, row: int, category: str, mine: Floats, matrix: Floats, own: Bools, reason: str
) -> Fault | None:
    """A reason of the last check with what is measured; None for what hangs on the building.

    Parameters
    ----------
    row, category
        The thing's row, -1 where it is not in the scene yet, and what it is.
    mine, matrix
        Its triangles (M, 3, 3) and its matrix (4, 4) in the world, metres.
    own
        bool (N,): which of the scene's triangles are its own.
    reason
        One of :func:`~.mesh_check.pose_fault`.
    """
    if reason == OUTSIDE:
        return Fault(row, IS_OUTSIDE, "is outside the building")
    if reason.startswith(WOULD_BLOCK):
        return Fault(row, BLOCKS, reason.replace(WOULD_BLOCK, "blocks"))
    low, high = mine.min(axis=(0, 1)) - ASIDE, mine.max(axis=(0, 1)) + ASIDE
    near = np.flatnonzero(~own & ((around.low <= high) & (around.high >= low)).all(axis=1))
    found = _collision(around, row, mine, matrix, near)
    over = ~own & (around.low[:, 2] < high[2])
    for axis in (0, 1):
        over &= (around.low[:, axis] <= high[axis]) & (around.high[:, axis] >= low[axis])
    gap = _gap(mine, around.triangles[over])
    if found is not None and gap >= HUNG and around.building[found.other] and found.depth <= MOUNTED:
        return None
    if found is not None or reason != FLOATING:
        return found or Fault(row, COLLIDES, f"is within {reason.removeprefix(WOULD_BE_IN)}")
    walls = around.triangles[near[around.building[around.owner[near]] & ~around.looks_up[near]]]
    hung = category in HANGING and around.roofless(mine)
    if gap >= HUNG and (hung or len(meets(smaller(mine, matrix, -ASIDE), walls))):
        return None
    return Fault(row, FLOATS, f"floats by {_length(gap)}" if np.isfinite(gap) else "floats: nothing is below it")


def _collision(around: SceneShapes, row: int, mine: Floats, matrix: Floats, near: Ints) -> Fault | None:
    """What of the triangles ``near`` a thing at a row it is in, the deepest; None where it goes through nothing."""
    skin, others, whole = smaller(mine, matrix), around.triangles[near], around.whole[around.owner[near]]
    hit = np.unique(whole[meets(skin, others)])
    depths = {int(other): _depth(skin, matrix, others[whole == other]) for other in hit.tolist()}
    if not depths:
        return None
    other = max(depths, key=lambda one: depths[one])
    deep = f"by more than {_length(DEEP)}" if depths[other] >= DEEP else f"by {_length(depths[other])}"
    return Fault(row, COLLIDES, f"collides with {around.graph.name[other]} {deep}", other, depths[other])


def _is_held(objects: SceneObjects, fault: Fault) -> bool:
    """Is a collision only with what holds the thing, and no deeper than what is mounted there may be?"""
    (number,) = np.flatnonzero(objects.row == fault.row)
    support = int(objects.support[number])
    holds = support >= 0 and objects.relation[number] in HELD and int(objects.row[support]) == fault.other
    return holds and fault.depth <= MOUNTED


def _depth(skin: Floats, matrix: Floats, others: Floats) -> float:
    """How far, metres, a thing must be moved at least, sideways or up, until it goes through no face of others."""
    own = orthonormal_axes(matrix[None, :3, :3])[0].T
    ways = [sign * way for way in (*np.eye(3), *own) for sign in (1.0, -1.0) if sign * way[2] > -0.5]
    best = DEEP
    for way in ways:
        if len(meets(skin + way * best, others)):
            continue
        low, high = 0.0, best
        for _ in range(STEPS):
            middle = (low + high) / 2
            low, high = (middle, high) if len(meets(skin + way * middle, others)) else (low, middle)
        best = high
    return best + DEEPEST if best < DEEP else DEEP


def _gap(mine: Floats, faces: Floats) -> float:
    """How far, metres, the nearest of some faces is below a thing; infinite where none is."""
    points = np.unique(mine.reshape(-1, 3), axis=0)
    points = points[np.argsort(points[:, 2], kind="stable")][:POINTS]
    near, far = 0.0, FARTHEST
    if not _falls_on(points, far, faces):
        return float("inf")
    for _ in range(STEPS):
        middle = (near + far) / 2
        near, far = (near, middle) if _falls_on(points, middle, faces) else (middle, far)
    return far


def _falls_on(points: Floats, far: float, faces: Floats) -> bool:
    """Does any of some points (N, 3) come onto a face when it falls so far?"""
    segments = np.stack([points, points - np.array([0, 0, far])], axis=1)
    return bool(len(crossings(segments, faces)[0]))


def _length(metres: float) -> str:
    """A length for people: centimetres, or metres from one on."""
    return f"{metres:.1f} m" if metres >= 1 else f"{max(round(100 * metres), 1)} cm"
