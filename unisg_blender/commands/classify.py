"""``unisg classify``: what kind of scene it is."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from ..errors import DONE
from ..formats.scene_files import check_kinds, read_scene_file, shown

HELP = "Tell what kind of scene a file holds, by a trained network."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument("path", metavar="FILE", type=Path, help="a scene file")
    parser.add_argument("--model", metavar="M.onnx", type=Path, help="from 'unisg train classifier' (default: shipped)")


def run(args: argparse.Namespace) -> int:
    """Print the chance of each kind, or with ``--json`` one JSON object."""
    from ..predict.scene_kind import SceneModel

    model = SceneModel(args.model)
    check_kinds(args.path, None)
    with shown(args.quiet or args.json, "entities read") as tell:
        graph, _ = read_scene_file(args.path, tell)
    chances = model.classify(graph)
    best = next(iter(chances))
    if args.json:
        kinds = {name: round(value, 6) for name, value in chances.items()}
        print(json.dumps({"file": str(args.path), "kind": best, "chances": kinds}, ensure_ascii=False))
    elif not args.quiet:
        for name, value in chances.items():
            print(f"{name}  {value:.1%}")
    return DONE
