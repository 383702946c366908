"""Generation: new objects for empty and existing scenes, from a trained model. Needs numpy and onnxruntime only."""

from __future__ import annotations

from .generator import Generated, Generator
from .place.placement import Placement

__all__ = ["Generated", "Generator", "Placement"]
