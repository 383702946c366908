"""``unisg label``: proposed categories for the objects of a scene that have none."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import DONE, SOME_FAILED, UniSGError
from ..runtime.file_endings import WRITABLE, is_of
from .argument_types import PATH, number, whole
from .common import (
    add_limit,
    add_mapping,
    make_folder,
    print_report,
    read_shown,
    shown_lines,
    words_of,
)
from .outputs import check_file, check_folder

if TYPE_CHECKING:
    from ..predict.category_model import LabelModel
    from ..predict.category_proposals import Proposal
    from ..scene import SceneGraph

HELP = (
    "Propose categories for the objects of a scene that have none, from shape, name, neighbours, and place in the room."
)
EVIDENCE = ("shape", "name", "neighbours", "structure")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument("files", metavar="FILE", type=PATH, nargs="+", help="scene files")
    add_mapping(parser)
    parser.add_argument(
        "--best", metavar="N", type=whole(1, 1000), default=3, help="categories to name for each object (3)"
    )
    parser.add_argument("--use", metavar="KINDS", default=",".join(EVIDENCE), help=f"evidence ({','.join(EVIDENCE)})")
    parser.add_argument("--all", action="store_true", help="also for objects that have a category")
    add_limit(parser, "objects of a file")
    parser.add_argument("--model", metavar="M", type=PATH, help="model of categories (default: the shipped one)")
    parser.add_argument(
        "--out", metavar="OUT", type=PATH, help="write the scene with the accepted categories; of several files: folder"
    )
    parser.add_argument(
        "--threshold", metavar="P", type=number(0, 1), default=0.6, help="accept from this confidence on (0.6)"
    )


def run(args: argparse.Namespace) -> int:
    """Read, propose, print; with ``--out`` accept and write. Of several files one that fails costs only itself."""
    from ..predict.category_model import LabelModel

    use = _checked(args)
    model = LabelModel.load(args.model)
    targets = _targets(args)
    reports, lines, failed = [], [], 0
    for file, out in targets.items():
        try:
            report, told = _label(args, file, out, model, use)
        except UniSGError as error:
            if len(targets) == 1:
                raise
            failed += 1
            print(f"unisg label: {error}", file=sys.stderr)
            continue
        reports.append(report)
        lines += [*([f"{file}:"] if len(targets) > 1 else []), *told]
    print_report(args, {"files": reports, "failed": failed}, lines)
    return SOME_FAILED if failed else DONE


def _targets(args: argparse.Namespace) -> dict[Path, Path | None]:
    """Where each file's scene goes: to ``--out``, or with several files into that folder, which is made."""
    files = list(dict.fromkeys(args.files))
    if args.out is None:
        return dict.fromkeys(files)
    if len(files) == 1:
        check_file("--out", args.out, WRITABLE, files)
        return {files[0]: args.out}
    names = Counter(file.name for file in files)
    name, count = names.most_common(1)[0]
    if count > 1:
        raise UniSGError(f"{count} of the files are called {name}: label them one by one, or without --out")
    if any(file.parent.resolve() == args.out.resolve() for file in files):
        raise UniSGError(f"--out {args.out} is the folder of the files themselves: choose another")
    check_folder("--out", args.out)
    make_folder(args.out)
    return {file: args.out / file.name for file in files}


def _label(
    args: argparse.Namespace, file: Path, out: Path | None, model: LabelModel, use: list[str]
) -> tuple[dict[str, Any], list[str]]:
    """The report about a file, and its lines; with ``out`` its scene is written."""
    from ..predict.category_proposals import propose_categories

    graph, _ = read_shown(args, file, out)
    rows = range(len(graph)) if args.all else None
    proposals = propose_categories(graph, model, rows=rows, best=args.best, use=use, words=words_of(args))
    accepted = [proposal for proposal in proposals if proposal.confidence >= args.threshold]
    if out is not None:
        _write(file, out, graph, accepted)
    return _report(file, out, graph, proposals, len(accepted)), _lines(args, out, proposals, len(accepted))


def _checked(args: argparse.Namespace) -> list[str]:
    use = [kind.strip() for kind in args.use.split(",") if kind.strip()]
    if not use or set(use) - set(EVIDENCE):
        raise UniSGError(f"--use takes some of {', '.join(EVIDENCE)}, not {args.use!r}")
    return use


def _write(source: Path, out: Path, graph: SceneGraph, accepted: Sequence[Proposal]) -> None:
    from ..formats.scene_files import opened_by_blender, write_scene_file
    from ..predict.category_proposals import accept

    graph = accept(graph, accepted)
    if not (is_of(out, (".blend",)) and opened_by_blender(source)):
        write_scene_file(graph, out)
        return
    from ..blender import objects_by_uid, save_blend
    from ..blender.authoring.identities import assign_category
    from ..blender.blend_files import current_scene
    from ..scene.properties import CATEGORY

    objects = objects_by_uid(current_scene())  # the file is still open: what the scenegraph does not hold stays in it
    for row, uid in enumerate(graph.uid):
        category = graph.category_name(row)
        if category and uid in objects and objects[uid].get(CATEGORY) != category:
            assign_category([objects[uid]], category)
    save_blend(out)


def _report(
    file: Path, out: Path | None, graph: SceneGraph, proposals: Sequence[Proposal], accepted: int
) -> dict[str, Any]:
    return {
        "file": str(file),
        "entities": len(graph),
        "categorised": int((graph.category >= 0).sum()),
        "accepted": accepted,
        "out": None if out is None else str(out),
        "proposals": [
            {
                "name": proposal.name,
                "uid": proposal.uid,
                "row": proposal.row,
                "known": proposal.known,
                "categories": [
                    {"category": name, "confidence": round(value, 4)} for name, value in proposal.categories
                ],
            }
            for proposal in proposals
        ],
    }


def _lines(args: argparse.Namespace, out: Path | None, proposals: Sequence[Proposal], accepted: int) -> list[str]:
    lines = [
        f"{proposal.name}: {'' if proposal.known else 'not known; perhaps '}"
        + ", ".join(f"{name} {value:.0%}" for name, value in proposal.categories)
        for proposal in proposals
    ]
    if not proposals:
        return ["nothing to propose: no object without a category has a mesh"]
    lines = shown_lines(args, lines, "objects")
    if out is not None:
        lines.append(f"{out}: {accepted} of {len(proposals)} proposals accepted")
    return lines
