"""The UniSG graph in a network: entities see their components and their family through GraphSAGE convolutions."""

from __future__ import annotations

import warnings
from collections.abc import Mapping

from torch import Tensor, nn
from torch_geometric.nn import HeteroConv, SAGEConv

EdgeKind = tuple[str, str, str]

COMPONENTS = ("info", "trs", "mesh", "action")
FAMILY: tuple[EdgeKind, ...] = (("entity", "parent_of", "entity"), ("entity", "rev_parent_of", "entity"))


def edge_kinds(components: tuple[str, ...] = COMPONENTS) -> tuple[EdgeKind, ...]:
    """Edges both ways: parents and children, entities and their components."""
    down = [("entity", "has", kind) for kind in components]
    return (*FAMILY, *down, *((kind, "rev_has", "entity") for kind in components))


class HeteroSage(nn.Module):
    """A linear layer per node type, then two GraphSAGE convolutions over all kinds of edges.

    GraphSAGE: Hamilton, Ying and Leskovec, 2017; mean aggregation, messages of
    different kinds of edges are added. Source of the graph: UniSG^GA, section 3.

    Parameters
    ----------
    widths
        Width of the features by node type; "entity" and some of :data:`COMPONENTS`.
    hidden
        Width of all layers.
    """

    def __init__(self, widths: Mapping[str, int], hidden: int) -> None:
        super().__init__()
        self.kinds = edge_kinds(tuple(kind for kind in COMPONENTS if kind in widths))
        self.inputs = nn.ModuleDict({kind: nn.Linear(width, hidden) for kind, width in widths.items()})
        upward = tuple(kind for kind in self.kinds if kind[2] == "entity")  # of the last layer only entities are read
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "There exist node types")  # whose values after it nobody reads
            self.layers = nn.ModuleList(
                HeteroConv({kind: SAGEConv((hidden, hidden), hidden) for kind in kinds}, aggr="sum")
                for kinds in (self.kinds, upward)
            )

    def forward(
        self, x: Mapping[str, Tensor], edges: Mapping[EdgeKind, Tensor], rows: Mapping[str, Tensor] | None = None
    ) -> Tensor:
        """Embeddings (N, hidden) of the entities.

        Parameters
        ----------
        x
            Features (K, width) by node type.
        edges
            int64 (2, E) by kind, source over destination.
        rows
            By node type: which row of ``x`` each node has, where many share one.
        """
        hidden = {kind: layer(x[kind]) for kind, layer in self.inputs.items()}
        for kind, place in (rows or {}).items():
            hidden[kind] = hidden[kind][place]
        for layer in self.layers:
            hidden = layer({kind: value.relu() for kind, value in hidden.items()}, edges)
        return hidden["entity"]
