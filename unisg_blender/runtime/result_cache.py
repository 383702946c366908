"""Runs many small measurements on all processors, and keeps each result, so that a second run goes on."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .atomic_files import DamagedError, read_plain, write_file
from .process_pool import process_pool


@dataclass(frozen=True, eq=False)
class Task:
    """A function of a module and its arguments.

    Attributes
    ----------
    name
        File name of the kept result: ``.npz`` for arrays by name, ``.json`` for a JSON-ready record.
    """

    name: str
    call: Callable[..., dict[str, Any]]
    arguments: tuple[Any, ...]


def hashed(label: str, depends: Any, digits: int) -> str:
    """A name that begins with ``label`` and has ``digits`` of the checksum of all that a result depends on."""
    return f"{label}-{hashlib.sha256(json.dumps(depends, sort_keys=True).encode()).hexdigest()[:digits]}"


def array_task(call: Callable[..., dict[str, NDArray[np.float64]]], arguments: tuple[Any, ...], depends: Any) -> Task:
    """A task whose result is arrays; ``depends`` is everything that it depends on, JSON-ready."""
    return Task(hashed(call.__name__, [call.__name__, depends], 24) + ".npz", call, arguments)


def run_all(
    tasks: Sequence[Task], folder: Path, jobs: int, done: Callable[[int], None] = lambda _: None
) -> list[dict[str, Any]]:
    """Results of all tasks, in order; those that ``folder`` keeps are read, the others computed and kept there.

    ``done`` is called with how many are finished. With one job all is computed in this process.

    Raises
    ------
    DamagedError
        If a kept result cannot be read.
    """
    results = {
        number: kept for number, task in enumerate(tasks) if (kept := kept_result(folder / task.name)) is not None
    }
    done(len(results))
    for number, result in _computed(
        [(number, task) for number, task in enumerate(tasks) if number not in results], jobs
    ):
        _keep(folder / tasks[number].name, result)
        results[number] = result
        done(len(results))
    return [results[number] for number in range(len(tasks))]


def _computed(tasks: Sequence[tuple[int, Task]], jobs: int) -> Iterator[tuple[int, dict[str, Any]]]:
    if jobs == 1 or len(tasks) < 2:
        for number, task in tasks:
            yield number, task.call(*task.arguments)
        return
    with process_pool(jobs) as pool:
        running = {pool.submit(task.call, *task.arguments): number for number, task in tasks}
        for future in as_completed(running):
            yield running[future], future.result()


def kept_result(path: Path) -> dict[str, Any] | None:
    """What a file keeps, None if there is none; DamagedError if it is not what was written."""
    try:
        data = read_plain(path)
        if path.suffix == ".json":
            return json.loads(data)
        with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
            return dict(arrays)
    except FileNotFoundError:
        return None
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise DamagedError(f"{path} cannot be read ({error}): remove it, it will be made again") from None


def _keep(path: Path, result: dict[str, Any]) -> None:
    if path.suffix == ".json":
        write_file(path, json.dumps(result, ensure_ascii=False))
        return
    data = io.BytesIO()
    np.savez(data, **result)
    write_file(path, data.getvalue())
