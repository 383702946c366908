"""A room in which one thing is to be placed by pointing: what is known of it before anybody points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...dataset.assets.asset import Asset
from ...errors import UniSGError
from ...geometry.arrays import Bools, Floats
from ...geometry.polygon import outside_distance
from ...scene import SceneGraph
from ...spatial.objects import as_whole, middle_of
from ...spatial.structure import recognise_structure
from ...spatial.structure.structure import Room
from ..check.pose_check import PoseCheck, own_triangles
from ..generator import Generator
from ..observe.facing import front_first
from ..observe.placeable import Placeable
from ..place.growing_scene import GrowingScene, Target
from ..place.instanced_scene import with_instances
from ..propose.requests import Beside, On
from .place_map import PlaceMap, place_map

UNDER, ASIDE = 0.02, 0.05
"""Metres under the ceiling, and outside of the outline, up to which a point is in the room."""


@dataclass(frozen=True)
class Wanted:
    """What is to be placed: a category in any words, in its ``shape``-th form or as the given ``asset``; ``on`` or
    ``beside`` an object of the scene, by uid or name. Its forms are the given ``shapes``, then those of the scene, then
    those of the model."""

    category: str
    shape: int = 0
    asset: Asset | None = None
    on: str = ""
    beside: str = ""
    shapes: Sequence[Asset] = ()


@dataclass(frozen=True, eq=False)
class PlacingRoom:
    """A scene with one thing to place in it; nothing of it changes.

    Attributes
    ----------
    generator
        A generator that knows the thing's category.
    graph, shown, read
        The scene as it was given, with what its instances show, and that in the generator's words.
    wanted, target
        What is to be placed, by its category in the generator's words, and as the generator sees it.
    shapes
        How many shapes of it there are.
    scene
        The room's objects.
    number
        Which of several rooms it is, -1 where there is one only.
    holders
        bool (K,): which objects may hold it.
    note
        What is to be said where none of those that usually hold it is there.
    map, check
        Where the model would put it, and what says what is wrong with a place.
    beside
        Number of the object beside which it is wanted, -1 for none.
    """

    generator: Generator
    graph: SceneGraph
    shown: SceneGraph
    read: SceneGraph
    wanted: Wanted
    target: Target
    shapes: int
    scene: GrowingScene
    number: int
    holders: Bools
    note: str
    map: PlaceMap
    check: PoseCheck
    beside: int = -1

    @staticmethod
    def of(
        generator: Generator, graph: SceneGraph, wanted: Wanted, near: Floats | None = None,
        words: Mapping[str, str] | None = None, seed: int = 0, before: PlacingRoom | None = None,
    ) -> PlacingRoom:  # fmt: skip
        """Look at a scene, which takes a tenth of a second to some.

        Parameters
        ----------
        near
            A point (3,) in the room that is meant, world metres; the largest one without.
        words
            What the user says of words for things.
        before
            A room of the same scene: what is known of that is not looked at again.

        Raises
        ------
        UniSGError
            For a category that nobody knows, a wish for an object that is missing, or a model that is damaged.
        """
        if not wanted.category:
            raise UniSGError("say what is to be placed: give a category")
        (category,) = generator.understood({wanted.category: 1}, words)
        knowing, wanted = generator.knowing([category]), replace(wanted, category=category)
        same = before if before is not None and before.graph is graph else None
        shown = same.shown if same else with_instances(graph)
        alike = same if same and same.generator is knowing else None
        read = alike.read if alike else knowing.seen(shown, words)
        seen = as_whole(as_whole(read, wanted.on), wanted.beside)
        if wanted.on or wanted.beside:
            near = middle_of(seen, wanted.on or wanted.beside)
        number, near = _room(seen, near)
        wishes = wanted.on + wanted.beside + (alike.wanted.on + alike.wanted.beside if alike else "")
        again = alike is not None and alike.number == number and not wishes
        scene = alike.scene if alike and again else GrowingScene(seen, knowing.contract, near, number >= 0)
        rng = np.random.default_rng(seed)
        shape, shapes = _shape(knowing, wanted, seen, rng)
        target = Target(knowing.categories.index(category), shape, True)
        holders, note = scene.holders(target.category)
        beside = scene.find(seen, wanted.beside) if wanted.beside else -1
        if wanted.on:
            usual = scene.tables.usual
            holders, note = On(knowing.proposer, scene.find(seen, wanted.on), usual).holders(scene.observed), ""
        found = place_map(scene, knowing.proposer, target, holders, rng)
        if beside >= 0:
            wish = Beside(knowing.proposer, beside)
            half = target.placeable.half
            found = replace(found, fits=found.fits & [wish.has(scene.observed, half, place) for place in found.places])
        return PlacingRoom(
            knowing, graph, shown, read, wanted, target, shapes, scene, number, holders, note, found,
            same.check if same else PoseCheck.of(read), beside,
        )  # fmt: skip

    @cached_property
    def triangles(self) -> Floats:
        """The triangles (M, 3, 3) of the thing where its asset is, metres."""
        return own_triangles(self.target.placeable)

    @cached_property
    def room(self) -> Room | None:
        """The room as it was recognised, None where none was."""
        rooms = recognise_structure(self.shown).rooms
        return rooms[max(self.number, 0)] if rooms else None

    @property
    def floor(self) -> float:
        """Height of the floor, metres."""
        return 0.0 if self.room is None else self.room.floor

    def inside(self, point: Floats) -> bool:
        """Is a point (3,) within the outline of the room and under its ceiling? Anything is without a room."""
        outline = self.scene.space.outline
        if outline is None:
            return True
        under = self.room is None or point[2] < self.room.ceiling - UNDER
        return bool(under and outside_distance(outline, point[None, :2])[0] < ASIDE)

    def has(self, point: Floats) -> bool:
        """Is a point (3,) in this room, or in none?"""
        return self.number < 0 or recognise_structure(self.shown).room_at(point) in (self.number, -1)


def _room(seen: SceneGraph, near: Floats | None) -> tuple[int, Floats | None]:
    """The room that a point is in, or the largest, and a point in it; -1 where a scene has no two rooms."""
    structure = recognise_structure(seen)
    if len(structure.rooms) <= 1:
        return -1, near
    number = structure.room_at(near) if near is not None else -1
    if number < 0:
        number = max(
            range(len(structure.rooms)), key=lambda one: (structure.rooms[one].indoors, structure.rooms[one].area)
        )
    room = structure.rooms[number]
    return number, np.append(room.inner_point, room.floor)


def _shape(generator: Generator, wanted: Wanted, seen: SceneGraph, rng: np.random.Generator) -> tuple[Placeable, int]:
    """What is given, or one of the shapes that there are, of the scene before those of the model, else a box; and how
    many there are."""
    if wanted.asset is not None:
        return Placeable(replace(wanted.asset, category=wanted.category)), 1
    library = generator.library
    given = [Placeable(front_first(replace(asset, category=wanted.category))) for asset in wanted.shapes]
    there = [*given, *library.of_scene(wanted.category, seen), *library.of_model(wanted.category)]
    shapes = list({shape.asset.key: shape for shape in reversed(there)}.values())[::-1]
    if shapes:
        return shapes[wanted.shape % len(shapes)], len(shapes)
    return library.placeable(generator.categories.index(wanted.category), seen, rng), 1
