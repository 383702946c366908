"""``unisg label``: proposed categories for the objects of a scene that have none."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import DONE, UniSGError
from ..runtime.file_endings import BLENDER, is_of
from .common import add_limit, add_scene, check_at_least, check_folder_of, print_report, read_shown, shown_lines

if TYPE_CHECKING:
    from ..predict.category_proposals import Proposal
    from ..scene import SceneGraph

HELP = "Propose categories for the objects of a scene that have none, from shape, size, name and neighbours."
EVIDENCE = ("shape", "name", "neighbours")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    add_scene(parser)
    parser.add_argument("--best", metavar="N", type=int, default=3, help="categories to name for each object (3)")
    parser.add_argument("--use", metavar="KINDS", default=",".join(EVIDENCE), help="evidence (shape,name,neighbours)")
    parser.add_argument("--all", action="store_true", help="also for objects that have a category")
    add_limit(parser, "objects")
    parser.add_argument("--model", metavar="M", type=Path, help="model of categories (default: the shipped one)")
    parser.add_argument("--out", metavar="OUT", type=Path, help="write the scene with the accepted categories")
    parser.add_argument(
        "--threshold", metavar="P", type=float, default=0.5, help="accept from this confidence on (0.5)"
    )


def run(args: argparse.Namespace) -> int:
    """Read, propose, print; with ``--out`` accept and write."""
    from ..predict.category_model import LabelModel
    from ..predict.category_proposals import propose_categories

    use = _checked(args)
    model = LabelModel.load(args.model)
    graph, _ = read_shown(args, args.file, args.out)
    rows = range(len(graph)) if args.all else None
    proposals = propose_categories(graph, model, rows=rows, best=args.best, use=use)
    accepted = [proposal for proposal in proposals if proposal.confidence >= args.threshold]
    if args.out is not None:
        _write(args.file, args.out, graph, accepted)
    print_report(args, _report(args, graph, proposals, len(accepted)), _lines(args, proposals, len(accepted)))
    return DONE


def _checked(args: argparse.Namespace) -> list[str]:
    use = [kind.strip() for kind in args.use.split(",") if kind.strip()]
    if not use or set(use) - set(EVIDENCE):
        raise UniSGError(f"--use takes some of {', '.join(EVIDENCE)}, not {args.use!r}")
    if args.best < 1 or not 0 <= args.threshold <= 1:
        raise UniSGError("--best must be at least 1, and --threshold lie between 0 and 1")
    check_at_least(args, 0, "limit")
    check_folder_of(args.out)
    return use


def _write(source: Path, out: Path, graph: SceneGraph, accepted: Sequence[Proposal]) -> None:
    from ..formats.scene_files import write_scene_file
    from ..predict.category_proposals import accept

    if not (is_of(source, BLENDER) and is_of(out, BLENDER)):
        write_scene_file(accept(graph, accepted), out)
        return
    from ..blender import objects_by_uid, save_blend
    from ..blender.authoring.identities import assign_category
    from ..blender.blend_files import current_scene

    objects = objects_by_uid(current_scene())  # the file is still open: what the scenegraph does not hold stays in it
    for proposal in accepted:
        if proposal.uid in objects:
            assign_category([objects[proposal.uid]], proposal.best)
    save_blend(out)


def _report(args: argparse.Namespace, graph: SceneGraph, proposals: Sequence[Proposal], accepted: int) -> dict:
    return {
        "file": str(args.file),
        "entities": len(graph),
        "categorised": int((graph.category >= 0).sum()),
        "accepted": accepted,
        "out": None if args.out is None else str(args.out),
        "proposals": [
            {
                "name": proposal.name,
                "uid": proposal.uid,
                "row": proposal.row,
                "categories": [
                    {"category": name, "confidence": round(value, 4)} for name, value in proposal.categories
                ],
            }
            for proposal in proposals
        ],
    }


def _lines(args: argparse.Namespace, proposals: Sequence[Proposal], accepted: int) -> list[str]:
    lines = [
        f"{proposal.name}: " + ", ".join(f"{name} {value:.0%}" for name, value in proposal.categories)
        for proposal in proposals
    ]
    if not proposals:
        return ["nothing to propose: no object without a category has a mesh"]
    lines = shown_lines(args, lines, "objects")
    if args.out is not None:
        lines.append(f"{args.out}: {accepted} of {len(proposals)} proposals accepted")
    return lines
