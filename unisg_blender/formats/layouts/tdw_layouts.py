"""Layouts of ThreeDWorld's floor plans: poses of models, whose sizes are in ``models_core.json`` beside the file.

Unity (left-handed, y up, metres); a position is that of the bottom's middle. What stands on what is not told. Gan et
al., "ThreeDWorld: A Platform for Interactive Multi-Modal Physical Simulation", 2021.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...errors import UniSGError
from ...scene import SceneGraph
from ..axes import Array, pose, unity_point, unity_turn
from ..layout_file import LayoutFile
from ..room_builder import RoomBuilder

NAME = "TDW layouts"
LICENCE = "BSD-2-Clause"
MODELS = "models_core.json"
SIDES = ("left", "right", "front", "back", "bottom", "top")


def recognises(data: Any) -> bool:
    """Whether it has plans, of layouts, of models with a scale."""
    plan = next(iter(data.values()), None) if isinstance(data, dict) else None
    layout = next(iter(plan.values()), None) if isinstance(plan, dict) else None
    return isinstance(layout, list) and bool(layout) and isinstance(layout[0], dict) and "scale_factor" in layout[0]


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """Each layout of each plan."""
    models = file.assets.at(MODELS)
    if models is None:
        raise UniSGError(f"nothing says how large its models are: put {MODELS} beside it, or into --assets FOLDER")
    records = json.loads(models.read_text(encoding="utf-8"))["records"]
    for plan, layouts in file.data.items():
        for layout, objects in layouts.items():
            builder = RoomBuilder(f"TDW {plan}-{layout}")
            for number, item in enumerate(objects):
                model = records.get(item["name"])
                if model is None:
                    file.report.add(item["name"], f"it is not in {MODELS}: it is left out")
                    continue
                size = _size(model) * unity_point(item["scale_factor"])
                local = pose(unity_point(item["position"]), unity_turn(item["rotation"]))
                builder.box(model["wcategory"] or item["name"], size, local, uid=str(number))
            file.report.add("", "floor, walls and what stands on what are not told")
            yield builder.build()


def _size(model: Mapping[str, Any]) -> Array:
    sides = [unity_point(model["bounds"][side]) for side in SIDES]
    return np.asarray(np.max(sides, axis=0) - np.min(sides, axis=0))
