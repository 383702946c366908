"""Layouts of InternScenes (``layout.json``): boxes with nine numbers, middle, size and three angles.

Right-handed, z up, metres; the angles are radians about z, x and y, R = Rz Rx Ry, of a thing whose front is +x. Meshes
are those of ``model_uid``, stretched to the box. Walls and floors are a mesh of their own there. Zhong et al.,
"InternScenes", 2025.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...scene import Mesh, SceneGraph
from ..axes import Array, axis_turn, euler_turn, numbers, pose
from ..layout_file import LayoutFile
from ..mesh_parts import moved
from ..room_builder import RoomBuilder

NAME = "InternScenes layout"
LICENCE = "CC-BY-NC-SA-4.0"
STRUCTURE = {"floor": "Floor", "wall": "Wall", "ceiling": "Ceiling", "door": "Door", "window": "Window"}


def recognises(data: Any) -> bool:
    """Whether it is a list of things with a model and nine numbers."""
    return (
        isinstance(data, list) and bool(data) and isinstance(data[0], dict) and {"bbox", "model_uid"} <= data[0].keys()
    )


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The room."""
    builder = RoomBuilder(file.title)
    for item in file.data:
        box = numbers(item["bbox"], 9)
        local, size = pose(box[:3], euler_turn("zxy", box[6:])), box[3:6]
        mesh = file.assets.mesh(str(item["model_uid"])) if file.assets.named and item["model_uid"] else None
        shape = builder.box_mesh(item["category"], size, -0.5) if mesh is None else _stretched(mesh, item, size)
        category = STRUCTURE.get(item["category"], item["category"])
        others = {"asset": item["model_uid"]} if item["model_uid"] else None
        builder.add(category, local, shape, uid=str(item["id"]), others=others)
    file.report.add("", "walls, floors and what stands on what are not told")
    yield builder.build()


def _stretched(mesh: Mesh, item: Any, size: Array) -> Mesh:
    """An asset with its front along +x, its middle at the origin, as large as the box."""
    quarter = 2 if str(item["model_uid"]).startswith("partnet_mobility") else 1
    turned = moved(mesh, pose((0, 0, 0), axis_turn("z", quarter * np.pi / 2)))
    own = np.maximum(np.ptp(turned.bounds, axis=0), 1e-6)
    change = np.diag([*(size / own), 1.0]) @ pose(-turned.bounds.mean(axis=0))
    return moved(turned, change)
