"""The CGVAE's loss with its edge term estimated on some pairs: the same on average, at a fraction of the work."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from ..losses.variational import node_terms
from .network import Cgvae


@dataclass(frozen=True)
class PairSample:
    """Ordered pairs of different nodes: ``child``, ``parent`` int64 (P,), ``edge`` and ``weight`` (P,).

    ``weight`` is how many pairs each stands for; the weights of all pairs of the batch sum to ``total`` on average.
    """

    child: Tensor
    parent: Tensor
    edge: Tensor
    weight: Tensor
    total: int


def sample_pairs(parent: Tensor, scene: Tensor, negatives: int, generator: torch.Generator) -> PairSample:
    """All edges, and for each node ``negatives`` other nodes of its scene that are not its parent.

    Parameters
    ----------
    parent, scene
        int64 (N,): row of the parent (-1 for roots) and number of the scene, ascending; every scene has three nodes
        or more.
    """
    counts = torch.bincount(scene)
    size, start = counts[scene], (torch.cumsum(counts, 0) - counts)[scene]
    node, weight = torch.arange(len(parent), device=parent.device), torch.ones(len(parent), device=parent.device)
    child = parent >= 0
    place, above = node - start, parent - start
    others = size - 1 - child.long()  # of its scene, without itself and its parent
    draw = (torch.rand(len(node), negatives, generator=generator, device=parent.device) * others[:, None]).long()
    draw = torch.minimum(draw, others[:, None] - 1)
    low, high = torch.minimum(place, above), torch.maximum(place, above)
    low, high = torch.where(child, low, place), torch.where(child, high, size)  # a root skips itself only
    draw = draw + (draw >= low[:, None])
    draw = draw + (draw >= high[:, None])
    return PairSample(
        torch.cat([node[child], node.repeat_interleave(negatives)]),
        torch.cat([parent[child], (start[:, None] + draw).flatten()]),
        torch.cat([weight[child], torch.zeros_like(weight).repeat(negatives)]),
        torch.cat([weight[child], (others / negatives).repeat_interleave(negatives)]),
        int((counts * (counts - 1)).sum()),
    )


def sampled_terms(
    model: Cgvae, features: Tensor, category: Tensor, edges: Tensor, pairs: PairSample, noise: Tensor
) -> tuple[dict[str, Tensor], Tensor]:
    """As :func:`.training.batch_terms`, with sampled pairs; also the decoded features (N, features)."""
    code, mean, log_variance = model.draw(features, category, edges, noise)
    decoded = model.decode_nodes(code)
    hidden = model.child(code)[pairs.child] + model.parent(code)[pairs.parent]
    logits = model.edge_decoder(hidden).squeeze(-1)
    each = nn.functional.binary_cross_entropy_with_logits(logits, pairs.edge, reduction="none")
    bce = (each * pairs.weight).sum() / pairs.total
    return {**node_terms(decoded, features, mean, log_variance), "bce": bce}, decoded
