"""Experiment "topology": which of 10,000 cubes stand on which, by a graph autoencoder, as in the paper."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import torch
from torch import Tensor
from torch_geometric.transforms import ToUndirected

from ...dataset import UniSGDataset
from ...metrics.edge_metrics import area_under_roc, average_precision
from .classification import scenes_of, standardised, widths_of
from .gae import GraphAutoencoder, edge_logits, edge_loss, random_pairs

RATE, HIDDEN = 3e-3, 16
HELD_OUT = 0.15
RELATION = ("entity", "on_top_of", "entity")
COMPONENTS = ("info", "trs", "mesh")
"""Cubes have no actions."""


@lru_cache(maxsize=1)
def _batch(folder: Path, number: int) -> Any:
    return ToUndirected(merge=False)(UniSGDataset(folder).batch([number]))


def run(settings: Mapping[str, Any], data: Path) -> dict[str, Any]:
    """Loss, average precision and ROC area after every epoch, on edges to learn from and held-out ones.

    ``settings``: form, seed, epochs. Each seed has a scene of its own, as in the paper.

    Inputs are standardised: the floor has 10,000 children and the field is 106 m
    wide, raw numbers make inner products of a million and kill every unit. Negatives are random pairs of cubes, as
    many as edges, drawn anew each epoch.
    """
    batch = _batch(data / "pairs_by_seed", settings["seed"])
    raw = scenes_of(batch, settings["form"], False, COMPONENTS)
    scene = standardised([raw], [raw])[0]
    generator = torch.Generator().manual_seed(settings["seed"])
    cubes = torch.arange(1, batch["entity"].num_nodes)  # the first entity is the floor
    edges = batch[RELATION].edge_index
    edges = edges[:, edges[1] > 0]
    order = torch.randperm(edges.shape[1], generator=generator)
    count = round(HELD_OUT * len(order))
    held_out, known = edges[:, order[:count]], edges[:, order[count:]]
    none = random_pairs(count, cubes, generator)
    torch.manual_seed(settings["seed"])
    network = GraphAutoencoder(widths_of(scene), HIDDEN, HIDDEN)
    optimizer = torch.optim.Adam(network.parameters(), RATE)
    names = ("loss", "average_precision", "test_loss", "test_average_precision", "test_roc_area")
    curves: dict[str, list[float]] = {name: [] for name in names}
    for _ in range(settings["epochs"]):
        others = random_pairs(known.shape[1], cubes, generator)
        embedding = network(scene.x, scene.edges, scene.rows)
        loss = edge_loss(embedding, known, others)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        with torch.no_grad():  # of the weights before the step: one pass through the graph serves both
            there = _areas(embedding, held_out, none)
            values: tuple[Any, ...] = (
                loss.detach(),
                _areas(embedding, known, others)[0],
                edge_loss(embedding, held_out, none),
                *there,
            )
        for name, value in zip(curves, values, strict=True):
            curves[name].append(round(float(value), 6))
    return {"parameters": sum(weight.numel() for weight in network.parameters()), "curves": curves}


def _areas(embedding: Tensor, edges: Tensor, others: Tensor) -> tuple[float, float]:
    score = torch.cat([edge_logits(embedding, edges), edge_logits(embedding, others)]).numpy()
    truth = torch.arange(len(score)).numpy() < edges.shape[1]
    return average_precision(score, truth), area_under_roc(score, truth)
