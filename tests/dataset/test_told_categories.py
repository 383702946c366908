"""What has no category is told by its name and its place: exported, classified, in the words of a dataset."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.meshes.shapes import box
from tests.words.foreign_scenes import bedroom, kitchen
from unisg_blender.dataset import open_dataset
from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset
from unisg_blender.dataset.told_categories import told_categories
from unisg_blender.formats import write_scene_file
from unisg_blender.predict import SceneModel
from unisg_blender.scene import SceneBuilder, SceneGraph


def categories(graph: SceneGraph) -> dict[str, str]:
    return {name: graph.category_name(row) for row, name in enumerate(graph.name)}


def test_names_and_places_tell() -> None:
    assert categories(told_categories(kitchen())) == {
        "Ground": "Floor", "N": "Wall", "S": "Wall", "E": "Wall", "W": "Wall", "Fridge.001": "Refrigerator",
        "SM_Stove_01": "Cooker", "kitchen_sink": "Sink", "Table": "Table", "Stuhl_03": "Chair", "Cube.007": "",
    }  # fmt: skip


def test_in_the_words_of_a_vocabulary() -> None:
    found = categories(told_categories(bedroom(), ("Floor", "Wall", "Couch", "Bed", "Side Table"), {"衣柜": "Couch"}))
    assert (found["Doppelbett"], found["comodino"], found["衣柜_01"]) == ("Bed", "Side Table", "Couch")
    assert (found["Ground"], found["W"]) == ("Floor", "Wall")


def test_what_the_user_said_stays() -> None:
    builder = SceneBuilder("own")
    builder.add("Chair", uid="a", category="Throne", mesh=box((1, 1, 1)))
    assert told_categories(builder.build()).category_name(0) == "Throne"


def test_the_kind_of_a_foreign_scene_is_told_by_its_things() -> None:
    found = SceneModel().classify(kitchen())
    assert found.kind == ""
    assert found.by_things == "kitchen"
    assert "looks like: kitchen" in found.lines[0]


@pytest.mark.slow
def test_an_export_understands_when_asked(tmp_path: Path) -> None:
    write_scene_file(kitchen(), tmp_path / "k.json")
    for number, understand in enumerate((False, True)):
        out = tmp_path / f"d{number}"
        export_dataset([tmp_path / "k.json"], out, ExportOptions(understand=understand), jobs=1)
        assert ("Refrigerator" in open_dataset(out).vocabulary["categories"]) is understand
        assert ("Floor" in open_dataset(out).vocabulary["categories"]) is understand
