"""Pictures and the graphs of what they show, for learning from both. Needs torch and Pillow."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import MissingPackageError
from .heterodata import UniSGDataset

try:
    import torch
except ImportError:
    raise MissingPackageError("torch", "learn") from None


class PictureDataset(torch.utils.data.Dataset):
    """What ``unisg render`` has made: a record for each picture.

    ``name``; ``picture`` uint8 (3, height, width); ``instance`` int32 (height, width), the number of each pixel's
    object, 0 for none; ``depth`` float32 (height, width), metres, infinite where nothing is; ``graph``, the
    ``HeteroData`` of what is seen; and ``number`` int64 (E,), that of each of its entities in ``instance``, 0 for parts
    of other objects.

    Parameters
    ----------
    folder
        The one that ``unisg render --out`` was given.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        self.graphs = UniSGDataset(self.folder / "graphs")

    def __len__(self) -> int:
        return len(self.graphs)

    def __getitem__(self, index: int) -> dict[str, Any]:
        try:
            from PIL import Image
        except ImportError:
            raise MissingPackageError("Pillow", "figures") from None
        name = self.graphs.columns[index].source
        with Image.open(self.folder / "pictures" / f"{name}.png") as image:
            picture = torch.from_numpy(np.array(image.convert("RGB")).transpose(2, 0, 1).copy())
        with np.load(self.folder / "truth" / f"{name}.npz") as truth:
            found = {key: torch.from_numpy(truth[key]) for key in ("instance", "depth")}
        labels = json.loads((self.folder / "labels" / f"{name}.json").read_text(encoding="utf-8"))["objects"]
        number_of = {label["uid"]: label["id"] for label in labels}
        numbers = [number_of.get(uid, 0) for uid in self.graphs.columns[index].strings("entity.uid")]
        number = torch.tensor(numbers, dtype=torch.int64)
        return {"name": name, "picture": picture, **found, "graph": self.graphs[index], "number": number}
