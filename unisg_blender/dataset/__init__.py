"""Datasets for learning: scenes as columns on disk, as records, and as heterogeneous graphs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..runtime.lazy_names import lazy_names
from .format.encoding import Sample
from .format.reader import Dataset, Scene, open_dataset
from .format.writer import write_dataset
from .graphs.vocabularies import common_vocabulary
from .rebuild import to_scenegraph

if TYPE_CHECKING:
    from .graphs.edge_poses import EdgePoses
    from .graphs.heterodata import UniSGDataset, to_heterodata
    from .graphs.picture_dataset import PictureDataset

__all__ = [
    "Dataset", "EdgePoses", "PictureDataset", "Sample", "Scene", "UniSGDataset", "common_vocabulary", "open_dataset",
    "to_heterodata", "to_scenegraph", "write_dataset",
]  # fmt: skip

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "EdgePoses": ".graphs.edge_poses",
        "PictureDataset": ".graphs.picture_dataset",
        "UniSGDataset": ".graphs.heterodata",
        "to_heterodata": ".graphs.heterodata",
    },
)
