"""Experiment "generation": the CGVAE on operating rooms, MSE + BCE + KL, as in the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...dataset import open_dataset
from ...generate.propose.cgvae_proposer import edges_of
from ...metrics.pose_errors import pose_report, r_squared
from ...poses import FORMS
from ..cgvae.network import Cgvae, CgvaeSizes
from ..cgvae.sampled_pairs import PairSample, sample_pairs, sampled_terms
from ..cgvae.training import KL_WEIGHT

HIDDEN, EMBEDDING, LATENT = 16, 8, 8
RATE, BATCH, NEGATIVES = 3e-3, 100, 1
HELD_OUT = 0.1


@dataclass(frozen=True, eq=False)
class PaperRooms:
    """Some rooms: parent-relative affines (N, 4, 4), category, edges both ways, parent, scene, and pairs to decode."""

    local: Tensor
    category: Tensor
    edges: Tensor
    parent: Tensor
    scene: Tensor
    pairs: PairSample


@lru_cache(maxsize=1)
def _rooms(folder: Path, seed: int) -> tuple[list[PaperRooms], PaperRooms, int]:
    """Training batches, held-out rooms, number of categories."""
    dataset = open_dataset(folder)
    order = np.random.default_rng((seed, 2)).permutation(len(dataset))
    count = max(1, round(HELD_OUT * len(order)))
    generator = torch.Generator().manual_seed(seed)
    parts = np.array_split(order[count:], max(1, round((len(order) - count) / BATCH)))
    batches = [_joined(dataset, rows, generator) for rows in parts]
    return batches, _joined(dataset, order[:count], generator), len(dataset.categories)


def _joined(dataset: Any, rows: NDArray[np.int64], generator: torch.Generator) -> PaperRooms:
    scenes = [dataset[int(row)] for row in rows]
    counts = np.array([len(scene) for scene in scenes])
    start = np.repeat(np.cumsum(counts) - counts, counts)
    parent = np.concatenate([scene.parent for scene in scenes]).astype(np.int64)
    parent = np.where(parent >= 0, parent + start, -1)
    category = np.concatenate([scene["entity.category"] for scene in scenes]).astype(np.int64)
    local = np.concatenate([scene.features[:, :16] for scene in scenes]).reshape(-1, 4, 4)
    number = torch.from_numpy(np.repeat(np.arange(len(scenes)), counts))
    above = torch.from_numpy(parent)
    known = torch.from_numpy(np.where(category < 0, len(dataset.categories), category))
    pairs = sample_pairs(above, number, NEGATIVES, generator)
    return PaperRooms(torch.from_numpy(local), known, torch.from_numpy(edges_of(parent)), above, number, pairs)


def run(settings: Mapping[str, Any], data: Path) -> dict[str, Any]:
    """The terms of the loss after every epoch, in training and held-out rooms, and the decoded errors at the end.

    ``settings``: form, seed, epochs. Features are the raw channels of the form, as in the paper.
    """
    batches, held_out, categories = _rooms(data / "rooms", settings["seed"])
    form = FORMS[settings["form"]]
    features = {id(part): form.encode(part.local).float() for part in (*batches, held_out)}
    torch.manual_seed(settings["seed"])
    network = Cgvae(CgvaeSizes(form.width, categories, EMBEDDING, HIDDEN, LATENT))
    optimizer = torch.optim.Adam(network.parameters(), RATE)
    names = ("mse", "bce", "kl")
    curves: dict[str, list[float]] = {f"{stage}{name}": [] for stage in ("", "test_") for name in ("loss", *names)}

    def terms(part: PaperRooms) -> list[Tensor]:
        """The loss and its three terms, of one drawing of the latent code."""
        noise = torch.randn(len(part.category), LATENT)
        found, _ = sampled_terms(network, features[id(part)], part.category, part.edges, part.pairs, noise)
        return [found["mse"] + found["bce"] + KL_WEIGHT * found["kl"], *(found[name] for name in names)]

    for _ in range(settings["epochs"]):
        sums = np.zeros(4)
        for place in torch.randperm(len(batches)).tolist():
            loss, *parts = terms(batches[place])
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            sums += [float(value.detach()) for value in (loss, *parts)]
        with torch.no_grad():
            there = terms(held_out)
        for name, value in zip(curves, [*(sums / len(batches)), *map(float, there)], strict=True):
            curves[name].append(round(float(value), 6))
    result: dict[str, Any] = {"parameters": sum(weight.numel() for weight in network.parameters()), "curves": curves}
    return result | {"decoded": _decoded(network, batches, held_out, settings["form"], features)}


@torch.no_grad()
def _decoded(
    network: Cgvae, batches: list[PaperRooms], held_out: PaperRooms, form: str, features: Mapping[int, Tensor]
) -> dict[str, float]:
    """Errors of the reconstruction from the mean latents, beside those of always saying the training mean."""
    truth = features[id(held_out)]
    mean = torch.cat([features[id(part)] for part in batches]).mean(dim=0)
    latent, _, embedded = network.encode(truth, held_out.category, held_out.edges)
    found = network.decode_nodes(torch.cat([latent, embedded], dim=1)).numpy()
    rigid = FORMS["matrix"].encode(held_out.local.numpy()).reshape(-1, 4, 4)
    constant = np.broadcast_to(mean.numpy(), found.shape)
    report = {
        **pose_report(found, rigid, form),
        "mse": float(((found - truth.numpy()) ** 2).mean()),
        "r_squared": r_squared(found, truth.numpy(), mean.numpy()),
        "mse_of_zeros": float((truth.numpy() ** 2).mean()),
        "mse_of_mean": float(((constant - truth.numpy()) ** 2).mean()),
    }
    return report | {f"mean_{name}": value for name, value in pose_report(constant, rigid, form).items()}
