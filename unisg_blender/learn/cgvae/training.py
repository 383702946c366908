"""Train the paper's CGVAE on a dataset and write it as a model for the generator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch_geometric.data import Data
from torch_geometric.loader import DataLoader
from torch_geometric.utils import to_dense_adj, to_dense_batch

from ...dataset.format.reader import Dataset
from ...generate.observe.contract import Contract
from ...generate.observe.support_priors import CategoryPriors
from ...generate.propose.cgvae_proposer import edges_of, node_features
from ...poses import FORMS
from ..hyperparameters import Settings
from ..losses.edge_losses import dense_edge_loss
from ..losses.variational import node_terms
from ..onnx_export import export_onnx
from ..provenance import save_model_assets
from ..training_job import Prepared
from ..training_scenes import TrainingScene, scenes_and_priors, split
from .network import Cgvae, CgvaeSizes

CONSTANT = 1e-6
"""A channel that spreads less than this over the training set is constant and not learned."""

KL_WEIGHT = 1e-2

EPOCHS, FORM = 100, "cga_even"
BATCH, LATENT = 16, 16


def prepare(datasets: Sequence[Dataset], settings: Settings) -> Prepared:
    """Scenes as graphs; UniSGError if there are too few scenes or categories."""
    vocabulary, scenes, priors = scenes_and_priors(datasets[0], settings.quiet)
    contract = _contract(scenes, vocabulary, priors, settings.form or FORM)
    parts = split(scenes, settings.seed)
    torch.manual_seed(settings.seed)
    network = Cgvae(CgvaeSizes(len(contract.kept), len(vocabulary), latent=LATENT))
    loaders = [_loader(part, contract, settings.seed, part is parts[0]) for part in parts]
    return Prepared(network, loaders, (len(parts[0]), len(parts[1])), contract, (datasets[0], parts[1]))


def export(prepared: Prepared, source: dict[str, Any], out: Path) -> None:
    """Write the model, and the dataset's assets beside it; the losses of a constant go into ``source``."""
    dataset, val = prepared.beside
    source["predict_mean"] = predict_mean(val, prepared.contract)
    write_cgvae(prepared.network, replace(prepared.contract, provenance=source), out)
    save_model_assets(dataset, out)


def _contract(
    scenes: Sequence[TrainingScene], vocabulary: tuple[str, ...], priors: CategoryPriors, form: str
) -> Contract:
    mean, scale, kept = normalisation([scene.local for scene in scenes], form)
    return Contract(
        kind="cgvae", vocabulary=vocabulary, priors=priors, form=form, mean=tuple(mean.tolist()),
        scale=tuple(scale.tolist()), kept=tuple(kept.tolist()), latent=LATENT,
    )  # fmt: skip


def normalisation(
    poses: Sequence[NDArray[np.float64]], form: str
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Mean and spread of all channels of a form (stretch included), and the channels that vary."""
    raw = FORMS[form].encode(np.concatenate(poses), stretch=True)
    mean, spread = raw.mean(axis=0), raw.std(axis=0)
    kept = np.flatnonzero(spread > CONSTANT)
    return mean, np.where(spread > CONSTANT, spread, 1.0), kept


def predict_mean(scenes: Sequence[TrainingScene], contract: Contract) -> dict[str, float]:
    """The losses of always predicting the training mean, and the same chance for every edge, on some scenes."""
    features = np.concatenate([node_features(scene.local, contract) for scene in scenes])
    pairs = sum(len(scene.local) * (len(scene.local) - 1) for scene in scenes)
    rate = sum(int((scene.objects.support >= 0).sum()) for scene in scenes) / max(pairs, 1)
    chance = float(np.clip(rate, 1e-9, 1 - 1e-9))
    entropy = -(chance * np.log(chance) + (1 - chance) * np.log(1 - chance))
    return {"mse": round(float((features.astype(np.float64) ** 2).mean()), 6), "bce": round(float(entropy), 6)}


def _loader(scenes: Sequence[TrainingScene], contract: Contract, seed: int, shuffle: bool) -> DataLoader:
    graphs = []
    for scene in scenes:
        category = np.where(scene.objects.category < 0, len(contract.vocabulary), scene.objects.category)
        graphs.append(support_graph(node_features(scene.local, contract), category, scene.objects.support))
    return DataLoader(graphs, BATCH, shuffle=shuffle, generator=torch.Generator().manual_seed(seed))


def support_graph(features: NDArray[np.float32], category: NDArray[np.int64], support: NDArray[np.int64]) -> Data:
    """A scene's nodes with their features (N, C) and categories (N,); ``parent_index`` is children over parents."""
    child = np.flatnonzero(support >= 0)
    arrays = {"x": features, "category": category, "edge_index": edges_of(support)}
    arrays["parent_index"] = np.stack([child, support[child]])
    return Data(**{name: torch.from_numpy(array) for name, array in arrays.items()})


def terms(network: nn.Module, batch: Data) -> dict[str, Tensor]:
    """The terms of the loss of a batch of :func:`support_graph`, the codes drawn anew."""
    assert isinstance(network, Cgvae)
    found = batch_terms(network, batch, torch.randn(batch.num_nodes, network.sizes.latent, device=batch.x.device))
    return {"loss": found["mse"] + found["bce"] + KL_WEIGHT * found["kl"], **found}


def batch_terms(network: Cgvae, batch: Data, noise: Tensor) -> dict[str, Tensor]:
    """The terms with noise (N, latent): ``mse`` over channels, ``bce`` over pairs of nodes, ``kl`` over nodes."""
    code, mean, log_variance = network.draw(batch.x, batch.category, batch.edge_index, noise)
    padded, filled = to_dense_batch(code, batch.batch)
    truth = to_dense_adj(batch.parent_index, batch.batch)
    bce = dense_edge_loss(network.decode_edges(padded, padded), truth, filled)
    return {**node_terms(network.decode_nodes(code), batch.x, mean, log_variance), "bce": bce}


def example_inputs(sizes: CgvaeSizes, nodes: int = 5) -> dict[str, Tensor]:
    """Inputs of the right kinds for a scene of some nodes in a chain."""
    chain = torch.stack([torch.arange(nodes - 1), torch.arange(1, nodes)])
    return {
        "features": torch.zeros(nodes, sizes.features),
        "category": torch.arange(nodes) % (sizes.categories + 1),
        "edges": torch.cat([chain, chain.flip(0)], dim=1),
        "noise": torch.zeros(nodes, sizes.latent),
        "known": torch.ones(nodes),
    }


def write_cgvae(network: nn.Module, contract: Contract, out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    assert isinstance(network, Cgvae)
    node = {0: "nodes"}
    dynamic = {"features": node, "category": node, "edges": {1: "edges"}, "noise": node, "known": node}
    outputs = ["decoded", "adjacency", "latent"]
    export_onnx(network, example_inputs(network.sizes), outputs, dynamic, contract.to_json(), out)
