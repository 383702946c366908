"""The columns of the components ``camera`` and ``light``, and what Blender calls them."""

from __future__ import annotations

import math

CAMERA_NUMBERS = (
    "lens", "sensor_width", "sensor_height", "ortho_scale", "clip_start", "clip_end", "shift_x", "shift_y",
)  # fmt: skip
FOCUS = {"focused": "use_dof", "focus_distance": "focus_distance", "fstop": "aperture_fstop"}
LIGHT_NUMBERS = (
    "energy", "radius", "size", "size_y", "angle", "spot_size", "spot_blend", "spread", "diffuse", "specular",
    "exposure", "temperature",
)  # fmt: skip
LIGHT_SWITCHES = ("shadow", "normalize", "tinted")
BLENDER_NAME = {
    "radius": "shadow_soft_size", "diffuse": "diffuse_factor", "specular": "specular_factor", "shadow": "use_shadow",
    "tinted": "use_temperature",
}  # fmt: skip
ABSENT = {"spread": math.pi, "temperature": 6500.0, "normalize": True}
"""Values of what a light of that kind, or an older Blender, does not have; 0 for all others."""
