"""The paper's CGVAE: permutation invariance, masks, seeds, and ONNX against torch."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("torch_geometric")

from torch_geometric.data import Batch  # noqa: E402

from unisg_blender.dataset import open_dataset  # noqa: E402
from unisg_blender.generate.observe.contract import Contract  # noqa: E402
from unisg_blender.generate.observe.support_priors import CategoryPriors  # noqa: E402
from unisg_blender.generate.propose.cgvae_proposer import edges_of, node_features, poses_of  # noqa: E402
from unisg_blender.generate.propose.trained_model import load_model  # noqa: E402
from unisg_blender.learn.cgvae.network import Cgvae, CgvaeSizes  # noqa: E402
from unisg_blender.learn.cgvae.training import batch_terms, normalisation, support_graph, write_cgvae  # noqa: E402
from unisg_blender.learn.training_scenes import load_scenes, vocabulary_of  # noqa: E402
from unisg_blender.poses import FORMS  # noqa: E402

SIZES = CgvaeSizes(features=5, categories=4)
NOTHING = CategoryPriors({}, {}, {}, [])


def scene_tensors(seed: int, nodes: int) -> dict[str, torch.Tensor]:
    rng = np.random.default_rng(seed)
    support = np.array([-1] + [int(rng.integers(row)) for row in range(1, nodes)])
    return {
        "features": torch.from_numpy(rng.standard_normal((nodes, SIZES.features)).astype(np.float32)),
        "category": torch.from_numpy(rng.integers(0, 5, nodes)),
        "edges": torch.from_numpy(edges_of(support)),
        "noise": torch.from_numpy(rng.standard_normal((nodes, SIZES.latent)).astype(np.float32)),
        "known": torch.from_numpy(rng.integers(0, 2, nodes).astype(np.float32)),
    }


@pytest.fixture
def network() -> Cgvae:
    torch.manual_seed(0)
    return Cgvae(SIZES).eval()


def test_the_order_of_the_nodes_does_not_matter(network: Cgvae) -> None:
    inputs = scene_tensors(1, 9)
    order = torch.from_numpy(np.random.default_rng(2).permutation(9))
    place = torch.argsort(order)
    moved = {name: value[order] for name, value in inputs.items() if name != "edges"} | {
        "edges": place[inputs["edges"]]
    }
    with torch.no_grad():
        decoded, adjacency, latent = network(**inputs)
        decoded2, adjacency2, latent2 = network(**moved)
    torch.testing.assert_close(latent2, latent[order])
    torch.testing.assert_close(decoded2, decoded[order])
    torch.testing.assert_close(adjacency2, adjacency[order][:, order])


def test_new_nodes_see_noise_and_known_ones_do_not(network: Cgvae) -> None:
    inputs = scene_tensors(3, 6)
    other = inputs | {"noise": inputs["noise"] + 1}
    with torch.no_grad():
        one, two = network(**inputs)[0], network(**other)[0]
    same = (one == two).all(dim=1)
    assert (same == (inputs["known"] > 0)).all()


def test_the_loss_of_a_batch_does_not_mix_scenes(network: Cgvae) -> None:
    def losses(parts: list[dict[str, torch.Tensor]]) -> tuple[float, ...]:
        graphs = []
        for part in parts:
            support = np.full(len(part["category"]), -1)
            below, above = part["edges"][:, part["edges"].shape[1] // 2 :].numpy()
            support[below] = above
            graphs.append(support_graph(part["features"].numpy(), part["category"].numpy(), support))
        with torch.no_grad():
            noise = torch.cat([part["noise"] for part in parts])
            found = batch_terms(network, Batch.from_data_list(graphs), noise)
        return float(found["mse"]), float(found["bce"]), float(found["kl"])

    one, two = scene_tensors(4, 7), scene_tensors(5, 3)
    alone, both = np.array(losses([one])), np.array(losses([one, two]))
    rest = np.array(losses([two]))
    nodes, pairs = np.array([7, 3]) / 10, np.array([42, 6]) / 48
    np.testing.assert_allclose(both[[0, 2]], nodes[0] * alone[[0, 2]] + nodes[1] * rest[[0, 2]], rtol=1e-5)
    np.testing.assert_allclose(both[1], pairs[0] * alone[1] + pairs[1] * rest[1], rtol=1e-5)


@pytest.mark.slow
def test_the_file_agrees_with_torch_and_keeps_to_blenders_onnxruntime(network: Cgvae, tmp_path: Path) -> None:
    import onnx

    contract = Contract("cgvae", ("a", "b", "c", "d"), NOTHING, latent=SIZES.latent)
    path = tmp_path / "model.onnx"
    write_cgvae(network, contract, path)
    model = load_model(path)
    assert model.contract == contract
    for nodes in (2, 5, 40):
        inputs = scene_tensors(nodes, nodes)
        found = model.run(["decoded", "adjacency", "latent"], **{name: value.numpy() for name, value in inputs.items()})
        with torch.no_grad():
            for ours, theirs in zip(found, network(**inputs), strict=True):
                np.testing.assert_allclose(ours, theirs.numpy(), atol=1e-5)
    stored = onnx.load(path)
    assert stored.ir_version <= 10
    assert all(item.version <= 20 for item in stored.opset_import if not item.domain)
    assert not any("Random" in node.op_type for node in stored.graph.node)


@pytest.mark.parametrize("form", FORMS)
def test_features_go_out_and_come_back_in_every_form(form: str) -> None:
    from tests.generate.rooms import room
    from unisg_blender.generate.observe.observed_scene import relative
    from unisg_blender.scene import world_matrices
    from unisg_blender.spatial.objects import scene_objects

    graphs = [room(seed) for seed in range(4)]
    objects = [scene_objects(graph, graph.vocabulary) for graph in graphs]
    poses = [
        relative(world_matrices(graph)[part.row], part.support) for graph, part in zip(graphs, objects, strict=True)
    ]
    mean, scale, kept = normalisation(poses, form)
    contract = replace(
        Contract("cgvae", graphs[0].vocabulary, NOTHING, form=form),
        mean=tuple(mean),
        scale=tuple(scale),
        kept=tuple(kept),
    )
    assert len(kept) < FORMS[form].width + 6
    np.testing.assert_allclose(poses_of(node_features(poses[0], contract), contract), poses[0], atol=1e-5)


def test_scenes_of_a_dataset_have_the_things_that_went_in(dataset_folder: Path) -> None:
    from tests.generate.rooms import room
    from unisg_blender.scene import world_matrices

    dataset = open_dataset(dataset_folder)
    vocabulary = vocabulary_of(dataset)
    assert vocabulary == ("Cup", "Floor", "Lamp", "Table", "Wall")
    scene, graph = load_scenes(dataset, vocabulary, quiet=True)[0], room(0)
    np.testing.assert_allclose(scene.world, world_matrices(graph), atol=1e-5)
    np.testing.assert_array_equal(scene.objects.support, graph.parent)
