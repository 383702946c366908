"""Poses in every representation form: matrices, quaternions, dual quaternions, PGA and CGA motors."""

from __future__ import annotations

from .arrays import PoseError
from .forms import FORMS, STRETCH_CHANNELS, STRETCH_WIDTH, Form, convert

__all__ = ["FORMS", "STRETCH_CHANNELS", "STRETCH_WIDTH", "Form", "PoseError", "convert"]
