"""Opening and saving: every known kind, and files that are missing, damaged, foreign or hostile."""

from __future__ import annotations

import struct
from pathlib import Path

import bpy
import pytest

from tests.blender.helpers import add, assert_same_scene, box
from unisg_blender import UniSGError
from unisg_blender.blender import new_file, open_file, read_file, read_scene, save_blend

DATA = Path(__file__).parents[1] / "data"
GLTF_CYCLE = (
    '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]}'
)
GLTF_NO_BUFFER = (
    '{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],'
    '"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],'
    '"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],'
    '"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"missing.bin"}]}'
)


def small_scene() -> None:
    parent = add("Parent")
    parent.location = (1, 2, 3)
    child = add("Child", box(), parent)
    child.rotation_euler = (0.1, 0.2, 0.3)
    child["unisg_category"], child["unisg_uid"] = "Box", "the-box"
    bpy.context.view_layer.update()


def export(path: Path) -> None:
    name = str(path)
    if path.suffix == ".blend":
        save_blend(path)
    elif path.suffix in (".glb", ".gltf"):
        kind = "GLB" if path.suffix == ".glb" else "GLTF_SEPARATE"
        bpy.ops.export_scene.gltf(filepath=name, export_format=kind, export_extras=True)
    elif path.suffix == ".fbx":
        bpy.ops.export_scene.fbx(filepath=name, use_custom_props=True)
    elif path.suffix == ".obj":
        bpy.ops.wm.obj_export(filepath=name)
    else:
        bpy.ops.wm.usd_export(filepath=name)


@pytest.mark.parametrize("suffix", [".blend", ".glb", ".gltf", ".fbx", ".obj", ".usd", ".usda", ".usdc", ".usdz"])
def test_every_kind_of_file_opens(tmp_path: Path, suffix: str) -> None:
    small_scene()
    path = tmp_path / f"scene{suffix}"
    export(path)
    graph, _ = read_file(path)
    boxes = [graph[row] for row in range(len(graph)) if graph.mesh[row] >= 0]
    assert len(boxes) == 1
    assert len(boxes[0].mesh.triangles) == 12
    assert boxes[0].world[:3, 3] == pytest.approx((0, 0, 0) if suffix == ".obj" else (1, 2, 3), abs=1e-5)
    if suffix in (".blend", ".glb", ".gltf", ".fbx"):
        assert (boxes[0].category, boxes[0].uid) == ("Box", "the-box")


def bad_files() -> dict[str, bytes]:
    alien = (DATA / "bevy" / "alien.glb").read_bytes()
    blend = (DATA / "armory-examples" / "ui_script3d.blend").read_bytes()
    crate = b"PXR-USDC" + bytes(80)
    files = {
        f"text.{end}": b"this is no scene\n" for end in ("blend", "glb", "gltf", "fbx", "obj", "usd", "usdc", "usdz")
    }
    files |= {f"empty.{end}": b"" for end in ("blend", "glb", "obj", "usda")}
    return files | {
        "half.blend": blend[: len(blend) // 2],
        "head.blend": blend[:30],
        "half.glb": alien[: len(alien) // 2],
        "long.glb": struct.pack("<4sIIII", b"glTF", 2, 2**31, 2**31 - 20, 0x4E4F534A) + b"{}",
        "cycle.gltf": GLTF_CYCLE.encode(),
        "no_buffer.gltf": GLTF_NO_BUFFER.encode(),
        "other.gltf": b'{"name": "no asset"}',
        "half.usda": b'#usda 1.0\ndef Mesh "a" {\n point3f[] points = [(0, 0,',
        "half.usdc": crate,
        "zeros.fbx": b"Kaydara FBX Binary  \x00\x1a\x00" + bytes(200),
        "bytes.obj": bytes(range(256)) * 20,
        "scene.png": b"\x89PNG",
    }


@pytest.mark.parametrize("name", bad_files())
def test_bad_files_are_refused_in_one_line(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(bad_files()[name])
    add("Left over")
    with pytest.raises(UniSGError) as caught:
        read_file(path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)
    assert "Traceback" not in str(caught.value)


@pytest.mark.parametrize("name", ["missing.glb", "."])
def test_missing_files_and_folders(tmp_path: Path, name: str) -> None:
    with pytest.raises(UniSGError):
        open_file(tmp_path / name)


def test_scripts_in_opened_files_never_run(tmp_path: Path) -> None:
    target = tmp_path / "was here"
    text = bpy.data.texts.new("startup.py")
    text.write(f"open({str(target)!r}, 'w')")
    text.use_module = True
    item = add("Driven", box())
    driver = item.driver_add("location", 0).driver
    driver.expression = f"len([open({str(target)!r}, 'w')])"
    save_blend(tmp_path / "hostile.blend")
    target.unlink(missing_ok=True)
    graph, report = read_file(tmp_path / "hostile.blend")
    assert graph.name == ("Driven",)
    assert not target.exists()
    assert any("driver" in line for line in report)


def test_saving_is_all_or_nothing(tmp_path: Path) -> None:
    small_scene()
    graph = read_scene()
    path = tmp_path / "scene.blend"
    save_blend(path)
    assert [item.name for item in tmp_path.iterdir()] == ["scene.blend"]
    new_file()
    assert_same_scene(graph, read_file(path)[0])
    for bad in (tmp_path / "no folder" / "scene.blend", tmp_path):
        with pytest.raises(UniSGError):
            save_blend(bad)
    assert [item.name for item in tmp_path.iterdir()] == ["scene.blend"]


def test_what_is_lost_is_said_per_object() -> None:
    _, report = read_file(DATA / "vrm-addon" / "share_mesh_modified_and_non_modified_vrm1.blend")
    lines = list(report)
    assert any("modifiers" in line for line in lines)
    assert any("vertex groups" in line for line in lines)
    assert "objects)" in report.summary()


def test_a_file_without_objects_is_an_empty_scene(tmp_path: Path) -> None:
    save_blend(tmp_path / "nothing.blend")
    graph, report = read_file(tmp_path / "nothing.blend")
    assert len(graph) == 0
    assert any("no objects" in line for line in report)


def test_one_of_several_scenes(tmp_path: Path) -> None:
    add("First", box())
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(bpy.data.objects.new("Second", None))
    save_blend(tmp_path / "two.blend")
    assert read_file(tmp_path / "two.blend")[0].name == ("First",)
    graph, report = read_file(tmp_path / "two.blend", scene="Other")
    assert graph.name == ("Second",)
    assert "only the scene 'Other' is read; the others are 'Scene'" in list(report)
    with pytest.raises(UniSGError, match=r"there is no scene 'Third'.*; there are 'Other', 'Scene'"):
        read_file(tmp_path / "two.blend", scene="Third")


def test_paths_are_those_of_the_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Blender itself would resolve them against the variable PWD."""
    for name in ("here", "elsewhere"):
        (tmp_path / name).mkdir()
        new_file()
        bpy.context.scene.name = name
        save_blend(tmp_path / name / "scene.blend")
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setenv("PWD", str(tmp_path / "elsewhere"))
    graph, _ = read_file("scene.blend")
    assert graph.title == "here"
    save_blend("again.blend")
    assert sorted(path.name for path in Path().iterdir()) == ["again.blend", "scene.blend"]
    assert [path.name for path in (tmp_path / "elsewhere").iterdir()] == ["scene.blend"]


@pytest.mark.parametrize("value", [-1, 24, 2**31 - 1])
@pytest.mark.parametrize("name", [".corner_edge", ".corner_vert"])
def test_a_mesh_whose_numbers_do_not_fit_is_refused(tmp_path: Path, name: str, value: int) -> None:
    mesh = box("Broken")  # of 8 points, 12 edges and 24 corners
    add("Box", mesh)
    mesh.attributes[name].data[3].value = value
    save_blend(tmp_path / "broken.blend")
    with pytest.raises(UniSGError, match=r"cannot read .*broken\.blend: the mesh 'Broken' is damaged"):
        read_file(tmp_path / "broken.blend", geometry="original")


def test_what_stumbles_over_a_file_is_told_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from unisg_blender.blender import blend_files

    def stumbles(*args, **options):
        return {}["colour"]

    add("Box", box())
    save_blend(tmp_path / "box.blend")
    monkeypatch.setattr(blend_files, "read_scene", stumbles)
    with pytest.raises(UniSGError, match=r"box\.blend: is it damaged\? .*report this: KeyError: 'colour'"):
        read_file(tmp_path / "box.blend")


def test_names_that_are_no_unicode_are_read(tmp_path: Path) -> None:
    """As in files that were saved before Blender 2.5."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    mesh = bpy.data.meshes.new("Seinaet mesh")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.uv_layers.new(name="Seinaet uv")
    mesh.materials.append(bpy.data.materials.new("Seinaet paint"))
    thing = bpy.data.objects.new("Seinaet", mesh)
    thing.vertex_groups.new(name="Seinaet group")
    bpy.context.scene.collection.objects.link(thing)
    path = tmp_path / "old.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
    path.write_bytes(path.read_bytes().replace(b"Seinaet", b"Sein\xe4et"))
    graph, _ = read_file(path)
    assert graph.name == ("Sein\xe4et",)
    assert graph.meshes[0].materials == ("Sein\xe4et paint",)
    assert [layer.name for layer in bpy.data.meshes[0].uv_layers] == ["Sein\xe4et uv"]
    assert [group.name for group in bpy.data.objects[0].vertex_groups] == ["Sein\xe4et group"]
