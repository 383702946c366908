"""Rooms of other programs in Blender: from the menu, dropped, with one scene of several; what is wrong is reported."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType, SimpleNamespace

import bpy
import numpy as np
import pytest

from tests.formats.reading import write
from tests.formats.test_layouts import internscenes, models, tdw
from tests.formats.test_simulators import DAE
from unisg_blender.blender import read_scene

pytestmark = pytest.mark.usefixtures("extension", "fresh_file")


def test_a_room_is_imported_as_a_scene_of_its_own(tmp_path: Path) -> None:
    path = write(tmp_path / "layout.json", internscenes())
    assert bpy.ops.unisg.import_layout(filepath=str(path)) == {"FINISHED"}
    scene = bpy.data.scenes["layout"]
    chair = scene.objects["chair"]
    assert chair["unisg_category"] == "chair"
    assert tuple(round(each, 4) for each in chair.dimensions) == (0.4, 0.6, 1.0)
    np.testing.assert_allclose(read_scene(scene)["chair"].world[:3, 0], (0, 1, 0), atol=1e-6)


def test_the_next_file_is_asked_for_in_the_folder_of_the_last_one(tmp_path: Path, extension: ModuleType) -> None:
    operator = extension.operators.interchange.import_layout.UNISG_OT_import_layout
    path = write(tmp_path / "layout.json", internscenes())
    bpy.ops.unisg.import_layout(filepath=str(path))
    manager = SimpleNamespace(fileselect_add=lambda _: None)
    asked = type("Asked", (), {"filepath": "", "last_folder": operator.last_folder})()
    extension.operators.base.FileOperator.invoke(asked, SimpleNamespace(window_manager=manager), None)
    assert asked.filepath == f"{tmp_path}/"


def test_one_of_several_rooms_is_asked_for(tmp_path: Path) -> None:
    write(tmp_path / "models_core.json", models())
    path = write(tmp_path / "plans.json", tdw())
    assert bpy.ops.unisg.import_layout(filepath=str(path), scene="1") == {"FINISHED"}
    assert "TDW 2-1" in bpy.data.scenes


def test_a_collada_file_comes_in_again(tmp_path: Path) -> None:
    """Blender dropped them in 5.0, and 4.5 says that it is done and brings nothing."""
    path = write(tmp_path / "part.dae", DAE.format(up="Y_UP"))
    assert bpy.ops.unisg.import_layout(filepath=str(path)) == {"FINISHED"}
    assert len(bpy.data.scenes["part"].objects["part"].data.polygons) == 4


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("a.txt", "", "ends in"),
        ("a.json", "{}", "none|no scene"),
        ("a.world", "<sdf>", "XML"),
        ("no.dae", None, "No such"),
    ],
)
def test_what_cannot_be_read_is_reported(tmp_path: Path, name: str, text: str | None, reason: str) -> None:
    if text is not None:
        write(tmp_path / name, text)
    with pytest.raises(RuntimeError, match=reason):
        bpy.ops.unisg.import_layout(filepath=str(tmp_path / name))


def test_files_can_be_dropped() -> None:
    if hasattr(bpy.types, "FileHandler"):
        handler = bpy.types.FileHandler.bl_rna_get_subclass_py("UNISG_FH_layout")
        assert handler.bl_import_operator == "unisg.import_layout"
        assert ".world" in handler.bl_file_extensions.split(";")
