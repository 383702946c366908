"""Datasets and models for the tests, made in seconds, once in a process.

Where there is no torch, UNISG_TEST_MODELS names a folder that ``keep`` has filled elsewhere.
"""

from __future__ import annotations

import os
import tempfile
from functools import cache
from pathlib import Path

import pytest

from tests.generate.rooms import room
from unisg_blender.dataset import open_dataset, write_dataset

_TEMPORARY = tempfile.TemporaryDirectory(prefix="unisg-models-")
FOLDER = Path(os.environ.get("UNISG_TEST_MODELS", _TEMPORARY.name))
KINDS = ("cgvae", "anchors")


def write_rooms(folder: Path, count: int) -> Path:
    """A dataset of ``count`` small rooms."""
    write_dataset((room(seed) for seed in range(count)), folder)
    return folder


@cache
def shared_dataset() -> Path:
    """A dataset of twelve small rooms."""
    folder = FOLDER / "dataset"
    return folder if folder.exists() else write_rooms(folder, 12)


@cache
def shared_model(kind: str) -> Path:
    """A model of a kind, trained for a moment; skips where there is nothing to train with."""
    out = FOLDER / f"{kind}.onnx"
    if out.exists():
        return out
    torch = pytest.importorskip("torch")
    from unisg_blender.learn import job_list
    from unisg_blender.learn.hyperparameters import Settings

    torch.set_num_threads(1)  # two test runs at a time share the cores
    job_list.train(
        "cgvae", [open_dataset(shared_dataset())], out, Settings(paper=kind == "cgvae", epochs=2, quiet=True)
    )
    return out


def keep() -> None:
    """Make all of them."""
    for kind in KINDS:
        shared_model(kind)
