"""Whether a dataset says of itself what can be: its manifest and its columns, before anything relies on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...runtime.atomic_files import DamagedError
from ...runtime.json_records import from_record, parse_json
from .behaviour_rows import LINKS
from .columns import Columns, scene_count
from .schema import COLUMNS, REFERENCES, STRINGS, TABLES, VOCABULARIES, table_of

LARGEST_WIDTH = 2**16

ROWS = {
    "entity.parent": "entity", "world.entity": "entity", "relation.subject": "entity", "relation.target": "entity",
    "action.entity": "entity", "operation.entity": "entity",
}  # fmt: skip
"""Columns that hold rows of a table, counted from the scene's first."""

NONE_ALLOWED = ("entity.parent", "entity.category", "entity.mesh", "scene.label")
"""Columns in which -1 stands for nothing."""


@dataclass(frozen=True)
class FileEntry:
    """A file of the dataset beside its shards."""

    file: str
    sha256: str


@dataclass(frozen=True)
class ShardEntry:
    """A shard."""

    file: str
    sha256: str
    scenes: int
    entities: int


@dataclass(frozen=True)
class SourceEntry:
    """How much of a dataset is of one kind of file, under one licence; "" for unknown."""

    format: str
    licence: str
    files: int
    scenes: int


@dataclass(frozen=True)
class ManifestRecord:
    """What a manifest holds, as far as it is read."""

    schema: str
    version: int
    software: str
    form: str
    feature_channels: tuple[str, ...]
    mesh_feature_width: int
    types: tuple[str, ...]
    vocabulary: Mapping[str, tuple[str, ...]]
    counts: Mapping[str, int]
    category_counts: tuple[int, ...]
    shards: tuple[ShardEntry, ...]
    files: FileEntry | None
    assets: FileEntry | None = None
    sources: tuple[SourceEntry, ...] = ()
    extra: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class FileRecord:
    """What a dataset holds of a file that was exported, as far as it is read."""

    source: str
    status: str
    scenes: int = 0
    key: str = ""
    beside: Mapping[str, Any] = field(default_factory=dict)
    reason: str = ""
    extra: dict[str, Any] = field(default_factory=dict)


def check_manifest(manifest: Mapping[str, Any], path: Path) -> None:
    """DamagedError if a manifest lacks what is read of it, has something else there, or names files elsewhere."""
    try:
        record = from_record(ManifestRecord, manifest, "it")
    except UniSGError as error:
        raise DamagedError(f"{path} is damaged: {error}; export it again") from None
    names_of_files = [entry.file for entry in (*record.shards, record.files, record.assets) if entry is not None]
    if any(name != Path(name).name or not name for name in names_of_files):
        raise DamagedError(f"{path} is damaged: it names files that are not beside it; export it again")
    names = record.vocabulary
    numbers = [*record.counts.values(), *record.category_counts, record.mesh_feature_width]
    numbers += [number for shard in record.shards for number in (shard.scenes - 1, shard.entities)]
    if (
        set(names) != set(VOCABULARIES)
        or len(record.category_counts) != len(names["categories"])
        or min(numbers) < 0
        or record.mesh_feature_width > LARGEST_WIDTH
        or not record.shards
    ):
        raise DamagedError(f"{path} is damaged: its numbers do not fit each other; export it again")


def file_records(data: bytes, path: Path) -> list[dict[str, Any]]:
    """The records of a list of exported files; DamagedError if a line is none."""
    try:
        records = [parse_json(line, "a line") for line in data.split(b"\n") if line]
        for record in records:
            from_record(FileRecord, record, "a line")
    except UniSGError as error:
        raise DamagedError(f"{path} is damaged: {error}; export it again") from None
    return records


def check_columns(
    columns: Columns, path: Path, entry: Mapping[str, Any], widths: Mapping[str, int], manifest: Mapping[str, Any]
) -> None:
    """Look at every column of a shard, once.

    Parameters
    ----------
    entry
        What the manifest says of the shard.
    widths
        Of rows, by their names in :data:`.schema.COLUMNS`.
    manifest
        Of the dataset.

    Raises
    ------
    DamagedError
        If one is missing, or of another type or shape; if it is out of its range or not finite; if offsets do not
        fit.
    """
    try:
        _check_tables(columns, entry, widths)
        _check_strings(columns)
        _check_ranges(columns, manifest["vocabulary"], len(manifest["types"]))
    except _WrongColumn as wrong:
        raise DamagedError(f"{path} is damaged: its column {wrong.args[0]!r} is wrong; export it again") from None


class _WrongColumn(Exception):
    """Names the column."""


def _need(right: bool | np.bool_, key: str) -> None:
    if not right:
        raise _WrongColumn(key)


def _check_tables(columns: Columns, entry: Mapping[str, Any], widths: Mapping[str, int]) -> None:
    for key, column in COLUMNS.items():
        _need(key in columns and columns[key].dtype == column.dtype, key)
        shape = tuple(widths[size] if isinstance(size, str) else size for size in column.shape)
        unknown = key == "mesh.feature" and columns[key].ndim == 2 and not len(columns[key])
        _need(unknown or (columns[key].ndim > 0 and columns[key].shape[1:] == shape), key)
        _need(column.dtype != "float32" or np.isfinite(columns[key]).all(), key)
    _need(scene_count(columns) == entry["scenes"], "scene.label")
    counts = {"scene": entry["scenes"], "mesh": len(columns["mesh.bounds"])}
    for table in TABLES:
        counts[table] = _check_offsets(columns, f"{table}.ptr", entry["scenes"])
    _need(counts["entity"] == entry["entities"], "entity.ptr")
    for key in COLUMNS:
        _need(len(columns[key]) == counts[table_of(key)], key)
    for key in STRINGS:
        size = _check_offsets(columns, f"{key}.offsets", counts[table_of(key)])
        text = columns.get(f"{key}.bytes")
        _need(text is not None and text.dtype == np.uint8 and text.shape == (size,), f"{key}.bytes")


def _check_offsets(columns: Columns, key: str, rows: int) -> int:
    """The last of some offsets that begin with 0, do not fall, and are one more than the rows."""
    offsets = columns.get(key)
    _need(offsets is not None and offsets.dtype == np.int64 and offsets.shape == (rows + 1,), key)
    assert offsets is not None
    _need(offsets[0] == 0 and (np.diff(offsets) >= 0).all(), key)
    return int(offsets[-1])


def _check_strings(columns: Columns) -> None:
    """Text is UTF-8, and no offset lies within a character."""
    for key in STRINGS:
        text, offsets = columns[f"{key}.bytes"], columns[f"{key}.offsets"]
        starts = text[offsets[offsets < len(text)]]
        _need(((starts & 0xC0) != 0x80).all(), f"{key}.offsets")
        try:
            text.tobytes().decode("utf-8", "surrogatepass")
        except UnicodeDecodeError:
            raise _WrongColumn(f"{key}.bytes") from None


def _check_ranges(columns: Columns, vocabulary: Mapping[str, Sequence[str]], types: int) -> None:
    sizes: dict[str, Any] = {key: len(vocabulary[kind]) for key, kind in REFERENCES.items()}
    sizes |= {"entity.type": types, "entity.mesh": len(columns["mesh.bounds"]), "link.kind": len(LINKS)}
    counts = {table: np.diff(columns[f"{table}.ptr"]) for table in TABLES}
    for key, table in ROWS.items():
        sizes[key] = np.repeat(counts[table], counts[table_of(key)])
    first = columns["entity.ptr"][:-1]
    own = np.arange(len(columns["entity.parent"])) - np.repeat(first, counts["entity"])
    sizes["entity.parent"] = own  # parents come first, so that there is no circle
    for key, size in sizes.items():
        _check_range(columns[key], size, key)
    scene = np.repeat(np.arange(len(first)), counts["link"])
    for place, end in (("source", 0), ("target", 2)):
        by_kind = np.stack([counts[kind[end]] for kind in LINKS])
        _check_range(columns[f"link.{place}"], by_kind[columns["link.kind"], scene], f"link.{place}")


def _check_range(values: NDArray[Any], size: Any, key: str) -> None:
    least = -1 if key in NONE_ALLOWED else 0
    _need((values >= least).all() and (values < size).all(), key)
