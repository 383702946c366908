"""Lights as UsdLux describes them, and back, with the same factors as Blender's own exporter and importer.

Watts are pi times the intensity of a sphere, rectangle or disk; a sun's strength
is four times the intensity of a distant light.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

Values = Mapping[str, Any]
NEW: dict[str, Any] = {
    "data": "", "kind": "POINT", "color": (1.0, 1.0, 1.0), "shape": "", "energy": math.pi, "radius": 0.5, "size": 1.0,
    "size_y": 1.0, "angle": math.radians(0.53), "spot_size": math.pi / 4, "spot_blend": 0.0, "spread": math.pi,
    "diffuse": 1.0, "specular": 1.0, "exposure": 0.0, "temperature": 6500.0, "shadow": True, "normalize": False,
    "tinted": False,
}  # fmt: skip
"""What a light has where a file does not say."""
COMMON = {"exposure": "exposure", "diffuse": "diffuse", "specular": "specular", "colorTemperature": "temperature"}
SWITCHES = {"normalize": "normalize", "enableColorTemperature": "tinted"}
CONE, SOFTNESS, SHADOW = "shaping:cone:angle", "shaping:cone:softness", "shadow:enable"
EVERYWHERE = 90.0  # degrees: a wider cone than this is no spot


def light_attributes(values: Values) -> tuple[str, dict[str, Any]]:
    """The prim type of a light, and its inputs without their prefix."""
    kind, shape = values["kind"], values["shape"]
    inputs: dict[str, Any] = {"color": tuple(map(float, values["color"]))}
    inputs |= {name: float(values.get(key, NEW[key])) for name, key in COMMON.items()}
    inputs |= {name: bool(values.get(key, name == "normalize")) for name, key in SWITCHES.items()}
    inputs[SHADOW] = bool(values.get("shadow", True))
    if kind == "SUN":
        return "DistantLight", inputs | {"intensity": values["energy"] / 4, "angle": math.degrees(values["angle"])}
    inputs["intensity"] = values["energy"] / math.pi
    if kind == "AREA" and shape in ("DISK", "ELLIPSE"):
        return "DiskLight", inputs | {"radius": values["size"] / 2}
    if kind == "AREA":
        height = values["size_y"] if shape == "RECTANGLE" else values["size"]
        return "RectLight", inputs | {"width": values["size"], "height": height}
    inputs["radius"] = values["radius"]
    if kind == "SPOT":
        inputs |= {CONE: math.degrees(values["spot_size"]) / 2, SOFTNESS: values["spot_blend"]}
    return "SphereLight", inputs


def light_values(prim_type: str, found: Values, metres: float) -> dict[str, Any] | None:
    """What a light prim says of the component; ``metres`` is the size of a scene unit. None for other kinds."""
    values: dict[str, Any] = {"color": tuple(found["color"]), "shadow": bool(found.get(SHADOW, True))}
    values |= {key: float(found[name]) for name, key in COMMON.items()}
    values |= {key: bool(found[name]) for name, key in SWITCHES.items()}
    if prim_type == "DistantLight":
        angle = math.radians(found["angle"])
        return values | {"kind": "SUN", "energy": found["intensity"] * 4, "angle": angle, "shape": ""}
    values["energy"] = found["intensity"] * math.pi
    if prim_type == "DiskLight":
        return values | {"kind": "AREA", "shape": "DISK", "size": found["radius"] * 2 * metres}
    if prim_type == "RectLight":
        size = {"size": found["width"] * metres, "size_y": found["height"] * metres}
        return values | size | {"kind": "AREA", "shape": "RECTANGLE"}
    if prim_type != "SphereLight":
        return None
    values |= {"radius": found["radius"] * metres, "shape": "", "kind": "POINT"}
    if found.get(CONE, 180.0) < EVERYWHERE:
        spot = {"spot_size": 2 * math.radians(found[CONE]), "spot_blend": min(max(found.get(SOFTNESS, 0.0), 0.0), 1.0)}
        values |= spot | {"kind": "SPOT"}
    return values
