"""Run the jobs of a batch on an executor, whichever it is."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from itertools import islice
from typing import Any

from ..errors import MissingPackageError, UniSGError
from .asked_process import close_children
from .atomic_files import DiskFullError
from .process_pool import processors

WINDOW = 1000
"""How many jobs an executor is given at a time."""

Record = dict[str, Any]
"""A job, or what became of it: JSON-ready, with a ``source`` that says what it is about."""


@contextmanager
def own_executor(jobs: int | None) -> Iterator[Executor]:
    """Threads, by default one per processor; each has its jobs done by a process of its own."""
    pool = ThreadPoolExecutor(jobs or processors())
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        end = threading.Thread(target=pool.shutdown)
        end.start()
        while end.is_alive():  # what still works is of no use: the threads behind see it end
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


def run_jobs(
    executor: Executor, work: Callable[[Record], Record], jobs: Iterator[Record], wait: float | None = None
) -> Iterator[Record | None]:
    """What becomes of all jobs, as they are done; never more than :data:`WINDOW` of them under way.

    None whenever ``wait`` seconds pass without one.
    """
    done: queue.SimpleQueue[tuple[str, Future[Record]]] = queue.SimpleQueue()
    waiting: set[Future[Record]] = set()

    def submit(job: Record) -> None:
        """Give a job to a process; its record comes to the queue."""
        future = executor.submit(work, job)
        waiting.add(future)
        future.add_done_callback(partial(_put, done, job["source"]))

    try:
        for job in islice(jobs, WINDOW):
            submit(job)
        while waiting:
            try:
                source, future = done.get(timeout=wait)
            except queue.Empty:
                yield None
                continue
            waiting.discard(future)
            yield _result(source, future)
            for job in islice(jobs, 1):
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
        raise UniSGError(f"the executor broke down ({error}): resume the work") from None
    except Exception as error:  # the worker of a cluster died over it
        return {"source": source, "status": "failed", "reason": f"{type(error).__name__}: {error}".splitlines()[0]}
    if record["status"] == "full":
        raise DiskFullError(f"{record['reason']}; make room, then resume the work")
    return record


@contextmanager
def dask_executor(address: str | None) -> Iterator[Executor | None]:
    """Dask's executor for a scheduler's address; None without one.

    Raises
    ------
    UniSGError
        If no scheduler answers there, or Dask is not installed.
    """
    if address is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError:
        raise MissingPackageError("distributed", "cluster") from None
    try:
        client = Client(address, timeout=20)
    except (OSError, ValueError) as error:
        raise UniSGError(f"no Dask scheduler answers at {address}: {error}") from None
    with client:
        yield client.get_executor(pure=False)
