"""Relations between objects, computed from their geometry."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import numpy as np

from ..geometry.arrays import Ints
from ..geometry.box_overlap import nearby_pairs, penetration
from ..geometry.surface_contact import contact_heights, surface_gap, walls_around
from ..scene import components
from ..scene.component_table import entry_table
from ..scene.graph import SceneGraph
from .directions import directions
from .object_rows import Objects, find_objects
from .relation_tolerances import DEFAULT, RelationTolerances
from .surface_under import surface_under

KINDS = (
    "on_top_of", "inside", "above", "below", "left_of", "right_of", "in_front_of", "behind", "beside", "part_of",
    "connected_to",
)  # fmt: skip
"""The kinds of relations that are computed."""

Found = tuple[int, str, int]
"""Row of the subject, kind, row of the target."""


def relate(graph: SceneGraph, rows: Ints | None = None, tolerances: RelationTolerances = DEFAULT) -> SceneGraph:
    """The scenegraph with its relations computed anew; relations of kinds of its user's own stay.

    A :class:`~..scene.systems.System`: only relations whose subjects are among ``rows`` (K,), all
    when omitted, are computed anew; their targets may be any objects of the scene.
    """
    subjects = set(range(len(graph)) if rows is None else map(int, rows))
    found = [entry for entry in find_relations(graph, tolerances) if entry[0] in subjects]
    return with_relations(graph, found, KINDS, subjects)


def with_relations(
    graph: SceneGraph, found: Iterable[Found], kinds: Collection[str], subjects: Collection[int] | None = None
) -> SceneGraph:
    """The scenegraph with these relations for those of some ``kinds`` that some rows, or all, had; others stay."""
    entries = graph.entries(components.RELATIONS, "kind", "target")
    entries = [entry for entry in entries if entry[1] not in kinds or not (subjects is None or entry[0] in subjects)]
    entries += [(row, kind, graph.uid[target]) for row, kind, target in found]
    return graph.with_component(components.RELATIONS, entry_table(entries, "kind", "target"))


def find_relations(graph: SceneGraph, tolerances: RelationTolerances = DEFAULT) -> list[Found]:
    """All relations between the objects of a scene, sorted.

    An object is an entity with a mesh, or with a category and meshes below it. Oriented
    boxes of the meshes' parts say which pairs can meet; the surfaces themselves say
    which do. Time grows as O(N log N) for objects that are spread out in space.

    Returns
    -------
    list of (row of the subject, kind, row of the target)
        ``kind`` is one of :data:`KINDS`; "beside" and "connected_to" hold both ways, "above" and "below",
        "left_of" and "right_of", "in_front_of" and "behind" come in pairs.
    """
    objects = find_objects(graph, empty=False)
    found = _direct(_touching(objects, _close_pairs(objects, tolerances), tolerances))
    joined = {(min(subject, target), max(subject, target)) for subject, _, target in found}
    found += directions(objects, tolerances, joined)
    rows = [(int(objects.rows[subject]), kind, int(objects.rows[target])) for subject, kind, target in found]
    own = {row: int(objects.rows[obj]) for obj, parts in enumerate(objects.meshes) for row in parts.tolist()}
    return sorted(rows + [(row, "part_of", above) for row, above in own.items() if row != above])


def _close_pairs(objects: Objects, tolerances: RelationTolerances) -> Ints:
    """Pairs (K, 2) of objects of which some parts' oriented boxes touch, or one stands in the other's box."""
    parts = objects.parts
    pairs = nearby_pairs(parts.boxes, tolerances.gap)
    owners = parts.owner[pairs].reshape(-1, 2)
    pairs, owners = pairs[owners[:, 0] != owners[:, 1]], owners[owners[:, 0] != owners[:, 1]]
    depth = penetration(parts.boxes.take(pairs[:, 0]), parts.boxes.take(pairs[:, 1]))
    touching = np.sort(owners[depth >= -tolerances.gap], axis=1)
    near = nearby_pairs(objects.aligned)
    low, high = objects.bounds[:, near]
    high = high + tolerances.gap
    nested = (low[:, 0] >= low[:, 1] - tolerances.gap).all(axis=1) & (high[:, 0] <= high[:, 1] + tolerances.gap).all(
        axis=1
    )
    nested |= (low[:, 1] >= low[:, 0] - tolerances.gap).all(axis=1) & (high[:, 1] <= high[:, 0] + tolerances.gap).all(
        axis=1
    )
    return np.unique(np.concatenate([touching, near[nested]]), axis=0)


def _touching(objects: Objects, pairs: Ints, tolerances: RelationTolerances) -> list[Found]:
    """What rests on, lies in, belongs to or is joined with what."""
    found: list[Found] = []
    joined: list[tuple[int, int]] = []
    length, backdrop = (objects.high - objects.low).max(axis=1), _backdrop(objects, tolerances)
    for one, two in pairs.tolist():
        between: list[Found] = []
        for subject, target in ((one, two), (two, one)):
            if _lies_inside(objects, subject, target, tolerances):
                between.append((subject, "inside", target))
            elif subject == backdrop or length[subject] >= tolerances.vast * length[target]:
                continue  # a ground plane is not on the legs that pierce it
            elif _rests(objects, subject, target, tolerances):
                between.append((subject, "on_top_of", target))
        between = [_surer(objects, between, tolerances)] if len(between) > 1 else between
        if not between and _meets(objects, one, two, tolerances):
            if objects.is_below(one, two):
                between = [(one, "part_of", two)]
            elif objects.is_below(two, one):
                between = [(two, "part_of", one)]
            else:
                joined.append((one, two))
        found += between
    return found + _sunk_or_connected(objects, joined, {entry[0] for entry in found if entry[1] != "part_of"})


def _surer(objects: Objects, between: list[Found], tolerances: RelationTolerances) -> Found:
    """Of two things each of which rests on the other: a sheet bears what it reaches beyond, else the lower."""
    size = objects.high - objects.low

    def order(entry: Found) -> tuple[bool, bool, float]:
        """The greater, the surer."""
        subject, kind, target = entry
        sheet = size[target, 2] <= tolerances.overlap and size[target].max() > size[subject].max()
        return kind == "inside", bool(sheet), float(objects.low[subject, 2])

    return max(between, key=order)


def _backdrop(objects: Objects, tolerances: RelationTolerances) -> int:
    """The object that is vastly longer than all others together, -1 where there is none."""
    if len(objects) < 2:
        return -1
    largest = int((objects.high - objects.low).max(axis=1).argmax())
    low, high = np.delete(objects.low, largest, axis=0), np.delete(objects.high, largest, axis=0)
    around = float((high.max(axis=0) - low.min(axis=0)).max())
    return largest if (objects.high - objects.low)[largest].max() >= tolerances.backdrop * around else -1


def _sunk_or_connected(objects: Objects, joined: list[tuple[int, int]], borne: set[int]) -> list[Found]:
    """Of what meets: what stands sunk in something stands on it, where nothing bears it; the rest is connected."""
    deepest: dict[int, tuple[float, int]] = {}
    for pair in joined:
        for subject, target in (pair, pair[::-1]):
            if subject not in borne and (height := surface_under(objects, subject, target)) is not None:
                deepest[subject] = max(deepest.get(subject, (height, target)), (height, target))
    found = [(subject, "on_top_of", target) for subject, (_, target) in deepest.items()]
    sunk = {(subject, target) for subject, _, target in found}
    for one, two in joined:
        if (one, two) not in sunk and (two, one) not in sunk:
            found += [(one, "connected_to", two), (two, "connected_to", one)]
    return found


def _direct(found: list[Found]) -> list[Found]:
    """Without what rests on something only through a thin object between, as a cup on a cloth on a table."""
    bearers: dict[int, set[int]] = {}
    for subject, kind, target in found:
        if kind in ("on_top_of", "inside"):
            bearers.setdefault(subject, set()).add(target)
    return [
        (subject, kind, target)
        for subject, kind, target in found
        if kind != "on_top_of" or not any(target in bearers.get(other, ()) for other in bearers[subject] - {target})
    ]


def _rests(objects: Objects, subject: int, target: int, tolerances: RelationTolerances) -> bool:
    """Contacts below the subject's middle, and not only at the brim of a side that it touches."""
    low = np.maximum(objects.low[subject], objects.low[target])
    high = np.minimum(objects.high[subject], objects.high[target])
    if ((high - low)[:2] <= 0).any() or objects.low[subject, 2] < objects.low[target, 2] - tolerances.overlap:
        return False
    low[2], high[2] = low[2] - tolerances.gap - tolerances.overlap, high[2] + tolerances.gap + tolerances.overlap
    contacts = contact_heights(
        objects.triangles(subject), objects.triangles(target), low, high, tolerances.gap, tolerances.overlap
    )
    middle = (objects.low[subject, 2] + objects.high[subject, 2]) / 2
    return bool((contacts <= middle).any()) if len(contacts) else False


def _lies_inside(objects: Objects, subject: int, target: int, tolerances: RelationTolerances) -> bool:
    """The subject's box lies in the target's, and the target's surface stands around its middle."""
    low, high = objects.low[target] - tolerances.gap, objects.high[target] + tolerances.gap
    middle = (objects.low[subject] + objects.high[subject]) / 2
    footprint = (objects.low[subject, :2] >= low[:2]).all() and (objects.high[subject, :2] <= high[:2]).all()
    if not footprint or not (low <= middle).all() or not (middle <= high).all():
        return False
    walls = walls_around(middle, objects.triangles(target), objects.axes[target])
    upward = int(np.argmax(np.abs(objects.axes[target][2])))
    if np.isfinite(walls[upward]).all():
        return bool(np.isfinite(walls).sum() >= tolerances.walls)
    across = np.delete(walls.sum(axis=1), upward)
    depth = objects.high[target, 2] - middle[2] + walls[upward].min()
    return bool(np.isfinite(walls).sum() == 5 and depth >= tolerances.hollow * across.min())


def _meets(objects: Objects, one: int, two: int, tolerances: RelationTolerances) -> bool:
    low = np.maximum(objects.low[one], objects.low[two]) - tolerances.gap
    high = np.minimum(objects.high[one], objects.high[two]) + tolerances.gap
    parts = (objects.triangles_within(obj, low, high) for obj in (one, two))
    return surface_gap(*parts) <= tolerances.gap
