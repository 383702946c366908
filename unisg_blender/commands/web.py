"""``unisg web``: a scene and its lesson as a page that a browser plays."""

from __future__ import annotations

import argparse
from contextlib import closing, suppress
from pathlib import Path

from ..errors import DONE, UniSGError
from .argument_types import PATH, whole
from .common import add_scene, add_scene_options, make_folder, print_report, read_shown, tell_lost
from .outputs import check_file, check_folder

HELP = "Make a page of a scene, in which a browser plays its lesson: a folder for any static host, or a single file."


PAGES = (".html",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    add_scene(parser)
    add_scene_options(parser)
    parser.add_argument(
        "--out", metavar="DIR", type=PATH, required=True, help="folder of the site; with --single a .html"
    )
    parser.add_argument("--single", action="store_true", help="one page that opens from disk")
    parser.add_argument("--serve", action="store_true", help="show the site on 127.0.0.1 until Ctrl+C")
    parser.add_argument("--port", type=whole(0, 65535), default=8000, metavar="N", help="where to show it (8000)")


def run(args: argparse.Namespace) -> int:
    """Write the page, say what it cannot do, and show it if that is asked for."""
    from ..runtime.made_files import check_made, mark_made
    from ..web.site import NAMES, write_page, write_site

    if args.single and args.serve:
        raise UniSGError("--serve shows a folder: leave out --single")
    if args.out.suffix.lower() in PAGES and not (args.single or args.out.is_dir()):
        raise UniSGError(f"{args.out} is the name of a page, and a folder is made: add --single, or give another --out")
    if args.single:
        check_file("--out", args.out, PAGES, [args.file])
    else:
        check_folder("--out", args.out)
        check_made(args.out, NAMES)
    graph, lost = read_shown(args, args.file, geometry=args.geometry, scene=args.scene)
    if args.single:
        lost.extend(write_page(graph, args.out))
    else:
        make_folder(args.out)
        mark_made(args.out, NAMES)
        lost.extend(write_site(graph, args.out))
    report = {"in": str(args.file), "out": str(args.out), "entities": len(graph), "not_represented": list(lost)}
    print_report(args, report, [f"{args.out}: {len(graph)} entities"])
    tell_lost(args, lost)
    if args.serve:
        _serve(args.out, args.port, args.quiet or args.json)
    return DONE


def _serve(folder: Path, port: int, quiet: bool) -> None:
    from ..web.local_server import LocalServer

    server = LocalServer(folder, port)
    if not quiet:
        print(f"{server.address} (Ctrl+C ends it)", flush=True)
    with closing(server), suppress(KeyboardInterrupt):
        server.wait()
