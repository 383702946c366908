"""Have a file read by a process of its own, unless its scenes are there already."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...runtime.asked_process import ask
from ...runtime.atomic_files import DamagedError, check_plain, checksum, checksum_of
from ..assets.asset_file import Arrays, Assets
from ..format.columns import Columns
from ..format.shards import map_shard
from .file_checksums import unchanged
from .reader_process import ASSETS

WORK = "unisg_blender.dataset.export.reader_process:export"
"""What a process is asked to do; inside Blender the library is called so in a process of its own only."""

SETTINGS = (
    "source",
    "label",
    "form",
    "mapping",
    "understand",
    "instances",
    "reader",
    "mesh_encoder",
    "software",
    "assets",
)
"""What, beside a file's bytes, decides what is written of it."""


def export_file(job: dict[str, Any]) -> dict[str, Any]:
    """Read one file and write its scenes to the folder ``job["parts"]``.

    Plain records in and out, so that any :class:`concurrent.futures.Executor` can run it.

    Parameters
    ----------
    job
        ``path``, ``parts``, ``known`` and ``beside`` (key of what the dataset has of this
        file already, or "", and checksums of the files beside it then), ``timeout``
        (seconds), ``memory`` (bytes, 0 for no limit),
        and the :data:`SETTINGS`, of which ``source`` is the file's name in the dataset.

    Returns
    -------
    dict
        ``status`` is "ok" (with ``part``, a file in the folder, and counts),
        "same" (the dataset has it), "failed" (with ``reason``) or "full" (the disk is).
    """
    record: dict[str, Any] = {"source": job["source"]}
    try:
        check_plain(Path(job["path"]))
        with open(job["path"], "rb") as file:
            record["sha256"] = hashlib.file_digest(file, "sha256").hexdigest()
            record["bytes"] = file.tell()
    except OSError as error:
        return record | {"status": "failed", "reason": f"cannot be read: {error.strerror or error}"}
    settings = [record["sha256"], {name: job[name] for name in SETTINGS}]
    record["key"] = checksum(json.dumps(settings, sort_keys=True).encode())[:32]
    if record["key"] == job["known"] and unchanged(Path(job["path"]), job["beside"]):
        return record | {"status": "same"}
    answer = _earlier_answer(job, record["key"]) or ask(job | {"key": record["key"], "work": WORK})
    answer.pop("how_far", None)
    return record | answer


def _earlier_answer(job: dict[str, Any], key: str) -> dict[str, Any] | None:
    """The answer of an interrupted export, if its part is there and whole, and the files beside are what they were."""
    for path in Path(job["parts"]).glob(f"{key}-*.safetensors"):
        with contextlib.suppress(DamagedError):
            answer = read_part(path).answer
            if unchanged(Path(job["path"]), answer["beside"]):
                return answer | {"part": path.name}
        path.unlink(missing_ok=True)
    return None


@dataclass(frozen=True)
class ReadPart:
    """What was read of one file: its scenes, what their numbers mean, and what was collected of their geometry."""

    columns: Columns
    vocabulary: dict[str, list[str]]
    assets: Assets
    answer: dict[str, Any]


def read_part(path: Path) -> ReadPart:
    """A part; DamagedError if it is not what its name says.

    Columns are in memory, arrays of assets when they are fetched: the file stays open as long as the part is in use.
    """
    if not path.stem.endswith(checksum_of(path)[:16]):
        raise DamagedError(f"{path} is damaged: resume the export")
    shard = map_shard(path)
    notes = shard.notes
    columns = {key: np.array(values) for key, values in shard.columns.items() if not key.startswith(ASSETS)}

    def fetch(names: Iterable[str]) -> Arrays:
        """The arrays of those assets that the shard has."""
        return {name: np.array(shard.columns[ASSETS + name]) for name in names if ASSETS + name in shard.columns}

    return ReadPart(columns, notes["vocabulary"], Assets(notes["assets"], fetch), notes["answer"])
