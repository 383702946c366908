"""What is said of the tasks of a job while a process does them: a record for each."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..errors import UniSGError
from ..runtime.atomic_files import DiskFullError
from ..runtime.serving_process import Alive


def task_records(
    request: Mapping[str, Any], alive: Alive, do: Callable[[Mapping[str, Any]], dict[str, Any]]
) -> list[dict[str, Any]]:
    """Do the tasks of a job (see :mod:`.batch_plan`) but those that are ``left_out``, each with the reason.

    What fails costs itself only, but for a full disk and too little memory.
    """
    records = []
    for number, task in enumerate(request["tasks"]):
        reason = request["left_out"].get(str(number), "")
        records.append(failed(task, reason) if reason else _done(task, do))
        alive(number + 1)
    return records


def _done(task: Mapping[str, Any], do: Callable[[Mapping[str, Any]], dict[str, Any]]) -> dict[str, Any]:
    try:
        return named(task) | {"status": "ok"} | do(task)
    except (DiskFullError, MemoryError):
        raise
    except UniSGError as error:
        return failed(task, str(error))
    except Exception as error:
        return failed(task, f"{type(error).__name__}: {error}".splitlines()[0])


def named(task: Mapping[str, Any]) -> dict[str, Any]:
    """What every record says of its task."""
    return {"source": task["room"], "seed": task["seed"], "scene": Path(task["path"]).name}


def failed(task: Mapping[str, Any], reason: str) -> dict[str, Any]:
    """What is said of a task that could not be done."""
    return {**named(task), "status": "failed", "reason": reason}


def used_memory() -> int:
    """The most bytes of memory that this process has used; 0 where the system does not say."""
    if sys.platform == "win32":
        return 0
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
