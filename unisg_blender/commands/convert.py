"""``unisg convert``: any scene file to a Blender, USD or JSON file, through the scenegraph."""

from __future__ import annotations

import argparse

from ..errors import DONE
from ..runtime.file_endings import BLENDER, READABLE, WRITABLE, is_of
from .argument_types import PATH
from .common import add_scene, add_scene_options, print_report, read_shown, shown, tell_lost
from .outputs import check_file

HELP = f"Turn a scene file ({', '.join(READABLE)}) into {', '.join(WRITABLE)}, through the scenegraph."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    add_scene(parser, "source", "the file to read")
    parser.add_argument("target", metavar="OUT", type=PATH, help="the file to write; its ending says which kind")
    add_scene_options(parser)
    parser.add_argument("--still", action="store_true", help="leave out how things move in a Blender scene")
    parser.add_argument(
        "--physics", metavar="SHAPE", default="",
        help="make things rigid bodies that collide as box, hull or mesh, with masses, and the building firm, "
        "where the scene says nothing of that (written to .usd files, .xml and .blend)",
    )  # fmt: skip
    parser.add_argument("--realize", action="store_true", help="turn instances into entities of their own")


def run(args: argparse.Namespace) -> int:
    """Read, write, and say what got lost on the way."""
    from ..formats.scene_files import write_scene_file
    from ..scene.realize_instances import realize
    from ..scene.scene_text import summary
    from ..spatial.bodies import simulated_scene

    check_file("OUT", args.target, WRITABLE, [args.source])
    graph, lost = read_shown(
        args, args.source, args.target, geometry=args.geometry, animation=not args.still, scene=args.scene,
        unit="frames" if is_of(args.source, BLENDER) else "entities read",
    )  # fmt: skip
    if args.realize:
        graph = realize(graph)
    if args.physics:
        graph = simulated_scene(graph, args.physics)
    with shown(args.quiet or args.json, "entities written") as tell:  # instanced ones included
        lost.extend(write_scene_file(graph, args.target, tell))
    report = {"in": str(args.source), "out": str(args.target), **summary(graph), "not_represented": list(lost)}
    print_report(args, report, [f"{args.target}: {len(graph)} entities, {len(graph.meshes)} meshes"])
    tell_lost(args, lost)
    return DONE
