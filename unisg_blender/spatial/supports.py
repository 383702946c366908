"""What holds what: the one answer for generation, behaviour, metrics and experiments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry.arrays import Bools, Ints
from ..geometry.box_overlap import penetration
from ..geometry.boxes import Boxes, covers, part_tops
from ..geometry.planar import rotation
from ..scene import components
from ..scene.graph import SceneGraph
from .object_rows import Objects, find_objects
from .surface_under import surface_under

SUPPORT_KINDS = ("on_top_of", "inside", "hangs_from")
"""Relations to what holds an object."""

CONTACT = 0.02
"""Metres within which a bottom counts as resting on a surface."""

DEEPEST = 16
"""Supports under one another that are counted, at most."""


@dataclass(frozen=True, eq=False)
class Supports:
    """Which objects hold which: S entries, ascending by ``subject``; an object may have several.

    Attributes
    ----------
    objects
        The objects of the scene, K of them.
    subject, target
        int64 (S,): number of an object, and of one that holds it.
    kind
        S strings: the relation that says so, "" where the hierarchy or the geometry does.
    """

    objects: Objects
    subject: Ints
    target: Ints
    kind: NDArray[np.str_]

    @property
    def row(self) -> Ints:
        """Rows of the subjects in the scene, (S,)."""
        return self.objects.rows[self.subject]

    @property
    def on(self) -> Ints:
        """Rows of what holds them, (S,)."""
        return self.objects.rows[self.target]

    @property
    def hangs(self) -> Bools:
        """Which of them hang, (S,)."""
        return self.kind == "hangs_from"

    @property
    def first(self) -> Ints:
        """int64 (K,): the first object that holds each, -1 for none."""
        found = np.full(len(self.objects), -1, np.int64)
        found[self.subject[::-1]] = self.target[::-1]
        return found

    @property
    def first_kind(self) -> NDArray[np.str_]:
        """K strings: the relation to the first that holds each, "" where none is told."""
        found = np.zeros(len(self.objects), self.kind.dtype)
        found[self.subject[::-1]] = self.kind[::-1]
        return found

    @property
    def by_row(self) -> Ints:
        """int64 (N,): row of the first object that holds each row, for a part of an object that object; -1 for none."""
        of_row, rows = self.objects.of_row, np.append(self.objects.rows, -1)
        own = rows[of_row]
        return np.where(own == np.arange(len(own)), rows[np.append(self.first, -1)[of_row]], own)


def find_supports(graph: SceneGraph) -> Supports:
    """What holds each object: what its relations name, else the next object above, else what it rests on.

    Of the relations ``on_top_of``, ``inside`` and ``hangs_from`` count. Above in the hierarchy the nearest
    object with geometry counts, and one without it only where nothing bears the object. What rests on what is told by
    boxes (:func:`resting_on`), and by meshes where boxes say nothing: on a hill, or in a house of one mesh, things
    stand anywhere in the box, and some are sunk a little into what they stand on. What hangs is told by relations or
    the hierarchy alone: geometry cannot tell a picture on a wall from a chair that was pushed against it.
    """
    objects = find_objects(graph)
    solid = np.array([len(rows) > 0 for rows in objects.meshes], bool)
    subject, target, kind = _related(objects, solid)
    above = objects.above.copy()
    while (bare := (above >= 0) & ~solid[above]).any():
        above[bare] = objects.above[above[bare]]
    above[subject[::-1]] = target[::-1]
    for obj in np.argsort(objects.upright[0][:, 2] - objects.upright[1][:, 2], kind="stable"):  # what bears comes first
        if above[obj] < 0 and solid[obj]:
            above[obj] = resting_on(objects, int(obj), above)
            if above[obj] < 0:
                above[obj] = _standing_in(objects, int(obj), above, solid)
    above = np.where(above < 0, objects.above, above)
    rest = np.setdiff1d(np.flatnonzero(above >= 0), subject)
    subject, target = np.concatenate([subject, rest]), np.concatenate([target, above[rest]])
    order = np.argsort(subject, kind="stable")
    kind = np.concatenate([kind, np.zeros(len(rest), kind.dtype)])
    return Supports(objects, subject[order], target[order], kind[order])


def _related(objects: Objects, solid: Bools) -> tuple[Ints, Ints, NDArray[np.str_]]:
    """Subjects, targets and kinds of the relations that tell of supports with geometry."""
    relations = objects.graph.components.get(components.RELATIONS)
    if relations is None or not len(relations.rows):
        return np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0, "U10")
    row_of = objects.graph.row_of_uid
    kind = relations.columns["kind"].astype(str)
    rows = np.array([row_of.get(uid, -1) for uid in relations.columns["target"]], np.int64)
    subject, target = objects.of_row[relations.rows], np.append(objects.of_row, -1)[rows]
    named = np.isin(kind, SUPPORT_KINDS) & (subject >= 0) & (target >= 0) & (subject != target)
    named &= np.append(solid, False)[target]
    return subject[named], target[named], kind[named]


def resting_on(objects: Objects, obj: int, support: Ints) -> int:
    """The object that bears object ``obj``, by boxes; -1 for none.

    It has a part whose top is within :data:`CONTACT` of the bottom of ``obj`` and lies under its middle: the highest
    such part counts. Without one, a part under or beside its footprint does whose object stands on something itself or
    is lowest of all, as walls stand at the edge of a floor, but a rail not on the lamp below it. What bears reaches
    lower than ``obj``, so that a scalpel in a dish does not bear the dish, and is not held by ``obj`` itself, by what
    is known of the supports (K,).
    """
    center, half = objects.upright
    bottom, parts = center[:, 2] - half[:, 2], objects.parts
    if not half[obj].any():
        return -1
    tops = part_tops(parts.boxes)
    near = np.flatnonzero((np.abs(tops - bottom[obj]) <= CONTACT) & (bottom[parts.owner] < bottom[obj]))
    near = near[np.array([not _holds(support, obj, int(other)) for other in parts.owner[near]], bool)]
    under = near[covers(parts.boxes.take(near), center[obj, :2])]
    if not len(under):
        near = near[(support[parts.owner[near]] >= 0) | (bottom[parts.owner[near]] <= bottom[parts.owner].min())]
        own = Boxes(center, rotation(objects.yaw), half, np.ones(len(objects), bool))
        depth = penetration(own.take(np.full(len(near), obj)), parts.boxes.take(near))
        under = near[depth >= -CONTACT]
    return int(parts.owner[under[np.argmax(tops[under])]]) if len(under) else -1


def _standing_in(objects: Objects, obj: int, support: Ints, solid: Bools) -> int:
    """The object with the highest surface on or in which object ``obj`` stands, by their meshes; -1 for none."""
    low, high = objects.low - CONTACT, objects.high + CONTACT
    near = solid & (low <= objects.high[obj]).all(axis=1) & (high >= objects.low[obj]).all(axis=1)
    near[obj] = False
    best, highest = -1, -np.inf
    for other in np.flatnonzero(near).tolist():
        if not _holds(support, obj, other):
            height = surface_under(objects, obj, other, CONTACT)
            if height is not None and height > highest:
                best, highest = other, height
    return best


def _holds(support: Ints, obj: int, other: int) -> bool:
    """Whether ``other`` stands on ``obj``, or on what stands on it, and so on."""
    seen = set()
    while other >= 0 and other != obj and other not in seen:
        seen.add(other)
        other = int(support[other])
    return other == obj


def levels_of(support: Ints) -> Ints:
    """Number of supports under each object, (K,)."""
    level, above = np.zeros(len(support), np.int64), support.copy()
    for _ in range(DEEPEST):
        held = above >= 0
        level[held] += 1
        above[held] = support[above[held]]
    return level
