"""Train the paper's CGVAE on a dataset and write it as a model for the generator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.utils.data import DataLoader

from ...dataset.format.reader import Dataset
from ...generate.observe.contract import Contract
from ...generate.observe.support_priors import learn_priors
from ...generate.propose.cgvae_proposer import edges_of, node_features
from ...poses import FORMS
from ..losses.variational import cgvae_losses
from ..onnx_export import export_onnx
from ..provenance import provenance, save_model_assets
from ..settings import Settings
from ..trainer import Schedule, fit
from ..training_scenes import TrainingScene, load_scenes, split, vocabulary_of
from .network import Cgvae, CgvaeSizes

CONSTANT = 1e-6
"""A channel that spreads less than this over the training set is constant and not learned."""

KL_WEIGHT = 1e-2


FORM, EPOCHS = "cga_even", 100
BATCH, LATENT = 16, 16


def train(dataset: Dataset, out: Path, settings: Settings) -> dict[str, Any]:
    """Train the project's own model, or with ``settings.paper`` the paper's, and the behaviour beside it."""
    from ..anchors.training import train as train_anchors
    from ..behaviour.training import train as train_behaviour

    source = (train_paper if settings.paper else train_anchors)(dataset, out, settings)
    behaviour = train_behaviour(dataset, out, settings)
    notes = [*source.get("notes", ()), *behaviour.get("notes", ())]
    return {**source, "notes": list(dict.fromkeys(notes)), "behaviour": behaviour}


def train_paper(dataset: Dataset, out: Path, settings: Settings) -> dict[str, Any]:
    """Train, export and put the assets beside the model; returns the provenance that the model carries.

    Raises
    ------
    UniSGError
        Too few scenes or categories.
    """
    settings = replace(settings, form=settings.form or FORM, epochs=settings.epochs or EPOCHS)
    vocabulary = vocabulary_of(dataset)
    scenes = load_scenes(dataset, vocabulary, settings.quiet)
    contract = _contract(scenes, vocabulary, settings)
    train_scenes, val_scenes = split(scenes, settings.seed)
    torch.manual_seed(settings.seed)
    network = Cgvae(CgvaeSizes(len(contract.kept), len(vocabulary), latent=LATENT))
    loaders = [_loader(part, contract, settings.seed, part is train_scenes) for part in (train_scenes, val_scenes)]
    schedule = Schedule(settings.epochs or EPOCHS, devices=settings.devices, nodes=settings.nodes)
    losses = fit(network, _terms, loaders[0], loaders[1], schedule, settings)
    source = provenance(dataset, settings, len(train_scenes), len(val_scenes), losses, network)
    source["predict_mean"] = predict_mean(val_scenes, contract)
    write_cgvae(network, replace(contract, provenance=source), out)
    save_model_assets(dataset, out)
    return source


def _contract(scenes: Sequence[TrainingScene], vocabulary: tuple[str, ...], settings: Settings) -> Contract:
    form = settings.form or FORM
    mean, scale, kept = normalisation([scene.local for scene in scenes], form)
    priors = learn_priors((scene.objects for scene in scenes), vocabulary)
    return Contract(
        kind="cgvae",
        vocabulary=vocabulary,
        priors=priors,
        form=form,
        mean=tuple(mean.tolist()),
        scale=tuple(scale.tolist()),
        kept=tuple(kept.tolist()),
        latent=LATENT,
    )


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


@dataclass(frozen=True, eq=False)
class _Nodes:
    features: Tensor
    category: Tensor
    edges: Tensor
    parent: Tensor


def _loader(
    scenes: Sequence[TrainingScene], contract: Contract, seed: int, shuffle: bool
) -> DataLoader[Mapping[str, Tensor]]:
    nodes = [_nodes(scene, contract) for scene in scenes]
    order = torch.Generator().manual_seed(seed)
    return DataLoader(nodes, batch_size=BATCH, shuffle=shuffle, collate_fn=_collate, generator=order)  # type: ignore[arg-type]


def _nodes(scene: TrainingScene, contract: Contract) -> _Nodes:
    category = np.where(scene.objects.category < 0, len(contract.vocabulary), scene.objects.category)
    return _Nodes(
        torch.from_numpy(node_features(scene.local, contract)),
        torch.from_numpy(category),
        torch.from_numpy(edges_of(scene.objects.support)),
        torch.from_numpy(scene.objects.support.copy()),
    )


def _collate(scenes: Sequence[_Nodes]) -> dict[str, Tensor]:
    counts = torch.tensor([len(scene.category) for scene in scenes])
    start = (torch.cumsum(counts, 0) - counts).tolist()
    shifted = [torch.where(s.parent >= 0, s.parent + first, -1) for s, first in zip(scenes, start, strict=True)]
    return {
        "features": torch.cat([scene.features for scene in scenes]),
        "category": torch.cat([scene.category for scene in scenes]),
        "edges": torch.cat([scene.edges + first for scene, first in zip(scenes, start, strict=True)], dim=1),
        "parent": torch.cat(shifted),
        "scene": torch.repeat_interleave(torch.arange(len(scenes)), counts),
    }


def _terms(network: nn.Module, batch: Mapping[str, Tensor]) -> dict[str, Tensor]:
    assert isinstance(network, Cgvae)
    noise = torch.randn(len(batch["category"]), network.sizes.latent)
    losses = cgvae_losses(network, **batch, noise=noise)
    loss = losses.mse + losses.bce + KL_WEIGHT * losses.kl
    return {"loss": loss, "mse": losses.mse, "bce": losses.bce, "kl": losses.kl}


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


def write_cgvae(network: Cgvae, contract: Contract, out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    node = {0: "nodes"}
    dynamic = {"features": node, "category": node, "edges": {1: "edges"}, "noise": node, "known": node}
    outputs = ["decoded", "adjacency", "latent"]
    export_onnx(network, example_inputs(network.sizes), outputs, dynamic, contract.to_json(), out)
