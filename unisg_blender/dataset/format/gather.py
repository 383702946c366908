"""Any scenes of a dataset side by side, fast: only the columns that graphs need, no strings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .columns import COLUMN_TABLES, Columns
from .reader import Dataset
from .schema import COLUMNS

TABLES = ("entity", "relation", "action", "lesson", "stage", "link")
KEYS = {table: tuple(key for key, of in COLUMN_TABLES.items() if of == table) for table in (*TABLES, "world")}
MESH_KEYS = ("mesh.descriptor", "mesh.feature")


def gather(dataset: Dataset, indices: Sequence[int] | NDArray[np.integer], tables: Sequence[str] = TABLES) -> Columns:
    """Columns of some scenes in the order given: all numbers of some tables, and the meshes that occur.

    Raises
    ------
    IndexError
        If a number is not that of a scene.
    DamagedError
        If a shard is not what was written.
    """
    wanted = np.asarray(indices, np.int64)
    if wanted.size and (wanted.min() < 0 or wanted.max() >= len(dataset)):
        raise IndexError(f"scene numbers go from 0 to {len(dataset) - 1}")
    shards = np.searchsorted(dataset.starts, wanted, side="right") - 1
    rows = (wanted - dataset.starts[shards]).tolist()
    plan = [(table, f"{table}.ptr", KEYS[table]) for table in tables]
    pieces: dict[str, list[NDArray]] = {key: [] for *_, keys in plan for key in keys}
    counts: dict[str, list[int]] = {table: [] for table in tables}
    labels = []
    opened: dict[int, Columns] = {}
    for shard, row in zip(shards.tolist(), rows, strict=True):
        columns = opened[shard] = dataset.shard(shard, 1)
        labels.append(columns["scene.label"][row])
        for table, ptr, keys in plan:
            start, stop = columns[ptr][row : row + 2].tolist()
            counts[table].append(stop - start)
            if stop > start:
                for key in keys:
                    pieces[key].append(columns[key][start:stop])
    whole = {key: np.concatenate(found) if found else _none(dataset, key) for key, found in pieces.items()}
    whole |= {f"{table}.ptr": np.cumsum([0, *sizes], dtype=np.int64) for table, sizes in counts.items()}
    whole["scene.label"] = np.array(labels, np.int32)
    return whole | _meshes(dataset, whole, shards, opened)


def _none(dataset: Dataset, key: str) -> NDArray:
    column = COLUMNS[key]
    return np.zeros(
        (0, *(dataset.widths[item] if isinstance(item, str) else item for item in column.shape)), column.dtype
    )


def _meshes(dataset: Dataset, whole: Columns, shards: NDArray[np.int64], opened: dict[int, Columns]) -> Columns:
    """The mesh rows that the gathered entities use, and ``entity.mesh`` pointing to them."""
    mesh = whole["entity.mesh"].astype(np.int64)
    shard = np.repeat(shards, np.diff(whole["entity.ptr"]))
    used, place = np.unique(np.where(mesh < 0, -1, shard << 32 | mesh), return_inverse=True)
    hidden = int(len(used) > 0 and used[0] < 0)
    used = used[hidden:]
    result: Columns = {"entity.mesh": (place - hidden).astype(np.int32)}
    numbers, first = np.unique(used >> 32, return_index=True)
    runs = np.split(used & 0xFFFFFFFF, first[1:])
    for key in MESH_KEYS:
        found = [opened[number][key][rows] for number, rows in zip(numbers.tolist(), runs, strict=False)]
        result[key] = np.concatenate(found) if found else _none(dataset, key)
    return result
