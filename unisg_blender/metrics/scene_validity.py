"""Is a scene possible: collisions, floating and sunk objects, objects outside the room; per object, scene and set.

Formulas and limits follow the table of the project's generator benchmark: a
collision is deeper than 2 cm, or 1 cm where one of the two is smaller than 10
cm; floating or sunk is more than 2 cm off the support. Beside the collisions
stands a stricter count, in which flat objects collide from half their thickness
on. Structure (:data:`~..scene.categories.STRUCTURE`) is what others stand on or bump into; it is not
counted itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import Bools, Floats, Ints
from ..geometry.box_overlap import nearby_pairs, penetration
from ..geometry.boxes import Boxes, corners
from ..geometry.polygon import outside_distance
from ..scene.categories import FLOOR, STRUCTURE, has_category
from ..scene.graph import SceneGraph
from ..spatial.floor_plan import room_outline
from ..spatial.object_rows import Objects, find_objects
from ..spatial.part_boxes import PartBoxes
from ..spatial.supports import Supports, find_supports
from .support_gaps import support_gaps

DEEP, DEEP_SMALL, SMALL = 0.02, 0.01, 0.10
"""Collision limits in metres: for most objects, where one is small, and how small that is (longest edge)."""

OFF_SUPPORT = 0.02
OUTSIDE = 0.02
CategoryPair = tuple[str, str]


@dataclass(frozen=True, eq=False)
class Collisions:
    """Pairs (K, 2) of rows that overlap, first < second, how deep each does, metres (K,), and which do beyond the
    plain limits, bool (K,): the others are flat objects.
    """

    pairs: Ints
    depth: Floats
    deep: Bools


@dataclass(frozen=True, eq=False)
class SceneReport:
    """What was measured in one scene; bool (N,) columns are False where ``counted`` is.

    ``colliding`` is by the plain limits, ``overlapping`` by the stricter ones.
    """

    counted: Bools
    colliding: Bools
    overlapping: Bools
    off_support: Bools
    outside: Bools
    level: Ints
    collisions: Collisions

    @property
    def faults(self) -> Bools:
        """Objects with any fault, by the stricter limits."""
        return self.overlapping | self.off_support | self.outside


def counted_objects(graph: SceneGraph) -> Bools:
    """Which rows are objects with geometry and no structure, bool (N,)."""
    found = np.zeros(len(graph), bool)
    found[find_objects(graph, empty=False).rows] = True
    return found & ~has_category(graph, STRUCTURE)


def find_collisions(
    graph: SceneGraph, *, parts: bool = True, allowed: Iterable[CategoryPair] = (), supports: Supports | None = None
) -> Collisions:
    """All pairs of objects that overlap deeper than the limits, in metres.

    The depth of a pair is the largest penetration (separating axes, exact) over the
    boxes of their connected parts, or of the whole objects with ``parts=False``. The
    plain limit is 2 cm, and 1 cm if either's longest edge is under 10 cm; pairs
    beyond it are ``deep``. The stricter limit, which all pairs exceed, is also never
    more than half the thinnest edge of the two boxes that meet, since two scalpels
    6 mm high in one place reach only 6 mm into each other.

    Left out are pairs where one holds the other (see :func:`~..spatial.supports.find_supports`) or is above it in the
    hierarchy, pairs of two pieces of structure, and pairs of categories in ``allowed``. ``supports`` are those of the
    scene, for who has them already.
    """
    supports = find_supports(graph) if supports is None else supports
    objects = supports.objects
    boxes = objects.parts if parts else _whole_boxes(objects)
    near = nearby_pairs(boxes.boxes)
    owners = boxes.owner[near]
    kept = owners[:, 0] != owners[:, 1]
    counted = counted_objects(graph)[objects.rows]
    kept &= counted[owners].any(axis=1)
    kept &= ~_is_among(owners, _support_pairs(supports), len(objects))
    near, owners = near[kept], owners[kept]
    depth = penetration(boxes.boxes.take(near[:, 0]), boxes.boxes.take(near[:, 1]))
    longest = 2 * objects.oriented.half.max(axis=1)
    limit = np.where(longest[owners].min(axis=1) < SMALL, DEEP_SMALL, DEEP)
    thinnest = 2 * boxes.boxes.half.min(axis=1)
    strict = np.maximum(np.minimum(limit, thinnest[near].min(axis=1) / 2), 1e-6)
    hit = depth > strict
    found, index = np.unique(np.sort(owners[hit], axis=1), axis=0, return_inverse=True)
    deepest, deep = np.zeros(len(found)), np.zeros(len(found), bool)
    np.maximum.at(deepest, index.reshape(-1), depth[hit])
    np.logical_or.at(deep, index.reshape(-1), (depth > limit)[hit])
    found = objects.rows[found]
    banned = {tuple(sorted(pair)) for pair in allowed}
    names = [tuple(sorted((graph.category_name(a), graph.category_name(b)))) for a, b in found]
    keep = np.array([pair not in banned for pair in names], bool)
    return Collisions(found[keep], deepest[keep], deep[keep])


def overlapping_categories(graphs: Iterable[SceneGraph], *, parts: bool = False) -> set[CategoryPair]:
    """Category pairs that overlap in real scenes (chairs under tables) by more than the plain limits.

    They are to be ``allowed`` in generated ones.
    """
    found = set()
    for graph in graphs:
        collisions = find_collisions(graph, parts=parts)
        for first, second in collisions.pairs[collisions.deep]:
            low, high = sorted((graph.category_name(first), graph.category_name(second)))
            found.add((low, high))
    return found


def _whole_boxes(objects: Objects) -> PartBoxes:
    solid = np.unique(objects.parts.owner)
    return PartBoxes(objects.oriented.take(solid), solid)


def _support_pairs(supports: Supports) -> Ints:
    """(S, 2) pairs of objects of which the second holds the first, or is next above it in the hierarchy."""
    above = supports.objects.above
    pairs = [np.stack([np.arange(len(above)), above], axis=1), np.stack([supports.subject, supports.target], axis=1)]
    joined = np.concatenate(pairs)
    return joined[joined[:, 1] >= 0]


def _is_among(pairs: Ints, known: Ints, count: int) -> Bools:
    """Which pairs occur among the known ones, in either order."""
    key = np.sort(pairs, axis=1) @ (count, 1) if len(pairs) else np.zeros(0, np.int64)
    return np.isin(key, np.sort(known, axis=1) @ (count, 1) if len(known) else ())


def outside_room(graph: SceneGraph, objects: Objects | None = None, outline: Floats | None = None) -> Floats:
    """How far each object reaches out of the room's outline seen from above, float64 (N,) metres, 0 inside.

    The largest distance of a corner of its part boxes to the outline, or the depth
    to which a corner of the room that points inwards reaches into one of them. NaN
    for rows without geometry, and everywhere in a scene without a floor. ``objects`` are those of the scene, for who
    has them already.
    """
    result = np.full(len(graph), np.nan)
    if outline is None and FLOOR not in graph.vocabulary:
        return result
    outline = room_outline(graph) if outline is None else outline
    objects = find_objects(graph) if objects is None else objects
    parts, owner = objects.parts.boxes, objects.rows[objects.parts.owner]
    out = outside_distance(outline, corners(parts)[:, :, :2]).max(axis=1)
    result[owner] = 0.0
    np.maximum.at(result, owner, np.maximum(out, _poked(parts, outline)))
    return result


def _poked(boxes: Boxes, outline: Floats) -> Floats:
    """How deep corners of the room that point inwards reach into boxes, float64 (P,)."""
    before, after = outline - np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0) - outline
    reflex = outline[before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] < -1e-9]
    if not len(reflex):
        return np.zeros(len(boxes.center))
    points = np.concatenate([reflex, np.zeros((len(reflex), 1))], axis=1) - boxes.center[:, None] * (1, 1, 0)
    upright = np.abs(boxes.axes[:, 2, 2]) > 0.999  # of tilted boxes only the corners count
    seen = np.abs(np.einsum("pij,pci->pcj", boxes.axes, points))[..., :2]
    deep = (boxes.half[:, None, :2] - seen).min(axis=-1).max(axis=1)
    return np.where(upright, np.maximum(deep, 0.0), 0.0)


def support_levels(graph: SceneGraph, supports: Supports | None = None) -> Ints:
    """On how many objects an object stands, one on another, int64 (N,): floor 0, table 1, tray 2, tool 3.

    The longest way down over what holds it, see :func:`~..spatial.supports.find_supports`; 0 for what is no object.
    """
    found = find_supports(graph) if supports is None else supports
    level = np.zeros(len(graph), np.int64)
    for _ in range(len(graph)):  # objects that carry each other in a circle end this
        higher = level.copy()
        np.maximum.at(higher, found.row, level[found.on] + 1)
        if (higher == level).all():
            break
        level = higher
    return level


def measure_scene(graph: SceneGraph, *, parts: bool = True, allowed: Iterable[CategoryPair] = ()) -> SceneReport:
    """All faults of one scene.

    Parameters
    ----------
    graph
        The scene.
    parts, allowed
        As for :func:`find_collisions`.
    """
    counted = counted_objects(graph)
    supports = find_supports(graph)
    collisions = find_collisions(graph, parts=parts, allowed=allowed, supports=supports)
    colliding, overlapping = np.zeros(len(graph), bool), np.zeros(len(graph), bool)
    overlapping[collisions.pairs.reshape(-1)] = True
    colliding[collisions.pairs[collisions.deep].reshape(-1)] = True
    gap = support_gaps(graph, counted, supports)
    outside = np.nan_to_num(outside_room(graph, supports.objects)) > OUTSIDE
    return SceneReport(
        counted, colliding & counted, overlapping & counted, np.abs(np.nan_to_num(gap, posinf=np.inf)) > OFF_SUPPORT,
        outside & counted, support_levels(graph, supports), collisions,
    )  # fmt: skip


def summarise(reports: Iterable[SceneReport]) -> dict[str, float]:
    """Many scenes in one row: shares of objects (0..1) with each fault, and of scenes without any.

    ``objects`` and ``scenes`` are counts; shares are over all objects of all scenes;
    ``level`` is the mean, over scenes, of the highest support level.
    """
    reports = list(reports)
    objects = sum(int(report.counted.sum()) for report in reports)
    share = {
        name: sum(int(getattr(report, name).sum()) for report in reports) / max(objects, 1)
        for name in ("colliding", "overlapping", "off_support", "outside", "faults")
    }
    clean = np.mean([not report.faults.any() for report in reports]) if reports else np.nan
    level = np.mean([report.level.max(initial=0) for report in reports]) if reports else np.nan
    counts = {"scenes": float(len(reports)), "objects": float(objects)}
    return counts | share | {"scenes_without_fault": float(clean), "level": float(level)}
