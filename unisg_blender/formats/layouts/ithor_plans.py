"""AI2-THOR's own account of its objects: floor plans of iTHOR by name, or the metadata of an event.

Boxes are by their corners: oriented ones of what can be moved, axis-aligned ones of the rest; Unity (left-handed, y up,
metres). What holds what: ``parentReceptacles``. Kolve et al., "AI2-THOR: An Interactive 3D Environment", 2017.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ...scene import SceneGraph
from ..layout_file import LayoutFile
from ..room_builder import RoomBuilder, oriented_box, upright_box
from .category_words import words

NAME = "AI2-THOR objects"
LICENCE = "Apache-2.0"
MARKS = ("objectType", "parentReceptacles", "axisAlignedBoundingBox")


def recognises(data: Any) -> bool:
    """Whether its first objects are described as AI2-THOR does."""
    plans = list(_plans(data))
    return bool(plans) and all(_is_plan(objects) for _, objects in plans[:3])


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The floor plans."""
    for name, objects in _plans(file.data):
        yield _plan(file, f"iTHOR {name}" if name else file.title, objects)


def _plans(data: Any) -> Iterator[tuple[str, Sequence[Mapping[str, Any]]]]:
    if isinstance(data, dict) and isinstance(data.get("objects"), list) and "agent" in data:
        yield str(data.get("sceneName", "")), data["objects"]
    elif isinstance(data, dict) and data and all(isinstance(each, list) for each in data.values()):
        yield from data.items()


def _is_plan(objects: Any) -> bool:
    return bool(objects) and isinstance(objects[0], dict) and all(mark in objects[0] for mark in MARKS)


def _plan(file: LayoutFile, title: str, objects: Sequence[Mapping[str, Any]]) -> SceneGraph:
    builder, tops = RoomBuilder(title), dict[str, float]()
    bottoms: dict[str, float] = {}
    for item in objects:
        oriented = item.get("objectOrientedBoundingBox")
        bounds = oriented or item["axisAlignedBoundingBox"]
        corners = np.array(bounds["cornerPoints"], np.float64).reshape(-1, 3)[:, [0, 2, 1]]
        if len(corners) != 8 or not np.isfinite(corners).all():
            file.report.add(str(item["objectId"]), "the file gives no box for it: it is left out")
            continue
        local, size = oriented_box(corners) if oriented else upright_box(corners.min(axis=0), corners.max(axis=0))
        uid = str(item["objectId"])
        builder.box(words(item["objectType"]), size, local, uid=uid)
        bottoms[uid], tops[uid] = corners[:, 2].min(), corners[:, 2].max()
    for item in objects:
        uid = str(item["objectId"])
        for above in item["parentReceptacles"] or ():
            if uid in bottoms and above in tops:
                within = bottoms[uid] < tops[above] - 0.05 and tops[uid] <= tops[above] + 0.05
                builder.relate(uid, "inside" if within else "on_top_of", str(above))
    return builder.build()
