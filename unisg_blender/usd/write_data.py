"""Cameras, lights and visibility in USD's standard schemas, for other tools.

The component tables keep Blender's exact numbers beside them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from ..scene import components
from ..scene.graph import SceneGraph, Table
from .names import Identifiers
from .specs import Types, apply_schema, attribute, define

Values = Mapping[str, Any]
MILLIMETRE = 0.01
"""USD gives lens and sensor in tenths of a scene unit, here of a metre."""


def write_camera(prim: Any, identifiers: Identifiers, found: Table | None, row: int) -> str:
    """A Camera under the entity's prim; the entity type that it shows."""
    values = _entry(found, row)
    camera = define(prim, identifiers.take(prim.name), "Camera")
    if not values:
        return "CAMERA"
    ortho = values["kind"] == "ORTHO"
    attribute(camera, "projection", Types.Token, "orthographic" if ortho else "perspective")
    width, height = values["sensor_width"] * MILLIMETRE, values["sensor_height"] * MILLIMETRE
    if ortho:
        width = height = values["ortho_scale"] * 10.0
    largest = max(width, height)
    for name, value in (
        ("focalLength", values["lens"] * MILLIMETRE),
        ("horizontalAperture", width),
        ("verticalAperture", height),
        ("horizontalApertureOffset", values["shift_x"] * largest),
        ("verticalApertureOffset", values["shift_y"] * largest),
    ):
        attribute(camera, name, Types.Float, float(value), uniform=False)
    clip = (float(values["clip_start"]), float(values["clip_end"]))
    attribute(camera, "clippingRange", Types.Float2, clip, uniform=False)
    return "CAMERA"


def write_light(prim: Any, identifiers: Identifiers, found: Table | None, row: int) -> str:
    """A light under the entity's prim; the entity type that it shows."""
    values = _entry(found, row)
    kind, numbers = _light_form(values)
    light = define(prim, identifiers.take(prim.name), kind)
    if not values:
        return "LIGHT"
    attribute(light, "inputs:color", Types.Color3f, tuple(map(float, values["color"])), uniform=False)
    for name, value in numbers.items():
        attribute(light, f"inputs:{name}", Types.Float, float(value), uniform=False)
    attribute(light, "inputs:normalize", Types.Bool, True, uniform=False)
    if values["kind"] == "SPOT":
        apply_schema(light, "ShapingAPI")
    return "LIGHT"


def _light_form(values: Values) -> tuple[str, dict[str, float]]:
    """The USD light type and its inputs; watts spread over pi as USD's normalised lights do."""
    kind = values.get("kind", "POINT")
    if not values:
        return "SphereLight", {}
    if kind == "SUN":
        return "DistantLight", {"intensity": values["energy"], "angle": math.degrees(values["angle"])}
    power = {"intensity": values["energy"] / math.pi}
    if kind == "AREA" and values["shape"] in ("DISK", "ELLIPSE"):
        return "DiskLight", power | {"radius": values["size"] / 2}
    if kind == "AREA":
        height = values["size_y"] if values["shape"] == "RECTANGLE" else values["size"]
        return "RectLight", power | {"width": values["size"], "height": height}
    sphere = power | {"radius": values["radius"]}
    if kind == "SPOT":
        cone = {
            "shaping:cone:angle": math.degrees(values["spot_size"]) / 2,
            "shaping:cone:softness": values["spot_blend"],
        }
        return "SphereLight", sphere | cone
    return "SphereLight", sphere


def write_visibility(prims: Sequence[Any], graph: SceneGraph) -> None:
    """Hide in USD what is hidden by itself; USD hides everything below as well, Blender does not."""
    found = graph.components.get(components.VISIBILITY)
    if found is None:
        return
    parents = set(graph.parent.tolist())
    for row, hidden in zip(found.rows.tolist(), found.columns["hidden"] | found.columns["viewport"], strict=True):
        if hidden and row not in parents:
            attribute(prims[row], "visibility", Types.Token, "invisible", uniform=False)


def _entry(found: Table | None, row: int) -> Values:
    values = {} if found is None else found.of(row)
    return {name: column[0] for name, column in values.items() if len(column)}
