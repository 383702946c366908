"""Writes the frozen rooms that generators are trained and measured on: ``unisg-rooms``, see docs/benchmark.md.

The version is that of the worlds' scenes, which do not change under one version:
each part has a digest (:func:`scenes_digest`) that is known beforehand, and the
command says whether what it made has it.
"""

from __future__ import annotations

import argparse
import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ... import __version__
from ...dataset import Sample, open_dataset, to_scenegraph, write_dataset
from ...errors import UniSGError
from ...runtime.atomic_files import write_file
from ...runtime.process_pool import processes
from ...scene import SceneGraph
from ...worlds.world_batches import make_many

NAME, VERSION = "unisg-rooms", "1.0"
RECORD = "benchmark.json"
FORM = "quaternion"
DIGITS = 6


@dataclass(frozen=True)
class FrozenPart:
    """``count`` rooms of a world from ``seed`` on, in a folder, and the digest of the scenes."""

    folder: str
    world: str
    seed: int
    count: int
    digest: str


PARTS = (
    FrozenPart(
        "operating-room/training",
        "operating-room",
        0,
        1000,
        "cb0916cf17ab0f7ef0a5362c8392c2539eacd5e87c2f0aacfa8e8d8e5bd78972",
    ),
    FrozenPart(
        "operating-room/test",
        "operating-room",
        100_000,
        300,
        "ad5f5858389fdc4d7f35a77f3ebedbd2590bf6eadc8c2677e5648ec083eb9cb8",
    ),
    FrozenPart(
        "living-room/training",
        "living-room",
        0,
        1000,
        "d316836ce60464e02e7aca034ae7e6d0363b677ce3d31ea880ca5b1de831ad59",
    ),
    FrozenPart(
        "living-room/test",
        "living-room",
        100_000,
        300,
        "8d5e4c15f4e56cd1a111b7ce27201f073c3aab2e27e41c84d749391b3ff00131",
    ),
)


def write_rooms(args: argparse.Namespace, folder: Path, progress: Callable[[str], None]) -> dict[str, Any]:
    """Make all parts; those that are there already, whole, are kept.

    Returns
    -------
    dict
        What ``benchmark.json`` holds: name, version, software, and for each part its seeds, counts, whether its
        digest is the one of this version, and the checksums of its files.

    Raises
    ------
    UniSGError
        If a folder holds something else, or what is there is not this version.
    """
    folder.mkdir(parents=True, exist_ok=True)
    parts: dict[str, Any] = {}
    numbering: dict[str, Mapping[str, Sequence[str]]] = {}
    for part in PARTS:
        parts[part.folder] = write_part(
            part, folder / part.folder, progress, processes(args.jobs), numbering.get(part.world)
        )
        numbering.setdefault(part.world, open_dataset(folder / part.folder).vocabulary)
    report = {"name": NAME, "version": VERSION, "software": f"unisg_blender {__version__}", "parts": parts}
    write_file(folder / RECORD, json.dumps(report, indent=1) + "\n")
    return report


def write_part(
    part: FrozenPart,
    folder: Path,
    progress: Callable[[str], None],
    jobs: int = 1,
    vocabulary: Mapping[str, Sequence[str]] | None = None,
) -> dict[str, Any]:
    """Make one part, its names numbered as ``vocabulary`` does, unless it is there; returns its record."""
    note = folder / "part.json"
    if note.is_file():
        progress(f"{part.folder} is there")
        record: dict[str, Any] = json.loads(note.read_text("utf-8"))
        if record["sha256"] != file_sums(folder) or record["count"] != part.count or record["seed"] != part.seed:
            raise UniSGError(f"{folder} holds other rooms, or damaged ones: give another folder")
        return record
    seeds = range(part.seed, part.seed + part.count)
    scenes = _told(make_many(part.world, seeds, jobs), part, progress)
    write_dataset((Sample(graph, graph.title, part.world) for graph in scenes), folder, FORM, vocabulary=vocabulary)
    found = scenes_digest(folder)
    record = {
        "world": part.world, "seed": part.seed, "count": part.count, "digest": found,
        "is_version": VERSION if found == part.digest else None,
        "counts": open_dataset(folder).manifest["counts"], "sha256": file_sums(folder),
    }  # fmt: skip
    write_file(note, json.dumps(record, indent=1) + "\n")
    return record


def _told(scenes: Iterable[SceneGraph], part: FrozenPart, progress: Callable[[str], None]) -> Iterator[SceneGraph]:
    for number, graph in enumerate(scenes):
        if number % 100 == 0:
            progress(f"{part.folder}: {number} of {part.count} rooms")
        yield graph


def file_sums(folder: Path) -> dict[str, str]:
    """SHA-256 of each file of a dataset by name."""
    files = sorted(path for path in folder.iterdir() if path.suffix in (".safetensors", ".json", ".jsonl"))
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files if path.name != "part.json"}


def scenes_digest(folder: Path) -> str:
    """A digest of where which objects stand in the scenes of a dataset.

    Of names, categories, hierarchy, matrices and boxes of meshes, lengths to a
    micrometre; so rounded, it is the same on all machines, of which the last bit of
    a cosine may differ.
    """
    found = hashlib.sha256()
    for graph in map(to_scenegraph, open_dataset(folder)):
        words = [graph.title, *graph.name, *(graph.category_name(row) for row in range(len(graph)))]
        found.update("\0".join(words).encode())
        bounds = np.array([mesh.bounds for mesh in graph.meshes]).reshape(-1, 6)
        for numbers in (graph.local, bounds[graph.mesh[graph.mesh >= 0]]):
            found.update(np.rint(numbers * 10**DIGITS).astype("<i8").tobytes())
        found.update(graph.parent.astype("<i4").tobytes())
    return found.hexdigest()
