"""Losses of variational autoencoders."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from ..cgvae.network import Cgvae


def kl_divergence(mean: Tensor, log_variance: Tensor) -> Tensor:
    """KL divergence (B,) of normal distributions from the standard one, nats.

    Source: Kingma and Welling, "Auto-Encoding Variational Bayes" (2014), appendix B.
    """
    return 0.5 * (mean.square() + log_variance.exp() - 1 - log_variance).sum(-1)


@dataclass(frozen=True)
class CgvaeLosses:
    """The terms of the loss, each a mean: ``mse`` over channels, ``bce`` over pairs, ``kl`` over nodes."""

    mse: Tensor
    bce: Tensor
    kl: Tensor


def cgvae_losses(
    model: Cgvae, features: Tensor, category: Tensor, edges: Tensor, parent: Tensor, scene: Tensor, noise: Tensor
) -> CgvaeLosses:
    """The loss terms of a batch of scenes.

    Parameters
    ----------
    features, category, edges, noise
        As in :meth:`Cgvae.forward`, the nodes of all scenes one after another.
    parent
        int64 (N,): row of the parent in the batch, -1 for roots.
    scene
        int64 (N,): number of the scene, ascending.
    """
    mean, logvar, embedded = model.encode(features, category, edges)
    code = torch.cat([mean + noise * (0.5 * logvar).exp(), embedded], dim=1)
    mse = (model.decode_nodes(code) - features).square().mean()
    kl = 0.5 * (mean.square() + logvar.exp() - 1 - logvar).sum(dim=1).mean()
    return CgvaeLosses(mse, _edge_loss(model, code, parent, scene), kl)


def _edge_loss(model: Cgvae, code: Tensor, parent: Tensor, scene: Tensor) -> Tensor:
    """Binary cross-entropy over all ordered pairs of different nodes of one scene."""
    counts = torch.bincount(scene)
    start = torch.cumsum(counts, 0) - counts
    place = torch.arange(len(scene)) - start[scene]
    padded = code.new_zeros(len(counts), int(counts.max()), code.shape[1])
    padded[scene, place] = code
    logits = model.decode_edges(padded, padded)
    target = torch.zeros_like(logits)
    child = parent >= 0
    target[scene[child], place[child], parent[child] - start[scene[child]]] = 1.0
    filled = torch.arange(int(counts.max())) < counts[:, None]
    mask = filled[:, :, None] & filled[:, None, :] & ~torch.eye(int(counts.max()), dtype=torch.bool)
    return nn.functional.binary_cross_entropy_with_logits(logits[mask], target[mask])
