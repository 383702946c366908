"""How a thing is held: on a top that is under it, at a side, from above, or within; and how far it is from the side."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.generate.observe.support_priors import AT_SIDE, HANGS, INSIDE, RESTS, contact
from unisg_blender.geometry.boxes import Boxes
from unisg_blender.spatial.objects import SceneObjects

Place = tuple[float, float, float]


def objects(place: Place, half: Place = (0.1, 0.1, 0.1)) -> SceneObjects:
    """A table of 1 x 1 x 0.8 m at the origin, and a thing."""
    center, halves = np.array([(0, 0, 0.4), place]), np.array([(0.5, 0.5, 0.4), half])
    parts = Boxes(center, np.tile(np.eye(3), (2, 1, 1)), halves, np.ones(2, bool))
    support = np.array([-1, 0])
    return SceneObjects(
        np.arange(2), np.zeros(2, int), support, center, halves, np.zeros(2), parts, np.arange(2), ("", "")
    )


@pytest.mark.parametrize(
    ("place", "kind", "gap"),
    [
        ((0.2, 0.1, 0.9), RESTS, 0.0), ((0.49, 0.49, 0.9), RESTS, 0.0), ((0.62, 0.0, 0.9), AT_SIDE, 0.02),
        ((0.65, 0.0, 0.4), AT_SIDE, 0.05), ((0.0, -0.6, 0.2), AT_SIDE, 0.0), ((0.0, 0.0, -0.1), HANGS, 0.0),
        ((0.0, 0.0, 0.4), INSIDE, 0.0), ((9.0, 0.0, 0.4), INSIDE, 0.0),
    ],
)  # fmt: skip
def test_how_a_thing_is_held(place: Place, kind: str, gap: float) -> None:
    found = contact(objects(place), 1, 0)
    assert found[0] == kind
    assert found[1] == pytest.approx(gap, abs=1e-9)


@pytest.mark.parametrize(("height", "kind"), [(0.1, RESTS), (0.105, RESTS), (0.5, INSIDE), (-0.3, INSIDE)])
def test_without_a_support_it_stands_on_the_ground_or_nowhere(height: float, kind: str) -> None:
    assert contact(objects((3.0, 0.0, height)), 1, -1) == (kind, 0.0)
