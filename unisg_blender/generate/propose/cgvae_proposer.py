"""Poses proposed by the paper's conditional graph VAE."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.planar import heading, rotate
from ...poses import FORMS
from ..observe.contract import Contract
from ..observe.placeable import Placeable
from .proposer import Proposals, Proposer, Query
from .trained_model import TrainedModel

SHIFT = 1e-6


def node_features(local: Floats, contract: Contract) -> NDArray[np.float32]:
    """Standardised features (K, width) of poses (K, 4, 4) relative to their supports."""
    raw = FORMS[contract.form].encode(local, stretch=True)
    kept = list(contract.kept)
    mean, scale = np.array(contract.mean), np.array(contract.scale)
    return ((raw[:, kept] - mean[kept]) / scale[kept]).astype(np.float32)


def poses_of(features: NDArray[np.float32], contract: Contract) -> Floats:
    """Poses (K, 4, 4) of what the network gave (K, width), made valid."""
    form = FORMS[contract.form]
    kept = list(contract.kept)
    raw = np.tile(np.array(contract.mean), (len(features), 1))
    raw[:, kept] += features.astype(np.float64) * np.array(contract.scale)[kept]
    return form.decode(form.project(raw + _nudge(raw), stretch=True), stretch=True)


def _nudge(raw: Floats) -> Floats:
    """Something tiny for rows of zeros, which have no nearest pose."""
    return np.where(np.abs(raw).max(axis=1, keepdims=True) < SHIFT, SHIFT, 0.0)


def edges_of(support: Ints) -> Ints:
    """Edges (2, E) between each object and its support, both ways."""
    child = np.flatnonzero(support >= 0)
    down = np.stack([support[child], child])
    return np.concatenate([down, down[::-1]], axis=1).astype(np.int64)


class CgvaeProposer(Proposer):
    """Draws latents for new nodes, decodes poses and chooses parents by the adjacency decoder."""

    def __init__(self, model: TrainedModel) -> None:
        self.model = model
        self.contract = model.contract

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """See :class:`~.proposer.Proposer`; what is to come plays no part."""
        scene, known = query.scene, len(query.scene.category)
        features = np.zeros((known + count, len(self.contract.kept)), np.float32)
        features[:known] = node_features(scene.local, self.contract)
        noise = rng.standard_normal((known + count, self.contract.latent)).astype(np.float32)
        kinds = np.where(scene.category < 0, len(self.contract.vocabulary), scene.category)
        decoded, adjacency = self.model.run(
            ["decoded", "adjacency"],
            features=features,
            category=np.append(kinds, np.full(count, query.category)).astype(np.int64),
            edges=edges_of(scene.support),
            noise=np.float32(query.sampling.variety) * noise,
            known=np.append(np.ones(known, np.float32), np.zeros(count, np.float32)),
        )
        supports = _choose(query.sampling.power * adjacency[known:, :known], query.allowed, rng)
        above = np.concatenate([scene.world, np.eye(4)[None]])[supports]
        return Proposals(supports, _places(above @ poses_of(decoded[known:], self.contract), query.placeable))


def _choose(logits: NDArray[np.float32], allowed: Bools, rng: np.random.Generator) -> Ints:
    """A support per row, at random by the probabilities of the edges to the allowed ones; -1 if none is."""
    if not allowed.any():
        return np.full(len(logits), -1, np.int64)
    chance = 1 / (1 + np.exp(-np.clip(logits.astype(np.float64), -40, 40)))
    chance = np.where(allowed, chance, 0) + 1e-12 * allowed
    total = np.cumsum(chance, axis=1)
    return (total < rng.random((len(logits), 1)) * total[:, -1:]).sum(axis=1)


def _places(world: Floats, placeable: Placeable) -> Floats:
    """Places (T, 4) of a placeable whose entity has world matrices (T, 4, 4); scale and lean are the asset's own."""
    own = heading(placeable.asset.graph.local[0, :3, :3])
    yaw = heading(world[:, :3, :3]) - own
    return np.concatenate([world[:, :3, 3] + rotate(placeable.foot, yaw), yaw[:, None]], axis=1)
