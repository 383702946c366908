"""Many small trainings, two at a time, each kept as a JSON file: what is there is not made again."""

from __future__ import annotations

import hashlib
import importlib
import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from ...errors import UniSGError
from ...runtime.progress import Progress

EXPERIMENTS = {
    "classification": (1, "...learn.paper.classification:run"),
    "topology": (2, "...learn.paper.topology:run"),
    "generation": (1, "...learn.paper.generation:run"),
    "poses": (1, "...learn.paper.poses:run"),
    "pairs": (1, "...learn.paper.pairs:run"),
    "rules": (1, "...learn.paper.pairs:run_rules"),
    "scale": (1, ".scale:run"),
    "link_prediction": (2, "...learn.paper.links:run"),
}
"""Version of the code (another one makes results anew) and "module:function": (settings, data folder) -> result."""

THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")


@dataclass(frozen=True)
class Run:
    """One training: an experiment and its JSON-ready settings, the seed among them."""

    experiment: str
    settings: Mapping[str, Any]

    @property
    def key(self) -> str:
        """Name of the file that keeps the result."""
        version = EXPERIMENTS[self.experiment][0]
        text = json.dumps([self.experiment, version, dict(self.settings)], sort_keys=True)
        return f"{self.experiment}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"


def run_all(runs: Sequence[Run], folder: Path, jobs: int, quiet: bool = False) -> dict[str, dict[str, Any]]:
    """Do what has not been done yet.

    Parameters
    ----------
    runs
        In the order in which they are wanted.
    folder
        Has the data in ``data``, and gets one file per run in ``runs``, each whole or not at all.
    jobs
        Processes, one thread each.

    Returns
    -------
    dict
        By :attr:`Run.key`: ``experiment``, ``settings``, ``seconds`` of processor time, ``result``.
    """
    kept = folder / "runs"
    kept.mkdir(parents=True, exist_ok=True)
    unique = {run.key: run for run in runs}
    done = {key: record for key in unique if (record := _read(kept / f"{key}.json")) is not None}
    missing = [run for key, run in unique.items() if key not in done]
    bar = Progress(len(unique), "trainings", quiet)
    try:
        bar.update(len(done))
        for record in _records(missing, folder, jobs):
            done[record.pop("key")] = record
            bar.update(len(done))
    finally:
        bar.close()
    return done


def finished(runs: Sequence[Run], folder: Path) -> dict[str, dict[str, Any]]:
    """The results that are there already."""
    found = {run.key: _read(folder / "runs" / f"{run.key}.json") for run in runs}
    return {key: record for key, record in found.items() if record is not None}


def _read(path: Path) -> dict[str, Any] | None:
    try:
        return json.loads(path.read_text("utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise UniSGError(f"{path} cannot be read ({error}): remove it, it will be made again") from None


def _records(missing: Sequence[Run], folder: Path, jobs: int) -> Iterator[dict[str, Any]]:
    tasks = [(run.key, run.experiment, dict(run.settings), str(folder)) for run in missing]
    if jobs <= 1 or len(tasks) <= 1:
        yield from (_do(*task) for task in tasks)
        return
    pool = ProcessPoolExecutor(jobs, get_context("spawn"), initializer=_one_thread)
    try:
        futures = [pool.submit(_do, *task) for task in tasks]
        yield from (future.result() for future in as_completed(futures))
    finally:
        pool.shutdown(cancel_futures=True)


def _one_thread() -> None:
    os.environ.update(dict.fromkeys(THREADS, "1"))
    import torch

    torch.set_num_threads(1)


def _do(key: str, experiment: str, settings: dict[str, Any], folder: str) -> dict[str, Any]:
    module, name = EXPERIMENTS[experiment][1].split(":")
    function: Callable[..., dict[str, Any]] = getattr(importlib.import_module(module, __package__), name)
    start = time.process_time()
    result = function(settings, Path(folder) / "data")
    seconds = round(time.process_time() - start, 2)
    record = {"experiment": experiment, "settings": settings, "seconds": seconds, "result": result}
    write_json(Path(folder) / "runs" / f"{key}.json", record)
    return {"key": key, **record}


def write_json(path: Path, record: Any) -> None:
    """Write a file whole or not at all."""
    draft = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    draft.write_text(json.dumps(record, ensure_ascii=False), encoding="utf-8")
    os.replace(draft, path)
