"""Which things stand beside each other: by the spheres around them, both ways, large ones by nobody."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("torch")

from tests.meshes.shapes import box
from unisg_blender.learn.object_categories.training import standing_together
from unisg_blender.predict.category_proposals import BESIDE, MOST_NEIGHBOURS, beside
from unisg_blender.scene import SceneBuilder, SceneGraph


def row_of_boxes(*places: tuple[float, float]) -> SceneGraph:
    """Cubes in a row: middle along x and size."""
    builder = SceneBuilder("row")
    for number, (x, size) in enumerate(places):
        local = np.eye(4)
        local[0, 3] = x
        builder.add(f"Box {number:03d}", uid=str(number), local=local, mesh=box((size,) * 3, (-size / 2,) * 3))
    return builder.build()


def pairs(graph: SceneGraph) -> set[tuple[int, int]]:
    return set(zip(*(part.tolist() for part in beside(graph)), strict=True))


@pytest.mark.parametrize(("gap", "near"), [(BESIDE - 0.01, True), (BESIDE + 0.01, False)])
@pytest.mark.parametrize("sizes", [(0.2, 0.2), (0.2, 1.0), (1.0, 0.4)])
def test_they_are_near_by_their_own_sizes(gap: float, near: bool, sizes: tuple[float, float]) -> None:
    graph = row_of_boxes((0.0, sizes[0]), (sum(sizes) / 2 + gap, sizes[1]))
    assert pairs(graph) == ({(0, 1), (1, 0)} if near else set())


def test_large_things_have_no_neighbours() -> None:
    assert pairs(row_of_boxes((0.0, 0.3), (0.3, 2.9))) == {(0, 1), (1, 0)}
    assert pairs(row_of_boxes((0.0, 0.3), (0.3, 3.1))) == set()
    assert pairs(row_of_boxes((0.0, 0.3))) == set()


def test_of_many_the_nearest_count() -> None:
    graph = row_of_boxes(*((0.05 * k, 0.04) for k in range(40)))
    found = beside(graph)[0]
    assert np.bincount(found).max() <= MOST_NEIGHBOURS
    mine = sorted(two for one, two in pairs(graph) if one == 20)
    assert mine == [*range(20 - MOST_NEIGHBOURS // 2, 20), *range(21, 21 + MOST_NEIGHBOURS // 2)]


def test_what_stands_together_oftener_than_by_chance_and_seldomer() -> None:
    def scene(*kinds: str) -> SceneGraph:
        """Cubes in a row, each beside the next one or two."""
        graph = row_of_boxes(*((0.6 * k, 0.2) for k in range(len(kinds))))
        names = tuple(dict.fromkeys(kinds))
        return graph.replace(vocabulary=names, category=np.array([names.index(kind) for kind in kinds], np.int32))

    pairs_seen = [scene("Cup", "Plate")] * 30 + [scene("Lamp", "Book")] * 30 + [scene("Cup", "Lamp")]
    found = standing_together(pairs_seen, ["Cup", "Plate", "Lamp", "Book", "Chair"])
    np.testing.assert_allclose(found, found.T)
    counts = np.zeros((4, 4))
    for one, two, times in ((0, 1, 30), (2, 3, 30), (0, 2, 1)):
        counts[one, two] = counts[two, one] = times
    expected = counts.sum(axis=1)[:, None] * counts.sum(axis=0) / counts.sum()
    np.testing.assert_allclose(found[:4, :4], np.clip(np.log((counts + 1) / (expected + 1)), -2, 2))
    assert found[0, 1] > 0.5
    assert found[1, 3] == -2
    assert not found[4].any()
    assert not standing_together([scene("Cup")], ["Cup"]).any()
