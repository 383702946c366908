"""What goes with a trained model: where it comes from, and its assets."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import torch
from torch import nn

from .. import __version__
from ..dataset.assets.asset_file import save_assets
from ..dataset.format.reader import Dataset
from ..generate.propose.trained_model import assets_path
from .hyperparameters import Settings
from .training_scenes import FEW_SCENES, dataset_checksum

BUILDING = {
    "Floor": "what stands on the ground and what is in the room cannot be told; give the floors that category",
    "Wall": "the sides of the floor stand for walls; give the walls that category if there are any",
}
"""Categories of the building without which less can be learned, and what that means."""


def provenance(
    dataset: Dataset, settings: Settings, scenes: tuple[int, int], losses: dict[str, float], network: nn.Module
) -> dict[str, Any]:
    """Dataset, counts, software, settings, losses and date of a training on the first of ``scenes``, the second held
    out.
    """
    return facts(dataset, settings, scenes) | {
        "losses": {name: round(value, 6) for name, value in sorted(losses.items())},
        "parameters": sum(parameter.numel() for parameter in network.parameters()),
    }


def facts(dataset: Dataset, settings: Settings, scenes: tuple[int, int]) -> dict[str, Any]:
    """The same but losses and size."""
    return {
        "notes": dataset_notes(dataset),
        "dataset": {"sha256": dataset_checksum(dataset), "scenes": len(dataset), **dataset.manifest["counts"]},
        "scenes_trained": scenes[0],
        "scenes_held_out": scenes[1],
        "settings": settings.to_record(),
        "software": f"unisg_blender {__version__}, torch {torch.__version__}, Python {platform.python_version()}",
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
    }


def dataset_notes(dataset: Dataset) -> list[str]:
    """What to expect of a generator trained on a dataset, where that is little."""
    notes = []
    if len(dataset) < FEW_SCENES:
        notes.append(f"{len(dataset)} scenes are few: expect little variety; {FEW_SCENES} or more make a useful model")
    for name, why in BUILDING.items():
        if name not in dataset.category_counts:
            notes.append(f'no object has the category "{name}": {why}')
    if dataset.assets() is None:
        notes.append("the dataset keeps no shapes: new objects copy those of the scene, or are plain boxes")
    return notes


def several(datasets: Sequence[Dataset]) -> dict[str, Any]:
    """The entries of a model that learns from several datasets together."""
    return {"notes": [], "datasets": [{"name": dataset.path.name, "scenes": len(dataset)} for dataset in datasets]}


def save_model_assets(dataset: Dataset, out: Path) -> int:
    """Put the dataset's assets beside the model; returns how many there are, 0 where the dataset has none.

    Without them the generator makes new objects out of those in the scene, else plain boxes.
    """
    file = dataset.assets()
    if file is None:
        assets_path(out).unlink(missing_ok=True)
        return 0
    assets = [file.asset(number) for number in range(len(file.index["assets"]))]
    save_assets(assets_path(out), assets)
    return len(assets)
