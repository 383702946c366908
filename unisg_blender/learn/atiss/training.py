"""Train the set model of :mod:`.network` on a dataset and write it as a model that the evaluation can run."""

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
from torch.utils.data import Dataset as Items

from ...dataset.format.reader import Dataset
from ...generate.observe.contract import Contract
from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.placement_order import ranks
from ...geometry.planar import wrapped
from ..hyperparameters import Settings
from ..losses.mixtures import logistics_nll
from ..onnx_export import export_onnx
from ..trainer import Schedule
from ..training_job import Prepared
from ..training_scenes import TrainingScene, scenes_and_priors, split
from .network import Atiss, AtissSizes

EPOCHS, FORM = 20, None
BATCH, TARGETS, TOKENS = 12, 32, 96
OUTPUTS = ("position", "heading")
INPUTS = ("category", "box", "mask", "target_category", "target_half", "place")
Batch = dict[str, Tensor]


def prepare(datasets: Sequence[Dataset], settings: Settings) -> Prepared:
    """Scenes as rows; UniSGError if there are too few scenes or categories."""
    vocabulary, scenes, priors = scenes_and_priors(datasets[0], settings.quiet)
    rank = ranks(vocabulary, priors)
    train, val = ([rows_of(scene) for scene in part] for part in split(scenes, settings.seed))
    torch.manual_seed(settings.seed)
    network = Atiss(AtissSizes(len(vocabulary)))
    steps = max(1, (settings.epochs or EPOCHS) * len(train) // BATCH)
    watched = draw_batch(val, rank, np.random.default_rng(settings.seed), 4 * BATCH)
    items: list[Any] = [AtissBatches(train, rank, settings.seed, steps), [watched]]
    loaders = [DataLoader(part, batch_size=None) for part in items]
    contract, schedule = Contract("atiss", vocabulary, priors), Schedule(steps=steps)
    return Prepared(network, loaders, (len(train), len(val)), contract, schedule=schedule)


class AtissBatches(Items[Batch]):
    """Batches drawn one after the other; as many scenes in an epoch as there are."""

    def __init__(self, scenes: Sequence[NDArray[np.float64]], rank: NDArray[np.int64], seed: int, steps: int) -> None:
        self.scenes, self.rank, self.rng = scenes, rank, np.random.default_rng(seed)
        self.count = min(steps, -(-len(scenes) // BATCH))

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, _: int) -> Batch:
        return draw_batch(self.scenes, self.rank, self.rng, BATCH)


def export(prepared: Prepared, source: dict[str, Any], out: Path) -> None:
    """Write the model."""
    write_atiss(prepared.network, replace(prepared.contract, provenance=source), out)


def rows_of(scene: TrainingScene) -> NDArray[np.float64]:
    """What the network sees of a scene (K, 9): category, centre, half extents, heading, level; the room at the origin.

    The level of objects that are told and never asked for (of no known category, or roots) is 0.
    """
    seen = ObservedScene.of(scene.objects, scene.world)
    center = seen.center - np.array([*seen.room.middle, seen.room.ground])
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
    heading = wrapped(heading)
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


def terms(network: nn.Module, batch: Batch) -> dict[str, Tensor]:
    """Negative log-densities of the targets' positions and headings, and their sum, means over the targets."""
    position, heading = network(*(batch[name] for name in INPUTS))
    where = logistics_nll(position, batch["place"]).sum(-1)
    turn = logistics_nll(heading, batch["turn"], turn=True)
    weight = batch["weight"]
    each = {"position": where, "heading": turn, "loss": where + turn}
    return {name: (value * weight).sum() / weight.sum() for name, value in each.items()}


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


def write_atiss(network: nn.Module, contract: Contract, out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    dynamic = {name: {1: "things"} for name in INPUTS[:3]} | {name: {1: "targets"} for name in INPUTS[3:]}
    export_onnx(network, example_inputs(), OUTPUTS, dynamic, contract.to_json(), out)
