"""Training examples for the anchor model: a scene, one thing in it as the target, and what of the rest is visible."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.utils.data import Dataset

from ..generate.context import (
    TOKENS,
    chain,
    coming_vector,
    context_arrays,
    ground_of,
    plan_vector,
    support_arrays,
    tokens_for,
)
from ..generate.proposals import Scene
from .scenes import TrainingScene

RANDOM_SUBSETS = 0.35
"""Share of examples in which any other things may be missing; in the rest the scene is built up in order."""

JITTER, TURN_JITTER = 0.005, 0.02
"""Metres and radians by which what is visible is moved."""

DEQUANTISE, TURN_DEQUANTISE = 0.005, np.radians(0.5)


class Examples(Dataset[dict[str, Tensor]]):
    """Examples by number; number ``i`` of epoch ``e`` is always the same for the same seed.

    Parameters
    ----------
    scenes
        Scenes to learn from.
    rank
        By category: the order in which things are placed (see :mod:`..generate.order`).
    count
        Examples in an epoch.
    fresh
        Other examples in every epoch; False for a fixed set to validate on.
    """

    def __init__(self, scenes: Sequence[TrainingScene], rank: NDArray[np.int64], count: int, seed: int, fresh: bool):
        self.scenes = [Scene.of(scene.things, scene.world) for scene in scenes]
        self.rank = rank
        self.count = count
        self.rng = np.random.default_rng(seed)
        self.fixed = None if fresh else [self._draw() for _ in range(count)]

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, index: int) -> dict[str, Any]:
        return self._draw() if self.fixed is None else self.fixed[index]

    def _draw(self) -> dict[str, Any]:
        while True:
            scene = self.scenes[int(self.rng.integers(len(self.scenes)))]
            targets = np.flatnonzero((scene.category >= 0) & (scene.half.max(axis=1) > 0) & (scene.support >= 0))
            if len(targets):
                return example(scene, int(self.rng.choice(targets)), self.rank, self.rng)


def visible_with(scene: Scene, target: int, rank: NDArray[np.int64], rng: np.random.Generator) -> NDArray[np.bool_]:
    """Which things are there when the target is placed: those before it, or any; always what holds them."""
    count = len(scene.category)
    if rng.random() < RANDOM_SUBSETS:
        seen = rng.random(count) < rng.random()
    else:
        order = rank[scene.category] + rng.random(count)
        seen = order < order[target]
    seen[chain(scene.support, target)] = True
    seen[target] = False
    for thing in np.argsort([len(chain(scene.support, i)) for i in range(count)]):
        above = scene.support[thing]
        if above >= 0 and not seen[above]:
            seen[thing] = False
    return seen


def example(scene: Scene, target: int, rank: NDArray[np.int64], rng: np.random.Generator) -> dict[str, Any]:
    """One example: inputs of the model and the true support, height, position and heading."""
    seen = visible_with(scene, target, rank, rng)
    visible = np.flatnonzero(seen)
    category, parent, unknown = int(scene.category[target]), int(scene.support[target]), len(rank) - 1
    hidden = np.flatnonzero(~seen & (scene.category >= 0))
    hidden = hidden[hidden != target]
    if rng.random() < 0.5:  # a user may ask for less than a whole room
        hidden = hidden[rng.random(len(hidden)) < rng.random() ** 2]
    numbers, counts = np.unique(scene.category[hidden], return_counts=True)
    coming = dict(zip(numbers.tolist(), counts.tolist(), strict=True))
    shaken = _shaken(scene, rng)
    tokens = tokens_for(shaken, visible, parent)
    position = scene.center[target, :2] + rng.uniform(-DEQUANTISE, DEQUANTISE, 2)
    heading = scene.yaw[target] + rng.uniform(-TURN_DEQUANTISE, TURN_DEQUANTISE)
    bottom = scene.center[target, 2] - scene.half[target, 2]
    above = scene.center[parent, 2] - scene.half[parent, 2]
    return {
        "target_category": category,
        "target_half": scene.half[target].astype(np.float32),
        "target_bottom": np.float32(bottom - ground_of(scene)),
        "plan": plan_vector(scene, visible, category, parent, coming),
        "coming": coming_vector(coming, unknown),
        **context_arrays(shaken, tokens, category, parent, unknown),
        **support_arrays(scene, visible, category, unknown),
        "parent": int(np.flatnonzero(visible == parent)[0]),
        "height": np.float32(bottom - above + rng.uniform(-0.002, 0.002)),
        "position": position.astype(np.float32),
        "heading": np.float32(heading),
    }


def _shaken(scene: Scene, rng: np.random.Generator) -> Scene:
    shift = np.zeros_like(scene.center)
    shift[:, :2] = rng.uniform(-JITTER, JITTER, (len(shift), 2))
    yaw = scene.yaw + rng.uniform(-TURN_JITTER, TURN_JITTER, len(scene.yaw))
    return Scene(scene.category, scene.support, scene.world, scene.local, scene.center + shift, scene.half, yaw)


TOKEN_KEYS = ("category", "box", "flags")
SUPPORT_KEYS = ("support_category", "support_half", "support_load")


def collate(examples: Sequence[dict[str, Any]]) -> dict[str, Tensor]:
    """A batch: tokens and supports padded, with ``mask`` and ``support_mask``."""
    batch = {}
    for keys, name, most in ((TOKEN_KEYS, "mask", TOKENS), (SUPPORT_KEYS, "support_mask", 0)):
        counts = [len(item[keys[0]]) for item in examples]
        width = max(counts) if not most else min(most, max(counts))
        for key in keys:
            batch[key] = torch.from_numpy(np.stack([_padded(item[key], width) for item in examples]))
        batch[name] = torch.tensor([[float(place < count) for place in range(width)] for count in counts])
    for key in examples[0]:
        if key not in batch:
            batch[key] = torch.from_numpy(np.stack([np.asarray(item[key]) for item in examples]))
    return batch


def _padded(array: NDArray[Any], width: int) -> NDArray[Any]:
    result = np.zeros((width, *array.shape[1:]), array.dtype)
    result[: len(array)] = array[:width]
    return result
