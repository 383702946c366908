from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

torch = pytest.importorskip("torch")
from torch_geometric.data import Batch, HeteroData  # noqa: E402
from torch_geometric.loader import DataLoader  # noqa: E402
from torch_geometric.transforms import ToUndirected  # noqa: E402

from unisg_blender.dataset import (  # noqa: E402
    UniSGDataset,
    common_vocabulary,
    open_dataset,
    to_heterodata,
    write_dataset,
)
from unisg_blender.dataset.format import writer  # noqa: E402
from unisg_blender.errors import UniSGError  # noqa: E402
from unisg_blender.poses import FORMS  # noqa: E402
from unisg_blender.scene import Relation, SceneBuilder, SceneGraph  # noqa: E402
from unisg_blender.spatial.relations import KINDS  # noqa: E402

Make = Callable[..., SceneGraph]


def assert_same(data: HeteroData, other: HeteroData) -> None:
    assert data.node_types == other.node_types
    assert data.edge_types == other.edge_types
    for store, copy in zip(data.stores, other.stores, strict=True):
        assert set(store.keys()) == set(copy.keys())
        for key, value in store.items():
            if key == "numbering":
                assert list(value) == list(copy[key])
                continue
            assert torch.equal(value, copy[key]), (store._key, key)
            assert value.dtype == copy[key].dtype, (store._key, key)


@pytest.fixture
def folder(tmp_path: Path, make_scene: Make, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(writer, "SCENES_PER_SHARD", 8)
    monkeypatch.setattr(writer, "CHUNK", 8)
    write_dataset([make_scene(seed, seed % 5) for seed in range(20)], tmp_path / "ds", "pga_even")
    return tmp_path / "ds"


def test_nodes_and_edges_mean_the_scene(make_scene: Make) -> None:
    graph = make_scene(1)
    data = to_heterodata(graph, "dual_quaternion")
    data.validate()
    row = graph.row
    assert data["entity"].num_nodes == len(graph)
    assert_array_equal(data["entity"].category, graph.category)
    assert_array_equal(data["info"].x, graph.info)
    poses = FORMS["dual_quaternion"].decode(data["trs"].x.numpy().astype(float), stretch=True)
    assert_allclose(poses, graph.local, atol=1e-5)
    assert sorted(data["entity", "parent_of", "entity"].edge_index.T.tolist()) == sorted(
        [row("Tisch ü"), row(f"Tool.{number}")] for number in range(3)
    )
    stands = {(row(f"Tool.{number}"), row("Tisch ü")) for number in range(3)}
    assert set(map(tuple, data["entity", "on_top_of", "entity"].edge_index.T.tolist())) == stands
    assert data["mesh"].num_nodes == 2
    owners, meshes = data["entity", "has", "mesh"].edge_index
    box = data["entity"].x.reshape(-1, 2, 3)
    assert_allclose(data["mesh"].x[meshes, :3], (box[:, 1] - box[:, 0])[owners], atol=1e-6)
    assert data["entity", "has", "action"].edge_index.tolist() == [[row("Tool.0")], [0]]
    assert data["action", "targets", "entity"].edge_index.tolist() == [[0], [row("Tisch ü")]]
    assert data["action", "uses", "entity"].edge_index.tolist() == [[0], [row("Tool.0")]]
    assert data["stage", "contains", "action"].edge_index.tolist() == [[0], [0]]
    assert data["lesson", "contains", "stage"].edge_index.tolist() == [[0, 0], [0, 1]]


def test_every_scene_has_the_same_types(folder: Path) -> None:
    kinds = [data.metadata() for data in UniSGDataset(folder)]
    assert all(kind == kinds[0] for kind in kinds)


def test_dataset_and_scene_give_the_same_graph(folder: Path, make_scene: Make) -> None:
    dataset = UniSGDataset(folder)
    for number in (0, 7, 19):
        graph = to_heterodata(make_scene(number, number % 5), "pga_even", dataset.vocabulary)
        assert_same(dataset[number], graph)


def test_unknown_names_are_left_out(make_scene: Make) -> None:
    graph = make_scene(0)
    data = to_heterodata(graph, vocabulary={"categories": ("Table",), "relations": ("inside",)})
    assert set(data["entity"].category.tolist()) == {0, -1}
    assert data["entity", "inside", "entity"].num_edges == 0
    assert ("entity", "on_top_of", "entity") not in data.edge_types


def related(kind: str, categories: tuple[str, str] = ("Bowl", "Apple")) -> SceneGraph:
    """Two objects, the second of which stands in a relation to the first."""
    builder = SceneBuilder(kind)
    builder.add("first", uid="first", category=categories[0])
    builder.add("second", uid="second", category=categories[1], relations=(Relation(kind, "first"),))
    return builder.build()


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_a_batch_of_scenes_is_the_same_in_any_order(order: tuple[int, int]) -> None:
    graphs = [related("inside"), related("clipped_to", ("Cup", "Bowl"))]
    names = common_vocabulary(graphs)
    data = [to_heterodata(graphs[place], vocabulary=names) for place in order]
    batch = Batch.from_data_list(data)
    assert batch.vocabulary == names
    for kind in ("inside", "clipped_to"):
        assert batch["entity", kind, "entity"].num_edges == 1
    for one, other in zip(batch.to_data_list(), data, strict=True):
        assert_same(one, other)
        assert one.vocabulary == names
    found = [names["categories"][place] for place in batch["entity"].category]
    expected = [["Bowl", "Apple"], ["Cup", "Bowl"]]
    assert found == [*expected[order[0]], *expected[order[1]]]


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize(
    ("other", "kind"), [(related("inside", ("Apple", "Cup")), "categories"), (related("clipped_to"), "relations")]
)
def test_graphs_of_other_numbers_are_refused(order: tuple[int, int], other: SceneGraph, kind: str) -> None:
    data = [to_heterodata(graph) for graph in (related("inside"), other)]
    with pytest.raises(UniSGError, match=f"number their {kind} differently.*common_vocabulary"):
        Batch.from_data_list([data[place] for place in order])


def test_every_graph_has_edges_of_all_known_kinds() -> None:
    data = to_heterodata(related("inside"))
    assert all(("entity", kind, "entity") in data.edge_types for kind in (*KINDS, "hangs_from"))
    assert data.vocabulary["categories"] == ("Apple", "Bowl")


def test_a_dataset_is_read_with_the_numbers_of_another(tmp_path: Path) -> None:
    write_dataset([related("inside")], tmp_path / "train")
    write_dataset([related("inside", ("Apple", "Bowl")), related("inside")], tmp_path / "test")
    train = UniSGDataset(tmp_path / "train")
    test = UniSGDataset(tmp_path / "test", vocabulary=train.vocabulary)
    assert test.vocabulary == train.vocabulary == test[0].vocabulary
    assert test[0]["entity"].category.tolist() == [
        train.vocabulary["categories"].index(name) for name in ("Apple", "Bowl")
    ]
    assert open_dataset(tmp_path / "test", vocabulary=train.vocabulary)[0].categories == ("Apple", "Bowl")
    assert_same(test[1], train[0])
    Batch.from_data_list([train[0], test[0]])
    with pytest.raises(UniSGError, match="number their categories differently"):
        Batch.from_data_list([train[0], UniSGDataset(tmp_path / "test")[0]])


@pytest.mark.parametrize("other", [related("inside", ("Apple", "Fig")), related("clipped_to")])
def test_a_vocabulary_that_lacks_names_is_refused(tmp_path: Path, other: SceneGraph) -> None:
    write_dataset([other], tmp_path / "ds")
    with pytest.raises(UniSGError, match=r"that the vocabulary asked for lacks: '(Fig|clipped_to)'"):
        open_dataset(tmp_path / "ds", vocabulary=common_vocabulary([related("inside")]))


@pytest.mark.parametrize("indices", [[3], [19, 0, 8, 8, 5], list(range(20))])
def test_batch_is_what_pyg_makes_of_the_scenes(folder: Path, indices: list[int]) -> None:
    dataset = UniSGDataset(folder)
    batch = dataset.batch(indices)
    expected = Batch.from_data_list([dataset[index] for index in indices])
    assert_same(batch, expected)
    assert batch.num_graphs == len(indices)
    for own, copy in zip(batch.to_data_list(), expected.to_data_list(), strict=True):
        assert_same(own, copy)
    assert_same(batch[0], dataset[indices[0]])


def test_subsets_and_splits(folder: Path) -> None:
    dataset = UniSGDataset(folder)
    assert_same(dataset[5:9].batch([0, 3]), dataset.batch([5, 8]))
    train, test = dataset.split([0.75, 0.25], seed=1)
    again, _ = dataset.split([0.75, 0.25], seed=1)
    assert sorted([*train.indices(), *test.indices()]) == list(range(20))
    assert train.indices() == again.indices()
    inner, _ = test.split([0.4, 0.6], seed=0)
    assert len(inner) == 2
    assert set(inner.indices()) <= set(test.indices())


def test_reverse_edges_by_transform(folder: Path) -> None:
    dataset = UniSGDataset(folder, transform=ToUndirected(merge=False))
    pairs = dataset[4]["entity", "parent_of", "entity"].edge_index
    assert torch.equal(dataset[4]["entity", "rev_parent_of", "entity"].edge_index, pairs.flip(0))
    assert ("info", "rev_has", "entity") in dataset.batch([1, 2]).edge_types


@pytest.mark.parametrize("workers", [0, 2])
def test_loaders(folder: Path, workers: int) -> None:
    dataset = UniSGDataset(folder)
    own = list(dataset.loader(6, workers=workers))
    theirs = list(DataLoader(dataset, batch_size=6, num_workers=workers))
    assert [batch.num_graphs for batch in own] == [6, 6, 6, 2]
    for batch, expected in zip(own, theirs, strict=True):
        assert_same(batch, expected)


def test_shuffling_is_by_seed(folder: Path) -> None:
    dataset = UniSGDataset(folder)

    def order(loader: Any) -> list[int]:
        return [int(size) for batch in loader for size in batch["entity"].ptr.diff()]

    loader = dataset.loader(5, shuffle=True, seed=3)
    first = order(loader)
    assert first == order(dataset.loader(5, shuffle=True, seed=3))
    assert first != order(loader)  # the next epoch has another order
    assert sorted(first) == sorted(order(dataset.loader(20)))


def test_mesh_features_stand_beside_the_descriptor(tmp_path: Path, make_scene: Make) -> None:
    bare = SceneBuilder("bare")
    bare.add("Empty", uid="e")
    graphs = [bare.build(), make_scene(1)]
    write_dataset(graphs, tmp_path / "ds", mesh_encoder=lambda mesh: mesh.points.mean(axis=0))
    dataset = UniSGDataset(tmp_path / "ds")
    assert dataset[0]["mesh"].feature.shape == (0, 3)
    assert dataset.batch([0, 1, 1])["mesh"].feature.shape == (4, 3)


def test_datasets_travel_to_other_processes(folder: Path) -> None:
    dataset = UniSGDataset(folder)
    dataset[3]
    data = pickle.dumps(dataset)
    assert len(data) < 20_000  # the columns stay on disk
    assert_same(pickle.loads(data)[3], dataset[3])


@pytest.mark.parametrize("mapped", [1, 2, 500])
def test_few_shards_stay_in_memory(folder: Path, monkeypatch: pytest.MonkeyPatch, mapped: int) -> None:
    monkeypatch.setattr("unisg_blender.dataset.format.reader.MOST_MAPPED", mapped)
    dataset = open_dataset(folder, memory=1)
    expected = [scene.features.copy() for scene in open_dataset(folder)]
    for number in (0, 9, 19, 1, 9):
        assert_array_equal(dataset[number].features, expected[number])
        assert len(dataset._touched) == 1
        assert len(dataset._shards) <= mapped


def test_numbers_outside_are_refused(folder: Path) -> None:
    with pytest.raises(IndexError):
        UniSGDataset(folder).batch([20])
    with pytest.raises(IndexError):
        UniSGDataset(folder)._arrays(np.array([-1]))
