"""From folders of scene files to a dataset: in parallel, under time limits, to be continued where it stopped."""

from __future__ import annotations

import os
import shutil
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ... import __version__
from ...errors import UniSGError
from ...runtime.atomic_files import UNFINISHED, DiskFullError
from ...runtime.job_pool import Record, borrowed, own_executor, run_jobs
from ...runtime.steps import at_once
from ...words.category_mapping import Patterns, scene_label
from ..assets.asset_file import VERSION as ASSETS_VERSION
from ..assets.asset_file import Assets
from ..format.columns import mesh_checksums
from ..format.encoding import known_form
from ..format.reader import Dataset, open_dataset
from ..format.schema import VERSION
from ..format.writer import PARTS, DatasetWriter, dataset_folder, read_manifest
from .sources import find_sources, largest_first
from .supervisor import export_file, read_part


@dataclass(frozen=True)
class ExportOptions:
    """What to make of the files, and how.

    Attributes
    ----------
    form
        Name in ``FORMS``.
    timeout
        Seconds that a file may take, or some hundred scenes of a file of many.
    memory
        Bytes of address space that a reading process may have, 0 for no limit (not on Windows).
    mapping
        Categories by name patterns, see :mod:`...words.category_mapping`.
    understand
        Whether what has no category gets that of its name and of its place, see :mod:`..told_categories`; in the words
        of ``vocabulary``, if there is one.
    instances
        "realize": what collections, geometry nodes and particles show more than once becomes entities
        (see :mod:`.realized_instances`); "keep": it stays what it is, which a dataset does not hold.
    folder_labels
        Whether the folder that a file is in names the kind of its scenes (where the mapping does not).
    mesh_encoder
        "package.module:function" of a :data:`..format.encoding.MeshEncoder`, "" for none.
    vocabulary
        Names to number as another dataset does; new ones are added behind them.
    assets
        A folder with the meshes of what layouts of other programs place, "" for none.
    reader
        "package.module:function" of a :data:`.reader_process.Reader`, "" for the one of the file's kind.
    """

    form: str = "quaternion"
    timeout: float = 300.0
    memory: int = 0
    mapping: Patterns | None = None
    understand: bool = False
    instances: Literal["realize", "keep"] = "realize"
    folder_labels: bool = False
    mesh_encoder: str = ""
    vocabulary: Mapping[str, Sequence[str]] | None = None
    assets: str = ""
    reader: str = ""


def export_steps(
    inputs: Iterable[str | os.PathLike[str]], out: str | os.PathLike[str], options: ExportOptions = ExportOptions(), *,
    executor: Executor | None = None, jobs: int | None = None, resume: bool = False, overwrite: bool = False,
    wait: float | None = None,
) -> Generator[tuple[Record | None, int], None, list[Record]]:  # fmt: skip
    """Export scene files as a dataset; :func:`export_dataset` is the same at once.

    The scenes stand in the order of their files' paths; an export that was interrupted
    and resumed gives the same bytes as one that was not.

    Yields the record of each file as it is done, or None, and the number of files; None
    at the start, and whenever ``wait`` seconds pass. Closing the generator stops the export.

    Parameters
    ----------
    inputs
        Files, folders and globs.
    out
        Folder of the dataset.
    options
        What to make of the files.
    executor
        Runs the files; by default ``jobs`` threads, one per processor, each with a reading process of its own.
    resume
        Go on with an unfinished export, or bring a dataset up to date: only files that are new, were
        changed or failed are read.
    overwrite
        Replace what the folder holds.

    Returns
    -------
    list of dict
        One record per file, in order: ``source``, ``sha256``, ``bytes``, ``status`` ("ok" or
        "failed"), ``scenes``, ``entities``, ``not_represented``, ``beside``, or ``reason``.

    Raises
    ------
    UniSGError
        If the inputs or the folder cannot be used, no file can be read, or the disk is full.
    """
    known_form(options.form)
    sources = find_sources(inputs)
    with dataset_folder(out, overwrite, resume) as folder, _parts_folder(folder) as parts:
        before = _Before(folder if resume else None)
        work = (_job(path, options, parts, before) for path in largest_first(sources))
        yield None, len(sources)
        records: dict[str, Record] = {}
        with own_executor(jobs) if executor is None else borrowed(executor) as pool:
            for record in run_jobs(pool, export_file, work, wait):
                if record is not None:
                    records[record["source"]] = record
                yield record, len(sources)
        ordered = [records[path.as_posix()] for path in sources]
        _check_some_read(ordered)
        return _merge(folder, parts, options, ordered, before)


export_dataset = at_once(export_steps)


def _check_some_read(records: Sequence[Record]) -> None:
    if all(record["status"] == "failed" for record in records):
        first = f"{records[0]['source']}: {records[0]['reason']}"
        raise UniSGError(f"none of {len(records)} files could be read; {first}")
    if not any(record.get("scenes", 1) for record in records):
        raise UniSGError("there is no object in any of the files: nothing was written")


class _Before:
    """What the folder's dataset has of each file."""

    def __init__(self, folder: Path | None) -> None:
        self.dataset: Dataset | None = None
        self.assets: Assets | None = None
        self.records: dict[str, Record] = {}
        self.starts: dict[str, int] = {}
        if folder is None or read_manifest(folder) is None:
            return
        self.dataset = open_dataset(folder)
        self.assets = self.dataset.assets()
        start = 0
        for record in self.dataset.files():
            if record["status"] == "ok":
                self.records[record["source"]] = record
                self.starts[record["source"]] = start
                start += record["scenes"]


def _job(path: Path, options: ExportOptions, parts: Path, before: _Before) -> Record:
    source = path.as_posix()
    label = scene_label(source, options.mapping or {}) or (path.parent.name if options.folder_labels else "")
    earlier = before.records.get(source, {})
    return {
        "source": source,
        "path": str(path.absolute()),
        "parts": str(parts.absolute()),
        "known": earlier.get("key", ""),
        "beside": earlier.get("beside", {}),
        "timeout": options.timeout,
        "memory": options.memory,
        "label": label,
        "form": options.form,
        "mapping": options.mapping,
        "understand": [*(options.vocabulary or {}).get("categories", ())] if options.understand else None,
        "instances": options.instances,
        "reader": options.reader,
        "mesh_encoder": options.mesh_encoder,
        "assets": options.assets,
        "software": f"{__version__}, schema {VERSION}, assets {ASSETS_VERSION}",
    }


@contextmanager
def _parts_folder(folder: Path) -> Iterator[Path]:
    """The folder of what is read but not yet in a shard; stays for ``resume`` unless it is empty or all is done."""
    parts = folder / PARTS
    parts.mkdir(exist_ok=True)
    try:
        yield parts
    except BaseException:
        for path in parts.glob(UNFINISHED):
            path.unlink(missing_ok=True)
        if not any(parts.iterdir()):
            parts.rmdir()
        raise
    shutil.rmtree(parts, ignore_errors=True)


def _merge(folder: Path, parts: Path, options: ExportOptions, records: list[Record], before: _Before) -> list[Record]:
    """Write the shards and the manifest from what was read, in the order of the records; returns the final records."""
    writer = DatasetWriter(folder, options.form, options.vocabulary)
    final = []
    try:
        for record in records:
            if record["status"] == "same":
                record = before.records[record["source"]]
                _add_earlier(writer, record, before)
            elif record["status"] == "ok" and record["part"]:
                part = read_part(parts / record["part"])
                writer.add(part.columns, part.vocabulary)
                writer.assets.merge(part.assets, record["source"], mesh_checksums(part.columns))
            final.append({key: value for key, value in record.items() if key != "part"})
        writer.finish(final)
    except DiskFullError as error:
        raise DiskFullError(f"{error}; make room, then resume the export") from None
    return final


def _add_earlier(writer: DatasetWriter, record: Record, before: _Before) -> None:
    assert before.dataset is not None
    if record["scenes"]:
        start = before.starts[record["source"]]
        columns = before.dataset.columns(start, start + record["scenes"])
        writer.add(columns, before.dataset.vocabulary)
        if before.assets is not None:
            writer.assets.merge(before.assets, record["source"], mesh_checksums(columns))
