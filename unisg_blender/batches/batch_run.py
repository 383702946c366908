"""From tasks to rooms: in parallel, on one machine or a cluster, to be continued where it stopped."""

from __future__ import annotations

import os
import shutil
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from functools import partial
from itertools import chain
from pathlib import Path

from ..dataset.export.supervisor import read_part
from ..dataset.format.columns import mesh_checksums
from ..dataset.format.writer import PARTS, DatasetWriter, dataset_folder
from ..errors import UniSGError
from ..runtime.atomic_files import UNFINISHED, DiskFullError, made_folder
from ..runtime.folder_lock import folder_lock
from ..runtime.job_pool import Record, borrowed, own_executor, run_jobs
from ..runtime.made_files import check_made, mark_made
from ..runtime.steps import at_once
from .batch_plan import BatchOptions, Task, chunk_jobs
from .batch_report import REPORT, MadeBefore, write_report
from .chunk_work import make_chunk
from .room_worker import failed


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
    with _folder(Path(out), tasks, options, resume, overwrite) as folder, _parts(folder, overwrite) as parts:
        before = MadeBefore(folder, resume)
        all_jobs = partial(chunk_jobs, tasks, options, folder, parts)
        yield [], len(tasks)
        answers = before.all_answers(all_jobs())
        if answers is not None:
            return _records(answers)
        answers = []
        known = MadeBefore(folder, resumed=False) if options.format == "dataset" else before
        work = (job for job in all_jobs() if known.answer(job) is None)
        new = map(make_chunk, work) if options.here else _elsewhere(work, executor, jobs, wait)
        for answer in chain(filter(None, map(known.answer, all_jobs())), new):
            answers += [] if answer is None else [_checked(answer)]
            yield ([] if answer is None else answer["records"]), len(tasks)
        answers.sort(key=lambda answer: answer["number"])
        records = _records(answers)
        _check_some_made(records)
        if options.format == "dataset":
            _write_dataset(folder, parts, options, answers, records)
        write_report(folder, records)
        return records


make_batch = at_once(batch_steps)
"""Make the rooms of a batch, with the parameters of :func:`batch_steps`; returns their records."""


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


@contextmanager
def _folder(out: Path, tasks: Sequence[Task], options: BatchOptions, resume: bool, overwrite: bool) -> Iterator[Path]:
    """The folder of a batch, locked, in which nothing of somebody else is replaced."""
    if options.format == "dataset":
        with dataset_folder(out, overwrite, resume) as folder:
            yield folder
        return
    names = [REPORT, *(f"{task['room']}.{options.format}" for task in tasks)]
    with made_folder(out), folder_lock(out):
        if not (resume or overwrite):
            taken = next((name for name in (PARTS, *names) if (out / name).exists()), None)
            if taken is not None:
                what = f"{out} holds an unfinished batch" if taken == PARTS else f"{out / taken} exists already"
                raise UniSGError(f"{what}: choose another folder, or use --resume or --overwrite")
        check_made(out, names)
        mark_made(out, names)
        yield out


@contextmanager
def _parts(folder: Path, overwrite: bool) -> Iterator[Path]:
    """The folder of what is made but not finished; stays for ``resume`` unless it is empty or all is done."""
    parts = folder / PARTS
    if overwrite:
        shutil.rmtree(parts, ignore_errors=True)
    parts.mkdir(exist_ok=True)
    try:
        yield parts
    except BaseException:
        for path in (*parts.glob(UNFINISHED), *folder.glob(UNFINISHED)):
            path.unlink(missing_ok=True)
        if not any(parts.iterdir()):
            parts.rmdir()
        raise
    shutil.rmtree(parts, ignore_errors=True)


def _check_some_made(records: Sequence[Record]) -> None:
    if all(record["status"] == "failed" for record in records):
        raise UniSGError(f"none of {len(records)} rooms could be made; {records[0]['source']}: {records[0]['reason']}")


def _write_dataset(
    folder: Path, parts: Path, options: BatchOptions, answers: Sequence[Record], records: Sequence[Record]
) -> None:
    """Write the shards and the manifest from the parts, in the order of the jobs."""
    writer = DatasetWriter(folder, options.form, options.vocabulary)
    try:
        for answer in answers:
            if answer["part"]:
                part = read_part(parts / answer["part"])
                writer.add(part.columns, part.vocabulary)
                sums = mesh_checksums(part.columns)
                for place, record in enumerate(record for record in answer["records"] if record["status"] == "ok"):
                    writer.assets.merge(part.assets, record["source"], sums if place == 0 else ())
        writer.finish(records)
    except DiskFullError as error:
        raise DiskFullError(f"{error}; make room, then resume the batch") from None
