"""The judge of placing that the benchmark of interiors has tells boxes apart that hold and that do not."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.spatial.built_rooms import CORRIDOR, SQUARE, box, room, scene

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks" / "interiors"))
pytest.importorskip("bpy")
from placing_judge import Judge


def verdict(outline, low, high, mounted: bool = False) -> list[str]:
    """What the judge says of a box in a room with a desk."""
    objects = room(outline, 0.1) | {"desk": box((3, 0.2, 0), (3.4, 0.6, 0.7))}
    judge = Judge(scene(objects), [{"floor": 0.0, "outline": [outline.tolist()], "unclear": []}])
    graph = scene(objects | {"new": box(low, high)})
    return judge.verdicts(graph, {graph.row_of_uid["new"]: mounted})[graph.row_of_uid["new"]]


@pytest.mark.parametrize(
    ("low", "high", "mounted", "told"),
    [
        ((1, 2, 0), (1.5, 2.5, 0.5), False, []),
        ((3.1, 0.3, 0.7), (3.3, 0.5, 0.9), False, []),
        ((1, 2, 0.2), (1.5, 2.5, 0.5), False, ["in the air"]),
        ((3.35, 0.3, 0.7), (3.9, 0.5, 0.9), False, ["tips"]),
        ((2.8, 0.3, 0), (3.2, 0.5, 0.5), False, ["in something"]),
        ((3.1, 0.3, 0.2), (3.3, 0.5, 0.5), False, ["in the air", "in something"]),
        ((8, 2, 0), (8.5, 2.5, 0.5), False, ["outside", "in the air"]),
        ((1, 0.01, 1.4), (1.5, 0.04, 1.9), True, []),
        ((1, 0.4, 1.4), (1.5, 0.43, 1.9), True, ["in the air"]),
    ],
)
def test_what_is_told_of_a_box(low, high, mounted: bool, told: list[str]) -> None:
    assert verdict(SQUARE, low, high, mounted) == told


@pytest.mark.parametrize(("width", "told"), [(0.4, []), (0.9, ["cuts off"])])
def test_a_corridor_that_is_blocked_is_told(width: float, told: list[str]) -> None:
    assert verdict(CORRIDOR, (5, 0, 0), (6, width, 1.5)) == told
