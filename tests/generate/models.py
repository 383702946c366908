"""Datasets and models for the tests, made in seconds."""

from __future__ import annotations

from pathlib import Path

from tests.generate.rooms import room
from unisg_blender.dataset import open_dataset, write_dataset
from unisg_blender.dataset.assets import AssetCollector


def write_rooms(folder: Path, count: int) -> Path:
    """A dataset of ``count`` small rooms with its assets."""
    collector = AssetCollector()
    write_dataset(collector.watch(room(seed) for seed in range(count)), folder)
    collector.save(folder)
    return folder


def trained(folder: Path, out: Path, paper: bool, seed: int = 0, epochs: int = 2) -> Path:
    """A model trained for a moment."""
    import torch

    from unisg_blender.learn.settings import Settings
    from unisg_blender.learn.train_cgvae import train

    torch.set_num_threads(1)  # two test runs at a time share the cores
    train(open_dataset(folder), out, Settings(paper=paper, epochs=epochs, seed=seed, quiet=True))
    return out
