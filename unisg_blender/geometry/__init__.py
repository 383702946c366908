"""Geometry on plain arrays: boxes, polygons, planar poses, contact of surfaces. Knows no scene."""

from __future__ import annotations

from .box_distance import separation
from .box_overlap import nearby_pairs, penetration
from .boxes import Boxes, world_bounds

__all__ = ["Boxes", "nearby_pairs", "penetration", "separation", "world_bounds"]
