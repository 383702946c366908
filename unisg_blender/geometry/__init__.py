"""Geometry on plain arrays: boxes, polygons, planar poses, contact of surfaces. Knows no scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..runtime.lazy_names import lazy_names
from .boxes import Boxes, world_bounds

if TYPE_CHECKING:
    from .box_distance import separation
    from .box_overlap import nearby_pairs, penetration

__all__ = ["Boxes", "nearby_pairs", "penetration", "separation", "world_bounds"]

__getattr__, __dir__ = lazy_names(  # the others load scipy
    __name__, {"nearby_pairs": ".box_overlap", "penetration": ".box_overlap", "separation": ".box_distance"}
)
