"""Datasets and models for the tests, made in seconds, once in a process."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

from tests.generate.rooms import room
from unisg_blender.dataset import open_dataset, write_dataset

_FOLDER = tempfile.TemporaryDirectory(prefix="unisg-models-")


def write_rooms(folder: Path, count: int) -> Path:
    """A dataset of ``count`` small rooms."""
    write_dataset((room(seed) for seed in range(count)), folder)
    return folder


@cache
def shared_dataset() -> Path:
    """A dataset of twelve small rooms."""
    return write_rooms(Path(_FOLDER.name) / "dataset", 12)


@cache
def shared_model(kind: str) -> Path:
    """A model of a kind, trained for a moment."""
    import torch

    from unisg_blender.learn import job_list
    from unisg_blender.learn.hyperparameters import Settings

    torch.set_num_threads(1)  # two test runs at a time share the cores
    out = Path(_FOLDER.name) / f"{kind}.onnx"
    job_list.train(
        "cgvae", [open_dataset(shared_dataset())], out, Settings(paper=kind == "cgvae", epochs=2, quiet=True)
    )
    return out
