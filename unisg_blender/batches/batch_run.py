"""From tasks to rooms: in parallel, on one machine or a cluster, to be continued where it stopped."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor
from functools import partial
from itertools import chain
from pathlib import Path

from ..dataset.export.supervisor import read_part
from ..dataset.format.columns import mesh_checksums
from ..dataset.format.writer import DatasetWriter, dataset_folder
from ..errors import UniSGError
from ..runtime.atomic_files import DiskFullError
from ..runtime.job_pool import Record, borrowed, own_executor, run_jobs
from ..runtime.steps import at_once
from .batch_folder import GRAPHS, batch_folder, parts_folder
from .batch_plan import PICTURES, BatchOptions, Task, chunk_jobs
from .batch_report import MadeBefore, other_records, write_report
from .chunk_work import make_chunk
from .pictures.coco_files import write_coco
from .task_records import failed


def batch_steps(
    tasks: Sequence[Task], out: str | os.PathLike[str], options: BatchOptions, *, executor: Executor | None = None,
    jobs: int | None = None, resume: bool = False, overwrite: bool = False, wait: float | None = None,
) -> Generator[tuple[list[Record], int], None, list[Record]]:  # fmt: skip
    """Make the rooms of a batch; :func:`make_batch` is the same at once.

    What is written is the same whatever the jobs, and however often it was stopped and resumed.

    Yields the records of some rooms as they are done (none at the start, and whenever ``wait`` seconds pass), and the
    number of all rooms. Closing the generator stops the batch.

    Parameters
    ----------
    tasks
        The rooms, see :func:`.batch_plan.plan_rooms`.
    out
        Folder of the files and :data:`REPORT`, or of the dataset.
    options
        What to make of them.
    executor
        Runs the jobs; by default ``jobs`` threads, one per processor, each with a process of its own.
    resume
        Go on with an interrupted batch.
    overwrite
        Replace what an earlier one made there.

    Returns
    -------
    list of dict
        One record per room, in order: ``source`` (its name), ``seed``, ``scene``, ``status`` ("ok" or "failed"),
        ``entities`` and what its maker says, or ``reason``.

    Raises
    ------
    UniSGError
        If the folder cannot be used, no room could be made, or the disk is full.
    """
    with (
        batch_folder(Path(out), tasks, options.format, resume, overwrite) as folder,
        parts_folder(folder, overwrite) as parts,
    ):
        all_jobs = partial(chunk_jobs, tasks, options, folder, parts)
        yield [], len(tasks)
        others = other_records(folder, tasks, options.format)
        before = MadeBefore(folder, resume)
        answers = before.all_answers(all_jobs())
        if answers is not None:
            return _records(answers)
        whole = options.format in ("dataset", PICTURES)  # what is of all rooms needs the parts of all
        known = MadeBefore(folder, resumed=False) if whole else before
        answers = []
        for answer in _answers(all_jobs, known, options, executor, jobs, wait):
            answers += [] if answer is None else [_checked(answer)]
            yield ([] if answer is None else answer["records"]), len(tasks)
        answers.sort(key=lambda answer: answer["number"])
        _check_some_made(_records(answers), parts)
        _finish(folder, parts, options, answers)
        write_report(folder, [*others, *_records(answers)])
        return _records(answers)


make_batch = at_once(batch_steps)
"""Make the rooms of a batch, with the parameters of :func:`batch_steps`; returns their records."""


def _answers(
    all_jobs: Callable[[], Iterator[Record]], known: MadeBefore, options: BatchOptions, executor: Executor | None,
    jobs: int | None, wait: float | None,
) -> Iterator[Record | None]:  # fmt: skip
    """What became of all jobs: of those that are done already first, then of others as they are done."""
    work = (job for job in all_jobs() if known.answer(job) is None)
    new = map(make_chunk, work) if options.here else _elsewhere(work, executor, jobs, wait)
    return chain(filter(None, map(known.answer, all_jobs())), new)


def _records(answers: Sequence[Record]) -> list[Record]:
    return [record for answer in answers for record in answer["records"]]


def _elsewhere(
    work: Iterator[Record], executor: Executor | None, jobs: int | None, wait: float | None
) -> Iterator[Record | None]:
    """What becomes of all jobs, in processes of their own or on somebody's executor."""
    with own_executor(jobs) if executor is None else borrowed(executor) as pool:
        waiting: dict[str, Record] = {}
        for answer in run_jobs(pool, make_chunk, _remembered(work, waiting), wait):
            job = waiting.pop(answer["source"]) if answer is not None else {}
            yield answer if answer is None or answer["status"] != "failed" else _lost(job, answer["reason"])


def _remembered(work: Iterator[Record], waiting: dict[str, Record]) -> Iterator[Record]:
    for job in work:
        waiting[job["source"]] = job
        yield job


def _lost(job: Record, reason: str) -> Record:
    """The answer for a job over which the worker of a cluster died."""
    return {"number": job["number"], "records": [failed(task, reason) for task in job["tasks"]], "part": ""}


def _checked(answer: Record) -> Record:
    if answer.get("status") == "full":
        raise DiskFullError(f"{answer['reason']}; make room, then resume the batch")
    return answer


def _check_some_made(records: Sequence[Record], parts: Path) -> None:
    """Refuse a batch of which nothing came; nothing stays of it that another call would have to go on with."""
    if all(record["status"] == "failed" for record in records):
        shutil.rmtree(parts, ignore_errors=True)
        many = f"none of {len(records)} rooms could be made; " if len(records) > 1 else ""
        raise UniSGError(f"{many}{records[0]['source']}: {records[0]['reason']}")


def _finish(folder: Path, parts: Path, options: BatchOptions, answers: Sequence[Record]) -> None:
    """Write what is of all rooms together: a dataset, or the labels and scenegraphs of all pictures."""
    if options.format == "dataset":
        _write_dataset(folder, parts, options, answers)
    if options.format == PICTURES:
        with dataset_folder(folder / GRAPHS, overwrite=True) as graphs:
            _write_dataset(graphs, parts, options, answers)
        names = [name for record in _records(answers) for name in record.get("pictures", ())]
        write_coco(folder, names, (options.vocabulary or {}).get("categories", ()))


def _write_dataset(folder: Path, parts: Path, options: BatchOptions, answers: Sequence[Record]) -> None:
    """Write the shards and the manifest from the parts, in the order of the jobs."""
    writer = DatasetWriter(folder, options.form, options.vocabulary)
    try:
        for answer in answers:
            if answer["part"]:
                part = read_part(parts / answer["part"])
                writer.add(part.columns, part.vocabulary)
                sums = mesh_checksums(part.columns)
                sources = [] if options.format == PICTURES else answer["records"]  # pictures keep no geometry
                for place, record in enumerate(record for record in sources if record["status"] == "ok"):
                    writer.assets.merge(part.assets, record["source"], sums if place == 0 else ())
        writer.finish(_records(answers))
    except DiskFullError as error:
        raise DiskFullError(f"{error}; make room, then resume the batch") from None
