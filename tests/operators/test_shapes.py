"""Where shapes come from: what was chosen, what is marked as an asset here or in a library; linked or appended."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

pytestmark = pytest.mark.slow

SEED = 5
"""Of the fixture ``room``."""

CATALOG = "0d4ba9d4-3f6e-4a5b-9d63-0a1c5a9f3b11"
LIBRARY = f"""
import bpy, sys
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)

def cube(name, size, **marks):
    bpy.ops.mesh.primitive_cube_add(size=size, location=(4, 2, size / 2))
    item = bpy.context.object
    item.name = item.data.name = name
    material = bpy.data.materials.new(name + " Paint")
    item.data.materials.append(material)
    for key, value in marks.items():
        item[key] = value
    return item

cube("Thing A", 0.41).asset_mark()
bpy.data.objects["Thing A"].asset_data.tags.new("couch")
cube("Thing B", 0.42, unisg_category="Plant").asset_mark()
arrayed = cube("Thing C", 0.2)
arrayed.modifiers.new("Array", "ARRAY").count = 3
arrayed.asset_mark()
arrayed.asset_data.catalog_id = "{CATALOG}"
cube("Nothing", 0.3)
group = bpy.data.collections.new("Vase Blue")
group.objects.link(cube("Vase Part", 0.15))
group.asset_mark()
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
"""


@pytest.fixture(scope="module")
def library_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two files of assets, of which one is damaged, and catalogs."""
    folder = tmp_path_factory.mktemp("library")
    (folder / "things").mkdir()
    made = [sys.executable, "-c", LIBRARY + "\nimport os; os._exit(0)", str(folder / "things" / "assets.blend")]
    subprocess.run(made, check=True, capture_output=True, timeout=120)
    (folder / "damaged.blend").write_bytes(b"nothing")
    text = f"# catalogs\nVERSION 1\n\n{CATALOG}:Furniture/Bookcases:Furniture-Bookcases\n"
    (folder / "blender_assets.cats.txt").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def library(library_folder: Path, extension: ModuleType, room: None) -> Iterator[Path]:
    """The folder as an asset library of the preferences, looked through."""
    index = extension.operators.shapes.library_index
    index.forget()
    listed = bpy.context.preferences.filepaths.asset_libraries
    while len(listed):
        bpy.ops.preferences.asset_library_remove(index=0)
    bpy.ops.preferences.asset_library_add(directory=str(library_folder))
    listed[0].name = "Mine"
    assert bpy.ops.unisg.look_through_libraries() == {"FINISHED"}
    yield library_folder
    bpy.ops.preferences.asset_library_remove(index=0)
    index.forget()


def generated(add: str, **how: object) -> list[bpy.types.Object]:
    """What is new, without the parts."""
    before = {item.name for item in bpy.data.objects}
    assert bpy.ops.unisg.generate(add=add, model="living_room", seed=2, **how) == {"FINISHED"}
    bpy.context.view_layer.update()
    return [item for item in bpy.context.scene.objects if item.name not in before]


def source(extension: ModuleType, category: str) -> SimpleNamespace:
    return extension.operators.shapes.shape_sources.source_of(bpy.context.scene, category)


def test_where_shapes_come_from_by_category_tag_catalog_and_name(extension: ModuleType, library: Path) -> None:
    assert source(extension, "Plant").text == "Thing B of Mine"
    assert source(extension, "Sofa").text == "Thing A of Mine"
    assert source(extension, "Bookshelf").text == "Thing C of Mine"
    assert source(extension, "Vase").text == "Vase Blue of Mine"
    assert source(extension, "Chair").kind == "SCENE"
    assert source(extension, "Toaster").kind == "MODEL"


def test_looking_leaves_the_file_as_it_was_and_reads_only_what_changed(extension: ModuleType, library: Path) -> None:
    assert not bpy.data.libraries
    index = extension.operators.shapes.library_index
    there = index.blend_files([library])
    assert len(there) == 2
    assert index.changed_files(there) == []
    there[str(library / "things" / "assets.blend")][0] += 1
    assert index.changed_files(there) == [str(library / "things" / "assets.blend")]


def test_an_object_of_a_library_is_a_linked_duplicate(library: Path) -> None:
    (plant,) = generated("Plant=1")
    assert plant.data.name == "Thing B"
    assert Path(bpy.path.abspath(plant.data.library.filepath)) == library / "things" / "assets.blend"
    assert (plant.library, plant["unisg_category"]) == (None, "Plant")
    assert not [mesh for mesh in bpy.data.meshes if mesh.name.startswith("Thing B") and mesh.library is None]
    assert not bpy.data.materials.get(("Thing B Paint", None))
    corners = np.array([plant.matrix_world @ vertex.co for vertex in plant.data.vertices])
    assert corners[:, 2].min() == pytest.approx(0, abs=1e-3)
    np.testing.assert_allclose(np.ptp(corners[:, 2]), 0.42, atol=1e-5)


def test_with_modifiers_it_is_an_instance_as_large_as_it_shows(library: Path) -> None:
    (shelf,) = generated("Bookshelf=1")
    assert (shelf.type, shelf.instance_type) == ("EMPTY", "COLLECTION")
    (part,) = shelf.instance_collection.all_objects
    assert (part.name, len(part.modifiers)) == ("Thing C", 1)
    assert part.name not in bpy.context.scene.objects
    corners = np.array([
        each.matrix_world @ vertex.co
        for each in bpy.context.evaluated_depsgraph_get().object_instances
        if each.is_instance and each.parent.original == shelf
        for vertex in each.object.data.vertices
    ])  # fmt: skip
    assert max(np.ptp(corners, axis=0)) == pytest.approx(0.6, abs=0.02)
    assert corners[:, 2].min() == pytest.approx(0, abs=1e-3)


def test_a_collection_of_a_library_is_an_instance_and_things_stand_on_what_is_there(library: Path) -> None:
    new = generated("Vase=2")
    assert {item.instance_collection.name for item in new} == {"Vase Blue"}
    assert all(item.parent is not None for item in new)
    assert len(bpy.data.libraries) == 1


def test_appended_it_is_of_this_file(library: Path, extension: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(extension.operators.preferences.DEFAULTS, "use", "APPEND")
    (plant,) = generated("Plant=1")
    assert plant.data.library is None
    assert plant.data.name == "Thing B"


def test_this_file_comes_before_libraries_and_what_was_chosen_before_all(
    extension: ModuleType, library: Path, tmp_path: Path
) -> None:
    bpy.ops.mesh.primitive_cube_add(size=0.37, location=(30, 0, 0))
    mine = bpy.context.object
    mine.name, mine["unisg_category"] = "Own Pot", "Plant"
    mine.asset_mark()
    assert source(extension, "Plant").text == "Own Pot of this file"
    (plant,) = generated("Plant=1")
    assert plant.data == mine.data
    other = next(item for item in bpy.data.objects if item.get("unisg_category") == "Cup")
    name = other.name
    assert bpy.ops.unisg.choose_shape(category="Plant") == {"FINISHED"}
    bpy.context.scene.unisg_shapes["Plant"].object = other
    assert source(extension, "Plant").kind == "CHOSEN"
    (plant,) = generated("Plant=1")
    assert (plant.data, plant["unisg_category"]) == (other.data, "Plant")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "kept.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    assert bpy.context.scene.unisg_shapes["Plant"].object.name == name
    assert bpy.ops.unisg.choose_shape(category="Plant", remove=True) == {"FINISHED"}
    assert source(extension, "Plant").kind == "FILE"


def test_placing_begins_with_them(library: Path) -> None:
    before = set(bpy.context.scene.objects)
    assert bpy.ops.unisg.place(category="Plant", model="living_room", seed=1, location=(0, 0, 0)) == {"FINISHED"}
    (plant,) = set(bpy.context.scene.objects) - before
    assert plant.data.name == "Thing B"


def test_the_list_offers_every_asset_and_knows_what_it_is(extension: ModuleType, library: Path) -> None:
    module = extension.operators.placing.choose_and_place
    extension.operators.making.generation_settings.choose_model(bpy.context, "living_room")
    found = {text: key for key, text, _ in module._choices(None, bpy.context)}
    assert {"Thing A (Mine)", "Thing B (Mine)", "Thing C (Mine)", "Vase Blue (Mine)"} <= set(found)
    assets = {asset.shape.name: asset for asset in module._assets()}
    assert module._category(assets["Thing A"], "living_room") == "Sofa"
    text = assets["Thing A"].shape.text
    before = set(bpy.context.scene.objects)
    assert bpy.ops.unisg.place(asset=text, category="Sofa", how="ANYWHERE", model="living_room", seed=1) == {"FINISHED"}
    (sofa,) = set(bpy.context.scene.objects) - before
    assert (sofa.data.name, sofa["unisg_category"]) == ("Thing A", "Sofa")


def test_what_has_gone_is_told_and_nothing_is_made(library: Path, tmp_path: Path) -> None:
    file = library / "things" / "assets.blend"
    kept = file.rename(tmp_path / "away.blend")
    count = len(bpy.data.objects)
    try:
        with pytest.raises(RuntimeError, match="look through the asset libraries again"):
            bpy.ops.unisg.generate(add="Plant=1", model="living_room", seed=2)
    finally:
        kept.rename(file)
    assert len(bpy.data.objects) == count


def test_a_blender_of_its_own_writes_a_line_for_each_file(library_folder: Path, tmp_path: Path) -> None:
    import unisg_blender.blender.assets.asset_script as script

    listed = tmp_path / "files.txt"
    listed.write_text(f"{library_folder / 'damaged.blend'}\n{library_folder / 'things' / 'assets.blend'}\n")
    code = f"import runpy, sys; sys.argv = ['x', {str(tmp_path / 'out')!r}, {str(listed)!r}]\n"
    code += f"runpy.run_path({script.__file__!r}, run_name='__main__')\nimport os; os._exit(0)"
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, timeout=120)
    bad, good = map(json.loads, (tmp_path / "out").read_text().splitlines())
    assert bad["error"]
    assert {item["name"] for item in good["assets"]} == {"Thing A", "Thing B", "Thing C", "Vase Blue"}
