"""``unisg classify``: what kind of scene it is."""

from __future__ import annotations

import argparse

from ..errors import DONE
from .argument_types import PATH
from .common import add_scene, print_report, read_shown, words_of

HELP = "Tell what kind of scene a file holds, or that it is none that the network knows."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    add_scene(parser)
    parser.add_argument("--model", metavar="M.onnx", type=PATH, help="from 'unisg train classifier' (default: shipped)")


def run(args: argparse.Namespace) -> int:
    """Print the kind, or "none of these", and the chance of each, or with ``--json`` one JSON object."""
    from ..predict.scene_kind import SceneModel

    model = SceneModel(args.model)
    graph, _ = read_shown(args, args.file)
    found = model.classify(graph, words_of(args))
    report = {
        "file": str(args.file),
        "kind": found.kind or None,
        "nearest": found.nearest,
        "by_things": found.by_things or None,
        "chances": {name: round(value, 6) for name, value in found.chances.items()},
        "objects": found.objects,
        "objects_known": found.known,
        "distance": None if found.distance is None else round(found.distance, 3),
    }
    chances = ", ".join(f"{name} {value:.1%}" for name, value in found.chances.items())
    print_report(args, report, [*found.lines, f"of the kinds that the model knows: {chances}"])
    return DONE
