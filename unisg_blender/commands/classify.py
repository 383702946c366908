"""``unisg classify``: what kind of scene it is."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..errors import DONE
from .common import add_scene, print_report, read_shown

HELP = "Tell what kind of scene a file holds, by a trained network."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    add_scene(parser)
    parser.add_argument("--model", metavar="M.onnx", type=Path, help="from 'unisg train classifier' (default: shipped)")


def run(args: argparse.Namespace) -> int:
    """Print the chance of each kind, or with ``--json`` one JSON object."""
    from ..predict.scene_kind import SceneModel

    model = SceneModel(args.model)
    graph, _ = read_shown(args, args.file)
    chances = model.classify(graph)
    kinds = {name: round(value, 6) for name, value in chances.items()}
    report = {"file": str(args.file), "kind": next(iter(chances)), "chances": kinds}
    print_report(args, report, (f"{name}  {value:.1%}" for name, value in chances.items()))
    return DONE
