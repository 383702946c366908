"""Which rooms a batch makes: each has a name, a scene that it begins with or none, and a seed."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .. import __version__
from ..dataset.format.schema import VERSION
from ..errors import UniSGError
from ..runtime.atomic_files import DamagedError, checksum, checksum_of

CHUNK, CHUNKS = 8, 32
"""Rooms that a process is asked for at a time at most, and jobs that a batch has at least where it has rooms enough."""

DIGITS = 32
"""Of a job's key, with which the names of what is made of it begin."""

FORMATS = ("blend", "glb", "usda", "json", "dataset")
PICTURES = "pictures"
"""The format of a batch of pictures, see :mod:`.pictures.picture_worker`."""

WORK = {PICTURES: "unisg_blender.batches.pictures.picture_worker:make_pictures"}
ROOM_WORK = "unisg_blender.batches.room_worker:make_rooms"

Task = dict[str, Any]
"""A room to make, JSON-ready: ``room`` (its name), ``path`` (of its scene, "" for none) with ``sha256``, ``seed``."""


@dataclass(frozen=True)
class BatchOptions:
    """What is made of the tasks, and how.

    Attributes
    ----------
    maker
        "package.module:function" of a :data:`.made_room.Maker`.
    settings
        What it is told beside the task, JSON-ready: all that decides what is made.
    format
        One of :data:`FORMATS`.
    form, mesh_encoder, vocabulary
        Of a dataset, as :func:`~..dataset.write_dataset` has them; the encoder as "package.module:function".
    timeout
        Seconds that a room may take.
    memory
        Bytes of memory from which on a process is replaced by a new one.
    here
        Make the rooms in this process: few that are made sooner than another process starts.
    threads
        Threads with which a process renders.
    """

    maker: str
    settings: dict[str, Any]
    format: str = "blend"
    form: str = "quaternion"
    mesh_encoder: str = ""
    vocabulary: dict[str, tuple[str, ...]] | None = field(default=None, hash=False)
    timeout: float = 300.0
    memory: int = 4 * 2**30
    here: bool = False
    threads: int = 1


def plan_rooms(scenes: Sequence[Path], count: int, seed: int, stem: str) -> list[Task]:
    """The rooms of a batch: ``count`` for each scene with the seeds ``seed``, ``seed`` + 1 ..., or from nothing.

    A room is named after its scene, or ``stem``, and its seed: what else is in the batch changes nothing in it.

    Raises
    ------
    UniSGError
        If a scene cannot be read.
    """
    names = _names(scenes) if scenes else [stem]
    sums = [_checksum(path) for path in scenes] or [""]
    paths = [str(path.absolute()) for path in scenes] or [""]
    return [
        {"room": f"{name}-{number:05d}", "path": path, "sha256": total, "seed": number}
        for name, path, total in zip(names, paths, sums, strict=True)
        for number in range(seed, seed + count)
    ]


def _names(scenes: Sequence[Path]) -> list[str]:
    """A name for each scene: that of its file, with its folders where several files have it."""
    stems = Counter(path.stem for path in scenes)
    names = [path.stem if stems[path.stem] == 1 else "-".join((*path.parts[-2:-1], path.name)) for path in scenes]
    names = [name.replace(".", "-") if stems[path.stem] > 1 else name for name, path in zip(names, scenes, strict=True)]
    twice = next((name for name, many in Counter(names).items() if many > 1), None)
    if twice is not None:
        raise UniSGError(f"several scenes would be named {twice!r}: rename one, or give them to two calls")
    return names


def _checksum(path: Path) -> str:
    try:
        return checksum_of(path)
    except DamagedError as error:
        raise UniSGError(str(error)) from None


def chunk_jobs(tasks: Sequence[Task], options: BatchOptions, folder: Path, parts: Path) -> Iterator[dict[str, Any]]:
    """The tasks as jobs of some rooms each.

    ``key`` says all that decides what comes of a job; ``made`` is a file in the folder ``parts`` that an interrupted
    batch has made of it, "" for none.
    """
    decides = {
        "maker": options.maker, "settings": options.settings, "format": options.format, "form": options.form,
        "mesh_encoder": options.mesh_encoder,
    }  # fmt: skip
    shared = decides | {
        "folder": str(folder.absolute()), "parts": str(parts.absolute()), "timeout": options.timeout, "memory": 0,
        "most_memory": options.memory, "here": options.here, "threads": options.threads,
        "work": WORK.get(options.format, ROOM_WORK),
    }  # fmt: skip
    made = {path.name[:DIGITS]: path.name for path in parts.iterdir()} if parts.is_dir() else {}  # read once for all
    size = max(1, min(CHUNK, len(tasks) // CHUNKS))
    for start in range(0, len(tasks), size):
        chunk = list(tasks[start : start + size])
        said = [f"{__version__}, schema {VERSION}", decides, [{**task, "path": ""} for task in chunk]]
        key = checksum(json.dumps(said, sort_keys=True).encode())[:DIGITS]
        named = {"number": start, "source": f"{chunk[0]['room']} ...", "key": key, "made": made.get(key, "")}
        yield {**shared, **named, "tasks": chunk}
