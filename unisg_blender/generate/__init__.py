"""Generation: new objects for empty and existing scenes, from a trained model. Needs numpy and onnxruntime only."""

from __future__ import annotations

from .check.settled_scene import settle, settle_rows
from .generator import Generated, Generator
from .place.placement_record import Placement
from .place.settle_existing import Settled
from .propose.place_sampling import Sampling

__all__ = ["Generated", "Generator", "Placement", "Sampling", "Settled", "settle", "settle_rows"]
