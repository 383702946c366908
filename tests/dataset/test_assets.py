"""What a dataset keeps of its scenes' geometry."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.dataset.conftest import CORNERS, FACES, box
from unisg_blender.dataset import open_dataset, write_dataset
from unisg_blender.dataset.assets import asset_collector as collect
from unisg_blender.dataset.assets.asset import Asset, object_graph, shell_of
from unisg_blender.dataset.assets.asset_collector import AssetCollector
from unisg_blender.dataset.assets.asset_file import AssetFile, Assets, assets_bytes, pack_assets
from unisg_blender.dataset.scenes_with_shapes import scenes_with_shapes
from unisg_blender.errors import UniSGError
from unisg_blender.scene import Material, Mesh, SceneBuilder, SceneGraph, mesh_from_faces
from unisg_blender.spatial.object_rows import object_rows


def room(number: int, shapes: int = 1, faces: int = 6) -> SceneGraph:
    """A floor with a chair of two parts (seat uncategorised below an empty) and some lamps of different shapes."""
    builder = SceneBuilder(title=f"room {number}")
    builder.add("Floor", uid="f", mesh=box("floor", (4.0, 3.0 + number, 0.1)), category="Floor")
    chair = builder.add("Chair", uid="c", category="Chair")
    builder.add("Seat", uid="s", parent=chair, mesh=box("seat", (0.4, 0.4, 0.1 + 0.01 * number)))
    for shape in range(shapes):
        mesh = mesh_from_faces("lamp", CORNERS * (0.1 + shape + 10 * number), FACES * (faces // 6))
        builder.add(f"Lamp {shape}", uid=f"l{shape}", mesh=mesh, category="Lamp")
    return builder.build()


def collected(*graphs: SceneGraph) -> AssetCollector:
    collector = AssetCollector()
    for number, graph in enumerate(graphs):
        collector.add(graph, f"file {number}")
    return collector


def packed(collector: AssetCollector) -> Assets:
    arrays, index = collector.pack()
    return Assets(index, lambda names: {name: arrays[name] for name in names if name in arrays})


def test_a_written_dataset_keeps_different_things_of_each_category(tmp_path: Path) -> None:
    write_dataset([room(number, shapes=3) for number in range(5)], tmp_path / "ds")
    file = open_dataset(tmp_path / "ds").assets()
    assert file is not None
    assert [len(file.numbers(name)) for name in ("Lamp", "Chair", "Floor", "")] == [8, 5, 0, 5]
    chair = file.asset(file.numbers("Chair")[1])
    assert (chair.graph.name, chair.graph.parent.tolist()) == (("Chair", "Seat"), [-1, 0])
    assert np.allclose(np.ptp(chair.graph.meshes[0].points, axis=0), (0.4, 0.4, 0.11))
    scene = next(scenes_with_shapes(open_dataset(tmp_path / "ds")))
    assert len(scene.meshes[scene.mesh[scene.row("Lamp 0")]].points) == 8


def test_an_overwritten_dataset_keeps_nothing_of_the_old_one(tmp_path: Path) -> None:
    write_dataset([room(0)], tmp_path / "ds")
    (tmp_path / "ds" / "assets.safetensors").write_bytes(b"of an early version")
    bare = SceneBuilder(title="bare")
    bare.add("Empty", uid="e", category="Lamp")
    write_dataset([bare.build()], tmp_path / "ds", overwrite=True)
    assert open_dataset(tmp_path / "ds").assets() is None
    assert not list((tmp_path / "ds").glob("assets*"))


def test_damaged_assets_are_noticed(tmp_path: Path) -> None:
    write_dataset([room(0)], tmp_path / "ds")
    path = next((tmp_path / "ds").glob("assets-*"))
    data = bytearray(path.read_bytes())
    data[-5] ^= 1
    path.write_bytes(data)
    for use in (lambda: open_dataset(tmp_path / "ds").assets(), lambda: open_dataset(tmp_path / "ds").check()):
        with pytest.raises(UniSGError, match="damaged"):
            use()
    path.unlink()
    with pytest.raises(UniSGError, match="cannot be read"):
        open_dataset(tmp_path / "ds").assets()


def test_merging_by_source_gives_what_the_sources_gave(tmp_path: Path) -> None:
    rooms = [room(number, shapes=4) for number in range(4)]
    whole = packed(merged([packed(collected(graph)) for graph in rooms]))
    again = AssetCollector()
    for number, graph in enumerate(rooms):
        again.merge(whole, f"file {number}", [mesh.checksum for mesh in graph.meshes])
    assert assets_bytes(*again.pack()) == assets_bytes(*merged([packed(collected(graph)) for graph in rooms]).pack())
    assert {record["source"] for record in whole.index["assets"]} == {f"file {number}" for number in range(4)}


def merged(parts: list[Assets]) -> AssetCollector:
    collector = AssetCollector()
    for number, part in enumerate(parts):
        for record in part.index["assets"]:
            record["source"] = f"file {number}"
        collector.merge(part, f"file {number}", part.shapes("parts"))
    return collector


def test_large_things_are_kept_only_where_there_is_no_smaller_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(collect, "MOST_FACES", 12)
    monkeypatch.setattr(collect, "LARGEST", 30)
    found = packed(collected(room(1, faces=36), room(2, faces=24), room(3, faces=24), room(4)))
    assert [found.index["assets"][number]["faces"] for number in found.numbers("Lamp")] == [24, 6]


def test_all_together_stays_within_a_budget_but_each_category_has_something(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(collect, "BUDGET", 30)
    found = packed(collected(*(room(number, shapes=2) for number in range(6))))
    assert sum(record["faces"] for record in found.index["assets"]) <= 30
    assert found.numbers("Chair")
    assert found.numbers("Lamp")


def test_materials_of_the_same_name_from_different_files_stay_apart() -> None:
    assets = []
    for number in range(3):
        mesh = box("lamp", (1.0, 1.0, 1.0 + number))
        slotted = Mesh(mesh.name, mesh.points, mesh.corners, mesh.offsets, materials=("Material", "Common"))
        builder = SceneBuilder()
        builder.add("Lamp", uid="l", mesh=slotted, category="Lamp")
        color = (number % 2, 0.0, 0.0, 1.0)
        materials = {"Material": Material("Material", color), "Common": Material("Common")}
        assets.append(Asset("Lamp", builder.build().replace(materials=materials)))
    arrays, index = pack_assets(assets)
    found = Assets(index, lambda names: {name: arrays[name] for name in names if name in arrays})
    for number in range(3):
        graph = found.asset(number).graph
        name, common = graph.meshes[0].materials
        assert graph.materials[name].base_color == (number % 2, 0.0, 0.0, 1.0)
        assert common == "Common"
    assert sorted(index["materials"]) == ["Common", "Material", "Material.001"]


def test_what_somebody_calls_a_floor_may_be_anything() -> None:
    builder = SceneBuilder()
    line = mesh_from_faces("line", np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), [[0, 1, 2]])
    builder.add("A", uid="a", mesh=line, category="Floor")
    builder.add("B", uid="b", mesh=mesh_from_faces("none", np.zeros((0, 3)), []), category="Floor")
    builder.add("C", uid="c", category="Floor")
    collector = collected(builder.build())
    assert not collector.outlines
    assert collector.pack()[1]["parts"]


def test_a_room_takes_the_parts_of_its_walls_along() -> None:
    builder = SceneBuilder()
    floor = builder.add("Floor", uid="f", category="Floor")
    builder.add("Slab", uid="s", parent=floor, mesh=box("slab", (4.0, 4.0, 0.1)))
    builder.add("Lamp", uid="l", parent=floor, mesh=box("lamp", (0.1, 0.1, 0.1)), category="Lamp")
    graph = builder.build()
    shell = shell_of(graph)
    assert shell is not None
    assert shell.graph.name == ("Floor", "Slab")
    assert [graph.name[row] for row in object_rows(graph)] == ["Floor", "Lamp", "Floor"]
    assert object_graph(graph, graph.row("Lamp")).faces == 6


def test_other_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "x.safetensors").write_bytes(b"nothing")
    with pytest.raises(UniSGError, match="no assets file"):
        AssetFile(tmp_path / "x.safetensors")
