"""Cameras as USD describes them, and back: the component's values and a Camera prim's attributes.

USD gives lens and sensor in tenths of a scene unit; a component in millimetres.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Values = Mapping[str, Any]
NEW: dict[str, Any] = {
    "data": "", "kind": "PERSP", "active": False, "fit": "HORIZONTAL", "focused": False, "lens": 50.0,
    "sensor_width": 36.0, "sensor_height": 24.0, "ortho_scale": 6.0, "clip_start": 0.1, "clip_end": 1000.0,
    "shift_x": 0.0, "shift_y": 0.0, "focus_distance": 10.0, "fstop": 2.8,
}  # fmt: skip
"""What a camera has where a file does not say."""


def camera_attributes(values: Values, metres: float = 1.0) -> dict[str, Any]:
    """Attributes of a Camera prim; ``metres`` is the size of a scene unit."""
    tenth = 100.0 * metres  # millimetres in a tenth of a scene unit
    ortho = values["kind"] == "ORTHO"
    width, height = values["sensor_width"] / tenth, values["sensor_height"] / tenth
    if ortho:
        width = height = 10.0 * values["ortho_scale"] / metres
    reference = height if values["fit"] == "VERTICAL" else width
    focused = bool(values.get("focused", False))
    return {
        "projection": "orthographic" if ortho else "perspective",
        "focalLength": values["lens"] / tenth,
        "horizontalAperture": width,
        "verticalAperture": height,
        "horizontalApertureOffset": values["shift_x"] * reference,
        "verticalApertureOffset": values["shift_y"] * reference,
        "clippingRange": (values["clip_start"] / metres, values["clip_end"] / metres),
        "focusDistance": values["focus_distance"] / metres if focused else 0.0,
        "fStop": values["fstop"] if focused else 0.0,
    }


def camera_values(found: Values, metres: float, fit: str) -> dict[str, Any]:
    """What a Camera prim's attributes say of the component; ``fit`` decides to what a shift is relative."""
    tenth = 100.0 * metres
    ortho = found["projection"] == "orthographic"
    width, height = found["horizontalAperture"], found["verticalAperture"]
    reference = (height if fit == "VERTICAL" and not ortho else width) or 1.0
    values = {
        "kind": "ORTHO" if ortho else "PERSP",
        "lens": found["focalLength"] * tenth,
        "shift_x": found["horizontalApertureOffset"] / reference,
        "shift_y": found["verticalApertureOffset"] / reference,
        "clip_start": found["clippingRange"][0] * metres,
        "clip_end": found["clippingRange"][1] * metres,
        "focused": found["fStop"] > 0,
    }
    if found["fStop"] > 0:
        values |= {"fstop": found["fStop"], "focus_distance": found["focusDistance"] * metres}
    if ortho:
        return values | {"ortho_scale": max(width, height) / 10.0 * metres}
    return values | {"sensor_width": width * tenth, "sensor_height": height * tenth}
