"""A room while it is being furnished: places objects, remembers who stands on what, makes the scenegraph."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from ..geometry.arrays import Bools, Floats
from ..geometry.planar import rotation
from ..geometry.polygon import inside
from ..scene.action_data import ActionData
from ..scene.builder import SceneBuilder
from ..scene.graph import SceneGraph
from ..scene.identity import derived_uid
from ..scene.lesson_node import LessonNode
from ..scene.relation import Relation
from .furniture.kit import Furniture
from .furniture.palette import used_by
from .occupancy import Occupancy, Shapes

TRIES = 12
FIRST_TRIES = 3
Value = TypeVar("Value")
Pose = Floats
"""x, y, z in metres and the yaw in radians."""


@dataclass(frozen=True, eq=False)
class Placed:
    """An asset in the room; ``pose`` is (x, y, z, yaw) in the world."""

    number: int
    name: str
    uid: str
    asset: Furniture
    pose: Pose
    parent: Placed | None
    relation: str

    def point(self, x: float, y: float, z: float = 0.0) -> Floats:
        """A point of the asset's frame in the world."""
        return self.pose_at(x, y, z, 0.0)[:3]

    def pose_at(self, x: float, y: float, z: float, yaw: float) -> Pose:
        """A pose in the asset's frame as one in the world."""
        own_x, own_y, own_z, own_yaw = self.pose.tolist()
        cos, sin = math.cos(own_yaw), math.sin(own_yaw)
        return np.array([own_x + cos * x - sin * y, own_y + sin * x + cos * y, own_z + z, own_yaw + yaw])

    def seen(self, pose: Pose) -> Pose:
        """A pose in the world as one in the asset's frame."""
        own_x, own_y, own_z, own_yaw = self.pose.tolist()
        x, y, z, yaw = pose.tolist()
        cos, sin, x, y = math.cos(own_yaw), math.sin(own_yaw), x - own_x, y - own_y
        return np.array([cos * x + sin * y, cos * y - sin * x, z - own_z, yaw - own_yaw])


@dataclass
class Layout:
    """The objects placed so far in a world with a random generator of its own."""

    title: str
    rng: np.random.Generator
    outline: Floats
    objects: list[Placed] = field(default_factory=list)
    taken: Occupancy = field(default_factory=Occupancy)
    _names: Counter[str] = field(default_factory=Counter)

    def add(
        self, asset: Furniture, pose: Sequence[float] | Pose, parent: Placed | None, relation: str = "on_top_of"
    ) -> Placed:
        """Put an asset there without asking."""
        count = self._names[asset.category]
        self._names[asset.category] += 1
        name = f"{asset.category}.{count:03d}" if count else asset.category
        pose = np.asarray(pose, np.float64)
        obj = Placed(len(self.objects), name, derived_uid(self.title, name), asset, pose, parent, relation)
        self.objects.append(obj)
        self.taken.add(asset.shapes, pose, obj.number)
        return obj

    def keep_out(self, size: Sequence[float], pose: Sequence[float] | Pose) -> None:
        """Keep a box free (``size`` x, y, z; ``pose`` of the centre of its bottom)."""
        half = np.array([size]) / 2
        self.taken.add(Shapes(half * np.array([0, 0, 1.0]), half), np.asarray(pose, np.float64), -1)

    def is_clear(self, size: Sequence[float], pose: Sequence[float] | Pose) -> bool:
        """Is a box (``size`` x, y, z; ``pose`` of the centre of its bottom) free, and in the room?"""
        half = np.array([size]) / 2
        poses = np.asarray(pose, np.float64)[None]
        free = self.taken.free(Shapes(half * np.array([0, 0, 1.0]), half), poses)
        return bool(free[0] and inside(self.outline, poses[:, :2])[0])

    def fits(self, asset: Furniture, poses: Floats, parent: Placed, clearance: float = 0.0) -> Bools:
        """At which poses (T, 4) the asset meets nothing and, on the floor, has its middle in the room."""
        indoors = inside(self.outline, poses[:, :2]) if parent.parent is None else None
        return self.taken.free(asset.shapes, poses, ignore=parent.number, clearance=clearance, asked=indoors)

    def place(
        self, asset: Furniture, propose: Callable[[], Sequence[float] | Pose], parent: Placed, *,
        clearance: float = 0.0, relation: str = "on_top_of", tries: int = TRIES,
    ) -> Placed | None:  # fmt: skip
        """Put the asset at the first of some proposed poses where it fits; None if there is none."""
        for count in (FIRST_TRIES, tries - FIRST_TRIES):  # most objects fit at once
            poses = np.array([propose() for _ in range(count)], np.float64)
            for pose in poses[self.fits(asset, poses, parent, clearance)]:
                return self.add(asset, pose, parent, relation)
        return None

    def place_on(
        self, asset: Furniture, support: Placed, surface: str, *, yaw: float | None = None, spread: float = 0.1,
        area: tuple[float, float, float, float] = (0, 0, 1, 1), clearance: float = 0.006, relation: str = "on_top_of",
        tries: int = TRIES,
    ) -> Placed | None:  # fmt: skip
        """Put the asset somewhere on a surface, whole on it.

        ``yaw`` in the support's frame (any when None) with ``spread`` radians of
        untidiness; ``area`` is the part of the surface to use, as shares (x from, y
        from, x to, y to).
        """
        top = support.asset.surfaces[surface]
        if asset.size[2] > top.headroom:
            return None
        for count in (FIRST_TRIES, tries - FIRST_TRIES):
            turns = self.rng.uniform(0, 2 * np.pi, count) if yaw is None else yaw + self.rng.normal(0, spread, count)
            poses = self._poses_on(asset, support, surface, turns, area)
            for pose in poses[self.fits(asset, poses, support, clearance)]:
                return self.add(asset, pose, support, relation)
        return None

    def _poses_on(
        self, asset: Furniture, support: Placed, surface: str, turns: Floats,
        area: tuple[float, float, float, float],
    ) -> Floats:  # fmt: skip
        """Poses somewhere on a part of a surface, one for each turn with which the asset fits on it whole."""
        top, bounds = support.asset.surfaces[surface], asset.mesh.bounds
        half, middle = (bounds[1, :2] - bounds[0, :2]) / 2, (bounds[1, :2] + bounds[0, :2]) / 2
        ways = rotation(turns)[:, :2, :2]
        low, high = (np.array(area[:2]) - 0.5) * top.size, (np.array(area[2:]) - 0.5) * top.size
        room = (high - low) / 2 - np.abs(ways) @ half
        at = (low + high) / 2 + self.rng.uniform(-1, 1, (len(turns), 2)) * room + top.center[:2] - ways @ middle
        x, y, z, yaw = support.pose
        turned = at @ matrix_of(support.pose)[:2, :2].T
        poses = np.column_stack([turned + np.array([x, y]), np.full(len(turns), z + top.center[2]), turns + yaw])
        return poses[(room >= 0).all(axis=1)]

    def named(self, category: str) -> list[Placed]:
        """All objects of a category, in the order in which they were placed."""
        return [obj for obj in self.objects if obj.asset.category == category]

    def build(
        self,
        actions: dict[str, list[ActionData]] | None = None,
        operation: LessonNode | None = None,
        relations: dict[str, list[Relation]] | None = None,
    ) -> SceneGraph:
        """The scenegraph; ``actions`` and further ``relations`` by the uid of the entity that they belong to."""
        builder = SceneBuilder(self.title, used_by(obj.asset.mesh for obj in self.objects))
        for obj in self.objects:
            own = () if obj.parent is None else (Relation(obj.relation, obj.parent.uid),)
            builder.add(
                obj.name,
                uid=obj.uid,
                parent=-1 if obj.parent is None else obj.parent.number,
                local=matrix_of(obj.pose if obj.parent is None else obj.parent.seen(obj.pose)),
                mesh=obj.asset.mesh,
                category=obj.asset.category,
                actions=tuple((actions or {}).get(obj.uid, ())),
                relations=(*own, *(relations or {}).get(obj.uid, ())),
            )
        if operation is not None:
            builder.add("Operation", uid=derived_uid(self.title, "Operation"), lsa=operation)
        return builder.build()


def pick(rng: np.random.Generator, values: Sequence[Value]) -> Value:
    """One of the values, each as likely."""
    return values[int(rng.integers(len(values)))]


def matrix_of(pose: Sequence[float] | Pose) -> Floats:
    """The 4x4 matrix of a pose (x, y, z, yaw)."""
    cos, sin = math.cos(pose[3]), math.sin(pose[3])
    return np.array([[cos, -sin, 0, pose[0]], [sin, cos, 0, pose[1]], [0, 0, 1, pose[2]], [0, 0, 0, 1.0]])


def facing(start: Floats, target: Floats) -> float:
    """The yaw with which an object at ``start`` turns its front (-y) to ``target`` (both (2+,), metres)."""
    return float(np.arctan2(target[0] - start[0], start[1] - target[1]))
