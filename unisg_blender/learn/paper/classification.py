"""Experiment "classification": operating room or living room, by GraphSAGE convolutions and an attention readout."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch_geometric.transforms import ToUndirected

from ...dataset import UniSGDataset
from ...poses import FORMS
from ..hetero_sage import COMPONENTS, EdgeKind, edge_kinds
from ..scene_classifier.network import SceneClassifier
from .experiment_scenes import TESTS

HIDDEN, BATCH = 32, 10
RATE, FEW_RATE = 1e-3, 3e-3
"""Learning rates of Adam: for the paper's setting, and for few scenes."""

TRAIN_SHARE = 0.7

POSITION = {"trs_matrix": (3, 7, 11), "dual_quaternion": (4, 5, 6, 7)}
"""Channels that hold the position; the first three of the other forms whose pose has no copies in it."""


@dataclass(frozen=True, eq=False)
class Scenes:
    """Some scenes as one graph: what :class:`SceneClassifier` takes, and the true kinds (B,)."""

    x: dict[str, Tensor]
    edges: dict[EdgeKind, Tensor]
    rows: dict[str, Tensor]
    scene: Tensor
    label: Tensor

    def logits(self, network: SceneClassifier) -> Tensor:
        """What the network says of them."""
        return network(self.x, self.edges, self.scene, len(self.label), self.rows)


def scenes_of(batch: Any, form: str, stretch: bool, components: Sequence[str] = COMPONENTS) -> Scenes:
    """A batch of graphs whose poses are whole affines, with poses in a form; entities have no features of their own."""
    x = {"entity": torch.ones(batch["entity"].num_nodes, 1)}
    local = batch["trs"].x[:, :16].reshape(-1, 4, 4)
    features = {
        "info": batch["info"].x,
        "trs": FORMS[form].encode(local, stretch=stretch),
        "action": torch.cat([batch["action"].x, batch["action"].mask], dim=1).float(),
    }
    mesh, place = torch.unique(batch["mesh"].feature, dim=0, return_inverse=True)
    x |= {kind: features[kind] if kind != "mesh" else mesh for kind in components}
    edges = {kind: batch[kind].edge_index for kind in edge_kinds(tuple(components))}
    return Scenes(x, edges, {"mesh": place} if "mesh" in components else {}, batch["entity"].batch, batch.y)


def doubled(scenes: Scenes, form: str) -> Scenes:
    """The same with the position's channels twice, as CGA's motors have theirs."""
    poses = scenes.x["trs"]
    again = poses[:, list(POSITION.get(form, (0, 1, 2)))]
    return replace(scenes, x={**scenes.x, "trs": torch.cat([poses, again], dim=1)})


def standardised(parts: Sequence[Scenes], like: Sequence[Scenes]) -> list[Scenes]:
    """Features by the means and spreads that their channels have in ``like``; constant channels become 0."""
    result = [replace(part, x=dict(part.x)) for part in parts]
    for kind in like[0].x.keys() - {"entity"}:
        every = torch.cat([part.x[kind] for part in like])
        mean, spread = every.mean(dim=0), every.std(dim=0)
        factor = torch.where(spread > 1e-6, 1 / spread.clamp_min(1e-6), 0.0)
        for part in result:
            part.x[kind] = ((part.x[kind] - mean) * factor).clamp(-10, 10)
    return result


def widths_of(scenes: Scenes) -> dict[str, int]:
    """Width of the features by node type."""
    return {kind: value.shape[1] for kind, value in scenes.x.items()}


@lru_cache(maxsize=2)
def _dataset(folder: Path) -> UniSGDataset:
    return UniSGDataset(folder, transform=ToUndirected(merge=False))


def run(settings: Mapping[str, Any], data: Path) -> dict[str, Any]:
    """The paper's setting: loss and accuracy after every epoch, in training and held-out scenes.

    ``settings``: form, seed, epochs; and for the second set of tables ``training`` (number of scenes),
    ``components``, ``stretch``, ``scaling`` ("standard" or "raw" features) and ``doubled`` (see :func:`doubled`); the
    accuracy on all sets of :data:`.data.TESTS` is then told too.
    """
    dataset = _dataset(data / "classification")
    few = "training" in settings
    training, held_out = _split(dataset, settings)

    def part(whole: UniSGDataset, rows: Any) -> Scenes:
        """Some of the scenes in the form and with the components of the settings."""
        components = tuple(settings.get("components", COMPONENTS))
        scenes = scenes_of(whole.batch(rows), settings["form"], settings.get("stretch", False), components)
        return doubled(scenes, settings["form"]) if settings.get("doubled") else scenes

    torch.manual_seed(settings["seed"])
    rng = np.random.default_rng(settings["seed"])
    parts = np.array_split(rng.permutation(training), max(1, round(len(training) / BATCH)))
    batches, tests = [part(dataset, rows) for rows in parts], {"held out": part(dataset, held_out)}
    if few:
        whole = _dataset(data / "classification_tests")
        tests = {name: part(whole, range(i, len(whole), len(TESTS))) for i, name in enumerate(TESTS)}
        if settings.get("scaling", "standard") == "standard":
            tests = dict(zip(tests, standardised(list(tests.values()), batches), strict=True))
            batches = standardised(batches, batches)
    network = SceneClassifier(widths_of(batches[0]), 2, HIDDEN)
    first = next(iter(tests.values()))
    curves = _train(network, batches, first, settings["epochs"], FEW_RATE if few else RATE, rng)
    result: dict[str, Any] = {"parameters": sum(weight.numel() for weight in network.parameters()), "curves": curves}
    if few:
        result["tests"] = {name: _measure(network, scenes)[1] for name, scenes in tests.items()}
        result["curves"] = {name: values[-1:] for name, values in curves.items()}
    return result


def _split(dataset: UniSGDataset, settings: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Rows to train on, the same number of each kind, and the others."""
    rng = np.random.default_rng((settings["seed"], 1))
    half = len(dataset) // 2
    count = settings.get("training", round(2 * half * TRAIN_SHARE)) // 2
    orders = [rng.permutation(half) + kind * half for kind in (0, 1)]
    known, others = (np.concatenate([order[cut] for order in orders]) for cut in (slice(count), slice(count, None)))
    return known, others


def _train(
    network: SceneClassifier, batches: list[Scenes], test: Scenes, epochs: int, rate: float, rng: np.random.Generator
) -> dict[str, list[float]]:
    optimizer = torch.optim.Adam(network.parameters(), rate)
    curves: dict[str, list[float]] = {name: [] for name in ("loss", "accuracy", "test_loss", "test_accuracy")}
    for _ in range(epochs):
        network.train()
        sums = np.zeros(3)
        for place in rng.permutation(len(batches)):
            batch = batches[place]
            logits = batch.logits(network)
            loss = nn.functional.cross_entropy(logits, batch.label)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            count = len(batch.label)
            sums += [count * float(loss.detach()), float((logits.argmax(1) == batch.label).sum()), count]
        values = [*(sums[:2] / sums[2]), *_measure(network, test)]
        for name, value in zip(curves, values, strict=True):
            curves[name].append(round(float(value), 6))
    return curves


@torch.no_grad()
def _measure(network: SceneClassifier, scenes: Scenes) -> tuple[float, float]:
    """Mean cross-entropy and accuracy."""
    network.eval()
    logits = scenes.logits(network)
    right = (logits.argmax(1) == scenes.label).float().mean()
    return float(nn.functional.cross_entropy(logits, scenes.label)), float(right)
