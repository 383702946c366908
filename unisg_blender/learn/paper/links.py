"""Experiment "link_prediction": the paper's graph autoencoder asked about scenes that it has not seen."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch_geometric.transforms import ToUndirected

from ...dataset import UniSGDataset
from .classification import scenes_of, standardised, widths_of
from .gae import GraphAutoencoder, edge_logits, edge_loss
from .pairs import SHARES, judge, load_pairs
from .topology import COMPONENTS

RATE, HIDDEN = 3e-3, 32


@lru_cache(maxsize=3)
def _batch(folder: Path, part: str) -> tuple[Any, Tensor]:
    """Scenes of a share, and the entity of each object that pairs are told of."""
    dataset = UniSGDataset(folder, transform=ToUndirected(merge=False))
    low, high = (round(end * len(dataset)) for end in SHARES[part])
    batch = dataset.batch(range(low, high))
    floor = dataset.vocabulary["categories"].index("Floor")
    return batch, torch.from_numpy(np.flatnonzero(batch["entity"].category.numpy() != floor))


def run(settings: Mapping[str, Any], data: Path) -> dict[str, Any]:
    """Trained with the near pairs as negatives; ``settings``: form, seed, rotation, epochs. Stretch stands beside."""
    folder = data / f"cubes_{settings['rotation']}"
    batches = {name: _batch(folder, name) for name in SHARES}
    raw = [scenes_of(batch, settings["form"], True, COMPONENTS) for batch, _ in batches.values()]
    scenes = dict(zip(SHARES, standardised(raw, raw[:1]), strict=True))
    parts = {name: load_pairs(folder, name) for name in SHARES}
    pairs = {name: batches[name][1][torch.from_numpy(part.pairs.T)] for name, part in parts.items()}
    truth = torch.from_numpy(parts["train"].truth)
    edges, others = pairs["train"][:, truth], pairs["train"][:, ~truth]
    torch.manual_seed(settings["seed"])
    network = GraphAutoencoder(widths_of(scenes["train"]), HIDDEN, HIDDEN)
    optimizer = torch.optim.Adam(network.parameters(), RATE)
    for _ in range(settings["epochs"]):
        scene = scenes["train"]
        loss = edge_loss(network(scene.x, scene.edges, scene.rows), edges, others)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    score = {}
    with torch.no_grad():
        for name in ("validation", "test"):
            scene = scenes[name]
            score[name] = edge_logits(network(scene.x, scene.edges, scene.rows), pairs[name]).numpy()
    parameters = sum(weight.numel() for weight in network.parameters())
    return {"parameters": parameters, "rows": [judge(score["validation"], score["test"], parts)]}
