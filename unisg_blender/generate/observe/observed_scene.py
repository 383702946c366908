"""A scene as the models of generation see it: objects as arrays, growing as objects are added."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.boxes import Boxes
from ...spatial.objects import SceneObjects
from ...spatial.support_surfaces import support_surfaces, surface_at
from .placeable import Placeable
from .room_shape import RoomShape

Item = TypeVar("Item")


@dataclass(eq=False)
class ObservedScene:
    """The objects of a scene that is growing, K of them.

    Attributes
    ----------
    category, support
        int64 (K,): number in the model's vocabulary (-1 for others), and the object that holds it (-1: none).
    world
        (K, 4, 4): matrices of the objects' entities in the world.
    center, half, yaw
        (K, 3), (K, 3), (K,): the upright boxes, as in :class:`~...spatial.objects.SceneObjects`.
    surface
        int64 (K,): which of its support's surfaces each stands on, -1 for none of them.
    parts
        Gives the world boxes of an object's parts by its number.
    """

    category: Ints
    support: Ints
    world: Floats
    center: Floats
    half: Floats
    yaw: Floats
    surface: Ints
    parts: Callable[[int], Boxes]
    _surfaces: dict[int, Floats] = field(default_factory=dict)
    _placeables: dict[int, Placeable] = field(default_factory=dict)
    _kept: dict[str, Any] = field(default_factory=dict)

    @staticmethod
    def of(objects: SceneObjects, world: Floats) -> ObservedScene:
        """The scene of some objects whose entities have ``world`` (K, 4, 4) matrices."""
        none = np.full(len(objects), -1, np.int64)
        scene = ObservedScene(
            objects.category, objects.support, world, objects.center, objects.half, objects.yaw, none, objects.parts_of
        )
        held = np.flatnonzero(objects.support >= 0)
        none[held] = [scene.surface_of(objects.bottom[obj], objects.support[obj]) for obj in held]
        return scene

    def part(self, kept: Bools) -> ObservedScene:
        """The scene with some objects only, bool (K,); what stood on others stands on nothing."""
        rows = np.flatnonzero(kept)
        number = np.append(np.where(kept, np.cumsum(kept) - 1, -1), -1)
        parts = self.parts
        return ObservedScene(
            self.category[rows], number[self.support[rows]], self.world[rows], self.center[rows], self.half[rows],
            self.yaw[rows], self.surface[rows], lambda obj: parts(int(rows[obj])),
        )  # fmt: skip

    @property
    def room(self) -> RoomShape:
        """The room around the objects."""
        return self.kept("room", lambda: RoomShape.of(self.support, self.center, self.half, self.yaw))

    def kept(self, name: str, make: Callable[[], Item]) -> Item:
        """Something of the scene as it is, made once until something is added."""
        if name not in self._kept:
            self._kept[name] = make()
        item: Item = self._kept[name]
        return item

    @property
    def local(self) -> Floats:
        """Matrices (K, 4, 4) relative to the objects' supports."""
        return relative(self.world, self.support)

    def surfaces(self, obj: int) -> Floats:
        """The surfaces of an object, see :func:`~...spatial.support_surfaces.support_surfaces`."""
        if obj in self._placeables:
            return self._placeables[obj].surfaces
        if obj not in self._surfaces:
            bottom = float(self.center[obj, 2] - self.half[obj, 2])
            self._surfaces[obj] = support_surfaces(self.parts(obj), bottom)
        return self._surfaces[obj]

    def surface_of(self, bottom: float, support: int) -> int:
        """Which surface of a support carries something whose bottom is at a height, metres; -1 for none."""
        return surface_at(self.surfaces(support), bottom - (self.center[support, 2] - self.half[support, 2]))

    def add(self, category: int, support: int, world: Floats, placeable: Placeable, place: Floats) -> int:
        """A further object at a place (4,); returns its number."""
        number = len(self.category)
        self._kept.clear()
        center = place[:3] + np.array([0, 0, placeable.half[2]])
        surface = self.surface_of(float(place[2]), support) if support >= 0 else -1
        self.category = np.append(self.category, category)
        self.support = np.append(self.support, support)
        self.surface = np.append(self.surface, surface)
        self.world = np.concatenate([self.world, world[None]])
        self.center = np.concatenate([self.center, center[None]])
        self.half = np.concatenate([self.half, placeable.half[None]])
        self.yaw = np.append(self.yaw, place[3])
        self._placeables[number] = placeable
        return number


def relative(world: Floats, support: Ints) -> Floats:
    """Matrices (K, 4, 4) relative to those of the supports (int (K,), -1 for the world)."""
    local, held = world.copy(), np.flatnonzero(support >= 0)
    local[held] = within(world[support[held]], world[held])
    return local


def within(above: Floats, world: Floats) -> Floats:
    """Affine matrices (..., 4, 4) relative to those above them (..., 4, 4).

    By cofactors: a linear algebra library wakes all its threads for every 4 x 4 matrix.
    Above something scaled to nothing only where it is counts.
    """
    a, b, c, d, e, f, g, h, i = np.moveaxis(above[..., :3, :3], (-2, -1), (0, 1)).reshape(9, *above.shape[:-2])
    cofactors = [e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g, c * d - a * f,
                 d * h - e * g, b * g - a * h, a * e - b * d]  # fmt: skip
    volume = np.asarray(a * cofactors[0] + b * cofactors[3] + c * cofactors[6])[..., None, None]
    flat = volume == 0
    inverse = np.stack(cofactors, axis=-1).reshape(*above.shape[:-2], 3, 3) / np.where(flat, 1.0, volume)
    local = world.copy()
    local[..., :3, 3] -= above[..., :3, 3]
    local[..., :3, :] = np.where(flat, local[..., :3, :], inverse @ local[..., :3, :])
    return local
