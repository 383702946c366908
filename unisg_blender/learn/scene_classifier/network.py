"""Which kind of scene is it: two GraphSAGE convolutions over the UniSG graph and an attention readout."""

from __future__ import annotations

from collections.abc import Mapping

from torch import Tensor, nn
from torch_geometric.nn import AttentionalAggregation

from ..hetero_sage import EdgeKind, HeteroSage


class SceneClassifier(nn.Module):
    """Scores of ``classes`` kinds of scenes.

    The readout is a weighted mean of the entities' embeddings, weights by a
    learned gate and softmax over the scene (Li et al., "Gated graph sequence neural
    networks", 2016, equation 7). Source: UniSG^GA, experiment on classification;
    the widths are ours, the paper gives none.
    """

    def __init__(self, widths: Mapping[str, int], classes: int, hidden: int = 32) -> None:
        super().__init__()
        self.encoder = HeteroSage(widths, hidden)
        self.readout = AttentionalAggregation(nn.Linear(hidden, 1))
        self.head = nn.Linear(hidden, classes)

    def forward(
        self,
        x: Mapping[str, Tensor],
        edges: Mapping[EdgeKind, Tensor],
        scene: Tensor,
        scenes: int,
        rows: Mapping[str, Tensor] | None = None,
    ) -> Tensor:
        """Logits (scenes, classes); ``scene`` int64 (N,) is the scene of each entity, ascending."""
        return self.head(self.embedding(x, edges, scene, scenes, rows))

    def embedding(
        self,
        x: Mapping[str, Tensor],
        edges: Mapping[EdgeKind, Tensor],
        scene: Tensor,
        scenes: int,
        rows: Mapping[str, Tensor] | None = None,
    ) -> Tensor:
        """What is read out of each scene, (scenes, hidden), before the scores."""
        return self.readout(self.encoder(x, edges, rows).relu(), scene, dim_size=scenes)
