"""Houses of ProcTHOR as scenegraphs of boxes: rooms, walls, doors, windows, and what stands in them.

A file has a house a line (JSON, perhaps gzipped); beside it lies ``asset-database.json`` with the sizes of the assets.
Made in Unity (left-handed, y up, metres): their point (x, y, z) is (x, z, y) here. Every object is one box: the meshes
are not public. Deitke et al., "ProcTHOR: Large-Scale Embodied AI Using Procedural Generation", 2022.
"""

from __future__ import annotations

import gzip
import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..scene import SceneBuilder, SceneGraph, mesh_from_faces

DATABASE = "asset-database.json"
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
THICK, SLAB = 0.04, 0.1
"""Metres: walls, that are sheets there, and floors."""

EXTERIOR = "exterior"

Array = NDArray[np.float64]


def read_houses(path: Path) -> Iterator[tuple[str, SceneGraph]]:
    """The houses of a file, each with the types of its rooms ("Kitchen", "Bedroom+Bathroom").

    Raises
    ------
    UniSGError
        If a file cannot be read, is damaged, or the sizes of the assets are missing.
    """
    try:
        assets = json.loads(path.with_name(DATABASE).read_text(encoding="utf-8"))
        sizes = {each["assetId"]: each for group in assets.values() for each in group}
        with gzip.open(path, "rt", encoding="utf-8") if path.suffix == ".gz" else path.open(encoding="utf-8") as lines:
            for number, line in enumerate(lines):
                record = json.loads(line)
                kinds = "+".join(sorted({room["roomType"] for room in record["rooms"]}))
                yield kinds, _House(record, sizes, f"{path.name.split('.')[0]}-{number:03d}").graph()
    except (OSError, EOFError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise UniSGError(f"cannot read {path} as houses of ProcTHOR: {error}") from None


class _House:
    def __init__(self, record: Mapping[str, Any], sizes: Mapping[str, Any], title: str) -> None:
        self.record, self.sizes, self.builder = record, sizes, SceneBuilder(title)
        self.counts: dict[str, int] = {}

    def graph(self) -> SceneGraph:
        """All of the house."""
        for room in self.record["rooms"]:
            self._floor(room)
        for wall in self.record["walls"]:
            if EXTERIOR not in wall["id"]:
                self._wall(wall)
        for kind in ("doors", "windows"):
            for opening in self.record[kind]:
                self._opening(opening, kind[:-1].capitalize())
        for item in self.record["objects"]:
            self._item(item, -1, np.eye(4))
        return self.builder.build()

    def _add(self, category: str, points: Array, faces: list[list[int]], pose: Array, parent: int = -1) -> int:
        self.counts[category] = number = self.counts.get(category, -1) + 1
        name = f"{category}.{number:03d}" if number else category
        mesh = mesh_from_faces(name, points, faces)
        return self.builder.add(name, uid=name, parent=parent, local=pose, mesh=mesh, category=category)

    def _floor(self, room: Mapping[str, Any]) -> None:
        outline = np.array([_point(corner)[:2] for corner in room["floorPolygon"]])
        before = np.roll(outline, 1, axis=0)
        if (before[:, 0] * outline[:, 1] - before[:, 1] * outline[:, 0]).sum() < 0:
            outline = outline[::-1]
        count, steps = len(outline), np.arange(len(outline))
        points = np.concatenate([np.column_stack([outline, np.full(count, height)]) for height in (-SLAB, 0.0)])
        sides = np.stack([steps, (steps + 1) % count, count + (steps + 1) % count, count + steps], axis=1)
        self._add("Floor", points, [steps[::-1].tolist(), (count + steps).tolist(), *sides.tolist()], np.eye(4))

    def _wall(self, wall: Mapping[str, Any]) -> None:
        points = np.array([_point(corner) for corner in wall["polygon"]])
        pose, length = _along(points[0], points[1])
        middle = np.mean([_point(corner) for corner in self._room(wall["roomId"])["floorPolygon"]], axis=0)
        outward = -np.sign((middle - points[0]) @ pose[:3, 1]) or 1.0
        self._slab("Wall", pose, (0.0, length), (0.0, float(np.ptp(points[:, 2]))), outward * THICK / 2)

    def _opening(self, opening: Mapping[str, Any], category: str) -> None:
        wall = next(wall for wall in self.record["walls"] if wall["id"] == opening["wall0"])
        points = np.array([_point(corner) for corner in wall["polygon"]])
        hole = opening["holePolygon"]
        across, upright = sorted(corner["x"] for corner in hole), sorted(corner["y"] for corner in hole)
        pose = _along(points[0], points[1])[0]
        self._slab(category, pose, (across[0], across[-1]), (upright[0], upright[-1]), 0.0, 1.5)

    def _slab(
        self,
        category: str,
        pose: Array,
        along: tuple[float, float],
        up: tuple[float, float],
        out: float,
        wide: float = 1,
    ) -> None:
        """A box along a wall whose frame is ``pose``: x along it, y through it, z up."""
        pose = pose.copy()
        pose[:3, 3] += pose[:3, :3] @ np.array([sum(along) / 2, out, up[0]])
        size = np.array([along[1] - along[0], THICK * wide, up[1] - up[0]])
        self._add(category, _corners(size), FACES, pose)

    def _room(self, key: str) -> Mapping[str, Any]:
        return next(room for room in self.record["rooms"] if room["id"] == key)

    def _item(self, item: Mapping[str, Any], parent: int, above: Array) -> None:
        """An object and, under it, what it holds; what the database does not know is left out."""
        asset = self.sizes.get(item["assetId"])
        if asset is not None:
            size = np.maximum(_point(asset["boundingBox"]), 1e-3)
            world = np.eye(4)
            world[:3, :3], world[:3, 3] = _turn(item["rotation"]), _point(item["position"])
            category = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", asset["objectType"])
            points = _corners(size) - (0, 0, size[2] / 2)
            parent = self._add(category, points, FACES, np.linalg.inv(above) @ world, parent)
            above = world
        for child in item.get("children") or ():
            self._item(child, parent, above)


def _point(record: Mapping[str, float]) -> Array:
    return np.array([record["x"], record["z"], record["y"]], np.float64)


def _along(start: Array, stop: Array) -> tuple[Array, float]:
    """The frame (4, 4) at the start of a wall, and its length."""
    step = stop - start
    length = float(np.hypot(*step[:2]))
    if not length:
        raise ValueError("a wall has no length")
    (x, y), pose = step[:2] / length, np.eye(4)
    pose[:2, :2], pose[:3, 3] = [[x, -y], [y, x]], (*start[:2], 0.0)
    return pose, length


def _corners(size: Array) -> Array:
    """Corners (8, 3) of a box that stands on the origin."""
    signs = np.stack(np.meshgrid([-1, 1], [-1, 1], [0, 2], indexing="ij"), axis=-1).reshape(-1, 3)
    return np.asarray(signs * size / 2)


def _turn(degrees: Mapping[str, float]) -> Array:
    """The rotation (3, 3) of Unity's Euler angles, R = Ry Rx Rz, seen in our axes."""
    turns = []
    for axis in "yxz":
        cos, sin = np.cos(np.radians(degrees[axis])), np.sin(np.radians(degrees[axis]))
        first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        turn = np.eye(3)
        turn[first, first], turn[second, second], turn[first, second], turn[second, first] = cos, cos, -sin, sin
        turns.append(turn)
    swap = np.eye(3)[[0, 2, 1]]
    return np.asarray(swap @ turns[0] @ turns[1] @ turns[2] @ swap)
