"""Columns are in order from below, and outlines go around exactly the cells that they are of."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from unisg_blender.geometry.column_raster import ALIKE, Grid, columns
from unisg_blender.geometry.mask_outline import outlines
from unisg_blender.geometry.polygon import area
from unisg_blender.geometry.traced_outlines import simplified_all

CELL = 0.5
masks = arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9)))


@settings(deadline=None)
@given(masks)
def test_outlines_enclose_the_cells(mask) -> None:
    loops = outlines(mask, Grid((0.0, 0.0), CELL, mask.shape))
    assert np.isclose(sum(area(loop) for loop in loops), mask.sum() * CELL**2)
    for loop in loops:
        assert len(loop) >= 4
        steps = np.roll(loop, -1, axis=0) - loop
        assert (np.count_nonzero(steps, axis=1) == 1).all()
        turns = steps[:, 0] * np.roll(steps[:, 1], -1) - steps[:, 1] * np.roll(steps[:, 0], -1)
        assert (turns != 0).all(), "a corner where it does not turn"


@settings(deadline=None)
@given(st.lists(masks, min_size=1, max_size=4), st.floats(0.01, 2.0))
def test_simplified_outlines_stay_near(shapes, tolerance) -> None:
    loops = [loop for mask in shapes for loop in outlines(mask, Grid((0.0, 0.0), CELL, mask.shape))]
    together = simplified_all(loops, tolerance)
    assert len(together) == len(loops)
    for loop, simple in zip(loops, together, strict=True):
        assert np.array_equal(simple, simplified_all([loop], tolerance)[0])
        assert {tuple(corner) for corner in simple} <= {tuple(corner) for corner in loop}
        ahead = np.roll(simple, -1, axis=0) - simple
        share = ((loop[:, None] - simple) * ahead).sum(-1) / np.maximum((ahead**2).sum(-1), 1e-18)
        off = loop[:, None] - simple - share.clip(0, 1)[..., None] * ahead
        assert (np.linalg.norm(off, axis=-1).min(axis=1) <= tolerance + 1e-9).all()


@settings(deadline=None)
@given(arrays(np.float64, st.tuples(st.integers(1, 30), st.just(3), st.just(3)), elements=st.floats(0, 4)))
def test_columns_go_from_below(triangles) -> None:
    found = columns(triangles, Grid((0.0, 0.0), CELL, (8, 8)))
    same = np.diff(found.cell) == 0
    assert (np.diff(found.cell) >= 0).all()
    assert (np.diff(found.height)[same] >= -ALIKE).all()
    once = set(zip(found.cell.tolist(), found.triangle.tolist(), strict=True))
    assert len(once) == len(found.cell)
