from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")


@pytest.fixture
def scene(extension: ModuleType) -> bpy.types.Scene:
    """A cube named Chair, active and selected, a bigger cube and a ball."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.context.window_manager.unisg_meshes.proposals.clear()
    bpy.ops.mesh.primitive_uv_sphere_add(location=(5, 0, 0), segments=16, ring_count=8)
    bpy.context.object.name = "Ball"
    bpy.ops.mesh.primitive_cube_add(location=(0, 5, 0), size=2.5)
    bpy.context.object.name = "Crate"
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name = "Chair"
    return bpy.context.scene


def test_encode_stores_a_feature_that_decodes(scene: bpy.types.Scene) -> None:
    chair = bpy.context.object
    assert bpy.ops.unisg.encode_mesh() == {"FINISHED"}
    assert isinstance(chair.data["unisg_mesh_feature"], str)
    chair.location = (1, 2, 3)
    assert bpy.ops.unisg.decode_mesh(faces=600, beside=False) == {"FINISHED"}
    made = bpy.context.object
    assert made.name == "Chair decoded"
    assert len(made.data.polygons) == 600
    assert tuple(made.location) == (1, 2, 3)
    assert 0.5 < max(made.dimensions) < 4
    assert made.select_get()
    assert not chair.select_get()


def test_decode_encodes_what_has_no_feature(scene: bpy.types.Scene) -> None:
    assert bpy.ops.unisg.decode_mesh(faces=100) == {"FINISHED"}
    assert "unisg_mesh_feature" not in bpy.data.objects["Chair"].data


def test_a_damaged_feature_is_reported(scene: bpy.types.Scene) -> None:
    bpy.context.object.data["unisg_mesh_feature"] = "{"
    with pytest.raises(RuntimeError, match="encode the mesh again"):
        bpy.ops.unisg.decode_mesh()
    assert len(scene.objects) == 3


def test_modifiers_count(scene: bpy.types.Scene) -> None:
    bpy.ops.unisg.encode_mesh()
    data = bpy.context.object.data
    before = data["unisg_mesh_feature"]
    bpy.context.object.modifiers.new("Bend", "WIREFRAME").thickness = 0.1
    bpy.ops.unisg.encode_mesh()
    assert data["unisg_mesh_feature"] != before


def test_an_empty_mesh_is_an_error_and_stays(scene: bpy.types.Scene) -> None:
    item = bpy.data.objects.new("Nothing", bpy.data.meshes.new("Nothing"))
    scene.collection.objects.link(item)
    bpy.context.view_layer.objects.active = item
    with pytest.raises(RuntimeError, match="no points"):
        bpy.ops.unisg.encode_mesh()
    assert item.name in scene.objects


def test_find_similar_in_the_scene(scene: bpy.types.Scene) -> None:
    assert bpy.ops.unisg.find_similar(count=2) == {"FINISHED"}
    settings = bpy.context.window_manager.unisg_meshes
    assert [match.name for match in settings.matches] == ["Crate", "Ball"]
    assert bpy.data.objects["Crate"].select_get()


def test_sizes_are_compared_in_metres_whatever_the_unit(scene: bpy.types.Scene, tmp_path: Path) -> None:
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")
    for size, name in ((0.01, "small"), (1.0, "large")):
        lines = [f"v {size * x} {size * y} {size * z}" for x, y, z in corners]
        lines += ["f " + " ".join(map(str, face)) for face in faces]
        (tmp_path / f"{name}.obj").write_text("\n".join(lines) + "\n")
    for metres, name in ((1.0, "large"), (0.01, "small")):  # the cube of 2 units
        scene.unit_settings.scale_length = metres
        assert bpy.ops.unisg.find_similar(folder=str(tmp_path), use_size=True) == {"FINISHED"}
        assert bpy.context.window_manager.unisg_meshes.matches[0].name.endswith(f"{name}.obj")


def test_find_similar_in_a_folder(scene: bpy.types.Scene, tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="no mesh files"):
        bpy.ops.unisg.find_similar(folder=str(tmp_path))
    (tmp_path / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")
    (tmp_path / "broken.ply").write_text("ply")
    assert bpy.ops.unisg.find_similar(folder=str(tmp_path)) == {"FINISHED"}
    assert bpy.context.window_manager.unisg_meshes.matches[0].name.endswith("flat.obj")


def test_propose_and_accept_one_and_all(scene: bpy.types.Scene) -> None:
    settings = bpy.context.window_manager.unisg_meshes
    assert bpy.ops.unisg.label() == {"FINISHED"}
    assert {item.name for item in settings.proposals} == {"Chair", "Crate", "Ball"}
    assert not any("unisg_category" in item for item in scene.objects)
    chair = next(item for item in settings.proposals if item.name == "Chair")
    confidences = [guess.confidence for guess in chair.guesses]
    assert confidences == sorted(confidences, reverse=True)
    assert 0 < sum(confidences) <= 1 + 1e-6
    assert bpy.ops.unisg.accept_category(uid=chair.uid, category=chair.guesses[1].name) == {"FINISHED"}
    assert bpy.data.objects["Chair"]["unisg_category"]
    assert len(settings.proposals) == 2
    assert bpy.ops.unisg.accept_categories(threshold=0.0) == {"FINISHED"}
    assert all(item["unisg_category"] for item in scene.objects)
    assert len(settings.proposals) == 0
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.unisg.label()


def test_a_click_on_a_proposal_selects_its_object(scene: bpy.types.Scene) -> None:
    bpy.ops.unisg.label()
    settings = bpy.context.window_manager.unisg_meshes
    settings.active = [item.name for item in settings.proposals].index("Ball")
    assert bpy.context.active_object.name == "Ball"
    assert [item.name for item in bpy.context.selected_objects] == ["Ball"]
    settings.active = 99
    assert bpy.context.active_object.name == "Ball"


def test_selected_only(scene: bpy.types.Scene) -> None:
    bpy.ops.unisg.label(selected_only=True)
    assert [item.name for item in bpy.context.window_manager.unisg_meshes.proposals] == ["Chair"]


def test_accepting_a_vanished_object_is_an_error(scene: bpy.types.Scene) -> None:
    with pytest.raises(RuntimeError, match="no longer there"):
        bpy.ops.unisg.accept_category(uid="gone", category="Chair")


def test_poll_wants_a_mesh_in_object_mode(scene: bpy.types.Scene) -> None:
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.unisg.encode_mesh.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.empty_add()
    assert not bpy.ops.unisg.encode_mesh.poll()
    assert not bpy.ops.unisg.decode_mesh.poll()


def test_undo_takes_a_category_back(scene: bpy.types.Scene) -> None:
    bpy.ops.ed.undo_push(message="start")
    bpy.ops.unisg.label()
    uid = bpy.context.window_manager.unisg_meshes.proposals[0].uid
    name = bpy.context.window_manager.unisg_meshes.proposals[0].name
    bpy.ops.unisg.accept_category("EXEC_DEFAULT", True, uid=uid, category="Box")
    assert bpy.data.objects[name]["unisg_category"] == "Box"
    bpy.ops.ed.undo()
    assert "unisg_category" not in bpy.data.objects[name]


def test_decoded_points_are_finite(scene: bpy.types.Scene) -> None:
    bpy.ops.unisg.decode_mesh(faces=50)
    points = np.empty(len(bpy.context.object.data.vertices) * 3, np.float32)
    bpy.context.object.data.vertices.foreach_get("co", points)
    assert np.isfinite(points).all()
