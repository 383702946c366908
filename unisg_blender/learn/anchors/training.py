"""Train the anchor mixture on a dataset and write it as a model for the generator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn
from torch.utils.data import DataLoader

from ...dataset.format.reader import Dataset
from ...generate.observe.contract import Contract
from ...generate.observe.placement_order import learn_orders
from ...generate.observe.scene_tokens import FLAGS, PLAN_WIDTH
from ...generate.observe.support_candidates import OCCUPANCY_WIDTH
from ...generate.observe.support_priors import learn_priors
from ..losses.mixtures import height_nll, mixture_nll
from ..losses.ranking import ranking_loss
from ..losses.variational import kl_divergence
from ..onnx_export import export_onnx
from ..provenance import provenance, save_model_assets
from ..settings import Settings
from ..trainer import Schedule, fit
from ..training_scenes import load_scenes, split, vocabulary_of
from .critic import drawn
from .examples import AnchorExamples, Order, RoomLayout, collate
from .network import COMPONENTS, AnchorModel, AnchorSizes
from .pose_encoder import LATENT

EPOCHS = 23
PER_EPOCH = 11200
PER_TARGET = 2
"""Examples in an epoch: at most so many for each object in the scenes."""

BATCH = 64
BACKGROUND = 2000
WATCHED = 640
"""Held-out examples on which the loss is watched, at most."""

NLL_LIMIT = 20.0
HEIGHT_WEIGHT, SUPPORT_WEIGHT = 0.3, 0.3
CRITIC_WEIGHT = 0.5
FREE_NATS = 0.1
"""Nats of the latent code, in the mean over a batch, that cost nothing."""

OUTPUTS = (
    "support_score", "height_weight", "height_mean", "height_sigma",
    "weight", "mean", "sigma", "heading", "kappa", "seen", "ratio",
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
    priors = learn_priors((scene.objects for scene in scenes), vocabulary)
    train_scenes, val_scenes = split(scenes, settings.seed)
    order = Order.of(vocabulary, priors)
    layouts = [[RoomLayout(scene, order) for scene in part] for part in (train_scenes, val_scenes)]
    priors = replace(priors, orders=learn_orders((layout.scene for layout in layouts[0]), vocabulary))
    torch.manual_seed(settings.seed)
    network = AnchorModel(AnchorSizes(len(vocabulary)))
    count = min(PER_EPOCH, PER_TARGET * sum(len(layout.targets) for layout in layouts[0]))
    loaders = [
        _loader(layouts[0], order, count, settings.seed, fresh=True),
        _loader(layouts[1], order, min(WATCHED, 40 * len(val_scenes)), settings.seed + 1, fresh=False),
    ]
    hidden = network.hidden_matrices()
    schedule = Schedule(settings.epochs or EPOCHS, muon=hidden, devices=settings.devices, nodes=settings.nodes)
    threads = torch.get_num_threads()
    torch.set_num_threads(max(1, threads - loaders[0].num_workers))  # else they wait for the one that prepares examples
    try:
        losses = fit(network, _terms, loaders[0], loaders[1], schedule, settings)
    finally:
        torch.set_num_threads(threads)
    source = provenance(dataset, settings, len(train_scenes), len(val_scenes), losses, network)
    write_anchors(network, Contract("anchors", vocabulary, priors, latent=network.sizes.latent, provenance=source), out)
    save_model_assets(dataset, out)
    return source


def _loader(
    layouts: Sequence[RoomLayout], order: Order, count: int, seed: int, fresh: bool
) -> DataLoader[list[dict[str, Tensor]]]:
    examples: Any = AnchorExamples(layouts, order, count, seed, fresh)
    workers = int(fresh and count >= BACKGROUND)
    return DataLoader(
        examples, batch_size=BATCH, collate_fn=collate, num_workers=workers, persistent_workers=workers > 0
    )


def _terms(network: nn.Module, batch: Sequence[Mapping[str, Tensor]]) -> dict[str, Tensor]:
    """The terms of the loss over all parts of a batch."""
    assert isinstance(network, AnchorModel)
    parts = [part_terms(network, part) for part in batch]
    size = sum(len(part["parent"]) for part in batch)
    terms = {name: sum((part[name].sum() for part in parts), start=torch.zeros(())) / size for name in parts[0]}
    terms["loss"] = (
        terms["nll"]
        + terms["kl"].clamp(min=FREE_NATS)
        + CRITIC_WEIGHT * terms["critic"]
        + HEIGHT_WEIGHT * terms["height"]
        + SUPPORT_WEIGHT * terms["support"]
    )
    return terms


def part_terms(network: AnchorModel, batch: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """For each example (B,): negative log-likelihoods of place, height and support, and was the likeliest right."""
    each = torch.arange(len(batch["parent"]))
    score, *heights = network.choose(
        batch["target_category"], batch["target_half"], batch["coming"], batch["whole"], batch["support_category"],
        batch["support_holder"], batch["support_half"], batch["support_load"], batch["support_content"],
        batch["support_near"],
    )  # fmt: skip
    score = score + (batch["support_mask"] - 1) * 1e4
    likeliest = score.argmax(1)
    weight, mean, sigma = (part[each, batch["parent"]] for part in heights)
    loose = batch["support_load"][each, batch["parent"], 6]  # what stands on a surface has the surface's height
    latent, divergence = _latent(network, batch)
    nll, (*mixture, view) = _place_nll(network, batch, latent)
    critic = ranking_loss(_scores(network, batch, tuple(mixture), view))
    prior = {} if network.training else {"prior_nll": _place_nll(network, batch, torch.randn_like(latent))[0]}
    return {
        "nll": nll,
        "kl": divergence,
        "critic": critic,
        **prior,
        "height": height_nll(weight, mean, sigma, batch["height"]).clamp(max=NLL_LIMIT) * loose,
        "support": nn.functional.cross_entropy(score, batch["parent"], reduction="none"),
        "support_right": (likeliest == batch["parent"]).float(),
        "kind_right": (batch["kind"][each, likeliest] == batch["kind"][each, batch["parent"]]).float(),
    }


def _place_nll(network: AnchorModel, batch: Mapping[str, Tensor], latent: Tensor) -> tuple[Tensor, tuple[Tensor, ...]]:
    """Negative log-likelihood (B,) of the true places given latent codes, and the mixtures."""
    mixture = network.places(
        batch["target_category"], batch["target_half"], batch["target_bottom"], batch["plan"], batch["row"], latent,
        batch["category"], batch["box"], batch["flags"], batch["mask"],
    )  # fmt: skip
    nll = mixture_nll(mixture[:-1], batch["box"], batch["position"].unsqueeze(1), batch["heading"].unsqueeze(1))
    return nll.squeeze(1).clamp(max=NLL_LIMIT), mixture


def _scores(network: AnchorModel, batch: Mapping[str, Tensor], mixture: tuple[Tensor, ...], view: Tensor) -> Tensor:
    """The critic's scores (B, 1 + DRAWS) of the true place and of draws."""
    true = torch.cat([batch["position"], batch["heading"].unsqueeze(1)], dim=1).unsqueeze(1)
    place = torch.cat([true, drawn(mixture, batch["box"], COMPONENTS)], dim=1)
    return network.judge(
        batch["target_half"], batch["target_bottom"], batch["box"], batch["flags"], batch["mask"], view, place
    )


def _latent(network: AnchorModel, batch: Mapping[str, Tensor]) -> tuple[Tensor, Tensor]:
    """A code (B, latent) drawn from the encoder, and its divergence (B,) from the standard normal, nats."""
    if network.encoder is None:
        return torch.zeros(len(batch["heading"]), 0), torch.zeros(len(batch["heading"]))
    mean, log_variance = network.encoder(
        network.embedding(batch["target_category"]), network.embedding(batch["category"]), batch["box"],
        batch["flags"], batch["mask"], batch["position"], batch["heading"],
    )  # fmt: skip
    noise = torch.randn_like(mean)
    return mean + noise * (log_variance / 2).exp(), kl_divergence(mean, log_variance)


def example_inputs(
    categories: int, batch: int = 2, tokens: int = 3, supports: int = 4, latent: int = LATENT
) -> dict[str, Tensor]:
    """Inputs of the right kinds."""
    box = torch.rand(batch, tokens, 8)
    box[..., 6:] = torch.nn.functional.normalize(box[..., 6:], dim=-1)
    return {
        "target_category": torch.zeros(batch, dtype=torch.int64),
        "target_half": torch.rand(batch, 3),
        "target_bottom": torch.rand(batch),
        "plan": torch.rand(batch, PLAN_WIDTH),
        "row": torch.rand(batch, categories),
        "latent": torch.rand(batch, latent),
        "category": torch.zeros(batch, tokens, dtype=torch.int64),
        "box": box,
        "flags": torch.zeros(batch, tokens, FLAGS),
        "mask": torch.ones(batch, tokens),
        "coming": torch.rand(batch, categories),
        "whole": torch.ones(batch),
        "support_category": torch.zeros(batch, supports, dtype=torch.int64),
        "support_holder": torch.zeros(batch, supports, dtype=torch.int64),
        "support_half": torch.rand(batch, supports, 3),
        "support_load": torch.rand(batch, supports, OCCUPANCY_WIDTH),
        "support_content": torch.rand(batch, supports, categories + 1),
        "support_near": torch.rand(batch, supports, categories + 1),
        "view": torch.rand(batch, tokens, 3 * AnchorSizes(categories).width),
        "place": torch.rand(batch, 5, 3),
    }


def write_anchors(network: AnchorModel, contract: Contract, out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    inputs = example_inputs(network.sizes.categories, latent=network.sizes.latent)
    dynamic: dict[str, dict[int, str]] = {name: {0: "targets"} for name in inputs}
    dynamic["place"][1] = "places"
    for name in ("category", "box", "flags", "mask", "view"):
        dynamic[name][1] = "tokens"
    for name in inputs:
        if name.startswith("support_"):
            dynamic[name][1] = "supports"
    export_onnx(network, inputs, OUTPUTS, dynamic, contract.to_json(), out)
