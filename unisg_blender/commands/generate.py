"""``unisg generate``: new objects for an empty or an existing scene."""

from __future__ import annotations

import argparse
import time
from collections import Counter
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..batches.made_room import MadeRoom
from ..batches.room_files import open_room
from ..errors import DONE, SOME_FAILED, UniSGError
from ..formats.scene_files import check_kinds, load_blender, write_scene_file
from ..runtime.atomic_files import replacing
from ..runtime.file_endings import WRITABLE, is_of
from .argument_types import PATH, SEED, named, number, whole
from .batch_options import add_batch_options, batch_reason
from .common import add_limit, add_mapping, print_report, read_shown, shown_lines, words_of
from .outputs import check_file
from .room_picture import room_view

if TYPE_CHECKING:
    from ..generate import Generated, Sampling

HELP = "Add objects to an empty or an existing scene with a trained model."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    from ..generate.propose.place_sampling import MOST_CANDIDATES, MOST_VARIETY

    parser.add_argument(
        "--model", metavar="M", type=PATH, help="trained model, or name of a shipped one (default: operating_room)"
    )
    parser.add_argument(
        "--scene", metavar="IN", type=named, nargs="+",
        help="scene file to complete (default: an empty scene); for a batch files, folders and globs",
    )  # fmt: skip
    add_mapping(parser)
    parser.add_argument("--add", metavar="WHAT", help='such as "Scalpel=2,Monitor=1" (default: a whole room)')
    parser.add_argument("--on", metavar="NAME", default="", help="thing of the scene on which all of it is wanted")
    parser.add_argument("--beside", metavar="NAME", default="", help="thing of the scene beside which it is wanted")
    parser.add_argument(
        "--in", dest="within", metavar="ROOM", default="",
        help='room of the scene in which it is wanted: "kitchen", "the bedroom", or its number (inspect --structure)',
    )  # fmt: skip
    parser.add_argument(
        "--out",
        metavar="OUT",
        type=PATH,
        required=True,
        help=f"file to write: {', '.join(WRITABLE)}; for a batch a folder",
    )
    parser.add_argument("--seed", type=SEED, help="same seed, same result (default: another result every time)")
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--sequential", action="store_true", help="one by one, each sees the ones before (default)")
    mode.add_argument("--bulk", action="store_true", help="propose places for all at once")
    parser.add_argument(
        "--variety", metavar="V", type=number(0, MOST_VARIETY), default=1.0,
        help="1 draws places as the model learned (default), 0 takes the likeliest, more draws unlikely ones as well",
    )  # fmt: skip
    parser.add_argument(
        "--candidates", metavar="N", type=whole(0, MOST_CANDIDATES), default=0,
        help="places drawn for each thing, of which those to be tried are chosen (default: as is usual for the model)",
    )  # fmt: skip
    parser.add_argument("--raw", action="store_true", help="take the model's first proposals without settling them")
    parser.add_argument(
        "--no-ways", action="store_true", help="let things cut the floor into parts between which nobody can walk"
    )
    parser.add_argument(
        "--no-behaviour", action="store_true", help="give the new objects no actions and leave the lesson alone"
    )
    parser.add_argument(
        "--render", metavar="PNG", type=PATH, help="write a picture of the result, a look into the room"
    )
    parser.add_argument(
        "--render-categories", action="store_true", help="colours by category there, not the things' own"
    )
    add_limit(parser, "objects")
    add_batch_options(parser)


def run(args: argparse.Namespace) -> int:
    """Generate, write, report; exit status 3 if some objects found no place, or rooms of a batch failed."""
    if batch_reason(args):
        from .generate_batch import run_batch

        return run_batch(args)
    args.scene = None if args.scene is None else Path(args.scene[0])
    import numpy as np

    from ..generate import Generator
    from ..generate.counts import parse_counts
    from ..pretrained import find_generator
    from ..scene import SceneBuilder

    _check(args)
    generator = Generator.load(find_generator(args.model))
    words = words_of(args)
    asked = None if args.add is None else generator.understood(parse_counts(args.add), words)
    scene = SceneBuilder("Room").build() if args.scene is None else read_shown(args, args.scene)[0]
    foreign = generator.read(scene, words, near=args.on or args.beside, within=args.within).lines()
    if not (args.json or args.quiet):
        print("\n".join(foreign) + "\n" * bool(foreign), end="", flush=True)
    counts = asked or generator.sample_counts(np.random.default_rng(args.seed), scene, words)
    start = time.perf_counter()
    result = generator.add(
        scene, counts, args.seed, bulk=args.bulk, settle=not args.raw, behaviour=not args.no_behaviour, on=args.on,
        beside=args.beside, within=args.within, words=words, ways=not args.no_ways, sampling=sampling_of(args),
    )  # fmt: skip
    spent = time.perf_counter() - start
    note = _write(args, result)
    report = {"out": str(args.out), **to_report(result), "seconds": round(spent, 4)}
    report |= {"picture": note} if note else {}
    print_report(args, report, _lines(args, report))
    return SOME_FAILED if result.refused else DONE


def sampling_of(args: argparse.Namespace) -> Sampling:
    """How places are drawn; UniSGError if that is out of range."""
    from ..generate import Sampling

    return Sampling(args.variety, args.candidates)


def _check(args: argparse.Namespace) -> None:
    check_file("--out", args.out, WRITABLE, [args.scene, args.render])
    check_file("--render", args.render, (".png",))
    if (args.on or args.beside or args.within) and (args.scene is None or args.add is None):
        raise UniSGError(
            "--on, --beside and --in need a --scene that has such a thing or room, and --add for what is wanted there"
        )
    if args.render is not None:
        load_blender()
    check_kinds(args.scene, args.out)


def _write(args: argparse.Namespace, result: Generated) -> str:
    """Write the scene and its picture, both or none of them; what is wrong with the picture, "" for nothing."""
    note, in_blender = "", is_of(args.out, (".blend",))
    with nullcontext() if args.render is None else replacing(args.render) as picture:
        if in_blender or picture is not None:
            open_room(MadeRoom(result.scene, {}, base=args.scene, new=result.rows))
        if picture is not None:
            from ..blender import render_picture

            note = render_picture(
                picture, leave_out=("Ceiling",), room=room_view(result), by_category=args.render_categories
            )
        if in_blender:
            from ..blender import save_blend

            save_blend(args.out)
        else:
            write_scene_file(result.scene, args.out)
    return note


def to_report(result: Generated) -> dict[str, Any]:
    """What was generated, JSON-ready."""
    return {
        "entities": len(result.scene),
        "added": result.added,
        "refused": len(result.refused),
        "actions": result.actions,
        "scene": None if result.reading is None else result.reading.to_record(),
        "objects": [placement.to_record() for placement in result.objects],
    }


def _lines(args: argparse.Namespace, report: dict[str, Any]) -> list[str]:
    lines = [_placed(item) for item in report["objects"] if not item["refused"]]
    refused = Counter((item["category"], item["note"]) for item in report["objects"] if item["refused"])
    return [
        *shown_lines(args, lines, "objects"),
        *(f"{count} x {category}: no place: {note}" for (category, note), count in refused.items()),
        *([f"{args.render}: {report['picture']}"] if "picture" in report else []),
        f"{report['out']}: {report['added']} objects added, {report['refused']} refused, {report['seconds']} s",
    ]


def _placed(item: dict[str, Any]) -> str:
    x, y, z = (row[3] for row in item["world"][:3])
    where = item["support"] or "the ground"
    note = f" ({item['note']})" if item["note"] else ""
    note += f"; plays in: {', '.join(item['actions'])}" if item["actions"] else ""
    return f"{item['name']} on {where} at ({x:.2f}, {y:.2f}, {z:.2f}), {item['milliseconds']} ms{note}"
