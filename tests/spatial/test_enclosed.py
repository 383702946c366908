"""What is around a thing makes it be inside: a tunnel does, a corner under a roof does not."""

from __future__ import annotations

import numpy as np
import pytest

from tests.meshes.shapes import box, joined
from unisg_blender.scene import SceneBuilder
from unisg_blender.spatial import find_relations

SLABS = {
    "floor": ((2.0, 2.0, 0.1), (-1, -1, -0.1)), "roof": ((2.0, 2.0, 0.1), (-1, -1, 1.0)),
    "left": ((0.1, 2.0, 1.0), (-1, -1, 0.0)), "right": ((0.1, 2.0, 1.0), (0.9, -1, 0.0)),
    "back": ((1.8, 0.1, 1.0), (-0.9, 0.9, 0.0)), "front": ((1.8, 0.1, 1.0), (-0.9, -1, 0.0)),
}  # fmt: skip


@pytest.mark.parametrize(
    ("parts", "inside"),
    [
        (("floor", "roof", "left", "right", "back", "front"), True), (("floor", "roof", "left", "right", "back"), True),
        (("floor", "roof", "left", "right"), True), (("floor", "roof", "left", "back"), True),
        (("floor", "roof", "left"), False), (("floor", "roof"), False),
        (("floor", "left", "right", "back", "front"), True), (("floor", "left", "right", "back"), False),
    ],
)  # fmt: skip
def test_four_sides_with_a_roof_or_five_without(parts: tuple[str, ...], inside: bool) -> None:
    builder = SceneBuilder("shelter")
    builder.add("House", uid="h", mesh=joined(*(box(*SLABS[name]) for name in parts)), category="House")
    local = np.eye(4)
    local[:3, 3] = -0.1, -0.1, 0
    builder.add("Ball", uid="b", mesh=box((0.2, 0.2, 0.2)), category="Ball", local=local)
    graph = builder.build()
    found = {(graph.name[one], kind, graph.name[two]) for one, kind, two in find_relations(graph)}
    assert (("Ball", "inside", "House") in found) == inside
    assert ("House", "inside", "Ball") not in found
