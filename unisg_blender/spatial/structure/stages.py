"""Stages: floors with walls on some sides only, as dioramas have them. What stands on one is no room of its own.

Such scenes are of any size: an aquarium on a stage of sixteen metres is as large as a room.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...geometry.column_raster import cells_on
from ...geometry.corner_ends import corner_ends
from ...geometry.grouped_ends import grouped_ends
from ...geometry.mask_outline import grown
from .region import Region
from .scan import HEADROOM, Scan

SIDES = 0.3
"""Share of the rim of a stage that is at walls, at least: two of four sides, with what is open in them."""

ABOVE = 0.1
"""Metres over what stands on a stage where its walls are looked for: they are higher than that."""

LARGER = 4.0
"""Times the area of all rooms found that a stage has, at least, for them to be things on it."""

RAISED, WITHIN = 0.3, 0.9
"""Metres over the stage that their floors are, at least, and the share of them that is within its rim."""

VAST = 10.0
"""Times the rectangle around all else that the one around a backdrop is, at least."""


def stands_on(regions: Sequence[Region], stage: Region, scan: Scan) -> bool:
    """Is all that was found things on a stage: small, raised, within its rim, and lower than its walls?"""
    area = sum(float(region.mask.sum()) for region in regions)
    if not regions or stage.mask.sum() < LARGER * area:
        return False
    from scipy.ndimage import binary_fill_holes

    whole = replace(stage, mask=np.asarray(binary_fill_holes(stage.mask)))
    for region in regions:
        i, j = np.nonzero(region.mask)
        cells = (i + region.first[0]) * scan.grid.shape[1] + j + region.first[1]
        if region.floor < stage.floor + RAISED or whole.over(cells, scan.grid.shape[1]).mean() < WITHIN:
            return False
    tops = [region.ceiling if np.isfinite(region.ceiling) else region.floor + HEADROOM for region in regions]
    return is_stage(stage, scan, max(tops) + ABOVE)


def is_stage(place: Region, scan: Scan, height: float) -> bool:
    """Are walls along enough of the outer rim of a place, at a height?"""
    from scipy.ndimage import binary_dilation, binary_fill_holes

    own = np.pad(np.asarray(binary_fill_holes(place.mask)), 3)
    grid = place.grid.window((-3, -3), (own.shape[0], own.shape[1]))
    walls = binary_dilation(grid.mask(cells_on(scan.cut(height)[0], grid)[0]), iterations=2)
    rim = grown(own) & ~own
    return bool((rim & walls).sum() >= SIDES * rim.sum())


def backdrop(scan: Scan) -> int:
    """The row of one thing that is vastly larger than all else together, -1 where there is none."""
    low, high = corner_ends(scan.triangles[:, :, :2])
    rows, place = np.unique(scan.row, return_inverse=True)
    if len(rows) < 2:
        return -1
    least, most = grouped_ends(place, len(rows), low, high)
    largest = int((most - least).prod(axis=1).argmax())
    others = np.arange(len(rows)) != largest
    around = float((most[others].max(axis=0) - least[others].min(axis=0)).prod())
    return int(rows[largest]) if (most - least)[largest].prod() >= VAST * around else -1
