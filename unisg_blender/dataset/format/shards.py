"""Files of a dataset: written whole or not at all, named after their content, read by memory map."""

from __future__ import annotations

import json
import mmap
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import save

from ...runtime.atomic_files import DamagedError, check_plain, checksum
from .columns import Columns
from .schema import SCHEMA, VERSION

DTYPES = {"F64": "<f8", "F32": "<f4", "I64": "<i8", "I32": "<i4", "I8": "i1", "U8": "u1", "BOOL": "?"}


def pack_shard(columns: Columns, notes: Mapping[str, Any] | None = None) -> bytes:
    """Columns as the bytes of a safetensors file; ``notes`` (JSON-ready) go to its metadata."""
    tensors = {key: np.ascontiguousarray(columns[key]) for key in sorted(columns)}
    record = {"schema": SCHEMA, "version": VERSION, **(notes or {})}
    return save(tensors, {"unisg": json.dumps(record, sort_keys=True)})  # one entry: safetensors shuffles several


@dataclass(frozen=True, eq=False)
class Shard:
    """A shard in memory: ``columns`` are read-only views on the map ``data``; ``notes`` is its metadata."""

    columns: Columns
    notes: dict[str, Any]
    data: mmap.mmap

    def release(self) -> None:
        """Give the memory back that reading has made resident; the columns stay valid and are read again on use."""
        _release(self.data)


def _release(data: mmap.mmap) -> None:
    if hasattr(mmap, "MADV_DONTNEED"):  # Windows trims by itself
        data.madvise(mmap.MADV_DONTNEED)


def map_shard(path: Path, expected: str | None = None) -> Shard:
    """Map a shard into memory.

    Parameters
    ----------
    path
        The safetensors file.
    expected
        Its SHA-256, which is then verified (reads the whole file once).

    Raises
    ------
    DamagedError
        If the file is missing, cut short, no shard, or not the one expected.
    """
    try:
        check_plain(path)
        with open(path, "rb") as file:
            data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except (OSError, ValueError) as error:
        raise DamagedError(f"{path} cannot be read ({error}): the dataset is damaged, export it again") from None
    if expected is not None:
        total = checksum(memoryview(data))
        _release(data)
        if total != expected:
            raise DamagedError(f"{path} is damaged: its checksum is not the one in the manifest; export it again")
    try:
        size = int.from_bytes(data[:8], "little")
        header = json.loads(data[8 : 8 + size])
        notes = json.loads(header.pop("__metadata__")["unisg"])
        columns = {key: _view(data, 8 + size, entry) for key, entry in header.items()}
    except (ValueError, KeyError, TypeError) as error:
        raise DamagedError(f"{path} is no shard of a dataset: {error}") from None
    if notes.get("schema") != SCHEMA or notes.get("version", 0) > VERSION:
        raise DamagedError(f"{path} has a schema that this software does not know: update it")
    return Shard(columns, notes, data)


def _view(data: mmap.mmap, base: int, entry: Mapping[str, Any]) -> NDArray[Any]:
    start, stop = entry["data_offsets"]
    shape = tuple(entry["shape"])
    if stop == start:
        return np.zeros(shape, DTYPES[entry["dtype"]])
    return np.ndarray(shape, DTYPES[entry["dtype"]], data, base + start)
