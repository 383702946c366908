"""Rooms in the representation of ReSpace (SSR; SSR-3DFRONT): an outline, and objects by description, size and place.

Right-handed, y up, metres; a position is that of the bottom's middle; quaternions are x y z w. Meshes are
``sampled_asset_jid`` or ``jid``, of 3D-FUTURE. There are no categories: a description is kept as it is. Doors, windows
and what stands on what are not told. GradientSpaces/respace.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...scene import SceneGraph
from ..axes import Y_UP, numbers, pose, quaternion_turn, seen_from
from ..layout_file import LayoutFile, has_lists
from ..mesh_parts import fitted
from ..room_builder import RoomBuilder

NAME = "SSR room"
LICENCE = "CC-BY-NC-4.0 (as 3D-FRONT, for research)"


def recognises(data: Any) -> bool:
    """Whether it has an outline above and below, and objects."""
    return has_lists(data, "bounds_top", "bounds_bottom", "objects")


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The room."""
    builder = RoomBuilder(file.title)
    low, high = (
        np.array([numbers(point, 3) for point in file.data[key]]) @ Y_UP[:3, :3].T
        for key in ("bounds_bottom", "bounds_top")
    )
    builder.floor(low, others={"room_type": str(file.data.get("room_type", ""))})
    middle, height = low.mean(axis=0), float(high[:, 2].max() - low[:, 2].min())
    for start, stop in zip(low, np.roll(low, -1, axis=0), strict=True):
        builder.wall(start, stop, height, inside=middle)
    for number, item in enumerate(file.data["objects"]):
        x, y, z, w = numbers(item["rot"], 4)
        turn = quaternion_turn(w, x, y, z) if np.abs([w, x, y, z]).any() else np.eye(3)
        local, size = seen_from(Y_UP, pose(item["pos"], turn)), numbers(item["size"], 3)[[0, 2, 1]]
        asset = str(item.get("sampled_asset_jid") or item.get("jid") or "")
        mesh = file.assets.mesh(asset, asset.partition("-(")[0]) if file.assets.named and asset else None
        text = str(item.get("desc", ""))
        others = {"asset": asset, "description": text}
        name = str(item.get("prompt") or text.rstrip(".").partition(",")[0])[:60] or "Object"
        shape = builder.box_mesh(name, size, 0.0) if mesh is None else fitted(mesh, size)
        builder.add("", local, shape, name=name, uid=str(item.get("uuid") or f"object {number}"), others=others)
    file.report.add("", "categories, doors, windows and what stands on what are not told")
    yield builder.build()
