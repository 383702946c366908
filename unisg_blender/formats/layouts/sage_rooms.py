"""Rooms of SAGE: walls, doors, windows, and objects with their sizes, masses and what they stand on (``place_id``).

Right-handed, z up, metres; a position is that of the bottom's middle, in the frame of the whole floor plan; angles are
degrees about the fixed axes x, y, z. Meshes are ``<source_id>``. NVlabs/sage, ``server/models.py``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...scene import SceneGraph
from ..axes import Array, fixed_turn, numbers, pose
from ..layout_file import LayoutFile, has_lists
from ..mesh_parts import fitted
from ..room_builder import RoomBuilder

NAME = "SAGE rooms"
LICENCE = "Apache-2.0 (its code; of the rooms: as their publisher says)"


def recognises(data: Any) -> bool:
    """Whether it is a plan of rooms with walls and objects, or one room."""
    rooms = _rooms(data)
    return bool(rooms) and all(has_lists(room, "walls", "objects") and "dimensions" in room for room in rooms)


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The floor plan."""
    builder = RoomBuilder(file.title)
    for room in _rooms(file.data):
        frames = _building(builder, room)
        for kind in ("door", "window"):
            for opening in room.get(f"{kind}s") or ():
                if opening["wall_id"] not in frames:
                    file.report.add(str(opening["id"]), "its wall is not in the room: it is left out")
                    continue
                _opening(builder, opening, kind, *frames[opening["wall_id"]])
        for item in room["objects"]:
            _object(file, builder, item)
            _support(builder, item, room)
    yield builder.build()


def _rooms(data: Any) -> list[Mapping[str, Any]]:
    if has_lists(data, "rooms"):
        return [room for room in data["rooms"] if isinstance(room, dict)]
    return [data] if has_lists(data, "walls", "objects") and "room_type" in data else []


def _building(builder: RoomBuilder, room: Mapping[str, Any]) -> dict[str, tuple[Array, float, float]]:
    """The floor and the walls; returns frame, length and thickness of each wall."""
    walls = room["walls"]
    ends = {wall["id"]: [_point(wall["start_point"]), _point(wall["end_point"])] for wall in walls}
    corner, size = _point(room["position"]), room["dimensions"]
    x, y = float(size["width"]), float(size["length"])
    outline = corner + np.array([[0, 0, 0], [x, 0, 0], [x, y, 0], [0, y, 0]])
    others = {"room_type": room["room_type"]}
    builder.floor(outline, uid=str(room["id"]), others=others)
    frames = {}
    for wall in walls:
        start, stop = ends[wall["id"]]
        thick = float(wall.get("thickness", 0.1))
        frame = builder.wall(start, stop, float(wall["height"]), thick, uid=str(wall["id"]))
        frames[wall["id"]] = frame, float(np.hypot(*(stop - start)[:2])), thick
    return frames


def _opening(
    builder: RoomBuilder, opening: Mapping[str, Any], kind: str, frame: Array, length: float, thick: float
) -> None:
    """A door or a window, whose middle is told as a share of the wall's length."""
    middle, half = float(opening["position_on_wall"]) * length, float(opening["width"]) / 2
    low = float(opening.get("sill_height", 0.0))
    up = (low, low + float(opening["height"]))
    builder.in_wall(kind.capitalize(), frame, (middle - half, middle + half), up, 1.5 * thick, uid=str(opening["id"]))


def _object(file: LayoutFile, builder: RoomBuilder, item: Mapping[str, Any]) -> None:
    """An object as its mesh, if that is there, else as a box."""
    size = numbers([item["dimensions"][key] for key in ("width", "length", "height")], 3)
    turn = fixed_turn(*np.radians(_point(item["rotation"])))
    mesh = file.assets.mesh(str(item["source_id"])) if file.assets.named else None
    shape = builder.box_mesh(item["type"], size, 0.0) if mesh is None else fitted(mesh, size)
    others = {"asset": str(item["source_id"]), "mass": float(item.get("mass", 1.0))}
    builder.add(item["type"], pose(_point(item["position"]), turn), shape, uid=str(item["id"]), others=others)


def _support(builder: RoomBuilder, item: Mapping[str, Any], room: Mapping[str, Any]) -> None:
    """What an object stands on, or which wall it hangs from."""
    place, walls = str(item.get("place_id") or ""), {str(wall["id"]) for wall in room["walls"]}
    if place == "floor":
        place = str(room["id"])
    builder.relate(str(item["id"]), "hangs_from" if place in walls else "on_top_of", place)


def _point(record: Mapping[str, float]) -> Array:
    return numbers([record["x"], record["y"], record["z"]], 3)
