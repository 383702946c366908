"""``unisg world``: make procedural scenes and write them as files or as a dataset."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import DONE, UniSGError
from ..runtime.atomic_files import write_file
from ..runtime.process_pool import processes
from ..worlds.many import make_many

if TYPE_CHECKING:
    from ..runtime.progress import Progress
    from ..scene.graph import SceneGraph

HELP = "Make procedural scenes."
FORMATS = ("blend", "usda", "dataset", "json")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    from ..poses import FORMS
    from ..worlds import WORLDS

    parser.add_argument("name", metavar="NAME", choices=WORLDS, help="which world: " + ", ".join(WORLDS))
    parser.add_argument("--count", metavar="N", type=int, default=1, help="how many scenes (1)")
    parser.add_argument("--out", metavar="DIR", type=Path, required=True, help="folder of the files, or of the dataset")
    parser.add_argument("--seed", metavar="S", type=int, default=0, help="the scenes have the seeds S, S+1, ... (0)")
    parser.add_argument("--format", choices=FORMATS, default="blend", help="what to write (blend)")
    parser.add_argument("--form", choices=FORMS, default="quaternion", help="form of a dataset's poses (quaternion)")
    parser.add_argument("--jobs", metavar="N", type=int, help="scenes made at a time (one per processor)")
    parser.add_argument("--overwrite", action="store_true", help="replace files or a dataset in that folder")


def run(args: argparse.Namespace) -> int:
    """Make the scenes and write them."""
    from ..runtime.progress import Progress

    if args.count < 1 or args.seed < 0 or (args.jobs is not None and args.jobs < 1):
        raise UniSGError("--count and --jobs must be at least 1, and --seed must not be negative")
    started = time.perf_counter()
    bar = Progress(args.count, "scenes", args.quiet)
    try:
        files = _write_dataset(args, bar) if args.format == "dataset" else _write_files(args, bar)
    finally:
        bar.close()
    seconds = time.perf_counter() - started
    if args.json:
        report = {"world": args.name, "seed": args.seed, "scenes": args.count, "seconds": round(seconds, 3)}
        print(json.dumps(report | {"format": args.format, "out": str(args.out), "files": files}))
    elif not args.quiet:
        print(f"{args.out}: {args.count} scenes of {args.name} in {seconds:.1f} s")
    return DONE


def _scenes(args: argparse.Namespace, bar: Progress) -> Iterator[SceneGraph]:
    seeds = range(args.seed, args.seed + args.count)
    for done, graph in enumerate(make_many(args.name, seeds, processes(args.jobs)), start=1):
        yield graph
        bar.update(done)


def _write_dataset(args: argparse.Namespace, bar: Progress) -> list[str]:
    from ..dataset import Sample, write_dataset

    scenes = (Sample(graph, graph.title, args.name) for graph in _scenes(args, bar))
    write_dataset(scenes, args.out, args.form, overwrite=args.overwrite)
    return []


def _write_files(args: argparse.Namespace, bar: Progress) -> list[str]:
    """One file per scene, named after world and seed; nothing is begun if one of them is there already."""
    paths = [args.out / f"{args.name}-{args.seed + number:05d}.{args.format}" for number in range(args.count)]
    taken = next((path for path in paths if path.exists()), None)
    if taken is not None and not args.overwrite:
        raise UniSGError(f"{taken} exists already: choose another folder, or use --overwrite")
    write = {"blend": _write_blend, "usda": _write_usda, "json": _write_json}[args.format]
    try:
        args.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UniSGError(f"cannot make the folder {args.out}: {error.strerror}") from None
    for path, graph in zip(paths, _scenes(args, bar), strict=True):
        write(graph, path)
    return [str(path) for path in paths]


def _write_blend(graph: SceneGraph, path: Path) -> None:
    from ..blender import new_file, save_blend, write_scene

    new_file()
    import bpy

    write_scene(graph, bpy.context.scene)
    save_blend(path)


def _write_usda(graph: SceneGraph, path: Path) -> None:
    from ..usd import write_usd

    write_usd(graph, path)


def _write_json(graph: SceneGraph, path: Path) -> None:
    """Summary, records of all entities and the lessons, for eyes and for other tools."""
    from ..scene.lesson_node import lesson_to_json
    from ..scene.scene_text import summary, to_records

    lsa = graph.components.get("lsa")
    lessons = [] if lsa is None else [json.loads(lesson_to_json(lesson)) for lesson in lsa.columns["data"]]
    record = summary(graph) | {"entities": to_records(graph), "lessons": lessons}
    write_file(path, json.dumps(record, ensure_ascii=False))
