"""Poses in every representation form: matrices, quaternions, dual quaternions, PGA and CGA motors."""

from __future__ import annotations

from .arrays import PoseError
from .clifford_interop import from_multivector, to_multivector
from .forms import FORMS, STRETCH_CHANNELS, STRETCH_WIDTH, Form, convert
from .motion import blend, compose, exp, inverse, log, sclerp
from .parts import MotorParts, dilator, rotor, split_motor, translator
from .reduction import pose_errors, rebuild, reduce_keyframes

__all__ = [
    "FORMS",
    "STRETCH_CHANNELS",
    "STRETCH_WIDTH",
    "Form",
    "MotorParts",
    "PoseError",
    "blend",
    "compose",
    "convert",
    "dilator",
    "exp",
    "from_multivector",
    "inverse",
    "log",
    "pose_errors",
    "rebuild",
    "reduce_keyframes",
    "rotor",
    "sclerp",
    "split_motor",
    "to_multivector",
    "translator",
]
