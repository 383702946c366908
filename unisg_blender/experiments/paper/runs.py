"""Many small trainings, two at a time, each kept as a JSON file: what is there is not made again."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...runtime.progress import Progress
from ...runtime.result_cache import Task, hashed, kept_result
from ...runtime.result_cache import run_all as run_tasks

EXPERIMENTS = {
    "classification": (1, "...learn.paper.classification:run"),
    "topology": (3, "...learn.paper.topology:run"),
    "generation": (1, "...learn.paper.generation:run"),
    "poses": (2, "...learn.paper.poses:run"),
    "pairs": (2, "...learn.paper.pairs:run"),
    "rules": (1, "...learn.paper.pairs:run_rules"),
    "scale": (1, ".scale:run"),
    "link_prediction": (2, "...learn.paper.links:run"),
    "algebra": (1, "...learn.symmetry.timed_training:run"),
}
"""Version of the code (another one makes results anew) and "module:function": (settings, data folder) -> result."""


@dataclass(frozen=True)
class Run:
    """One training: an experiment and its JSON-ready settings, the seed among them."""

    experiment: str
    settings: Mapping[str, Any]

    @property
    def key(self) -> str:
        """Name of the file that keeps the result."""
        return hashed(self.experiment, [self.experiment, EXPERIMENTS[self.experiment][0], dict(self.settings)], 16)


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
    tasks = [Task(f"{key}.json", _do, (run, folder / "data")) for key, run in unique.items()]
    bar = Progress(len(tasks), "trainings", quiet)
    try:
        return dict(zip(unique, run_tasks(tasks, kept, jobs, bar.update), strict=True))
    finally:
        bar.close()


def finished(runs: Sequence[Run], folder: Path) -> dict[str, dict[str, Any]]:
    """The results that are there already."""
    found = {run.key: kept_result(folder / "runs" / f"{run.key}.json") for run in runs}
    return {key: record for key, record in found.items() if record is not None}


def _do(run: Run, data: Path) -> dict[str, Any]:
    module, name = EXPERIMENTS[run.experiment][1].split(":")
    function: Callable[..., dict[str, Any]] = getattr(importlib.import_module(module, __package__), name)
    start = time.process_time()
    result = function(dict(run.settings), data)
    seconds = round(time.process_time() - start, 2)
    return {"experiment": run.experiment, "settings": dict(run.settings), "seconds": seconds, "result": result}
