"""Runs many small measurements on all processors, and keeps each result, so that a second run goes on."""

from __future__ import annotations

import hashlib
import json
import os
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Result = dict[str, NDArray[np.float64]]
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True, eq=False)
class Task:
    """A function of a module, its arguments, and everything that its result depends on, JSON-ready."""

    call: Callable[..., Result]
    arguments: tuple[Any, ...]
    depends: Any

    @property
    def name(self) -> str:
        """File name of the kept result."""
        text = json.dumps([self.call.__name__, self.depends], sort_keys=True)
        return f"{self.call.__name__}-{hashlib.sha256(text.encode()).hexdigest()[:24]}.npz"


def run_all(
    tasks: Sequence[Task], folder: Path, jobs: int, done: Callable[[int], None] = lambda _: None
) -> list[Result]:
    """Results of all tasks, in order; those that ``folder`` keeps are read, the others computed and kept there.

    ``done`` is called with how many are finished. With one job all is computed in this process.
    """
    results: list[Result | None] = [_kept(folder / task.name) for task in tasks]
    missing = [number for number, result in enumerate(results) if result is None]
    finished = len(tasks) - len(missing)
    done(finished)
    for number, result in _computed([(number, tasks[number]) for number in missing], jobs):
        _keep(folder / tasks[number].name, result)
        results[number] = result
        finished += 1
        done(finished)
    return [result for result in results if result is not None]


def processes(asked: int | None) -> int:
    """Processes to use; inside Blender one, whose program starts no other Python."""
    application = getattr(getattr(sys.modules.get("bpy"), "app", None), "binary_path", "")
    return 1 if application else asked or os.cpu_count() or 1


def _computed(tasks: Sequence[tuple[int, Task]], jobs: int) -> Iterator[tuple[int, Result]]:
    if jobs == 1 or len(tasks) < 2:
        for number, task in tasks:
            yield number, task.call(*task.arguments)
        return
    with _single_threads(), ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        running = {pool.submit(task.call, *task.arguments): number for number, task in tasks}
        try:
            for future in as_completed(running):
                yield running[future], future.result()
        finally:
            pool.shutdown(cancel_futures=True)


@contextmanager
def _single_threads() -> Iterator[None]:
    """New processes compute on one thread each."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name)
            if value is not None:
                os.environ[name] = value


def _kept(path: Path) -> Result | None:
    """What a file keeps; None if there is none, or only half of one."""
    try:
        with np.load(path, allow_pickle=False) as file:
            return dict(file)
    except (OSError, ValueError, zipfile.BadZipFile):
        return None


def _keep(path: Path, result: Result) -> None:
    handle, name = tempfile.mkstemp(suffix=".npz", prefix=".", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            np.savez(file, **result)
        os.replace(name, path)
    finally:
        Path(name).unlink(missing_ok=True)
