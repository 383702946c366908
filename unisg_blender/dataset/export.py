"""From folders of scene files to a dataset: in parallel, under time limits, to be continued where it stopped."""

from __future__ import annotations

import os
import queue
import shutil
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, Literal

from .. import __version__
from ..errors import UniSGError
from .asset_file import VERSION as ASSETS_VERSION
from .asset_file import Assets
from .columns import mesh_checksums
from .encode import known_form
from .mapping import Patterns, scene_label
from .reader import Dataset, open_dataset
from .schema import VERSION
from .shards import DiskFullError
from .sources import find_sources
from .supervise import close_children, export_file, read_part
from .writer import PARTS, DatasetWriter, dataset_folder, read_manifest

WINDOW = 1000
"""How many files an executor is given at a time."""

Record = dict[str, Any]


@dataclass(frozen=True)
class ExportOptions:
    """What to make of the files, and how.

    Attributes
    ----------
    form
        Name in ``FORMS``.
    timeout
        Seconds that a file may take.
    memory
        Bytes of address space that a reading process may have, 0 for no limit (not on Windows).
    mapping
        Categories by name patterns, see :mod:`.mapping`.
    instances
        "realize": what collections, geometry nodes and particles show more than once becomes entities
        (see :mod:`.realized`); "keep": it stays what it is, which a dataset does not hold.
    folder_labels
        Whether the folder that a file is in names the kind of its scenes (where the mapping does not).
    mesh_encoder
        "package.module:function" of a :data:`.encode.MeshEncoder`, "" for none.
    reader
        "package.module:function" of a :data:`.serve.Reader`, "" for Blender's.
    """

    form: str = "quaternion"
    timeout: float = 300.0
    memory: int = 0
    mapping: Patterns | None = None
    instances: Literal["realize", "keep"] = "realize"
    folder_labels: bool = False
    mesh_encoder: str = ""
    reader: str = ""


def export_dataset(
    inputs: Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    options: ExportOptions = ExportOptions(),
    *,
    executor: Executor | None = None,
    jobs: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    started: Callable[[int], None] | None = None,
    finished: Callable[[Record], None] | None = None,
) -> list[Record]:
    """Export scene files as a dataset.

    The scenes stand in the order of their files' paths, whatever the order in
    which they are read; an export that was interrupted and resumed gives the
    same bytes as one that was not.

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
    started, finished
        Called with the number of files, and with the record of each file as it is done.

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
        work = (_job(path, options, parts, before) for path in sources)
        if started is not None:
            started(len(sources))
        records: dict[str, Record] = {}
        with _own_executor(jobs) if executor is None else _borrowed(executor) as pool:
            for record in _run(pool, work):
                records[record["source"]] = record
                if finished is not None:
                    finished(record)
        ordered = [records[path.as_posix()] for path in sources]
        _check_some_read(ordered)
        return _merge(folder, parts, options.form, ordered, before)


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
        "instances": options.instances,
        "reader": options.reader,
        "mesh_encoder": options.mesh_encoder,
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
        for path in parts.glob(".*.tmp"):
            path.unlink(missing_ok=True)
        if not any(parts.iterdir()):
            parts.rmdir()
        raise
    shutil.rmtree(parts, ignore_errors=True)


@contextmanager
def _own_executor(jobs: int | None) -> Iterator[Executor]:
    pool = ThreadPoolExecutor(jobs or _processors())
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        close_children()  # what still reads is of no use: the threads behind see it end
        pool.shutdown(wait=True)
        close_children()


@contextmanager
def _borrowed(executor: Executor) -> Iterator[Executor]:
    try:
        yield executor
    finally:
        close_children()


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _run(executor: Executor, work: Iterator[Record]) -> Iterator[Record]:
    """The records of all files, as they are done; never more than :data:`WINDOW` files under way."""
    done: queue.SimpleQueue[tuple[str, Future[Record]]] = queue.SimpleQueue()
    waiting: set[Future[Record]] = set()

    def submit(job: Record) -> None:
        future = executor.submit(export_file, job)
        waiting.add(future)
        future.add_done_callback(partial(_put, done, job["source"]))

    try:
        for job in islice(work, WINDOW):
            submit(job)
        while waiting:
            source, future = done.get()
            waiting.discard(future)
            yield _result(source, future)
            for job in islice(work, 1):
                submit(job)
    finally:
        for future in waiting:
            future.cancel()


def _put(done: queue.SimpleQueue[tuple[str, Future[Record]]], source: str, future: Future[Record]) -> None:
    done.put((source, future))


def _result(source: str, future: Future[Record]) -> Record:
    try:
        record = future.result()
    except BrokenExecutor as error:
        raise UniSGError(f"the executor broke down ({error}): run the export again with --resume") from None
    except Exception as error:  # the worker of a cluster died over it
        return {"source": source, "status": "failed", "reason": f"{type(error).__name__}: {error}".splitlines()[0]}
    if record["status"] == "full":
        raise DiskFullError(f"{record['reason']}; make room, then run the export again with --resume")
    return record


def _merge(folder: Path, parts: Path, form: str, records: list[Record], before: _Before) -> list[Record]:
    """Write the shards and the manifest from what was read, in the order of the records; returns the final records."""
    writer = DatasetWriter(folder, form)
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
        raise DiskFullError(f"{error}; make room, then run the export again with --resume") from None
    return final


def _add_earlier(writer: DatasetWriter, record: Record, before: _Before) -> None:
    assert before.dataset is not None
    if record["scenes"]:
        start = before.starts[record["source"]]
        columns = before.dataset.columns(start, start + record["scenes"])
        writer.add(columns, before.dataset.vocabulary)
        if before.assets is not None:
            writer.assets.merge(before.assets, record["source"], mesh_checksums(columns))
