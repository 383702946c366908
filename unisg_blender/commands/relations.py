"""``unisg relations``: which object stands on, in, beside which, by geometry; or on which, by a trained network."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence

from ..errors import DONE, UniSGError
from ..formats.scene_files import write_scene_file
from ..runtime.file_endings import WRITABLE
from ..scene.graph import SceneGraph
from ..spatial.directions import OPPOSITE
from ..spatial.relation_tolerances import RelationTolerances
from ..spatial.relations import KINDS, Found, find_relations, relate
from .argument_types import PATH, number
from .common import add_limit, add_scene, print_report, read_shown, shown_lines
from .outputs import check_file

HELP = "Tell which thing stands on, in, above or beside which other, from geometry, or what is on what by a network."
CONVERSE = OPPOSITE | {kind: other for other, kind in OPPOSITE.items()} | {"connected_to": "connected_to"}
TOUCHING = 0.5
FARTHEST = 1e6
LIMITS = {"gap": (0, TOUCHING), "overlap": (0, TOUCHING), "heading": (-FARTHEST, FARTHEST)}
LENGTHS = {
    "gap": "largest distance at which surfaces touch, metres",
    "overlap": "largest depth at which surfaces touch, metres",
    "beside": "largest horizontal distance of things beside each other, metres",
    "above": "largest height at which one thing is told to be above another, metres",
    "heading": "direction in which the viewer looks, radians from +Y: it decides left, right, in front, behind",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    add_scene(parser)
    parser.add_argument("--kind", action="append", choices=KINDS, metavar="KIND", help=f"only this: {', '.join(KINDS)}")
    parser.add_argument(
        "--model",
        nargs="?",
        const="",
        metavar="M.onnx",
        help="tell what is on top of what by a network (the shipped one)",
    )
    add_limit(parser, "relations, each pair of objects once")
    parser.add_argument("--out", type=PATH, metavar="FILE", help="write the scene with its relations to this file")
    for name, text in LENGTHS.items():
        default, kind = getattr(RelationTolerances(), name), number(*LIMITS.get(name, (0, FARTHEST)))
        parser.add_argument(f"--{name}", type=kind, default=default, metavar="X", help=f"{text} ({default})")


def run(args: argparse.Namespace) -> int:
    """Print counts and one line per relation, or with ``--json`` all of them as one JSON object."""
    check_file("--out", args.out, WRITABLE, [args.file])
    if args.model is not None:
        return _run_model(args)
    tolerances = RelationTolerances(**{name: getattr(args, name) for name in LENGTHS})
    graph, _ = read_shown(args, args.file, args.out)
    found = [entry for entry in find_relations(graph, tolerances) if not args.kind or entry[1] in args.kind]
    if args.out is not None:
        write_scene_file(relate(graph, tolerances=tolerances), args.out)
    report = {"file": str(args.file), "relations": _records(graph, found)}
    print_report(args, report, _lines(args, graph, found))
    return DONE


def _run_model(args: argparse.Namespace) -> int:
    """The same by a trained network; with ``--out`` it replaces what the scene says about what is on top of what."""
    from ..predict.support_prediction import KIND, TopologyModel, with_supports

    if args.kind not in (None, [KIND]):
        raise UniSGError(f"the network knows {KIND!r} only: leave out --kind, or --model")
    model = TopologyModel(args.model or None)
    graph, _ = read_shown(args, args.file, args.out)
    found = model.find(graph)
    if args.out is not None:
        write_scene_file(with_supports(graph, found), args.out)
    records = _records(graph, [entry[:3] for entry in found])
    chances = [record | {"chance": entry[3]} for record, entry in zip(records, found, strict=True)]
    lines = _lines(args, graph, [entry[:3] for entry in found], [f"  {entry[3]:.0%}" for entry in found])
    print_report(args, {"file": str(args.file), "relations": chances}, lines)
    return DONE


def _lines(
    args: argparse.Namespace, graph: SceneGraph, found: list[Found], marks: Sequence[str] | None = None
) -> list[str]:
    """How many relations of each kind there are, and the first of them: what carries and holds before directions."""
    if not found:
        return [f"{args.file}: no such relation between its {len(graph)} entities"]
    told: dict[Found, str] = {}
    for place in sorted(range(len(found)), key=lambda place: KINDS.index(found[place][1])):
        subject, kind, target = found[place]
        if (target, CONVERSE.get(kind, ""), subject) not in told:
            mark = marks[place] if marks else ""
            told[found[place]] = f"{graph.name[subject]}  {kind.replace('_', ' ')}  {graph.name[target]}{mark}"
    counts = Counter(kind.replace("_", " ") for _, kind, _ in told)
    total = ", ".join(f"{kind} {count}" for kind, count in counts.items())
    return [*shown_lines(args, list(told.values()), "relations"), f"{args.file}: {total}"]


def _records(graph: SceneGraph, found: list[Found]) -> list[dict[str, str]]:
    return [
        {
            "subject": graph.name[subject],
            "subject_uid": graph.uid[subject],
            "kind": kind,
            "target": graph.name[target],
            "target_uid": graph.uid[target],
        }
        for subject, kind, target in found
    ]
