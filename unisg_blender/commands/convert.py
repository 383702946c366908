"""``unisg convert``: any scene file to a Blender, USD or JSON file, through the scenegraph."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from ..errors import DONE, UniSGError
from ..formats.scene_files import BLENDER, READABLE, WRITABLE, check_kinds, read_scene_file, shown, write_scene_file

HELP = f"Turn a scene file ({', '.join(READABLE)}) into {', '.join(WRITABLE)}, through the scenegraph."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument("source", metavar="IN", type=Path, help="the file to read")
    parser.add_argument("target", metavar="OUT", type=Path, help="the file to write; its ending says which kind")
    parser.add_argument(
        "--geometry",
        choices=("evaluated", "original", "none"),
        default="evaluated",
        help="of Blender scenes: meshes with modifiers applied (default), as they are edited, or none",
    )
    parser.add_argument("--scene", default="", metavar="NAME", help="of a Blender file with several scenes: this one")
    parser.add_argument("--still", action="store_true", help="leave out how things move in a Blender scene")
    parser.add_argument("--realize", action="store_true", help="turn instances into entities of their own")


def run(args: argparse.Namespace) -> int:
    """Read, write, and say what got lost on the way."""
    check_kinds(args.source, args.target)
    if args.target.exists() and args.target.resolve() == args.source.resolve():
        raise UniSGError(f"{args.target}: is the file to be read; choose another name")
    from ..scene.realize_instances import realize
    from ..scene.scene_text import summary

    quiet = args.quiet or args.json
    with shown(quiet, "frames" if args.source.suffix.lower() in BLENDER else "entities read") as tell:
        graph, lost = read_scene_file(
            args.source, tell, geometry=args.geometry, animation=not args.still, scene=args.scene
        )
    if args.realize:
        graph = realize(graph)
    with shown(quiet, "entities written") as tell:  # instanced ones included
        lost += write_scene_file(graph, args.target, tell)
    record = {"in": str(args.source), "out": str(args.target), **summary(graph), "not_represented": lost}
    if args.json:
        print(json.dumps(record, ensure_ascii=False))
    elif not args.quiet:
        print(f"{args.target}: {len(graph)} entities, {len(graph.meshes)} meshes")
        for line in lost:
            print(f"not represented: {line}", file=sys.stderr)
    return DONE
