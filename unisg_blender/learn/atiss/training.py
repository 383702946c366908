"""Train the set model of :mod:`.network` on a dataset and write it as a model that the evaluation can run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from tqdm import tqdm

from ...dataset.format.reader import Dataset
from ...generate.observe.contract import Contract
from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.placement_order import ranks
from ...generate.observe.scene_tokens import ground_of, room_middle
from ...generate.observe.support_priors import learn_priors
from ..losses.mixtures import logistics_nll
from ..onnx_export import export_onnx
from ..provenance import provenance
from ..settings import Settings
from ..training_scenes import TrainingScene, load_scenes, split, vocabulary_of
from .network import Atiss, AtissSizes

EPOCHS = 20
BATCH, TARGETS, TOKENS = 12, 32, 96
RATE, CLIP = 2e-3, 2.0
OUTPUTS = ("position", "heading")
Batch = dict[str, Tensor]


def train(dataset: Dataset, out: Path, settings: Settings) -> dict[str, Any]:
    """Train and export; returns the provenance that the model carries.

    Raises
    ------
    UniSGError
        Too few scenes or categories.
    """
    settings = replace(settings, epochs=settings.epochs or EPOCHS)
    vocabulary = vocabulary_of(dataset)
    scenes = load_scenes(dataset, vocabulary, settings.quiet)
    priors = learn_priors((scene.objects for scene in scenes), vocabulary)
    rank = ranks(vocabulary, priors)
    train_scenes, val_scenes = split(scenes, settings.seed)
    torch.manual_seed(settings.seed)
    network = Atiss(AtissSizes(len(vocabulary)))
    losses = fit_atiss(network, [rows_of(scene) for scene in train_scenes], rank, settings)
    rng = np.random.default_rng(settings.seed)
    network.eval()
    with torch.no_grad():
        val = _terms(network, draw_batch([rows_of(scene) for scene in val_scenes], rank, rng, 4 * BATCH))
    losses |= {f"val_{name}": float(value) for name, value in val.items()}
    source = provenance(dataset, settings, len(train_scenes), len(val_scenes), losses, network)
    write_atiss(network, Contract("atiss", vocabulary, priors, provenance=source), out)
    return source


def fit_atiss(
    network: Atiss, scenes: Sequence[NDArray[np.float64]], rank: NDArray[np.int64], settings: Settings
) -> dict[str, float]:
    """Train in place with AdamW and one cycle of the learning rate; an epoch sees as many scenes as there are."""
    steps = max(1, (settings.epochs or EPOCHS) * len(scenes) // BATCH)
    optimizer = torch.optim.AdamW(network.parameters(), RATE, weight_decay=0.01)
    cycle = torch.optim.lr_scheduler.OneCycleLR(optimizer, RATE, total_steps=max(steps, 2), pct_start=0.1)
    rng, mean = np.random.default_rng(settings.seed), 0.0
    bar = tqdm(range(steps), desc="training", disable=settings.quiet, unit="step")
    for step in bar:
        loss = _terms(network, draw_batch(scenes, rank, rng, BATCH))["loss"]
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), CLIP)
        optimizer.step()
        if step + 1 < steps:
            cycle.step()
        mean += (loss.item() - mean) / min(step + 1, 50)
        bar.set_postfix(loss=f"{mean:.3f}", refresh=False)
    return {"train_loss": mean}


def rows_of(scene: TrainingScene) -> NDArray[np.float64]:
    """What the network sees of a scene (K, 9): category, centre, half extents, heading, level; the room at the origin.

    The level of objects that are told and never asked for (of no known category, or roots) is 0.
    """
    seen = ObservedScene.of(scene.objects, scene.world)
    center = seen.center - np.array([*room_middle(seen), ground_of(seen)])
    asked = (seen.category >= 0) & (seen.support >= 0)
    return np.column_stack([seen.category, center, seen.half, seen.yaw, asked])


def draw_batch(
    scenes: Sequence[NDArray[np.float64]], rank: NDArray[np.int64], rng: np.random.Generator, count: int
) -> Batch:
    """Contexts and targets out of random scenes: random subsets, or what comes first in the order of placing.

    Each room is turned by some quarters.
    """
    category, target_category = np.zeros((count, TOKENS), np.int64), np.zeros((count, TARGETS), np.int64)
    box, mask = np.zeros((count, TOKENS, 8)), np.zeros((count, TOKENS))
    half, place = np.ones((count, TARGETS, 3)), np.zeros((count, TARGETS, 3))
    heading, weight = np.zeros((count, TARGETS)), np.zeros((count, TARGETS))
    box[..., 3:7] = 1.0
    for row in range(count):
        objects = _turned(scenes[rng.integers(len(scenes))], int(rng.integers(4)))
        shown, hidden = _cut(objects, rank, rng)
        kind = objects[:, 0].astype(np.int64)
        kind = np.where(kind < 0, len(rank) - 1, kind)
        n, t = len(shown), len(hidden)
        category[row, :n], target_category[row, :t], mask[row, :n], weight[row, :t] = kind[shown], kind[hidden], 1, 1
        box[row, :n, :6], angle = objects[shown, 1:7], objects[shown, 7]
        box[row, :n, 6], box[row, :n, 7] = np.cos(angle), np.sin(angle)
        half[row, :t], heading[row, :t] = objects[hidden, 4:7], objects[hidden, 7]
        place[row, :t] = objects[hidden, 1:4]
        place[row, :t, 2] -= objects[hidden, 6]
    heading = (heading + np.pi) % (2 * np.pi) - np.pi
    numbers = {"category": category, "target_category": target_category}
    values = {"box": box, "mask": mask, "target_half": half, "place": place, "turn": heading, "weight": weight}
    return {name: torch.from_numpy(array) for name, array in numbers.items()} | {
        name: torch.from_numpy(array.astype(np.float32)) for name, array in values.items()
    }


def _turned(objects: NDArray[np.float64], quarters: int) -> NDArray[np.float64]:
    cos, sin = (1, 0, -1, 0)[quarters], (0, 1, 0, -1)[quarters]
    result = objects.copy()
    result[:, 1] = cos * objects[:, 1] - sin * objects[:, 2]
    result[:, 2] = sin * objects[:, 1] + cos * objects[:, 2]
    result[:, 7] += quarters * np.pi / 2
    return result


def _cut(
    objects: NDArray[np.float64], rank: NDArray[np.int64], rng: np.random.Generator
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Which objects are shown, at most TOKENS, and which are asked for, at most TARGETS."""
    told, asked = np.flatnonzero(objects[:, 8] == 0), np.flatnonzero(objects[:, 8])
    order = rng.permutation(asked)
    if rng.random() < 0.5:
        order = order[np.argsort(rank[objects[order, 0].astype(np.int64)], kind="stable")]
    count = int(rng.integers(len(asked)))
    return np.concatenate([told, order[:count]])[:TOKENS], rng.permutation(order[count:])[:TARGETS]


def _terms(network: Atiss, batch: Batch) -> dict[str, Tensor]:
    names = ("category", "box", "mask", "target_category", "target_half", "place")
    position, heading = network(*(batch[name] for name in names))
    where = logistics_nll(position, batch["place"]).sum(-1)
    turn = logistics_nll(heading, batch["turn"], turn=True)
    weight = batch["weight"]
    terms = {"position": where, "heading": turn, "loss": where + turn}
    return {name: (value * weight).sum() / weight.sum() for name, value in terms.items()}


def example_inputs(objects: int = 5, targets: int = 2, batch: int = 1) -> Mapping[str, Tensor]:
    """Inputs of the right kinds."""
    return {
        "category": torch.zeros(batch, objects, dtype=torch.int64),
        "box": torch.rand(batch, objects, 8),
        "mask": torch.ones(batch, objects),
        "target_category": torch.zeros(batch, targets, dtype=torch.int64),
        "target_half": torch.rand(batch, targets, 3),
        "place": torch.rand(batch, targets, 3),
    }


def write_atiss(network: Atiss, contract: Contract, out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    inputs = example_inputs()
    objects = {name: {1: "things"} for name in ("category", "box", "mask")}
    targets = {name: {1: "targets"} for name in ("target_category", "target_half", "place")}
    export_onnx(network, inputs, OUTPUTS, objects | targets, contract.to_json(), out)
