"""Does what was placed hold: inside the building, on something, in nothing, before no door; judged by triangles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.boxes import Boxes, orthonormal_axes, world_bounds
from ...geometry.corner_ends import corner_ends, meeting_ends
from ...geometry.polygon import inside
from ...geometry.triangle_crossings import crossings, edges_of
from ...scene import SceneGraph
from ...scene.categories import STRUCTURE
from ...scene.components import RELATIONS
from ...scene.hierarchy import subtree, world_matrices
from .floor_in_pieces import cutting_floor
from .surroundings import PosedThing, Surroundings
from .ways_through import in_the_way

DEEPEST = 0.005
"""Metres that something may reach into another: its mesh is made so much smaller on every side before it is tested."""

MOUNTED = 0.03
"""Metres that something fixed to, hung from or put into a thing may reach into that."""

AIR, ASIDE = 0.02, 0.03
"""Metres below which what carries a thing is, and beside or above which what holds it is."""

BUILT = 2.5
"""Metres of height and of length from which on something may be a building: what is beside it has no ground."""

LEAST = 0.5
"""Share of its size that a thin thing keeps when it is made smaller."""

INSIDE = "inside"
HELD = {"hangs_from", INSIDE, "beside", "attached_to"}
"""Relations of what need not stand on anything."""

OUTSIDE, FLOATING = "it would be outside the building", "it would be in the air"
BLOCKING, CUTTING = "it would block a door", "it would block the way through the room"


def faults(
    graph: SceneGraph, before: SceneGraph, uids: Sequence[str], holders: Mapping[str, int] | None = None,
    spare: float = 0.0,
) -> dict[str, str]:  # fmt: skip
    """What does not hold of things in a scene, by uid: a reason each; what holds is left out.

    ``holders`` are rows of what things hang from or are fixed to; else their relations say so, of their parents.

    A thing is *in* another where its mesh, made 5 mm smaller on every side (3 cm for what it hangs from), crosses a
    face of it or lies within it; what is said to be inside something may lie within that; in the *air* where no face
    is within 2 cm below it, nor what holds it within 3 cm; *outside* where its middle is in no room; and *blocks* a
    door where it reaches into the 0.4 m before it. None may cut a place in its room off, nor, in a room that was
    recognised, narrow the way to it to less than a person with ``spare`` metres on both sides, see
    :func:`~.ways_through.in_the_way` and :func:`~.floor_in_pieces.cutting_floor`. Of two that are in each other it is
    the later one of ``uids`` that does not hold.
    """
    around, found = Surroundings.of(graph, before), {}
    gone = np.zeros(len(graph), bool)
    left = [uid for uid in reversed(uids) if graph.category_name(graph.row_of_uid[uid]) not in STRUCTURE]
    again = True
    while again:  # what stood on, or touched, something that does not hold is looked at once more
        again = False
        for uid in [uid for uid in left if uid not in found]:
            row = graph.row_of_uid[uid]
            reason = _fault(around, row, gone, (holders or {}).get(uid, -1))
            if reason:
                found[uid], again = reason, True
                gone[subtree(graph, row)] = True
    return found | dict.fromkeys(_cutting(around, [uid for uid in uids if uid not in found], gone, spare), CUTTING)


def _cutting(around: Surroundings, uids: Sequence[str], gone: Bools, spare: float) -> list[str]:
    """Which of some things cut a place in their room off."""
    graph, structure = around.graph, around.room.structure
    if structure is None:
        room = around.room
        if room.outline is None or not room.floor.any():
            return []
        ground = float((room.objects.center + room.objects.half)[room.floor, 2].max())
        return cutting_floor(graph, room.outline, ground, uids, gone)
    new = {uid: np.isin(around.row, subtree(graph, graph.row_of_uid[uid])) for uid in uids}
    there = ~np.logical_or.reduce([gone[around.row], *new.values()])
    of_room: dict[int, list[str]] = {}
    for uid, mine in new.items():
        if mine.any():
            points = around.triangles[mine]
            number = structure.room_at((points.min(axis=(0, 1)) + points.max(axis=(0, 1))) / 2)
            of_room.setdefault(number, []).append(uid)
    found = []
    for number, own in of_room.items():
        if number >= 0:
            cut = in_the_way(
                structure.rooms[number], around.triangles[there], [around.triangles[new[uid]] for uid in own], spare
            )
            found += [own[place] for place in cut]
    return found


def _fault(around: Surroundings, row: int, gone: Bools, holder_row: int) -> str:
    """Why the thing at a row does not hold, "" if it does; what is ``gone`` (N,) is not looked at."""
    skipped = gone.copy()
    skipped[(rows := subtree(around.graph, row))] = True
    mine = around.triangles[around.of_rows(rows)]
    kinds = _relations(around.graph, row)
    held = holder_row >= 0 or bool(kinds & HELD)
    holder_row = holder_row if holder_row >= 0 else int(around.graph.parent[row])
    holders = subtree(around.graph, holder_row) if held and holder_row >= 0 else np.zeros(0, np.int64)
    matrix = world_matrices(around.graph)[row]
    return pose_fault(around, PosedThing(mine, matrix, skipped, holders, held, INSIDE in kinds))


def pose_fault(around: Surroundings, thing: PosedThing) -> str:
    """Why a thing does not hold where it stands, "" if it does; see :func:`faults`."""
    mine, skipped = thing.triangles, thing.skipped
    if not len(mine):
        return ""
    least, most = corner_ends(mine)
    low, high = least.min(axis=0) - ASIDE, most.max(axis=0) + ASIDE
    near = around.near(low, high)
    near = near[~skipped[around.row[near]]]
    others, other_row = around.triangles[near], around.row[near]
    if _outside(around, (low + high) / 2):
        return OUTSIDE
    holds = np.zeros(len(skipped), bool)
    holds[thing.holders] = True
    holder = holds[other_row]
    touched = others[holder] if len(thing.holders) else others
    stands = _grounded(around, mine) or _carried(mine, others)
    if not stands and not (thing.held and _touched(mine, touched)):
        return FLOATING
    skin = smaller(mine, thing.matrix)
    inside_of = other_row[~holder][meets(skin, others[~holder])]
    if not len(inside_of):
        inside_of = _within(around, skin, skipped | holds)
    if not len(inside_of) and thing.held:
        held_skin = skin if thing.inside else smaller(mine, thing.matrix, MOUNTED)
        inside_of = other_row[holder][meets(held_skin, others[holder])]
    if len(inside_of):
        return f"it would be in {around.graph.name[int(inside_of[0])]}"
    return BLOCKING if _in_boxes(skin, around.doors) else ""


def smaller(triangles: Floats, matrix: Floats, depth: float = DEEPEST) -> Floats:
    """Triangles (M, 3, 3) of a thing with the matrix (4, 4), smaller by a depth on every side along its own axes."""
    axes = orthonormal_axes(matrix[None, :3, :3])[0]
    own = triangles @ axes
    least, most = corner_ends(own)
    low, high = least.min(axis=0), most.max(axis=0)
    size = np.maximum(high - low, 1e-9)
    middle = (low + high) / 2
    return (middle + (own - middle) * np.maximum(1 - 2 * depth / size, LEAST)) @ axes.T


def meets(first: Floats, second: Floats) -> Ints:
    """Numbers of the triangles of the second (M, 3, 3) that go through triangles of the first (N, 3, 3)."""
    near = _around(second, first)
    hit = crossings(edges_of(first[_around(first, second)]), second[near])[1]
    hit = hit if len(hit) else crossings(edges_of(second[near]), first)[0] // 3
    return near[hit]


def _around(triangles: Floats, others: Floats) -> Ints:
    """Numbers of the triangles (M, 3, 3) that reach into the box around the others."""
    if not len(others):
        return np.zeros(0, np.int64)
    low, high = corner_ends(others)
    return np.flatnonzero(meeting_ends(*corner_ends(triangles), low.min(axis=0), high.max(axis=0)))


def _within(around: Surroundings, skin: Floats, skipped: Bools) -> Ints:
    """Rows of the closed meshes that a thing is in without crossing a face: odd many faces in all directions.

    What is as large as a house does not count: a room drawn as one closed sheet is around all that is in it.
    """
    low, high = around.row_ends
    size = np.maximum(high - low, 0.0)
    house = (size[:, 2] >= BUILT) & (size[:, :2].max(axis=1) >= BUILT)
    larger = (low < skin.min(axis=(0, 1))).all(axis=1) & (high > skin.max(axis=(0, 1))).all(axis=1)
    mine = (larger & ~house & ~skipped)[around.row]
    if not mine.any():
        return np.zeros(0, np.int64)
    others, row = around.triangles[mine], around.row[mine]
    point, far = skin[0, 0], np.ptp(np.concatenate([others.reshape(-1, 3), skin.reshape(-1, 3)]), axis=0).max() + 1
    ways = np.array([[0.02, 0.03, 1.0], [1.0, 0.025, 0.035], [0.015, -1.0, 0.045]]) * far
    ray, face = crossings(np.stack([np.tile(point, (3, 1)), point + ways], axis=1), others)
    count = np.zeros((3, len(around.graph)), np.int64)
    np.add.at(count, (ray, row[face]), 1)
    return np.flatnonzero((count % 2 == 1).all(axis=0))


def _grounded(around: Surroundings, mine: Floats) -> bool:
    """Does a thing stand at height 0 in a scene without a floor and without what may be a building?"""
    room = around.room
    if room.structure is not None or room.outline is not None or abs(mine[:, :, 2].min()) > AIR:
        return False
    low, high = world_bounds(room.objects.parts)
    size = high - low
    return not ((size[:, 2] >= BUILT) & (size[:, :2].max(axis=1) >= BUILT)).any()


def _carried(mine: Floats, others: Floats) -> bool:
    """Is there a face of others close below a face of a thing? Its lowest faces are looked at first: most stand."""
    up = np.array([0, 0, 1.0])
    low = mine[:, :, 2].min(axis=1)
    lowest = mine[low <= low.min() + AIR]
    if any(_reach(_corners(part), -AIR * up, DEEPEST * up, others) for part in (lowest, mine)):
        return True
    return _reach(_corners(others), AIR * up, -DEEPEST * up, mine)


def _touched(mine: Floats, others: Floats) -> bool:
    """Is there a face of others close beside or above a thing?"""
    turns = np.arange(8) * np.pi / 4
    ways = [*np.column_stack([np.cos(turns), np.sin(turns), 0 * turns]), np.array([0, 0, 1.0])]
    return any(_reach(_corners(mine), ASIDE * way, -DEEPEST * way, others) for way in ways)


def _reach(points: Floats, there: Floats, back: Floats, triangles: Floats) -> bool:
    segments = np.stack([points + back, points + there], axis=1)
    return bool(len(crossings(segments, triangles)[0]))


def _corners(triangles: Floats) -> Floats:
    """Corners and middles of triangles: flat things on flat things may have no corner over another's face."""
    points = triangles.reshape(-1, 3)
    points = points[np.lexsort(points.T)]  # numpy's unique sorts rows as a whole, which takes much longer
    first = np.append(len(points) > 0, (points[1:] != points[:-1]).any(axis=1))
    return np.concatenate([points[first[: len(points)]], triangles.mean(axis=1)])


def _relations(graph: SceneGraph, row: int) -> set[str]:
    said = graph.components.get(RELATIONS)
    return set() if said is None else set(said.of(row)["kind"])


def _outside(around: Surroundings, middle: Floats) -> bool:
    """Is a point (3,) in no room, or on what is open to all sides and as high as a roof?"""
    structure, outline = around.room.structure, around.room.outline
    if structure is None:
        return outline is not None and not inside(outline, middle[None, :2])[0]
    number = structure.room_at(middle)
    if number < 0 or structure.rooms[number].indoors:
        return number < 0
    return bool(structure.rooms[number].floor - around.ends[0][:, 2].min() > BUILT)


def _in_boxes(triangles: Floats, boxes: Boxes) -> bool:
    """Does a triangle reach into one of some boxes?"""
    for center, axes, half in zip(boxes.center, boxes.axes, boxes.half, strict=True):
        own = (triangles - center) @ axes
        near = own[((own.min(axis=1) < half) & (own.max(axis=1) > -half)).all(axis=1)]
        if len(near):
            return True
    return False
