"""The paper's conditional graph variational autoencoder (CGVAE).

Graph convolutions (Kipf and Welling, 2017) over node features and a category
embedding give each node a Gaussian latent; latent and embedding together are
decoded by one MLP to node features and by another, over pairs of nodes, to the
adjacency. Loss: MSE + BCE + KL. Source: Kamarianakis et al., "UniSG^GA", 2023,
section on scene generation; sizes of layers are ours, the paper gives none.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch_geometric.nn import GCNConv


@dataclass(frozen=True)
class CgvaeSizes:
    """Widths: node ``features``, ``categories`` (one more is kept for unknown ones), and the layers."""

    features: int
    categories: int
    embedding: int = 24
    hidden: int = 96
    latent: int = 16


class Cgvae(nn.Module):
    """Encoder and decoders; :meth:`forward` is also what the exported model computes."""

    def __init__(self, sizes: CgvaeSizes) -> None:
        super().__init__()
        self.sizes = sizes
        self.embedding = nn.Embedding(sizes.categories + 1, sizes.embedding)
        self.first = GCNConv(sizes.features + sizes.embedding, sizes.hidden)
        self.second = GCNConv(sizes.hidden, sizes.hidden)
        self.to_mean = nn.Linear(sizes.hidden, sizes.latent)
        self.to_logvar = nn.Linear(sizes.hidden, sizes.latent)
        code = sizes.latent + sizes.embedding
        self.node_decoder = nn.Sequential(
            nn.Linear(code, sizes.hidden), nn.ReLU(), nn.Linear(sizes.hidden, sizes.hidden), nn.ReLU(),
            nn.Linear(sizes.hidden, sizes.features),
        )  # fmt: skip
        self.child = nn.Linear(code, sizes.hidden)
        self.parent = nn.Linear(code, sizes.hidden, bias=False)
        self.edge_decoder = nn.Sequential(nn.ReLU(), nn.Linear(sizes.hidden, 1))

    def encode(self, features: Tensor, category: Tensor, edges: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Mean and log variance (N, latent) of every node's latent, and its embedding (N, embedding)."""
        embedded = self.embedding(category)
        hidden = self.first(torch.cat([features, embedded], dim=1), edges).relu()
        hidden = self.second(hidden, edges).relu()
        return self.to_mean(hidden), self.to_logvar(hidden).clamp(-8, 8), embedded

    def draw(self, features: Tensor, category: Tensor, edges: Tensor, noise: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Codes (N, latent + embedding) drawn with ``noise`` (N, latent), and the latents' mean and log variance."""
        mean, log_variance, embedded = self.encode(features, category, edges)
        return torch.cat([mean + noise * (0.5 * log_variance).exp(), embedded], dim=1), mean, log_variance

    def decode_nodes(self, code: Tensor) -> Tensor:
        """Node features (N, features) of codes (N, latent + embedding)."""
        return self.node_decoder(code)

    def decode_edges(self, child: Tensor, parent: Tensor) -> Tensor:
        """Logits (..., N, M) that ``parent`` codes (..., M, C) are the parents of ``child`` codes (..., N, C)."""
        pairs = self.child(child).unsqueeze(-2) + self.parent(parent).unsqueeze(-3)
        return self.edge_decoder(pairs).squeeze(-1)

    def forward(
        self, features: Tensor, category: Tensor, edges: Tensor, noise: Tensor, known: Tensor
    ) -> tuple[Tensor, Tensor, Tensor]:
        """Decode a scene in which some nodes are known and the others are drawn.

        Parameters
        ----------
        features
            (N, features), standardised; anything for new nodes.
        category
            int64 (N,); the number of categories for an unknown one.
        edges
            int64 (2, E), both ways.
        noise
            (N, latent), standard normal.
        known
            (N,): 1 for nodes that are encoded, 0 for nodes whose latent is the noise.

        Returns
        -------
        decoded (N, features), adjacency logits (N, N) with row i's parents in its columns, latent mean (N, latent).
        """
        mean, _, embedded = self.encode(features, category, edges)
        latent = torch.where(known.unsqueeze(1) > 0, mean, noise)
        code = torch.cat([latent, embedded], dim=1)
        return self.decode_nodes(code), self.decode_edges(code, code), mean
