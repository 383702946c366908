"""Simple ways to place objects, to compare a model with."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from ...generate.observe.observed_scene import ObservedScene
from ...generate.propose.proposer import Proposals, Proposer, Query
from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.planar import outside_rectangle, rotate
from ...scene import SceneGraph
from ...scene.categories import FLOOR
from ...spatial.floor_plan import room_outline

SPREAD_FLOOR = 0.005
_NOWHERE = (np.zeros(4), np.ones(4))


class GaussianProposer(Proposer):
    """One Gaussian per category and kind of support over the offset in the support's frame and the heading.

    The support is drawn by how often the category stands on objects of its kind;
    the heading is normal around its circular mean. ``spread=0`` predicts the mean.

    Parameters
    ----------
    scenes
        Training scenes, categories numbered as in the model's vocabulary.
    spread
        Factor on the standard deviations.
    """

    def __init__(self, scenes: Sequence[ObservedScene], spread: float = 1.0) -> None:
        found: dict[tuple[int, int], list[Floats]] = defaultdict(list)
        for scene in scenes:
            kinds = np.append(scene.category, -2)[scene.support]
            for obj, offset in enumerate(offsets(scene)):
                if scene.category[obj] >= 0:
                    found[int(scene.category[obj]), int(kinds[obj])].append(offset)
        self.fits = {key: _fit(np.array(values)) for key, values in found.items()}
        self.counts = {key: len(values) for key, values in found.items()}
        self.spread = spread

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """See :class:`~unisg_blender.generate.propose.proposer.Proposer`."""
        scene, category, allowed = query.scene, query.category, query.allowed
        if not allowed.any():
            return Proposals(np.full(count, -1, np.int64), rng.normal(0, 1, (count, 4)))
        objects = np.flatnonzero(allowed)
        kinds = scene.category[objects]
        same = np.array([(kinds == kind).sum() for kind in kinds])
        chance = np.array([self.counts.get((category, int(kind)), 0.1) for kind in kinds]) / same
        supports = objects[rng.choice(len(objects), count, p=chance / chance.sum())]
        places = np.zeros((count, 4))
        for row, obj in enumerate(supports):
            mean, deviation = self.fits.get((category, int(scene.category[obj])), _NOWHERE)
            offset = mean + self.spread * deviation * rng.standard_normal(4)
            places[row] = *rotate(offset[:3], scene.yaw[obj]), offset[3]
            places[row] += (*scene.center[obj, :2], scene.center[obj, 2] - scene.half[obj, 2], scene.yaw[obj])
        return Proposals(supports.astype(np.int64), places)

    def log_density(self, query: Query, support: int, place: Floats) -> float:
        """Of a position and heading on a known support, nats (metres, radians)."""
        scene = query.scene
        kind = int(scene.category[support]) if support >= 0 else -2
        mean, deviation = self.fits.get((query.category, kind), _NOWHERE)
        origin = np.zeros(4)
        if support >= 0:
            origin[:] = *scene.center[support], scene.yaw[support]
        offset = rotate(place[:2] - origin[:2], -origin[3])
        return _log_normal(offset, place[3] - origin[3], mean, deviation)


class CopyProposer(Proposer):
    """Where an object of the category stood in a training room, as far from the middle of the room, with its heading.

    Of all rooms that have one, or, ``nearest``, of that one whose floor and counts of categories are most alike.
    """

    def __init__(self, scenes: Sequence[ObservedScene], categories: int, nearest: bool) -> None:
        self.scenes, self.categories, self.nearest = scenes, categories, nearest
        self.signatures = np.array([self._signature(scene) for scene in scenes])

    def _signature(self, scene: ObservedScene) -> Floats:
        counts = np.bincount(scene.category[scene.category >= 0], minlength=self.categories)
        root = scene.support < 0
        return np.append(counts, 8 * np.sort(scene.half[root, :2].max(axis=0, initial=0)))

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """See :class:`~unisg_blender.generate.propose.proposer.Proposer`."""
        rooms = [scene for scene in self.scenes if (scene.category == query.category).any()]
        if self.nearest and rooms:
            order = nearest_room(self._signature(query.scene), self.signatures)
            rooms = [scene for scene in map(self.scenes.__getitem__, order) if scene in rooms][:1]
        seen = [_from_middle(scene, query.category) for scene in rooms]
        found = np.concatenate(seen) if seen else np.zeros((1, 4))
        places = found[rng.integers(len(found), size=count)]
        places[:, :3] += (*query.scene.room.middle, query.scene.room.ground)
        return Proposals(
            np.array([carrier_of(query.scene, place, query.allowed) for place in places], np.int64), places
        )


def _from_middle(scene: ObservedScene, category: int) -> Floats:
    """Places (P, 4) of the objects of a category as seen from the room's middle."""
    mine = scene.category == category
    bottom = scene.center[mine] - scene.half[mine] * (0, 0, 1) - (*scene.room.middle, scene.room.ground)
    return np.column_stack([bottom, scene.yaw[mine]])


class WorldGaussianProposer(Proposer):
    """One Gaussian per category over position and heading in the room, whose middle is the origin.

    What carries the object is found afterwards, see :func:`carrier_of`.
    """

    def __init__(self, scenes: Sequence[ObservedScene]) -> None:
        found: dict[int, list[Floats]] = defaultdict(list)
        for scene in scenes:
            origin = np.array([*scene.room.middle, scene.room.ground])
            bottom = scene.center - scene.half * (0, 0, 1)
            for obj in np.flatnonzero(scene.category >= 0):
                found[int(scene.category[obj])].append(np.append(bottom[obj] - origin, scene.yaw[obj]))
        self.fits = {key: _fit(np.array(values)) for key, values in found.items()}

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """See :class:`~unisg_blender.generate.propose.proposer.Proposer`."""
        scene, allowed = query.scene, query.allowed
        mean, deviation = self.fits.get(query.category, _NOWHERE)
        places = mean + deviation * rng.standard_normal((count, 4))
        places[:, :3] += (*scene.room.middle, scene.room.ground)
        return Proposals(np.array([carrier_of(scene, place, allowed) for place in places], np.int64), places)

    def log_density(self, query: Query, support: int, place: Floats) -> float:
        """Of a position and heading, whatever the support, nats (metres, radians)."""
        mean, deviation = self.fits.get(query.category, _NOWHERE)
        return _log_normal(place[:2] - query.scene.room.middle, place[3], mean, deviation)


def carrier_of(scene: ObservedScene, place: Floats, allowed: Bools) -> int:
    """Which of the allowed objects a bottom at a place (4,) is nearest to: apart from its top, and beside it, metres.

    -1 where none is allowed.
    """
    objects = np.flatnonzero(allowed)
    if not len(objects):
        return -1
    offset = place[:2] - scene.center[objects, :2]
    aside = outside_rectangle(offset, scene.yaw[objects], scene.half[objects, :2])
    low, high = scene.center[objects, 2] - scene.half[objects, 2], scene.center[objects, 2] + scene.half[objects, 2]
    apart = np.maximum(place[2] - high, 0) + np.maximum(low - place[2], 0) + 0.1 * np.abs(place[2] - high)
    return int(objects[np.argmin(aside + apart)])


def offsets(scene: ObservedScene) -> Floats:
    """x, y, height of the bottom above the support's bottom, and heading (K, 4), in the frames of the supports."""
    held = scene.support >= 0
    support = np.maximum(scene.support, 0)
    offset = scene.center - np.where(held[:, None], scene.center[support], 0)
    yaw = np.where(held, scene.yaw[support], 0.0)
    below = np.where(held, scene.center[support, 2] - scene.half[support, 2], 0.0)
    height = scene.center[:, 2] - scene.half[:, 2] - below
    return np.column_stack([rotate(offset[:, :2], -yaw), height, scene.yaw - yaw])


def _fit(values: Floats) -> tuple[Floats, Floats]:
    """Mean and standard deviation (4,); of the last column, angles, the circular ones."""
    resultant = np.exp(1j * values[:, 3]).mean()
    mean = np.append(values[:, :3].mean(axis=0), np.angle(resultant))
    turn = np.sqrt(-2 * np.log(np.clip(np.abs(resultant), 1e-6, 1)))
    return mean, np.append(np.maximum(values[:, :3].std(axis=0), SPREAD_FLOOR), max(turn, 0.01))


def _log_normal(offset: Floats, turn: float, mean: Floats, deviation: Floats) -> float:
    """Log density of x, y and a heading (wrapped around the circle) under a Gaussian over x, y, z, heading."""
    z = (offset - mean[:2]) / deviation[:2]
    place = -0.5 * z @ z - np.log(deviation[:2]).sum() - np.log(2 * np.pi)
    images = turn - mean[3] + 2 * np.pi * np.arange(-3, 4)
    around = -0.5 * (images / deviation[3]) ** 2 - np.log(deviation[3]) - 0.5 * np.log(2 * np.pi)
    return float(place + np.logaddexp.reduce(around))


def signature(graph: SceneGraph, vocabulary: Sequence[str]) -> Floats:
    """Counts of the categories, and four times half the size of the room, to find similar rooms by."""
    names = [graph.category_name(row) for row in range(len(graph))]
    counts = np.array([names.count(name) for name in vocabulary], np.float64)
    size = np.zeros(2)
    if FLOOR in graph.vocabulary:
        size = np.ptp(room_outline(graph), axis=0) / 2
    return np.append(counts, 4 * size)


def nearest_room(wanted: Floats, signatures: Floats) -> Ints:
    """Numbers of the rooms with signatures (S, W), the nearest to the wanted one first."""
    return np.abs(signatures - wanted).sum(axis=1).argsort(kind="stable")
