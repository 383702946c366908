"""Shapes apart from their sizes: points moved and scaled into the unit sphere and back, and sizes to compare."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry.arrays import Floats


@dataclass(frozen=True, eq=False)
class UnitPlacement:
    """Where a shape lies: ``center`` float64 (3,) and ``scale``, the radius of its unit sphere, in the shape's unit."""

    center: Floats
    scale: float

    def restore(self, points: NDArray[np.floating]) -> Floats:
        """Points (..., 3) of the unit sphere in the shape's own frame and unit."""
        return points * self.scale + self.center


def normalise(points: NDArray[np.floating]) -> tuple[NDArray[np.float32], UnitPlacement]:
    """Points (n, 3) with their mean at the origin and the farthest at distance 1, and where they were.

    Mean and farthest distance turn with the shape, so that a rotated shape is
    normalised to the same shape, rotated. Points that all coincide stay at the
    origin, with scale 1.
    """
    center = points.mean(axis=0, dtype=np.float64)
    moved = points - center
    scale = float(np.sqrt(np.einsum("nk,nk->n", moved, moved).max(initial=0.0)))
    scale = scale if scale > 1e-12 * (1 + np.abs(center).max()) else 1.0
    return (moved / scale).astype(np.float32), UnitPlacement(center, scale)


def size_channels(sizes: NDArray[np.floating]) -> Floats:
    """Sizes (N, 3) along x, y, z in metres as (N, 3): logarithms of longer side, shorter side and height.

    The longer of the two level sides comes first, so that a quarter turn changes
    nothing; sides count as a tenth of a millimetre at least.
    """
    sizes = np.maximum(np.asarray(sizes, np.float64), 1e-4)
    level = np.sort(sizes[:, :2], axis=1)[:, ::-1]
    return np.log(np.column_stack([level, sizes[:, 2]]))
