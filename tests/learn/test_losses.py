"""Losses are those of their definitions: densities of scipy, sums over points and pairs, one at a time."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import cdist
from scipy.special import expit
from scipy.stats import logistic, norm, vonmises

torch = pytest.importorskip("torch")

from unisg_blender.learn.losses.chamfer import chamfer  # noqa: E402
from unisg_blender.learn.losses.edge_losses import contrastive_edge_loss, dense_edge_loss  # noqa: E402
from unisg_blender.learn.losses.mixtures import height_nll, logistics_nll, mixture_nll  # noqa: E402
from unisg_blender.learn.losses.ranking import ranking_loss  # noqa: E402
from unisg_blender.learn.losses.variational import kl_divergence, node_terms  # noqa: E402

RNG = np.random.default_rng(0)


def drawn(*shape: int) -> np.ndarray:
    return RNG.normal(size=shape)


def tensor(values: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(np.asarray(values, float))


def test_places_have_the_density_of_turned_normals_and_von_mises_headings() -> None:
    boxes, parts, asked = 2, 3, 5
    weight = drawn(1, boxes * parts)
    weight -= np.log(np.exp(weight).sum())
    mean, sigma = drawn(1, boxes * parts, 2), np.exp(drawn(1, boxes * parts, 2) * 0.4)
    turn, kappa = drawn(1, boxes * parts), np.exp(drawn(1, boxes * parts))
    yaw = np.array([0.7, -2.0])
    box = np.zeros((1, boxes, 8))
    box[0, :, 6], box[0, :, 7] = np.cos(yaw), np.sin(yaw)
    position, heading = drawn(1, asked, 2), drawn(1, asked)
    mixture = tuple(tensor(part) for part in (weight, mean, sigma, turn, kappa))
    found = mixture_nll(mixture, tensor(box), tensor(position), tensor(heading))[0].numpy()
    for s in range(asked):
        density = 0.0
        for k in range(boxes * parts):
            angle = yaw[k // parts]
            axes = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            off = axes @ (position[0, s] - mean[0, k])
            place = norm.pdf(off, 0, sigma[0, k]).prod()
            density += np.exp(weight[0, k]) * place * vonmises.pdf(heading[0, s], kappa[0, k], turn[0, k])
        assert found[s] == pytest.approx(-np.log(density))


def test_heights_and_values_have_the_densities_of_their_mixtures() -> None:
    weight, mean, sigma, height = drawn(4, 3), drawn(4, 3), np.exp(drawn(4, 3)), drawn(4)
    found = height_nll(*map(tensor, (weight, mean, sigma, height))).numpy()
    np.testing.assert_allclose(found, -np.log((np.exp(weight) * norm.pdf(height[:, None], mean, sigma)).sum(axis=1)))
    mixture = np.stack([weight, mean, sigma], axis=-2)
    found = logistics_nll(tensor(mixture), tensor(height)).numpy()
    np.testing.assert_allclose(
        found, -np.log((np.exp(weight) * logistic.pdf(height[:, None], mean, sigma)).sum(axis=1))
    )
    around = sum(logistic.pdf(height[:, None] + 2 * np.pi * k, mean, sigma) for k in (-1, 0, 1))
    found = logistics_nll(tensor(mixture), tensor(height), turn=True).numpy()
    np.testing.assert_allclose(found, -np.log((np.exp(weight) * around).sum(axis=1)))


def test_clouds_are_as_far_apart_as_their_points_from_the_nearest() -> None:
    first, second = drawn(3, 7, 3), drawn(3, 11, 3)
    expected = []
    for one, other in zip(first, second, strict=True):
        squares = cdist(one, other) ** 2
        expected.append(squares.min(axis=1).mean() + squares.min(axis=0).mean())
    np.testing.assert_allclose(chamfer(tensor(first), tensor(second)).numpy(), expected)
    assert float(chamfer(tensor(first), tensor(first)).max()) == 0


def test_edges() -> None:
    edges, others = drawn(6), drawn(9)
    found = float(contrastive_edge_loss(tensor(edges), tensor(others)))
    assert found == pytest.approx(-np.log(expit(edges)).mean() - np.log(1 - expit(others)).mean())
    logits, truth = drawn(2, 4, 4), (drawn(2, 4, 4) > 0).astype(float)
    filled = np.array([[1, 1, 1, 0], [1, 1, 0, 0]], bool)
    cost = []
    for b in range(2):
        for i in range(4):
            for j in range(4):
                if i != j and filled[b, i] and filled[b, j]:
                    chance = expit(logits[b, i, j])
                    cost.append(-np.log(chance if truth[b, i, j] else 1 - chance))
    found = float(dense_edge_loss(tensor(logits), tensor(truth), torch.from_numpy(filled)))
    assert found == pytest.approx(np.mean(cost))


def test_true_places_are_the_first_of_the_ranked() -> None:
    score = drawn(3, 5)
    expected = -np.log(np.exp(score[:, 0]) / np.exp(score).sum(axis=1))
    np.testing.assert_allclose(ranking_loss(tensor(score)).numpy(), expected)


def test_the_divergence_is_the_mean_of_the_ratio_of_densities() -> None:
    mean, log_variance = np.array([[0.5, -1.0], [0, 0]]), np.array([[0.3, -0.7], [0, 0]])
    found = kl_divergence(tensor(mean), tensor(log_variance)).numpy()
    assert found[1] == 0
    x = np.linspace(-12, 12, 20001)
    step = x[1] - x[0]
    expected = 0.0
    for m, v in zip(mean[0], log_variance[0], strict=True):
        p = norm.pdf(x, m, np.exp(v / 2))
        expected += (p * (norm.logpdf(x, m, np.exp(v / 2)) - norm.logpdf(x))).sum() * step
    assert found[0] == pytest.approx(expected, rel=1e-6)
    terms = node_terms(tensor(drawn(2, 3) * 0), tensor(np.full((2, 3), 2.0)), tensor(mean), tensor(log_variance))
    assert float(terms["mse"]) == 4
    assert float(terms["kl"]) == pytest.approx(found.mean())
