"""Houses of ProcTHOR, AI2-THOR and Holodeck: rooms, walls, doors, windows, and what stands in them.

Sizes are in ``asset-database.json``, beside the file or in the folder of assets; houses of Holodeck tell those of what
stands on the floor. Made in Unity (left-handed, y up, metres); a position is that of the box's middle. What holds
what: the objects that an object has as ``children``. Deitke et al., "ProcTHOR: Large-Scale Embodied AI Using
Procedural Generation", 2022; Yang et al., "Holodeck", 2024.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import UniSGError
from ...scene import SceneGraph
from ..axes import Array, pose, rigid_inverse, unity_point, unity_turn
from ..layout_file import LayoutFile, has_lists
from ..mesh_parts import moved
from ..room_builder import SHEET, RoomBuilder, wall_frame
from .category_words import without_number, words

NAME = "ProcTHOR house"
LICENCE = "Apache-2.0 (ProcTHOR-10k; of other houses: as their publisher says)"
DATABASE = "asset-database.json"
EXTERIOR = "exterior"
RESTING = 0.05
"""Metres by which an object may be sunk into what holds it and still be on top of it."""


def recognises(data: Any) -> bool:
    """Whether it has rooms with polygons as floors, walls and objects."""
    return has_lists(data, "rooms", "walls", "objects") and all("floorPolygon" in room for room in data["rooms"])


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The house of a text."""
    yield _House(file).graph()


def room_types(graph: SceneGraph) -> str:
    """The types of a house's rooms ("Kitchen", "Bedroom+Bathroom")."""
    said = (json.loads(text) for _, text in graph.entries("properties", "json"))
    return "+".join(sorted({record["room_type"] for record in said if "room_type" in record}))


@lru_cache(maxsize=4)
def _sizes(path: Path) -> dict[str, Any]:
    groups = json.loads(path.read_text(encoding="utf-8"))
    return {each["assetId"]: each for group in groups.values() for each in group}


class _House:
    def __init__(self, file: LayoutFile) -> None:
        self.file, self.record, self.builder = file, file.data, RoomBuilder(file.title)
        database = file.assets.at(DATABASE)
        self.sizes = {} if database is None else _sizes(database)
        self.walls = {wall["id"]: wall for wall in self.record["walls"]}
        self.rooms = {room["id"]: room for room in self.record["rooms"]}

    def graph(self) -> SceneGraph:
        """All of the house; UniSGError if nothing says how large things are."""
        for room in self.record["rooms"]:
            outline = np.array([unity_point(corner) for corner in room["floorPolygon"]])
            self.builder.floor(outline, uid=room["id"], others={"room_type": room["roomType"]})
        for wall in self.record["walls"]:
            if EXTERIOR not in wall["id"]:
                self._wall(wall)
        for kind in ("doors", "windows"):
            for opening in self.record.get(kind) or ():
                self._opening(opening, kind[:-1].capitalize())
        missing = sum(self._item(item, -1, np.eye(4), None) for item in self.record["objects"])
        if missing and not self.sizes:
            raise UniSGError(f"no size of its things is known: put {DATABASE} beside it, or into --assets")
        return self.builder.build()

    def _wall(self, wall: Mapping[str, Any]) -> None:
        points = np.array([unity_point(corner) for corner in wall["polygon"]])
        middle = np.mean([unity_point(corner) for corner in self.rooms[wall["roomId"]]["floorPolygon"]], axis=0)
        start, stop = _ends(points)
        self.builder.wall(start, stop, float(np.ptp(points[:, 2])), inside=middle, uid=wall["id"])

    def _opening(self, opening: Mapping[str, Any], category: str) -> None:
        wall = self.walls.get(opening["wall0"])
        if wall is None:
            self.file.report.add(str(opening["id"]), "its wall is not in the file: it is left out")
            return
        start, stop = _ends(np.array([unity_point(corner) for corner in wall["polygon"]]))
        hole = opening["holePolygon"]
        across, upright = [corner["x"] for corner in hole], [corner["y"] for corner in hole]
        frame, _ = wall_frame(start, stop)
        along, up = (min(across), max(across)), (min(upright), max(upright))
        self.builder.in_wall(category, frame, along, up, 1.5 * SHEET, uid=opening["id"])

    def _item(self, item: Mapping[str, Any], parent: int, above: Array, holder: tuple[str, float] | None) -> int:
        """An object and, under it, what it holds; returns how many have no size and are left out."""
        world = pose(unity_point(item["position"]), unity_turn(item["rotation"]))
        asset, uid, missing = self.sizes.get(item["assetId"]), str(item["id"]), 0
        size = unity_point(asset["boundingBox"]) if asset is not None else _footprint(item, world)
        mesh = self.file.assets.mesh(str(item["assetId"])) if self.file.assets.named else None
        if size is None and mesh is not None:
            size = np.ptp(mesh.bounds, axis=0)
        if size is None:
            self.file.report.add(uid, f"its asset is not in {DATABASE}: it is left out")
            missing = 1
        else:
            category = words(asset["objectType"]) if asset is not None else _called(item)
            shape = self.builder.box_mesh(category, size, -0.5)
            if mesh is not None:
                shape = moved(mesh, pose(-mesh.bounds.mean(axis=0)))
            local, bottom = rigid_inverse(above) @ world, float(world[2, 3] - size[2] / 2)
            others = {"asset": item["assetId"]}
            parent = self.builder.add(category, local, shape, uid=uid, parent=parent, others=others)
            if holder is not None:
                self.builder.relate(uid, "on_top_of" if bottom > holder[1] - RESTING else "inside", holder[0])
            above, holder = world, (uid, float(world[2, 3] + size[2] / 2))
        return missing + sum(self._item(child, parent, above, holder) for child in item.get("children") or ())


def _ends(points: Array) -> tuple[Array, Array]:
    """Where a wall starts and stops on the ground, by the first two corners of its polygon."""
    start, stop = points[0].copy(), points[1].copy()
    start[2] = stop[2] = points[:, 2].min()
    return start, stop


def _footprint(item: Mapping[str, Any], world: Array) -> Array | None:
    """The size of what Holodeck puts on the floor: its corners are in centimetres, its middle at half height."""
    corners = item.get("vertices")
    if not corners or world[2, 3] <= 0:
        return None
    flat = np.column_stack([np.asarray(corners, np.float64)[:, :2] / 100, np.zeros(len(corners))])
    across = np.ptp(flat @ world[:3, :3], axis=0)
    return np.array([across[0], across[1], 2 * world[2, 3]])


def _called(item: Mapping[str, Any]) -> str:
    """What a thing is, by the name that Holodeck gives it, or the first word of its identifier."""
    named = item.get("object_name") or str(item["id"]).partition("|")[0].partition(" (")[0]
    return without_number(words(str(named))) or "Object"
