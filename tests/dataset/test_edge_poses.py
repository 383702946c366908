"""Edges between entities carry relative poses: in any form, alike in single graphs and in batches."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

torch = pytest.importorskip("torch")
pytest.importorskip("torch_geometric")
from torch_geometric.data import Batch  # noqa: E402
from torch_geometric.transforms import ToUndirected  # noqa: E402

from tests.dataset.test_graph_data import assert_same  # noqa: E402
from unisg_blender.dataset import EdgePoses, UniSGDataset, to_heterodata, write_dataset  # noqa: E402
from unisg_blender.errors import UniSGError  # noqa: E402
from unisg_blender.poses import FORMS, Block, Form, forms, register_form  # noqa: E402
from unisg_blender.scene import SceneBuilder, SceneGraph, mesh_from_faces  # noqa: E402
from unisg_blender.worlds import living_room  # noqa: E402

Make = Callable[..., SceneGraph]
PARENT, ON, NEAREST = (("entity", kind, "entity") for kind in ("parent_of", "on_top_of", "nearest"))


@pytest.fixture
def folder(tmp_path: Path, make_scene: Make) -> Path:
    write_dataset([make_scene(seed, seed % 5) for seed in range(12)], tmp_path / "ds", "pga_even")
    return tmp_path / "ds"


def between(graph: SceneGraph, pairs: np.ndarray) -> np.ndarray:
    """The second's rigid pose in the first's frame, by the scenegraph's own world matrices."""
    rigid = FORMS["matrix"].encode(graph.world).reshape(-1, 4, 4)
    return np.linalg.inv(rigid[pairs[0]]) @ rigid[pairs[1]]


@pytest.mark.parametrize("form", sorted(FORMS))
def test_they_are_the_poses_of_the_second_in_the_frame_of_the_first(form: str) -> None:
    graph = living_room(3)
    data = to_heterodata(graph, edges=EdgePoses(form, nearest=4))
    data.validate()
    for kind in (PARENT, ON, NEAREST):
        store = data[kind]
        assert store.edge_attr.dtype == torch.float32
        assert store.edge_attr.shape == (store.num_edges, FORMS[form].width)
        assert store.num_edges
        found = FORMS[form].decode(FORMS[form].project(store.edge_attr.numpy().astype(float)))
        assert_allclose(found, between(graph, store.edge_index.numpy()), atol=2e-5)


def test_scale_shear_and_constraints_are_dealt_with_as_the_scene_does(make_scene: Make) -> None:
    graph = make_scene(1)  # sheared poses, and a tool that a constraint has moved
    data = to_heterodata(graph, "trs_matrix", edges=EdgePoses("matrix"))
    assert NEAREST not in data.edge_types
    for kind in (PARENT, ON):
        found = data[kind].edge_attr.numpy().reshape(-1, 4, 4)
        assert_allclose(found, between(graph, data[kind].edge_index.numpy()), atol=1e-5)


def test_without_asking_there_are_none(make_scene: Make, folder: Path) -> None:
    for data in (to_heterodata(make_scene(1)), UniSGDataset(folder)[1], UniSGDataset(folder).batch([1, 2])):
        assert not any("edge_attr" in store for store in data.edge_stores)


@pytest.mark.parametrize("indices", [[3], [11, 0, 8, 8, 5], list(range(12))])
def test_batches_are_what_pyg_makes_of_the_scenes(folder: Path, make_scene: Make, indices: list[int]) -> None:
    dataset = UniSGDataset(folder, edges=EdgePoses("dual_quaternion", nearest=2))
    batch, expected = dataset.batch(indices), Batch.from_data_list([dataset[index] for index in indices])
    assert_same(batch, expected)
    for own, copy in zip(batch.to_data_list(), expected.to_data_list(), strict=True):
        assert_same(own, copy)
    scene = make_scene(indices[0], indices[0] % 5)
    alone = to_heterodata(scene, "pga_even", dataset.vocabulary, edges=EdgePoses("dual_quaternion", nearest=2))
    assert_same(dataset[indices[0]], alone)
    assert_same(next(iter(dataset.loader(12))), dataset.batch(range(12)))


def test_datasets_with_them_travel_and_turn_round(folder: Path) -> None:
    dataset = UniSGDataset(folder, ToUndirected(merge=False), edges=EdgePoses(nearest=1))
    copy = pickle.loads(pickle.dumps(dataset))
    assert_same(copy[4], dataset[4])
    back = dataset[4]["entity", "rev_parent_of", "entity"]
    assert torch.equal(back.edge_attr, dataset[4][PARENT].edge_attr)  # still of the child in the parent's frame


def box(size: float) -> SceneGraph:
    builder, corners = SceneBuilder("row"), np.array([[0.0, 0, 0], [size, 0, 0], [0, size, size]])
    mesh = mesh_from_faces("thing", corners, [[0, 1, 2]])
    for number, x in enumerate((0.0, 1.0, 1.5, 5.0)):
        builder.add(f"thing {number}", uid=str(number), mesh=mesh, local=np.array(
            [[1.0, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]))  # fmt: skip
    builder.add("nothing", uid="empty")
    return builder.build()


@pytest.mark.parametrize(("count", "expected"), [
    (1, {(0, 1), (1, 2), (2, 1), (3, 2)}),
    (9, {(a, b) for a in range(4) for b in range(4) if a != b}),
])  # fmt: skip
def test_the_nearest_are_those_with_near_boxes(count: int, expected: set[tuple[int, int]]) -> None:
    graph = box(0.2)
    data = to_heterodata(graph, edges=EdgePoses(nearest=count))
    rows = {graph.row(f"thing {number}"): number for number in range(4)}
    found = [(rows[a], rows[b]) for a, b in data[NEAREST].edge_index.T.tolist()]
    assert set(found) == expected
    assert len(found) == len(expected)


def test_many_in_one_place_are_not_their_own_neighbours(tmp_path: Path) -> None:
    builder, mesh = SceneBuilder("heap"), mesh_from_faces("thing", np.eye(3), [[0, 1, 2]])
    for number in range(9):
        builder.add(f"thing {number}", uid=str(number), mesh=mesh)
    graph = builder.build()
    pairs = to_heterodata(graph, edges=EdgePoses(nearest=3))[NEAREST].edge_index
    assert (pairs[0] != pairs[1]).all()
    assert_array_equal(pairs[0].bincount(), np.full(9, 3))
    one = SceneBuilder("one")
    one.add("alone", uid="a", mesh=mesh)
    data = to_heterodata(one.build(), edges=EdgePoses(nearest=3))
    assert data[NEAREST].num_edges == 0


@pytest.fixture
def place_and_heading() -> Iterator[str]:
    """A form of one's own, as docs/dataset.md has it."""

    def encode(block: Block) -> tuple:
        """Where it is and which way its x axis points on the floor."""
        r, length = block.rotation, (block.rotation[0] ** 2 + block.rotation[3] ** 2) ** 0.5
        return (*block.translation, r[0] / length, r[3] / length)

    def decode(x: tuple) -> Block:
        """Upright."""
        cos, sin = x[3], x[4]
        turn = (cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
        return Block(turn, turn, tuple(x[:3]))

    register_form(Form("place_and_heading", ("tx", "ty", "tz", "cos", "sin"), encode, decode, lambda x: x))
    yield "place_and_heading"
    forms._FORMS.pop("place_and_heading")


def test_a_form_of_ones_own_goes_along_edges(place_and_heading: str, folder: Path) -> None:
    graph = living_room(2)
    data = to_heterodata(graph, edges=EdgePoses(place_and_heading))
    store = data[ON]
    expected = between(graph, store.edge_index.numpy())
    assert_allclose(store.edge_attr[:, :3], expected[:, :3, 3], atol=1e-5)
    assert_allclose(store.edge_attr[:, 3:].norm(dim=1), np.ones(store.num_edges), atol=1e-6)
    assert UniSGDataset(folder, edges=EdgePoses(place_and_heading)).batch([0, 1])[PARENT].edge_attr.shape[1] == 5


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(UniSGError, match="unknown form 'six_d'"):
        EdgePoses("six_d")
    with pytest.raises(UniSGError, match="nearest must be 0 or more, not -1"):
        EdgePoses(nearest=-1)
