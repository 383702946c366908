"""The sampled loss of the CGVAE is the full one on average."""

from __future__ import annotations

import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("torch_geometric")

from unisg_blender.generate.propose.cgvae_proposer import edges_of  # noqa: E402
from unisg_blender.learn.cgvae.network import Cgvae, CgvaeSizes  # noqa: E402
from unisg_blender.learn.cgvae.sampled_pairs import sample_pairs, sampled_terms  # noqa: E402
from unisg_blender.learn.cgvae.training import batch_terms, support_graph  # noqa: E402

PARENT = torch.tensor([-1, 0, 0, 1, 1, -1, 5, 6, 5])
SCENE = torch.tensor([0] * 5 + [1] * 4)
PAIRS = 5 * 4 + 4 * 3


@pytest.fixture
def batch() -> dict[str, torch.Tensor]:
    generator = torch.Generator().manual_seed(0)
    return {
        "features": torch.randn(9, 6, generator=generator),
        "category": torch.randint(4, (9,), generator=generator),
        "edges": torch.from_numpy(edges_of(PARENT.numpy())),
        "noise": torch.randn(9, 5, generator=generator),
    }


def test_pairs_are_of_one_scene_and_weigh_as_much_as_all() -> None:
    seen = set()
    for seed in range(200):
        pairs = sample_pairs(PARENT, SCENE, 2, torch.Generator().manual_seed(seed))
        assert (SCENE[pairs.child] == SCENE[pairs.parent]).all()
        assert (pairs.child != pairs.parent).all()
        assert torch.equal(pairs.edge > 0, PARENT[pairs.child] == pairs.parent)
        assert float(pairs.weight.sum()) == pytest.approx(PAIRS)
        assert pairs.total == PAIRS
        seen |= set(zip(pairs.child.tolist(), pairs.parent.tolist(), strict=True))
    assert len(seen) == PAIRS


def test_the_average_over_samples_is_the_full_loss(batch: dict[str, torch.Tensor]) -> None:
    torch.manual_seed(0)
    model = Cgvae(CgvaeSizes(6, 4, embedding=3, hidden=8, latent=5))
    with torch.no_grad():
        for weight in model.edge_decoder.parameters():
            weight.mul_(5)  # so that pairs differ
        graph = support_graph(batch["features"].numpy(), batch["category"].numpy(), PARENT.numpy())
        graph.batch = SCENE
        full = batch_terms(model, graph, batch["noise"])
        found = []
        for seed in range(200):
            pairs = sample_pairs(PARENT, SCENE, 1, torch.Generator().manual_seed(seed))
            losses, decoded = sampled_terms(model, **batch, pairs=pairs)
            found.append(float(losses["bce"]))
    assert decoded.shape == (9, 6)
    assert float(losses["mse"]) == pytest.approx(float(full["mse"]))
    assert float(losses["kl"]) == pytest.approx(float(full["kl"]))
    spread = torch.tensor(found).std() / 200**0.5
    assert float(spread) > 0
    assert abs(torch.tensor(found).mean() - full["bce"]) < 4 * spread
