"""The networks over the UniSG graph: the order of nodes does not matter, scenes do not mix, same seed same numbers."""

from __future__ import annotations

import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("torch_geometric")

from unisg_blender.learn.hetero_sage import HeteroSage, edge_kinds  # noqa: E402
from unisg_blender.learn.paper.gae import GraphAutoencoder, edge_logits, edge_loss, random_pairs  # noqa: E402
from unisg_blender.learn.scene_classifier.network import SceneClassifier  # noqa: E402

WIDTHS = {"entity": 1, "info": 4, "trs": 7, "mesh": 12, "action": 5}


def graph(seed: int, entities: int, meshes: int = 3, actions: int = 2) -> tuple[dict, dict]:
    generator = torch.Generator().manual_seed(seed)
    counts = {"entity": entities, "info": entities, "trs": entities, "mesh": meshes, "action": actions}
    x = {kind: torch.randn(counts[kind], width, generator=generator) for kind, width in WIDTHS.items()}
    row = torch.arange(entities)
    parent = torch.tensor([int(torch.randint(max(k, 1), (1,), generator=generator)) for k in range(entities)])
    edges = {("entity", "parent_of", "entity"): torch.stack([parent[1:], row[1:]])}
    for kind in ("info", "trs"):
        edges["entity", "has", kind] = torch.stack([row, row])
    edges["entity", "has", "mesh"] = torch.stack([row, torch.randint(meshes, (entities,), generator=generator)])
    edges["entity", "has", "action"] = torch.stack([torch.arange(actions) % entities, torch.arange(actions)])
    edges |= {(stop, f"rev_{name}", start): value.flip(0) for (start, name, stop), value in list(edges.items())}
    return x, edges


def joined(one: tuple[dict, dict], two: tuple[dict, dict]) -> tuple[dict, dict]:
    x = {kind: torch.cat([one[0][kind], two[0][kind]]) for kind in WIDTHS}
    shift = {kind: torch.tensor(len(one[0][kind])) for kind in WIDTHS}
    return x, {
        (start, name, stop): torch.cat(
            [one[1][start, name, stop], two[1][start, name, stop] + torch.stack([shift[start], shift[stop]])[:, None]],
            1,
        )
        for start, name, stop in one[1]
    }


def permuted(x: dict, edges: dict, seed: int) -> tuple[dict, dict, torch.Tensor]:
    generator = torch.Generator().manual_seed(seed)
    order = {kind: torch.randperm(len(value), generator=generator) for kind, value in x.items()}
    place = {kind: torch.argsort(value) for kind, value in order.items()}
    moved = {kind: value[order[kind]] for kind, value in x.items()}
    return moved, {
        (a, name, b): torch.stack([place[a][pairs[0]], place[b][pairs[1]]]) for (a, name, b), pairs in edges.items()
    }, order["entity"]  # fmt: skip


@pytest.mark.slow
def test_the_order_of_the_nodes_does_not_matter() -> None:
    torch.manual_seed(0)
    network, classifier = GraphAutoencoder(WIDTHS, 16, 8), SceneClassifier(WIDTHS, 3, 16)
    x, edges = graph(1, 9)
    moved_x, moved_edges, order = permuted(x, edges, 2)
    torch.testing.assert_close(network(moved_x, moved_edges), network(x, edges)[order], atol=1e-5, rtol=1e-5)
    scene = torch.zeros(9, dtype=torch.int64)
    one, two = classifier(x, edges, scene, 1), classifier(moved_x, moved_edges, scene, 1)
    assert one.shape == (1, 3)
    torch.testing.assert_close(one, two, atol=1e-5, rtol=1e-5)


def test_scenes_in_one_batch_do_not_see_each_other() -> None:
    torch.manual_seed(0)
    classifier = SceneClassifier(WIDTHS, 2, 16)
    parts = graph(1, 6), graph(2, 4, meshes=2, actions=1)
    x, edges = joined(*parts)
    both = classifier(x, edges, torch.tensor([0] * 6 + [1] * 4), 2)
    for number, (part, count) in enumerate(zip(parts, (6, 4), strict=True)):
        alone = classifier(*part, torch.zeros(count, dtype=torch.int64), 1)
        torch.testing.assert_close(both[number], alone[0], atol=1e-5, rtol=1e-5)


def test_shared_rows_are_the_same_as_copied_ones() -> None:
    torch.manual_seed(0)
    network = HeteroSage(WIDTHS, 8)
    x, edges = graph(3, 5, meshes=3)
    place = torch.tensor([1, 0, 1])
    copied = x | {"mesh": x["mesh"][place]}
    torch.testing.assert_close(network(x, edges, {"mesh": place}), network(copied, edges))


def test_entities_see_their_components_and_children() -> None:
    torch.manual_seed(0)
    network = HeteroSage(WIDTHS, 8)
    x, edges = graph(4, 5)
    for kind in ("trs", "mesh", "action", "info"):
        other = x | {kind: x[kind] + 1}
        assert not torch.allclose(network(other, edges), network(x, edges)), kind
    assert len(edge_kinds()) == 10


def test_same_seed_same_network() -> None:
    def weights(seed: int) -> torch.Tensor:
        torch.manual_seed(seed)
        return torch.cat([value.flatten() for value in SceneClassifier(WIDTHS, 2).parameters()])

    assert torch.equal(weights(1), weights(1))
    assert not torch.equal(weights(1), weights(2))


def test_the_decoder_is_symmetric_and_its_loss_by_hand() -> None:
    embedding = torch.tensor([[1.0, 0.0], [2.0, 0.0], [0.0, 3.0]])
    pairs = torch.tensor([[0, 1], [1, 2]])
    torch.testing.assert_close(edge_logits(embedding, pairs), torch.tensor([2.0, 0.0]))
    torch.testing.assert_close(edge_logits(embedding, pairs.flip(0)), edge_logits(embedding, pairs))
    loss = edge_loss(embedding, pairs[:, :1], pairs[:, 1:])
    assert float(loss) == pytest.approx(float(-torch.log(torch.sigmoid(torch.tensor(2.0)))) + 0.693147, abs=1e-5)


def test_random_pairs_are_pairs_of_the_given_nodes() -> None:
    nodes = torch.tensor([3, 5, 9])
    pairs = random_pairs(500, nodes, torch.Generator().manual_seed(0))
    assert (pairs[0] != pairs[1]).all()
    assert set(pairs.unique().tolist()) == {3, 5, 9}
    assert len({tuple(pair) for pair in pairs.T.tolist()}) == 6
