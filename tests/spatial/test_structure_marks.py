"""What users say of the building counts before what is recognised, and is kept in files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.spatial.built_rooms import SQUARE, area, box, grown, mesh, room, scene, slab
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import read_scene_file, write_scene_file
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.scene.structure_marks import (
    NOTHING,
    PART_MARK,
    ROOM_MARK,
    THING,
    marks,
    with_marks,
    with_parts,
)
from unisg_blender.spatial.structure import recognise_structure
from unisg_blender.spatial.structure.room_objects import room_objects
from unisg_blender.words import apply_mapping
from unisg_blender.words.category_mapping import checked_mapping

HEDGE = {f"hedge {name}": part for name, part in room(SQUARE + np.array([0, 6.0]), 0.3, 2.0).items() if "side" in name}
LAWN = {"lawn": slab(grown(np.array([[0, 0], [5, 0], [5, 10], [0, 10]], float), 1.0), -0.3, -0.1)}


def with_garden() -> SceneGraph:
    """A room, and beside it a place that hedges are around."""
    return scene(room(SQUARE, 0.2) | HEDGE | LAWN)


def rows(graph: SceneGraph, start: str) -> list[int]:
    return [row for row, name in enumerate(graph.name) if name.startswith(start)]


def sizes(graph: SceneGraph) -> list[float]:
    """Square metres of the rooms indoors."""
    return sorted(round(found.area, 1) for found in recognise_structure(graph).rooms if found.indoors)


def test_hedges_that_are_marked_as_things_make_no_room() -> None:
    graph = with_garden()
    assert len(sizes(graph)) == 2
    marked = with_parts(graph, {row: THING for row in rows(graph, "hedge")})
    assert sizes(marked) == [20.0]
    assert not set(rows(graph, "hedge")) & set(recognise_structure(marked).parts)


def test_a_mark_of_a_group_is_that_of_its_parts() -> None:
    builder = SceneBuilder("Garden")
    builder.add("hedges", uid="hedges")
    for name, part in (room(SQUARE, 0.2) | HEDGE | LAWN).items():
        builder.add(name, uid=name, mesh=mesh(part), parent=0 if name.startswith("hedge") else -1)
    graph = builder.build()
    assert sizes(with_parts(graph, {graph.row_of_uid["hedges"]: THING})) == [20.0]


def test_what_is_marked_as_nothing_is_neither_building_nor_thing() -> None:
    """A collision hull fills the room: with it there is no floor to stand on."""
    graph = scene(room(SQUARE, 0.2) | {"hull": box((0.1, 0.1, 0.01), (4.9, 3.9, 2.4))})
    marked = with_parts(graph, {rows(graph, "hull")[0]: NOTHING})
    found = recognise_structure(marked)
    assert [round(area(place.outline)) for place in found.rooms if place.floor < 1] == [20]
    seen = room_objects(marked, ())
    assert rows(graph, "hull")[0] not in seen.objects.row[seen.objects.owner]


def test_a_category_of_the_building_is_exchanged_for_a_mark_and_back() -> None:
    graph = with_parts(scene(room(SQUARE, 0.2)), {0: "floor"})
    assert graph.category_name(0) == "Floor"
    assert not marks(graph, PART_MARK)
    thing = with_parts(graph, {0: "Thing"})
    assert thing.category_name(0) == ""
    assert marks(thing, PART_MARK) == {0: "thing"}
    again = with_parts(thing, {0: "Wall"})
    assert again.category_name(0) == "Wall"
    assert not marks(again, PART_MARK)


def test_what_is_no_room_is_none_and_takes_its_surfaces_along() -> None:
    graph = with_garden()
    table = scene(room(SQUARE, 0.2) | HEDGE | LAWN | {"desk": box((1, 7, 0.7), (3, 8, 0.75))})
    assert len(recognise_structure(table).surfaces) >= 1
    marked = with_marks(table, ROOM_MARK, {rows(table, "desk")[0]: "none"})
    structure = recognise_structure(marked)
    assert sizes(marked) == [20.0]
    assert len(sizes(graph)) == 2
    assert all(surface.room < len(structure.rooms) for surface in structure.surfaces)
    assert rows(table, "desk")[0] not in {surface.row for surface in structure.surfaces}


@given(st.dictionaries(st.integers(0, 4), st.sampled_from(("", "a", "kitchen", 'say "x"', "ö")), max_size=5))
def test_marks_come_back_and_go(said: dict[int, str]) -> None:
    builder = SceneBuilder("Five")
    for number in range(5):
        builder.add(f"e{number}", uid=f"e{number}")
    graph = with_marks(with_marks(builder.build(), "other", {1: "kept"}), ROOM_MARK, said)
    assert marks(graph, ROOM_MARK) == {row: kind for row, kind in said.items() if kind}
    assert marks(graph, "other") == {1: "kept"}
    assert not marks(with_marks(graph, ROOM_MARK, dict.fromkeys(range(5), "")), ROOM_MARK)


@pytest.mark.parametrize("ending", [".json", ".usda", ".blend"])
def test_marks_are_kept_in_files(tmp_path: Path, ending: str) -> None:
    if ending == ".blend":
        pytest.importorskip("bpy")
    graph = with_parts(with_garden(), {1: THING, 2: NOTHING, 3: "Wall"})
    graph = with_marks(graph, ROOM_MARK, {0: "winter garden"})
    write_scene_file(graph, tmp_path / f"marked{ending}")
    again, _ = read_scene_file(tmp_path / f"marked{ending}")
    for key in (PART_MARK, ROOM_MARK):
        told = {graph.uid[row]: mark for row, mark in marks(graph, key).items()}
        assert told == {again.uid[row]: mark for row, mark in marks(again, key).items()}
    assert again.category_name(again.row_of_uid[graph.uid[3]]) == "Wall"


def test_a_mapping_corrects_what_is_recognised() -> None:
    graph = with_garden()
    assert sizes(apply_mapping(graph, checked_mapping({"structure": {"HEDGE*": "Thing"}}))) == [20.0]
    assert sizes(apply_mapping(graph, checked_mapping({"rooms": {"hedge side 0": "none", "lawn": "x"}}))) != [20.0]
    called = graph.replace(category=np.where(np.arange(len(graph)) == 0, 0, -1), vocabulary=("Rug",))
    floor = apply_mapping(called, checked_mapping({"structure": {graph.name[0]: "floor"}}))
    assert floor.category_name(0) == "Floor"  # whatever category there was


@pytest.mark.parametrize("part", ["Roof", "kitchen", "none"])
def test_a_mapping_that_says_what_is_not_known_is_refused(part: str) -> None:
    with pytest.raises(UniSGError, match="knows Floor, Wall, Ceiling, Door, Window, thing, nothing"):
        checked_mapping({"structure": {"*": part}})
