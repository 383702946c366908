from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from unisg_blender.dataset import Sample, open_dataset, to_scenegraph, write_dataset
from unisg_blender.dataset.format import writer
from unisg_blender.dataset.format.behaviour_rows import LINKS
from unisg_blender.dataset.format.columns import Vocabulary, join, scene_count
from unisg_blender.dataset.format.encoding import encode_scenes
from unisg_blender.dataset.format.schema import COLUMNS, STRINGS, TABLES
from unisg_blender.errors import UniSGError
from unisg_blender.poses import FORMS
from unisg_blender.scene import SceneBuilder, SceneGraph, local_bounds, world_matrices

Make = Callable[..., SceneGraph]
DOCS = Path(__file__).parents[2] / "docs" / "dataset.md"


def same_layout(graph: SceneGraph, again: SceneGraph) -> None:
    assert (again.name, again.uid, again.title) == (graph.name, graph.uid, graph.title)
    assert_array_equal(again.parent, graph.parent)
    assert_array_equal(again.type, graph.type)
    names = [graph.category_name(row) for row in range(len(graph))]
    assert [again.category_name(row) for row in range(len(graph))] == names
    scale = np.abs(graph.local).max()
    assert_allclose(again.local, graph.local, atol=2e-6 * scale)
    assert_allclose(world_matrices(again), world_matrices(graph), atol=1e-5 * scale**2)
    assert_allclose(local_bounds(again), local_bounds(graph), atol=1e-7)
    assert_array_equal(again.mesh < 0, graph.mesh < 0)


@pytest.mark.parametrize("form", FORMS)
def test_layout_comes_back(tmp_path: Path, scenes: list[SceneGraph], form: str) -> None:
    if form == "cga_similarity":
        scenes = scenes[:2]
    write_dataset(scenes, tmp_path / "ds", form)
    dataset = open_dataset(tmp_path / "ds")
    assert len(dataset) == len(scenes)
    assert dataset.form == form
    for graph, scene in zip(scenes, dataset, strict=True):
        assert scene.features.shape == (len(graph), FORMS[form].width + 6)
        same_layout(graph, to_scenegraph(scene))


def test_behaviour_and_relations_come_back(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    write_dataset(scenes, tmp_path / "ds")
    for graph, scene in zip(scenes, open_dataset(tmp_path / "ds"), strict=True):
        again = to_scenegraph(scene)
        assert list(again.components["lsa"].columns["data"]) == list(graph.components["lsa"].columns["data"])
        if "actions" in graph.components:
            table, copy = graph.components["actions"], again.components["actions"]
            assert_array_equal(copy.rows, table.rows)
            assert list(copy.columns["data"]) == list(table.columns["data"])
        inside = (
            [uid in graph.row_of_uid for uid in graph.components["relations"].columns["target"]]
            if len(graph) > 2
            else []
        )
        if any(inside):
            assert_array_equal(again.components["relations"].rows, graph.components["relations"].rows[inside])


def test_rows_of_behaviour(make_scene: Make) -> None:
    graph = make_scene(0)
    columns = encode_scenes([Sample(graph)], "quaternion", Vocabulary())
    tool, desk = graph.row("Tool.0"), graph.row("Tisch ü")
    assert columns["action.entity"].tolist() == [tool]
    kinds = [LINKS[kind][1] for kind in columns["link.kind"]]
    links = set(zip(kinds, columns["link.source"].tolist(), columns["link.target"].tolist(), strict=True))
    assert {("targets", 0, desk), ("uses", 0, tool)} <= links  # the tool "elsewhere" is not in the scene
    assert ("contains", 0, 1) in links
    assert len(columns["lesson.vector"]) == 1
    assert len(columns["stage.vector"]) == 2
    assert columns["operation.entity"].tolist() == [graph.row("Operation")]
    assert columns["relation.subject"].tolist() == [graph.row(f"Tool.{number}") for number in range(3)]


def test_meshes_are_stored_once(tmp_path: Path, make_scene: Make) -> None:
    manifest = write_dataset([make_scene(seed) for seed in range(300)], tmp_path / "ds")
    assert manifest["counts"]["meshes"] == 2


def test_mesh_encoder(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    calls = []

    def encoder(mesh: object) -> np.ndarray:
        calls.append(mesh)
        return np.full(5, len(calls))

    empty = SceneBuilder("nothing with a mesh")
    empty.add("Empty", uid="e")
    manifest = write_dataset([empty.build(), *scenes], tmp_path / "ds", mesh_encoder=encoder)
    assert manifest["mesh_feature_width"] == 5
    assert len(calls) == 2
    scene = open_dataset(tmp_path / "ds")[4]
    assert scene["mesh.feature"].shape == (2, 5)
    with pytest.raises(UniSGError, match="finite"):
        write_dataset(scenes, tmp_path / "other", mesh_encoder=lambda mesh: np.full(3, np.nan))
    assert not (tmp_path / "other").exists()


def test_shards_do_not_depend_on_how_scenes_arrive(
    tmp_path: Path, make_scene: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenes = [make_scene(seed) for seed in range(30)]
    monkeypatch.setattr(writer, "SCENES_PER_SHARD", 10)
    monkeypatch.setattr(writer, "CHUNK", 5)
    write_dataset(scenes, tmp_path / "a")
    write_dataset(iter(scenes), tmp_path / "b")
    files = [sorted((path.name, path.read_bytes()) for path in (tmp_path / name).iterdir()) for name in "ab"]
    assert files[0] == files[1]
    dataset = open_dataset(tmp_path / "a", memory=1)
    assert len(dataset.manifest["shards"]) == 3
    assert [dataset[index].title for index in (29, 0, 10, 9)] == ["Scene 29", "Scene 0", "Scene 10", "Scene 9"]
    middle = dataset.columns(8, 23)
    assert scene_count(middle) == 15
    assert_array_equal(middle["entity.features"][-1], dataset[22].features[-1])


def test_join_and_cut_are_inverse(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    vocabulary = Vocabulary()
    parts = [encode_scenes([Sample(graph)], "pga_even", vocabulary) for graph in scenes]
    write_dataset(scenes, tmp_path / "ds", "pga_even")
    dataset = open_dataset(tmp_path / "ds")
    whole = dataset.columns(0, len(dataset))
    joined = join(parts)
    for key in joined:
        if not key.startswith("scene.source"):
            assert_array_equal(whole[key], joined[key], err_msg=key)
    for number, part in enumerate(parts):
        scene = dataset[number]
        for key in part:
            if key.startswith("mesh.") or key.startswith("scene.source"):
                continue
            assert_array_equal(scene[key], part[key], err_msg=key)


def test_vocabulary_can_be_given(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    names = {"categories": ["Zebra", "Table"]}
    write_dataset(scenes, tmp_path / "ds", vocabulary=names)
    dataset = open_dataset(tmp_path / "ds")
    assert dataset.categories[:2] == ("Zebra", "Table")
    assert dataset.manifest["category_counts"][:2] == [0, len(scenes)]
    assert "Zebra" not in dataset.category_counts
    assert dataset.category_counts["Table"] == len(scenes)
    assert "Table" in dataset[0].categories


def test_labels_and_sources(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    samples = [
        Sample(graph, f"file {number}", "even" if number % 2 == 0 else "") for number, graph in enumerate(scenes)
    ]
    write_dataset(samples, tmp_path / "ds")
    dataset = open_dataset(tmp_path / "ds")
    assert [scene.label for scene in dataset] == ["even", "", "even", "", "even", "", "even"]
    assert dataset[3].source == "file 3"


def test_split_is_a_partition_by_seed(tmp_path: Path, make_scene: Make) -> None:
    write_dataset([make_scene(0, 0)] * 50, tmp_path / "ds")
    dataset = open_dataset(tmp_path / "ds")
    train, test = dataset.split([0.8, 0.2], seed=3)
    assert len(train) == 40
    assert sorted([*train, *test]) == list(range(50))
    assert_array_equal(dataset.split([0.8, 0.2], seed=3)[0], train)
    assert not np.array_equal(dataset.split([0.8, 0.2], seed=4)[0], train)
    with pytest.raises(UniSGError):
        dataset.split([0.8, 0.3], seed=0)


def test_scenes_of_one_source_stay_together(tmp_path: Path, make_scene: Make) -> None:
    names = [f"file {number % 7}" for number in range(40)]
    write_dataset([Sample(make_scene(0, 0), name) for name in names], tmp_path / "ds")
    dataset = open_dataset(tmp_path / "ds")
    assert dataset.sources() == names
    assert dataset.licences() == [""] * 40
    parts = dataset.split([0.5, 0.5], seed=1, by_source=True)
    assert sorted(np.concatenate(parts).tolist()) == list(range(40))
    of_part = [{names[row] for row in rows} for rows in parts]
    assert of_part[0].isdisjoint(of_part[1])
    assert 12 <= len(parts[0]) <= 28
    assert_array_equal(dataset.split([0.5, 0.5], seed=1, by_source=True)[0], parts[0])


def test_the_reader_in_the_documentation_reads(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    manifest = write_dataset(scenes, tmp_path / "ds")
    code = re.search(r"```python\n(import json.*?)```", DOCS.read_text(), re.DOTALL)
    assert code is not None
    names: dict = {"path": tmp_path / "ds" / manifest["shards"][0]["file"]}
    exec(code[1], names)
    scene = open_dataset(tmp_path / "ds")[3]
    assert_array_equal(names["parent"], scene.parent)
    assert_array_equal(names["poses"], scene.features)


def test_the_documentation_names_every_column() -> None:
    text = DOCS.read_text()
    for key in [*COLUMNS, *(f"{table}.ptr" for table in TABLES), *(f"{key}.bytes" for key in STRINGS)]:
        assert f"`{key}`" in text, key


@pytest.mark.slow
def test_reading_needs_neither_torch_nor_bpy(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    write_dataset(scenes, tmp_path / "ds")
    code = (
        "import sys; from unisg_blender.dataset import open_dataset;"
        f"open_dataset({str(tmp_path / 'ds')!r})[2].local();"
        "print({'torch', 'bpy', 'clifford', 'onnxruntime', 'torch_geometric'} & set(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert run.stdout.strip() == "set()"


def test_existing_folders_are_respected(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    write_dataset(scenes, tmp_path / "ds")
    with pytest.raises(UniSGError, match="holds a dataset already"):
        write_dataset(scenes[:1], tmp_path / "ds")
    assert len(open_dataset(tmp_path / "ds")) == len(scenes)
    write_dataset(scenes[:1], tmp_path / "ds", overwrite=True)
    assert len(open_dataset(tmp_path / "ds")) == 1
    manifest = open_dataset(tmp_path / "ds").manifest
    named = {manifest["shards"][0]["file"], manifest["assets"]["file"]}
    assert {path.name for path in (tmp_path / "ds").glob("*.safetensors")} == named
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("precious")
    with pytest.raises(UniSGError, match="not empty"):
        write_dataset(scenes, tmp_path / "mine")
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["thesis.txt"]


def test_bad_input_writes_nothing(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    broken = scenes[0].local.copy()
    broken[0, 0, 0] = np.nan
    for graphs in ([], [*scenes, scenes[0].replace(local=broken)]):
        with pytest.raises(UniSGError):
            write_dataset(graphs, tmp_path / "ds")
        assert not (tmp_path / "ds").exists()
    with pytest.raises(UniSGError, match="unknown form"):
        write_dataset(scenes, tmp_path / "ds", "euler")


def test_foreign_and_newer_datasets_are_refused(tmp_path: Path, scenes: list[SceneGraph]) -> None:
    with pytest.raises(UniSGError, match="holds no dataset"):
        open_dataset(tmp_path)
    manifest = write_dataset(scenes, tmp_path / "ds")
    for change in ({"version": 99}, {"form": "euler"}, {"schema": "other"}):
        (tmp_path / "ds" / "manifest.json").write_text(json.dumps(manifest | change))
        with pytest.raises(UniSGError):
            open_dataset(tmp_path / "ds")
    (tmp_path / "ds" / "manifest.json").write_text("{")
    with pytest.raises(UniSGError, match="cannot be read"):
        open_dataset(tmp_path / "ds")


@pytest.mark.parametrize("damage", ["flip", "cut", "empty", "missing"])
def test_damaged_shards_are_refused(tmp_path: Path, scenes: list[SceneGraph], damage: str) -> None:
    manifest = write_dataset(scenes, tmp_path / "ds")
    path = tmp_path / "ds" / manifest["shards"][0]["file"]
    data = bytearray(path.read_bytes())
    data[-5] ^= 1
    changed = {"flip": bytes(data), "cut": bytes(data[:-100]), "empty": b""}
    if damage == "missing":
        path.unlink()
    else:
        path.write_bytes(changed[damage])
    dataset = open_dataset(tmp_path / "ds")
    with pytest.raises(UniSGError, match=re.escape(path.name)):
        dataset[0]
    with pytest.raises(UniSGError):
        dataset.check()
