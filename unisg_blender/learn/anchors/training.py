"""Train the anchor mixture on a dataset and write it as a model for the generator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from ...dataset.format.reader import Dataset
from ...generate.observe.contract import Contract
from ...generate.observe.placement_order import learn_orders
from ...generate.observe.prior_tables import PriorTables
from ...generate.propose.anchor_inputs import ANCHOR_INPUTS, INTEGERS
from ..hyperparameters import Settings
from ..losses.mixtures import height_nll, mixture_nll
from ..losses.ranking import ranking_loss
from ..losses.variational import kl_divergence
from ..onnx_export import export_onnx
from ..provenance import save_model_assets
from ..trainer import Schedule, loader
from ..training_job import Prepared
from ..training_scenes import scenes_and_priors, split
from .critic import drawn
from .examples import AnchorExamples, RoomLayout, collate
from .network import AnchorModel, AnchorSizes

EPOCHS, FORM = 23, None
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


def prepare(datasets: Sequence[Dataset], settings: Settings) -> Prepared:
    """Scenes as layouts, with what all of them teach; UniSGError if there are too few scenes or categories."""
    vocabulary, scenes, priors = scenes_and_priors(datasets[0], settings.quiet)
    tables = PriorTables.of(priors, vocabulary)
    train, val = ([RoomLayout(scene, tables) for scene in part] for part in split(scenes, settings.seed))
    priors = replace(priors, orders=learn_orders((layout.scene for layout in train), vocabulary))
    torch.manual_seed(settings.seed)
    network = AnchorModel(AnchorSizes(len(vocabulary)))
    count = min(PER_EPOCH, PER_TARGET * sum(len(layout.targets) for layout in train))
    seen = AnchorExamples(train, tables, count, settings.seed, fresh=True)
    watched = AnchorExamples(val, tables, min(WATCHED, 40 * len(val)), settings.seed + 1, fresh=False)
    return Prepared(
        network,
        [
            loader(seen, BATCH, settings, False, collate, workers=int(count >= BACKGROUND)),
            loader(watched, BATCH, settings, False, collate),
        ],
        (len(train), len(val)),
        Contract("anchors", vocabulary, priors, latent=network.sizes.latent),
        datasets[0],
        schedule=Schedule(muon=network.hidden_matrices()),
    )


def export(prepared: Prepared, source: dict[str, Any], out: Path) -> None:
    """Write the model, and the dataset's assets beside it."""
    write_anchors(prepared.network, replace(prepared.contract, provenance=source), out)
    save_model_assets(prepared.beside, out)


def terms(network: nn.Module, batch: Sequence[Mapping[str, Tensor]]) -> dict[str, Tensor]:
    """The terms of the loss over all parts of a batch."""
    assert isinstance(network, AnchorModel)
    parts = [part_terms(network, part) for part in batch]
    size = sum(len(part["parent"]) for part in batch)
    found = {name: torch.stack([part[name].sum() for part in parts]).sum() / size for name in parts[0]}
    found["loss"] = (
        found["nll"]
        + found["kl"].clamp(min=FREE_NATS)
        + CRITIC_WEIGHT * found["critic"]
        + HEIGHT_WEIGHT * found["height"]
        + SUPPORT_WEIGHT * found["support"]
    )
    return found


def part_terms(network: AnchorModel, batch: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """For each example (B,): negative log-likelihoods of place, height and support, and was the likeliest right."""
    each = torch.arange(len(batch["parent"]), device=batch["parent"].device)
    score, *heights = network.choose(batch)
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
    mixture = network.places({**batch, "latent": latent})
    nll = mixture_nll(mixture[:-1], batch["box"], batch["position"].unsqueeze(1), batch["heading"].unsqueeze(1))
    return nll.squeeze(1).clamp(max=NLL_LIMIT), mixture


def _scores(network: AnchorModel, batch: Mapping[str, Tensor], mixture: tuple[Tensor, ...], view: Tensor) -> Tensor:
    """The critic's scores (B, 1 + DRAWS) of the true place and of draws."""
    true = torch.cat([batch["position"], batch["heading"].unsqueeze(1)], dim=1).unsqueeze(1)
    place = torch.cat([true, drawn(mixture, batch["box"])], dim=1)
    return network.judge(batch, view, place)


def _latent(network: AnchorModel, batch: Mapping[str, Tensor]) -> tuple[Tensor, Tensor]:
    """A code (B, latent) drawn from the encoder, and its divergence (B,) from the standard normal, nats."""
    if network.encoder is None:
        return batch["heading"].new_zeros(len(batch["heading"]), 0), torch.zeros_like(batch["heading"])
    mean, log_variance = network.encoder(
        network.embedding(batch["target_category"]), network.embedding(batch["category"]), batch["box"],
        batch["flags"], batch["mask"], batch["position"], batch["heading"],
    )  # fmt: skip
    noise = torch.randn_like(mean)
    return mean + noise * (log_variance / 2).exp(), kl_divergence(mean, log_variance)


def example_inputs(network: AnchorModel, **sizes: int) -> dict[str, Tensor]:
    """Inputs of the right kinds; two targets among three tokens and four supports unless ``sizes`` say otherwise."""
    known = network.sizes.categories + 1
    sizes = {
        "targets": 2, "tokens": 3, "supports": 4, "places": 5, "categories": known - 1, "known": known,
        "latent": network.sizes.latent, "view": 3 * network.sizes.width, **sizes,
    }  # fmt: skip
    inputs = {}
    for name, shape in ANCHOR_INPUTS.items():
        size = [sizes[part] if isinstance(part, str) else part for part in shape]
        inputs[name] = torch.zeros(size, dtype=torch.int64) if name in INTEGERS else torch.rand(size)
    inputs["box"][..., 6:] = nn.functional.normalize(inputs["box"][..., 6:], dim=-1)
    return inputs


def write_anchors(network: nn.Module, contract: Contract, out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    assert isinstance(network, AnchorModel)
    varying = ("targets", "tokens", "supports", "places")
    dynamic = {
        name: {axis: size for axis, size in enumerate(shape) if size in varying}
        for name, shape in ANCHOR_INPUTS.items()
    }
    export_onnx(network, example_inputs(network), OUTPUTS, dynamic, contract.to_json(), out)
