"""Scores of drawn places: five things are taken out of a room, and each is asked for again, many times.

Of every draw: the distance to where it was, whether the support is of the same kind, whether it faces as before with
regard to the nearest wall, the error of its height, whether it collides or floats; of all draws together the energy
score (:mod:`...metrics.energy_score`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...dataset.assets.asset import object_graph
from ...generate import Generator
from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.placeable import Placeable
from ...generate.observe.room_walls import RoomWalls
from ...generate.observe.scene_tokens import chain
from ...generate.place.growing_scene import GrowingScene, Target
from ...generate.place.placer import BATCHES
from ...generate.place.proposal_selection import first_fitting
from ...geometry.arrays import Floats
from ...geometry.box_overlap import penetration
from ...geometry.boxes import world_bounds
from ...geometry.planar import wrapped
from ...metrics.energy_score import DRAWS, energy_scores
from ...metrics.scene_validity import DEEP, DEEP_SMALL, OFF_SUPPORT, SMALL
from ...scene import SceneGraph, world_matrices
from ...scene.categories import STRUCTURE
from ...spatial.objects import scene_objects
from .cases import without

REMOVED = 5
RIGHT_WAY = 45.0
"""Degrees by which the turn against the nearest wall may differ from the true one."""

HIGH = 0.05
"""Metres above the floor from which on something that stands on no thing hangs."""

GROUPS = ("floor", "hung", "on things")
SCORES = ("energy", "degrees", "metres", "same_kind", "facing", "height", "collide", "float")


@dataclass(frozen=True, eq=False)
class Removed:
    """A room ``rest`` from which things were taken, and one of these: its shape, place (4,), kind of support, group."""

    rest: SceneGraph
    category: str
    placeable: Placeable
    place: Floats
    holder: str
    group: str
    room: int


def removals(graph: SceneGraph, known: Sequence[str], seed: int, room: int) -> list[Removed]:
    """:data:`REMOVED` things of known categories, drawn at random, taken from a room together with what is on them."""
    objects = scene_objects(graph, known)
    structural = np.array([*(name in STRUCTURE for name in known), False])
    movable = np.flatnonzero((objects.category >= 0) & ~structural[objects.category])
    taken = np.random.default_rng((seed, room, 5)).permutation(movable)[:REMOVED]
    gone = np.zeros(len(graph), bool)
    for obj in range(len(objects)):
        gone[objects.row[obj]] = bool(np.isin([obj, *chain(objects.support, obj)], taken).any())
    rest, found = without(graph, gone), []
    for obj in taken:
        holder = int(objects.support[obj])
        if holder >= 0 and gone[objects.row[holder]]:
            continue
        kind = graph.category_name(int(objects.row[holder])) if holder >= 0 else ""
        place = np.array([*objects.center[obj, :2], objects.bottom[obj], objects.yaw[obj]])
        ground = min(
            (float(objects.top[o]) for o in np.flatnonzero(objects.support < 0) if objects.half[o, 2] < 0.3),
            default=0.0,
        )
        group = "on things" if kind not in ("", *STRUCTURE) else "hung" if place[2] > ground + HIGH else "floor"
        shape = Placeable(object_graph(graph, int(objects.row[obj])))
        found.append(Removed(rest, known[objects.category[obj]], shape, place, kind, group, room))
    return found


class PlaceJudge:
    """A room without some things, in which the places of one way to propose are judged."""

    def __init__(self, generator: Generator, rest: SceneGraph) -> None:
        self.generator, self.scene = generator, GrowingScene(rest, generator.contract)
        self.walls = RoomWalls.of(self.scene.observed, self.scene.tables)

    def draws(self, item: Removed, rng: np.random.Generator, count: int = DRAWS) -> tuple[Floats, list[int]]:
        """Places (count, 4) and supports, each what the generator would take."""
        category = self.generator.contract.vocabulary.index(item.category)
        target = Target(category, item.placeable)
        query, places, supports = self.scene.query(target, self.scene.holders(category)[0], {}), [], []
        for _ in range(count):
            batches = (self.generator.proposer.propose(query, size, rng) for size in BATCHES)
            found = first_fitting(self.scene, target, batches, False)
            places.append(found.place)
            supports.append(found.support)
        return np.array(places), supports

    def scores(self, item: Removed, places: Floats, supports: Sequence[int]) -> Floats:
        """The mean :data:`SCORES` of drawn places; energies are NaN of a single one."""
        energy, degrees = energy_scores(places, item.place) if len(places) > 1 else (np.nan, np.nan)
        far = np.linalg.norm(places[:, :3] - item.place[:3], axis=1)
        kinds = [self._kind(obj) for obj in supports]
        met = np.array([self.met(item.placeable, place, obj) for place, obj in zip(places, supports, strict=True)])
        facing = np.nan if item.group == "on things" else self._facing(item, places)
        same, height = np.mean([kind == item.holder for kind in kinds]), np.abs(places[:, 2] - item.place[2]).mean()
        return np.array([energy, degrees, far.mean(), same, facing, height, *met.mean(axis=0)])

    def truth(self, item: Removed) -> Floats:
        """The scores of the true place itself."""
        alike = [obj for obj in range(len(self.scene.labels)) if self._kind(obj) == item.holder]
        gap = [np.linalg.norm(self.scene.observed.center[obj] - item.place[:3]) for obj in alike]
        return self.scores(item, item.place[None], [alike[int(np.argmin(gap))] if alike else -1])

    def _kind(self, obj: int) -> str:
        number = int(self.scene.observed.category[obj]) if obj >= 0 else -1
        return self.scene.vocabulary[number] if number >= 0 else ""

    def _facing(self, item: Removed, places: Floats) -> float:
        both = np.concatenate([item.place[None], places])
        gap, normal = self.walls.gaps(both, item.placeable.half)
        if not gap.shape[1]:
            return np.nan
        turn = both[:, 3] - normal[np.arange(len(both)), gap.argmin(axis=1)]
        return float((np.abs(np.degrees(wrapped(turn[1:] - turn[0]))) < RIGHT_WAY).mean())

    def met(self, placeable: Placeable, place: Floats, support: int) -> tuple[bool, bool]:
        """Does a placeable at a place (4,) reach into anything but what holds it, and does it touch nothing?"""
        space, boxes = self.scene.space, placeable.boxes_at(place[None])
        low, high = (bound - sign * OFF_SUPPORT for bound, sign in zip(world_bounds(boxes), (1, -1), strict=True))
        near = np.flatnonzero(((space.low < high.max(axis=0)) & (space.high > low.min(axis=0))).all(axis=1))
        if not len(near):
            return False, True
        mine, other = (part.ravel() for part in np.meshgrid(np.arange(len(low)), near, indexing="ij"))
        depth = penetration(boxes.take(mine), space.boxes.take(other))
        holders = [support, *chain(self.scene.observed.support, support)]
        limit = DEEP_SMALL if 2 * placeable.half.max() < SMALL else DEEP
        return bool((depth[~np.isin(space.owner[other], holders)] > limit).any()), bool((depth < -OFF_SUPPORT).all())


def layouts_of(graphs: Sequence[SceneGraph], vocabulary: Sequence[str]) -> list[ObservedScene]:
    """Scenes as the proposers learn from them."""
    found = [scene_objects(graph, vocabulary) for graph in graphs]
    return [
        ObservedScene.of(objects, world_matrices(graph)[objects.row])
        for objects, graph in zip(found, graphs, strict=True)
    ]
