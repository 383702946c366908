"""Cameras, lights and visibility in USD's standard schemas; the component tables keep the rest beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...scene import components
from ...scene.component_table import Table
from ...scene.graph import SceneGraph
from .. import light_units
from ..cameras import camera_attributes
from ..names import Identifiers
from .specs import Types, apply_schema, attribute, define

Values = Mapping[str, Any]
FALLBACK = {
    "exposure": 0.0, "diffuse": 1.0, "specular": 1.0, "colorTemperature": 6500.0, "enableColorTemperature": False,
    light_units.SHADOW: True,
}  # fmt: skip
"""Inputs of lights that are left out where they are what USD takes for granted."""


def write_camera(prim: Any, identifiers: Identifiers, found: Table | None, row: int) -> str:
    """A Camera under the entity's prim; the entity type that it shows."""
    values = _entry(found, row)
    camera = define(prim, identifiers.take(prim.name), "Camera")
    for name, value in camera_attributes(values).items() if values else ():
        if name == "projection":
            attribute(camera, name, Types.Token, value)
        elif name == "clippingRange":
            attribute(camera, name, Types.Float2, tuple(map(float, value)), uniform=False)
        else:
            attribute(camera, name, Types.Float, float(value), uniform=False)
    return "CAMERA"


def write_light(prim: Any, identifiers: Identifiers, found: Table | None, row: int) -> str:
    """A light under the entity's prim; the entity type that it shows."""
    values = _entry(found, row)
    kind, inputs = light_units.light_attributes(values) if values else ("SphereLight", {})
    light = define(prim, identifiers.take(prim.name), kind)
    inputs = {name: value for name, value in inputs.items() if value != FALLBACK.get(name)}
    for name, value in inputs.items():
        form = {tuple: Types.Color3f, bool: Types.Bool}.get(type(value), Types.Float)
        value = value if isinstance(value, bool | tuple) else float(value)
        attribute(light, f"inputs:{name}", form, value, uniform=False)
    schemas = ["ShapingAPI"] * (light_units.CONE in inputs) + ["ShadowAPI"] * (light_units.SHADOW in inputs)
    if schemas:
        apply_schema(light, *schemas)
    return "LIGHT"


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
