"""Poses in every representation form: matrices, quaternions, dual quaternions, PGA and CGA motors."""

from __future__ import annotations

from .arrays import PoseError
from .clifford_interop import from_multivector, to_multivector
from .encodings import Block
from .forms import FORMS, STRETCH_CHANNELS, STRETCH_WIDTH, Form, convert, register_form
from .motion import blend, compose, cubic_sclerp, exp, inverse, linear_slerp, log, sclerp
from .parts import MotorParts, dilator, rotor, split_motor, translator
from .reduction import pose_errors, rebuild, rebuild_cubic, reduce_keyframes, third_poses

__all__ = [
    "FORMS", "STRETCH_CHANNELS", "STRETCH_WIDTH", "Block", "Form", "MotorParts", "PoseError", "blend", "compose",
    "convert", "cubic_sclerp", "dilator", "exp", "from_multivector", "inverse", "linear_slerp", "log", "pose_errors",
    "rebuild", "rebuild_cubic", "reduce_keyframes", "register_form", "rotor", "sclerp", "split_motor", "third_poses",
    "to_multivector", "translator",
]  # fmt: skip
