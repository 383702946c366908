"""Losses of predicted edges: binary cross-entropies."""

from __future__ import annotations

import torch
from torch import Tensor, nn


def contrastive_edge_loss(edges: Tensor, others: Tensor) -> Tensor:
    """Of logits of edges (P,) and of pairs that are none (Q,): the mean of the two means."""
    return nn.functional.softplus(-edges).mean() + nn.functional.softplus(others).mean()


def dense_edge_loss(logits: Tensor, truth: Tensor, filled: Tensor) -> Tensor:
    """Over all ordered pairs of different nodes of one scene.

    Parameters
    ----------
    logits, truth
        (B, M, M): of B scenes of M nodes and fewer.
    filled
        bool (B, M): which nodes there are.
    """
    different = ~torch.eye(logits.shape[1], dtype=torch.bool, device=logits.device)
    asked = filled[:, :, None] & filled[:, None, :] & different
    return nn.functional.binary_cross_entropy_with_logits(logits[asked], truth[asked])
