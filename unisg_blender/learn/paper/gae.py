"""The paper's graph autoencoder: entities that stand on one another have embeddings with a large inner product."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor, nn

from ..hetero_sage import EdgeKind, HeteroSage
from ..losses.edge_losses import contrastive_edge_loss


class GraphAutoencoder(nn.Module):
    """GraphSAGE encoder, inner-product decoder (Kipf and Welling, "Variational graph auto-encoders", 2016).

    The logit of an edge is z_i . z_j, the same in both directions. Source: UniSG^GA,
    experiment on topology; the widths are ours. The encoder sees the hierarchy and the
    components, not the edges that it has to find. (PyG's ``GAE`` draws the encoder's weights a second time, and its
    loss takes logarithms of chances: other numbers than the published ones.)
    """

    def __init__(self, widths: Mapping[str, int], hidden: int = 32, latent: int = 16) -> None:
        super().__init__()
        self.encoder = HeteroSage(widths, hidden)
        self.latent = nn.Linear(hidden, latent)

    def forward(
        self, x: Mapping[str, Tensor], edges: Mapping[EdgeKind, Tensor], rows: Mapping[str, Tensor] | None = None
    ) -> Tensor:
        """Embeddings (N, latent) of the entities."""
        return self.latent(self.encoder(x, edges, rows).relu())


def edge_logits(embedding: Tensor, pairs: Tensor) -> Tensor:
    """Logits (P,) of pairs int64 (2, P)."""
    return (embedding[pairs[0]] * embedding[pairs[1]]).sum(dim=1)


def edge_loss(embedding: Tensor, edges: Tensor, others: Tensor) -> Tensor:
    """The loss of pairs that are edges, int64 (2, P), and of pairs that are none (2, Q)."""
    return contrastive_edge_loss(edge_logits(embedding, edges), edge_logits(embedding, others))


def random_pairs(count: int, nodes: Tensor, generator: torch.Generator) -> Tensor:
    """Pairs int64 (2, count) of different members of ``nodes``, drawn uniformly."""
    first = torch.randint(len(nodes), (count,), generator=generator)
    step = torch.randint(1, len(nodes), (count,), generator=generator)
    return torch.stack([nodes[first], nodes[(first + step) % len(nodes)]])
