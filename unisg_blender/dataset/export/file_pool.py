"""Run the files of an export on an executor, whichever it is."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from itertools import islice
from typing import Any

from ...errors import UniSGError
from ...runtime.atomic_files import DiskFullError
from ...runtime.process_pool import processors
from .supervisor import close_children, export_file

WINDOW = 1000
"""How many files an executor is given at a time."""

Record = dict[str, Any]


@contextmanager
def own_executor(jobs: int | None) -> Iterator[Executor]:
    """Threads, by default one per processor; each has files read by a process of its own."""
    pool = ThreadPoolExecutor(jobs or processors())
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        end = threading.Thread(target=pool.shutdown)
        end.start()
        while end.is_alive():  # what still reads is of no use: the threads behind see it end
            close_children()
            end.join(0.1)
        close_children()


@contextmanager
def borrowed(executor: Executor) -> Iterator[Executor]:
    """Somebody else's executor; what this process started for it is ended."""
    try:
        yield executor
    finally:
        close_children()


def run_files(executor: Executor, work: Iterator[Record], wait: float | None) -> Iterator[Record | None]:
    """The records of all files, as they are done; never more than :data:`WINDOW` files under way.

    None whenever ``wait`` seconds pass without one.
    """
    done: queue.SimpleQueue[tuple[str, Future[Record]]] = queue.SimpleQueue()
    waiting: set[Future[Record]] = set()

    def submit(job: Record) -> None:
        """Give a file to a process; its record comes to the queue."""
        future = executor.submit(export_file, job)
        waiting.add(future)
        future.add_done_callback(partial(_put, done, job["source"]))

    try:
        for job in islice(work, WINDOW):
            submit(job)
        while waiting:
            try:
                source, future = done.get(timeout=wait)
            except queue.Empty:
                yield None
                continue
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
        raise UniSGError(f"the executor broke down ({error}): resume the export") from None
    except Exception as error:  # the worker of a cluster died over it
        return {"source": source, "status": "failed", "reason": f"{type(error).__name__}: {error}".splitlines()[0]}
    if record["status"] == "full":
        raise DiskFullError(f"{record['reason']}; make room, then resume the export")
    return record
