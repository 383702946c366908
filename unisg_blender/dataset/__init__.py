"""Datasets for learning: scenes as columns on disk, as records, and as heterogeneous graphs."""

from __future__ import annotations

from typing import Any

from .format.encoding import Sample
from .format.reader import Dataset, Scene, open_dataset
from .format.writer import write_dataset
from .rebuild import to_scenegraph

__all__ = [
    "Dataset", "Sample", "Scene", "UniSGDataset", "open_dataset", "to_heterodata", "to_scenegraph", "write_dataset",
]  # fmt: skip

_LAZY = {"UniSGDataset": "graphs.heterodata", "to_heterodata": "graphs.heterodata"}


def __getattr__(name: str) -> Any:
    """What needs torch is imported when it is first asked for."""
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"{__name__}.{_LAZY[name]}"), name)
