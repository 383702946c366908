"""Houses of 3D-FRONT: rooms whose children are furniture by reference, and walls, floors and the like as meshes within.

Right-handed, y up, metres, as in the .obj of 3D-FUTURE; quaternions are x y z w. Furniture is the mesh of its ``jid``
(a folder with ``raw_model.obj``), else a box as large as its ``size`` or ``bbox``, which stands on its place. Which
room something is in is kept; what stands on what is not told. 3D-FRONT-FUTURE/3D-FRONT-ToolBox, ``scripts/scene.py``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...scene import Mesh, SceneGraph, mesh_from_faces
from ..axes import Y_UP, Array, numbers, point_rows, pose, quaternion_turn, seen_from
from ..layout_file import LayoutFile, has_lists
from ..room_builder import RoomBuilder

NAME = "3D-FRONT house"
LICENCE = "3D-FRONT terms of use (non-commercial)"
CATEGORIES = {
    "floor": "Floor", "ceiling": "Ceiling", "wall": "Wall", "door": "Door", "window": "Window", "column": "Column",
    "stair": "Stairs",
}  # fmt: skip
"""Words in the types of meshes, and what they are here; the first that is found counts."""


def recognises(data: Any) -> bool:
    """Whether it has furniture, meshes, and rooms of a scene."""
    return has_lists(data, "furniture", "mesh") and isinstance(data.get("scene"), dict) and "room" in data["scene"]


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The house."""
    builder = RoomBuilder(file.title)
    furniture = {item["uid"]: item for item in file.data["furniture"]}
    meshes = {item["uid"]: item for item in file.data["mesh"]}
    shapes: dict[str, Mesh | None] = {}
    for room in file.data["scene"]["room"]:
        for child in room["children"]:
            key, others = (
                child["ref"],
                {"room": str(room.get("instanceid", "")), "room_type": str(room.get("type", ""))},
            )
            uid = str(child.get("instanceid", key))
            matrix = _placed(child)
            if key in meshes:
                local = seen_from(Y_UP, matrix)
                if key not in shapes:
                    shapes[key] = _inline(meshes[key])
                kind = str(meshes[key].get("type", ""))
                builder.add(_category(kind), local, shapes[key], uid=uid, name=kind or "Mesh", others=others)
            elif key in furniture:
                item = furniture[key]
                if key not in shapes:
                    shapes[key] = _furniture(file, builder, item)
                if shapes[key] is None:
                    file.report.add(str(item.get("jid", key)), "its size is not told: it is left out (--assets FOLDER)")
                    continue
                name = str(item.get("category") or item.get("title") or "Furniture").rpartition("/")[2]
                asset = {"asset": str(item.get("jid", ""))}
                builder.add(name, seen_from(Y_UP, matrix), shapes[key], uid=uid, others=others | asset)
    file.report.add("", "materials and what stands on what are not told")
    yield builder.build()


def _placed(child: Mapping[str, Any]) -> Array:
    x, y, z, w = numbers(child.get("rot") or (0, 0, 0, 1), 4)
    return pose(child.get("pos") or (0, 0, 0), quaternion_turn(w, x, y, z), child.get("scale") or (1, 1, 1))


def _inline(item: Mapping[str, Any]) -> Mesh:
    """A mesh of the file, in our frame."""
    corners = point_rows(item["xyz"]) @ Y_UP[:3, :3].T
    faces = np.asarray(item["faces"], np.int64).reshape(-1, 3)
    if len(faces) and not 0 <= faces.min() <= faces.max() < len(corners):
        raise ValueError(f"the mesh {item['uid']!r} has faces of points that it does not have")
    return mesh_from_faces(str(item.get("type", "Mesh")), corners, faces)


def _furniture(file: LayoutFile, builder: RoomBuilder, item: Mapping[str, Any]) -> Mesh | None:
    mesh = file.assets.mesh(f"{item.get('jid', '')}/raw_model", str(item.get("jid", ""))) if file.assets.named else None
    size = item.get("size") or item.get("bbox")
    if mesh is not None or not size:
        return mesh
    return builder.box_mesh(str(item.get("category", "Furniture")), numbers(size, 3)[[0, 2, 1]], 0.0)


def _category(kind: str) -> str:
    return next((name for word, name in CATEGORIES.items() if word in kind.lower()), "")
