"""``unisg render``: pictures of scenes with labels, and the scenegraph of what each shows."""

from __future__ import annotations

import argparse
import re
import time
from pathlib import Path
from typing import Any

from ..batches.batch_folder import GRAPHS
from ..batches.batch_plan import PICTURES, BatchOptions, Task, plan_rooms
from ..batches.pictures.contact_sheet import write_contact_sheet
from ..batches.pictures.view_choice import KINDS, parse_views
from ..dataset import open_dataset
from ..dataset.format.writer import MANIFEST
from ..errors import DONE, SOME_FAILED, MissingPackageError, UniSGError
from ..formats.scene_files import load_blender
from ..runtime.atomic_files import checksum_of
from ..runtime.process_pool import processors
from .argument_types import PATH, SEED, named, whole
from .batch_options import add_running_options, made_rooms
from .common import add_form, add_mapping, noted, print_report, vocabulary_of
from .given_scenes import is_dataset
from .outputs import check_file, check_folder

HELP = "Take pictures of scenes, with masks, depth, boxes and the scenegraph of what each shows."
ENGINES = ("cycles", "workbench", "eevee")
LARGEST, ROWS = 16_384, 6
SIZE = re.compile(r"(\d{1,5})(?:x(\d{1,5}))?")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument("inputs", metavar="IN", type=named, nargs="+", help="scene files, folders, globs and datasets")
    parser.add_argument("--out", metavar="DIR", type=PATH, required=True, help="folder of pictures and labels")
    parser.add_argument(
        "--views", metavar="WHAT",
        help=f'such as "eye=4,corners=2,Chair=1": {", ".join(KINDS)}, or a category to look at (default: the cameras '
        "of the scene, or eye=2, or dollhouse=2 where nobody can stand)",
    )  # fmt: skip
    parser.add_argument("--size", metavar="WxH", default="512", help="pixels of a picture (512)")
    parser.add_argument("--engine", choices=ENGINES, default="cycles", help="what renders the pictures (cycles)")
    parser.add_argument("--samples", metavar="N", type=whole(1, 65536), default=32, help="of each pixel in cycles (32)")
    parser.add_argument("--seed", metavar="S", type=SEED, default=0, help="of the chosen views (0)")
    parser.add_argument(
        "--vocabulary", metavar="DATASET", type=PATH, help="number categories as it does (COCO: from 1 on)"
    )
    parser.add_argument(
        "--sheet", metavar="FILE", type=PATH, help="draw the first pictures beside their masks, depth and scenegraphs"
    )
    add_mapping(parser)
    add_form(parser)
    add_running_options(parser)


def run(args: argparse.Namespace) -> int:
    """Take the pictures, show progress and one line per scene that failed; exit status 3 if any did."""
    import sys

    from ..dataset.export.sources import find_sources
    from ..words import read_mapping

    check_folder("--out", args.out)
    if args.sheet is not None:
        check_file("--sheet", args.sheet, (".png", ".pdf", ".svg"))
    settings: dict[str, Any] = {
        "views": None if args.views is None else parse_views(args.views),
        "size": picture_size(args.size),
        "engine": args.engine,
        "samples": args.samples,
        "mapping": None if args.mapping is None else read_mapping(args.mapping),
        "assets": "" if args.assets is None else str(args.assets.absolute()),
    }
    datasets = [path for path in map(Path, args.inputs) if is_dataset(path)]
    files = [path for path in args.inputs if Path(path) not in datasets]
    planned = plan_rooms(find_sources(files), 1, 0, "") if files else []
    tasks = [{**task, "room": task["room"][:-6], "seed": args.seed} for task in planned]
    tasks += [{**task, "seed": args.seed} for path in datasets for task in dataset_tasks(path)]
    load_blender()
    if "bpy" not in sys.modules:
        raise MissingPackageError("bpy", "blender")
    options = BatchOptions(
        "", settings, PICTURES, args.form, vocabulary=vocabulary_of(args), timeout=args.timeout,
        memory=int(args.memory * 2**30), threads=max(1, processors() // (args.jobs or processors())),
    )  # fmt: skip
    started = time.perf_counter()
    records = made_rooms(args, tasks, options)
    seconds = time.perf_counter() - started
    bad = sum(record["status"] == "failed" for record in records)
    pictures = sum(len(record.get("pictures", ())) for record in records)
    if args.sheet is not None:
        names = [name for record in records for name in record.get("pictures", ())]
        write_contact_sheet(args.out, args.out / GRAPHS, args.sheet, names[:ROWS])
    report = {"out": str(args.out), "scenes": len(records), "failed": bad, "pictures": pictures}
    words = f", {bad} failed" if bad else ""
    line = f"{args.out}: {pictures} pictures of {len(records)} scenes{words} in {seconds:.1f} s"
    print_report(args, report | {"seconds": round(seconds, 3), "records": records}, [*noted(records), line])
    return SOME_FAILED if bad else DONE


def dataset_tasks(folder: Path) -> list[Task]:
    """A task for each scene of a dataset, named after its folder and its number."""
    total, many = checksum_of(folder / MANIFEST), len(open_dataset(folder))
    shared = {"path": str(folder.absolute()), "sha256": total}
    return [{"room": f"{folder.resolve().name}-{number:05d}", "scene": number, **shared} for number in range(many)]


def picture_size(text: str) -> list[int]:
    """Width and height out of "512" or "640x480"; UniSGError for anything else."""
    found = SIZE.fullmatch(text.strip().lower())
    size = [int(found[1]), int(found[2] or found[1])] if found else [0, 0]
    if not 1 <= min(size) <= max(size) <= LARGEST:
        raise UniSGError(f"--size must be pixels up to {LARGEST}, such as 512 or 640x480, not {text[:40]!r}")
    return size
