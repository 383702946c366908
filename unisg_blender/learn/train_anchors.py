"""Train the anchor mixture on a dataset and write it as a model for the generator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.utils.data import DataLoader

from ..dataset.reader import Dataset
from ..generate.context import PLAN_WIDTH
from ..generate.contract import Contract
from ..generate.habits import Habits, learn_habits
from ..generate.order import in_order
from .anchor_batches import Examples, collate
from .anchors import FLAGS, AnchorModel, AnchorSizes, height_nll, mixture_nll
from .export import export_onnx
from .fit import Schedule, fit
from .publish import provenance, save_model_assets
from .scenes import TrainingScene, load_scenes, split, vocabulary_of
from .settings import Settings

EPOCHS = 150
PER_EPOCH = 640
BATCH = 32
NLL_LIMIT = 20.0
HEIGHT_WEIGHT, SUPPORT_WEIGHT = 0.3, 0.3
OUTPUTS = (
    "support_score", "height_weight", "height_mean", "height_sigma",
    "weight", "mean", "sigma", "heading", "kappa",
)  # fmt: skip


def train(dataset: Dataset, out: Path, settings: Settings) -> dict[str, Any]:
    """Train, export and put the assets beside the model; returns the provenance that the model carries.

    Raises
    ------
    UniSGError
        Too few scenes or categories.
    """
    settings = replace(settings, epochs=settings.epochs or EPOCHS)
    vocabulary = vocabulary_of(dataset)
    scenes = load_scenes(dataset, vocabulary, settings.quiet)
    habits = learn_habits((scene.things for scene in scenes), vocabulary)
    train_scenes, val_scenes = split(scenes, settings.seed)
    torch.manual_seed(settings.seed)
    network = AnchorModel(AnchorSizes(len(vocabulary)))
    rank = placing_rank(habits, vocabulary)
    loaders = [
        _loader(train_scenes, rank, PER_EPOCH, settings.seed, fresh=True),
        _loader(val_scenes, rank, min(320, 40 * len(val_scenes)), settings.seed + 1, fresh=False),
    ]
    schedule = Schedule(settings.epochs or EPOCHS, devices=settings.devices, nodes=settings.nodes)
    losses = fit(network, _terms, loaders[0], loaders[1], schedule, settings)
    source = provenance(dataset, settings, len(train_scenes), len(val_scenes), losses, network)
    write_anchors(network, Contract("anchors", vocabulary, habits, provenance=source), out)
    save_model_assets(dataset, out)
    return source


def placing_rank(habits: Habits, vocabulary: Sequence[str]) -> NDArray[np.int64]:
    """The order of placing by category (C + 1,); unknown categories stand first."""
    order = in_order({name: 1 for name in vocabulary}, habits)
    return np.array([1 + order.index(name) for name in vocabulary] + [0], np.int64)


def _loader(
    scenes: Sequence[TrainingScene], rank: NDArray[np.int64], count: int, seed: int, fresh: bool
) -> DataLoader[dict[str, Tensor]]:
    return DataLoader(Examples(scenes, rank, count, seed, fresh), batch_size=BATCH, collate_fn=collate)


def _terms(network: nn.Module, batch: Mapping[str, Tensor]) -> dict[str, Tensor]:
    assert isinstance(network, AnchorModel)
    each = torch.arange(len(batch["parent"]))
    score, *heights = network.choose(
        batch["target_category"], batch["target_half"], batch["coming"],
        batch["support_category"], batch["support_half"], batch["support_load"],
    )  # fmt: skip
    score = score + (batch["support_mask"] - 1) * 1e4
    support = nn.functional.cross_entropy(score, batch["parent"])
    right = (score.argmax(1) == batch["parent"]).float().mean()
    weight, mean, sigma = (part[each, batch["parent"]] for part in heights)
    height = height_nll(weight, mean, sigma, batch["height"]).clamp(max=NLL_LIMIT).mean()
    mixture = network.places(
        batch["target_category"], batch["target_half"], batch["target_bottom"], batch["plan"], batch["coming"],
        batch["category"], batch["box"], batch["flags"], batch["mask"],
    )  # fmt: skip
    nll = mixture_nll(mixture, batch["box"], batch["position"], batch["heading"]).clamp(max=NLL_LIMIT).mean()
    loss = nll + HEIGHT_WEIGHT * height + SUPPORT_WEIGHT * support
    return {"loss": loss, "nll": nll, "height": height, "support": support, "support_accuracy": right}


def example_inputs(categories: int, batch: int = 2, tokens: int = 3, supports: int = 4) -> dict[str, Tensor]:
    """Inputs of the right kinds."""
    box = torch.rand(batch, tokens, 8)
    box[..., 6:] = torch.nn.functional.normalize(box[..., 6:], dim=-1)
    return {
        "target_category": torch.zeros(batch, dtype=torch.int64),
        "target_half": torch.rand(batch, 3),
        "target_bottom": torch.rand(batch),
        "plan": torch.rand(batch, PLAN_WIDTH),
        "coming": torch.rand(batch, categories),
        "category": torch.zeros(batch, tokens, dtype=torch.int64),
        "box": box,
        "flags": torch.zeros(batch, tokens, FLAGS),
        "mask": torch.ones(batch, tokens),
        "support_category": torch.zeros(batch, supports, dtype=torch.int64),
        "support_half": torch.rand(batch, supports, 3),
        "support_load": torch.rand(batch, supports, 4),
    }


def write_anchors(network: AnchorModel, contract: Contract, out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    inputs = example_inputs(network.sizes.categories)
    dynamic: dict[str, dict[int, str]] = {name: {0: "targets"} for name in inputs}
    for name in ("category", "box", "flags", "mask"):
        dynamic[name][1] = "tokens"
    for name in ("support_category", "support_half", "support_load"):
        dynamic[name][1] = "supports"
    export_onnx(network, inputs, OUTPUTS, dynamic, contract.to_json(), out)
