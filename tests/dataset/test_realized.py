"""Instances as objects of a dataset."""

from __future__ import annotations

import numpy as np
import pytest

from tests.dataset.conftest import box
from unisg_blender.dataset.export import realized_instances as realized
from unisg_blender.dataset.export.realized_instances import realize_objects
from unisg_blender.scene import SceneBuilder, SceneGraph, table, world_matrices
from unisg_blender.scene.realize_instances import count_copies
from unisg_blender.words.category_mapping import apply_mapping


def chair(category: str = "") -> SceneGraph:
    builder = SceneBuilder(title="Chairs")
    seat = builder.add("Chair", uid="seat", mesh=box("seat", (0.4, 0.4, 0.5)), category=category)
    builder.add("Cushion", uid="cushion", parent=seat, mesh=box("cushion", (0.3, 0.3, 0.1)))
    return builder.build()


def moved(x: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


def with_instances(graph: SceneGraph, prototype: SceneGraph, rows: list[int], source: str) -> SceneGraph:
    matrix = np.array([moved(number) for number in range(len(rows))])
    columns = {"prototype": [prototype] * len(rows), "matrix": matrix, "source": [source] * len(rows)}
    return graph.with_component("instances", table(rows, **columns))


@pytest.fixture
def hall() -> SceneGraph:
    """Three empties that show the collection "Chairs"."""
    builder = SceneBuilder()
    for number in range(3):
        builder.add(f"Chairs.{number:03}", uid=f"h{number}")
    return with_instances(builder.build(), chair(), [0, 1, 2], "COLLECTION")


def categories(graph: SceneGraph) -> list[tuple[str, str]]:
    return [(graph.name[row], graph.category_name(row)) for row in range(len(graph)) if graph.category[row] >= 0]


def test_copies_are_entities_where_they_are_shown(hall: SceneGraph) -> None:
    graph, lost = realize_objects(hall)
    assert (len(graph), len(set(graph.uid)), len(graph.meshes), lost) == (9, 9, 2, "")
    assert "instances" not in graph.components
    places = [world_matrices(graph)[row, 0, 3] for row in range(9) if graph.name[row] == "Chair"]
    assert places == [0.0, 1.0, 2.0]


@pytest.mark.parametrize("patterns", [{"objects": {"chair*": "Chair"}}, {"collections": {"chairs": "Chair"}}])
def test_a_mapping_names_each_copy_once(hall: SceneGraph, patterns: dict) -> None:
    graph, _ = realize_objects(apply_mapping(hall, patterns))
    found = categories(graph)
    assert [entry for entry in found if entry[0] == "Chair"] == [("Chair", "Chair")] * 3
    assert not any(name.startswith("Chairs.") for name, _ in found)  # what shows a chair is not another one


def test_an_empty_that_shows_something_else_keeps_its_category(hall: SceneGraph) -> None:
    graph, _ = realize_objects(apply_mapping(hall, {"objects": {"chairs.*": "Group", "cushion": "Cushion"}}))
    assert sorted({category for _, category in categories(graph)}) == ["Cushion", "Group"]


def test_drawn_objects_have_the_category_of_what_they_show() -> None:
    builder = SceneBuilder()
    builder.add("Book", uid="b", mesh=box("book", (0.2, 0.03, 0.3)), category="Book")
    shelf = builder.add("Shelf", uid="s", mesh=box("shelf", (1.0, 0.3, 2.0)), category="Shelf")
    graph = builder.build()
    rows = [graph.row("Shelf")] * 2
    assert shelf is not None
    for name, expected in (("Book", 3), ("Shelf", 1)):  # geometry that the shelf itself makes is no shelf
        single = SceneBuilder(title=name)
        single.add(name, uid="p", mesh=box("drawn", (0.2, 0.03, 0.3)))
        whole, _ = realize_objects(with_instances(graph, single.build(), rows, "GEOMETRY"))
        assert len(whole) == 4
        assert [category for _, category in categories(whole)].count(name) == expected


def test_grass_is_left_out(hall: SceneGraph, monkeypatch: pytest.MonkeyPatch) -> None:
    nested = with_instances(SceneBuilder().build(), chair(), [], "COLLECTION")
    assert count_copies(nested) == 0
    assert count_copies(hall) == 6
    monkeypatch.setattr(realized, "MOST_COPIES", 5)
    graph, lost = realize_objects(hall)
    assert graph is hall
    assert "6 copies" in lost
