"""The scenes of a dataset as a generator sees them, ready to learn from."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from ..dataset.format.reader import Dataset
from ..dataset.scenes_with_shapes import scenes_with_shapes
from ..errors import UniSGError
from ..generate.observe.observed_scene import relative
from ..generate.observe.support_priors import CategoryPriors, learn_priors
from ..scene import world_matrices
from ..spatial.objects import SceneObjects, scene_objects

FEWEST_SCENES = 4
FEW_SCENES = 50
HELD_OUT = 0.1


@dataclass(frozen=True, eq=False)
class TrainingScene:
    """Objects of a scene and their poses (K, 4, 4) in the world and relative to their supports."""

    objects: SceneObjects
    world: NDArray[np.float64]
    local: NDArray[np.float64]


def vocabulary_of(dataset: Dataset) -> tuple[str, ...]:
    """The categories that occur in a dataset, sorted.

    Raises
    ------
    UniSGError
        If there are too few scenes or categories to learn from.
    """
    if len(dataset) < FEWEST_SCENES:
        raise UniSGError(
            f"{dataset.path} has {len(dataset)} scenes: a generator needs {FEWEST_SCENES} to train at all, "
            f"about {FEW_SCENES} to be useful"
        )
    names = tuple(sorted(dataset.category_counts))
    if len(names) < 2:
        found = f"only {names[0]!r}" if names else "no category"
        raise UniSGError(f"{dataset.path} has {found}: give objects at least two categories (unisg_category)")
    return names


def scenes_and_priors(dataset: Dataset, quiet: bool) -> tuple[tuple[str, ...], list[TrainingScene], CategoryPriors]:
    """The categories and scenes of a dataset, and what the scenes say of where each category is; errors as above."""
    vocabulary = vocabulary_of(dataset)
    scenes = load_scenes(dataset, vocabulary, quiet)
    return vocabulary, scenes, learn_priors((scene.objects for scene in scenes), vocabulary)


def load_scenes(dataset: Dataset, vocabulary: Sequence[str], quiet: bool = False) -> list[TrainingScene]:
    """All scenes of a dataset; those without an object of a known category are left out."""
    scenes = []
    bar = tqdm(scenes_with_shapes(dataset), total=len(dataset), desc="reading scenes", disable=quiet, unit="scene")
    for graph in bar:
        objects = scene_objects(graph, vocabulary)
        if (objects.category >= 0).sum() >= 2:
            world = world_matrices(graph)[objects.row]
            scenes.append(TrainingScene(objects, world, relative(world, objects.support)))
    if len(scenes) < FEWEST_SCENES:
        raise UniSGError(
            f"only {len(scenes)} scenes of {dataset.path} have two categorised objects: too few to train on"
        )
    return scenes


def dataset_checksum(dataset: Dataset) -> str:
    """A digest of the dataset's content: of the checksums of its shards."""
    sums = json.dumps([shard["sha256"] for shard in dataset.manifest["shards"]])
    return hashlib.sha256(sums.encode()).hexdigest()


def split_rows(count: int, seed: int, parts: int = 1) -> list[NDArray[np.int64]]:
    """Rows to train on, and ``parts`` lots of :data:`HELD_OUT` held-out ones, at least one each; in random order."""
    order, held = np.random.default_rng(seed).permutation(count), max(1, round(HELD_OUT * count))
    return [order[parts * held :], *(order[part * held : (part + 1) * held] for part in range(parts))]


def split(scenes: Sequence[TrainingScene], seed: int) -> list[list[TrainingScene]]:
    """Scenes to train on and scenes to watch the loss on, at least one each."""
    return [[scenes[row] for row in np.sort(rows)] for rows in split_rows(len(scenes), seed)]
