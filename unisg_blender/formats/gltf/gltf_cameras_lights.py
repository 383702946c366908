"""Cameras and lights as glTF says them.

Sources: glTF 2.0, section 3.10 (cameras); KHR_lights_punctual (candela for points and spots, lux for suns). Watts of
radiant power are taken as Blender's exporter takes them: 683 lumen for each watt.
"""

from __future__ import annotations

import math
from typing import Any

LUMEN_PER_WATT = 683.0
ASPECT = 16 / 9
"""Width to height of the picture for which an angle of view across is told up and down."""


def camera_record(camera: dict[str, Any]) -> dict[str, Any]:
    """A camera from its row of the component ``camera``."""
    near, far = max(float(camera["clip_start"]), 1e-4), float(camera["clip_end"])
    far = max(far, near * 1.001)
    if camera["kind"] == "ORTHO":
        half = max(float(camera["ortho_scale"]), 1e-4) / 2
        shape = {"xmag": half, "ymag": half / ASPECT, "znear": near, "zfar": far}
        return {"type": "orthographic", "orthographic": shape}
    upright = camera["fit"] == "VERTICAL"
    size = float(camera["sensor_height" if upright else "sensor_width"])
    half = size / 2 / max(float(camera["lens"]), 1e-3) / (1 if upright else ASPECT)
    shape = {"yfov": 2 * math.atan(half), "aspectRatio": ASPECT, "znear": near, "zfar": far}
    return {"type": "perspective", "perspective": shape}


def light_record(light: dict[str, Any]) -> dict[str, Any]:
    """A light from its row of the component ``light``; an area shines from its middle as a wide spot."""
    energy = float(light["energy"]) * 2.0 ** float(light["exposure"])
    record: dict[str, Any] = {"color": [min(max(float(part), 0.0), 1.0) for part in light["color"]]}
    if light["kind"] == "SUN":
        return record | {"type": "directional", "intensity": max(energy, 0.0)}
    record["intensity"] = max(energy, 0.0) * LUMEN_PER_WATT / (4 * math.pi) / 1000
    if light["kind"] == "POINT":
        return record | {"type": "point"}
    outer = float(light["spot_size"]) / 2 if light["kind"] == "SPOT" else math.pi / 2
    outer = min(max(outer, 1e-3), math.pi / 2)
    inner = outer * (1 - min(max(float(light["spot_blend"]), 0.0), 1.0)) if light["kind"] == "SPOT" else 0.0
    return record | {"type": "spot", "spot": {"outerConeAngle": outer, "innerConeAngle": min(inner, outer * 0.999)}}
