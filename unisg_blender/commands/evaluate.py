"""``unisg evaluate``: how good are the scenes that a model makes, beside simple rules and real scenes."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import DONE, UniSGError

if TYPE_CHECKING:
    from ..evaluate.generation import Row
    from ..scene import SceneGraph

HELP = "Furnish the rooms of a dataset anew with a model, measure the result, and print baselines beside it."
TRAINING_SCENES = 300
"""Rooms that the baselines learn from, at most."""

COLUMNS = {
    "colliding": "collide %", "off_support": "float %", "outside": "outside %", "refused": "refused %",
    "same_support": "supports %",
}  # fmt: skip


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument("model", metavar="MODEL", type=Path, help="a trained generator")
    parser.add_argument("--data", metavar="DATASET", type=Path, required=True, help="rooms that it was not trained on")
    parser.add_argument(
        "--training", metavar="DATASET", type=Path, help="rooms for the baselines: Gaussian, mean, copy"
    )
    parser.add_argument("--scenes", metavar="N", type=int, default=100, help="how many rooms at most (default: 100)")
    parser.add_argument("--seed", type=int, default=0, help="same seed, same result (default: 0)")
    parser.add_argument("--out", metavar="FILE.json", type=Path, help="write the table there as well")


def run(args: argparse.Namespace) -> int:
    """Measure and print the table."""
    from ..evaluate.generation import compare
    from ..generate import Generator

    if args.scenes < 1:
        raise UniSGError(f"--scenes must be at least 1, not {args.scenes}")
    if args.out is not None and not args.out.parent.is_dir():
        raise UniSGError(f"there is no folder {args.out.parent} to write {args.out.name} to")
    generator = Generator.load(args.model)
    tests = _scenes(args.data, args.scenes)
    training = [] if args.training is None else _scenes(args.training, TRAINING_SCENES)
    known = {name for graph in tests for name in graph.vocabulary} & set(generator.categories)
    if not known:
        raise UniSGError(
            f"{args.data} has none of the categories that the model knows: {', '.join(generator.categories)}"
        )

    def progress(name: str) -> None:
        if not args.quiet:
            print(f"measuring: {name}", file=sys.stderr)

    rows = compare(generator, tests, training, args.seed, progress)
    report = {
        "model": str(args.model), "kind": generator.contract.kind, "data": str(args.data), "seed": args.seed,
        "rows": [row.to_record() for row in rows],
    }  # fmt: skip
    if args.out is not None:
        args.out.write_text(json.dumps(report, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(json.dumps(report, ensure_ascii=False) if args.json else table(rows))
    return DONE


def _scenes(path: Path, most: int | None) -> list[SceneGraph]:
    from itertools import islice

    from ..dataset.reader import open_dataset
    from ..dataset.shapes import scenes_with_shapes

    return list(islice(scenes_with_shapes(open_dataset(path)), most))


def table(rows: list[Row]) -> str:
    """The rows as a Markdown table."""
    head = ["", "scenes", "objects", *COLUMNS.values(), "ms / object"]
    lines = [_line(head), _line(["---"] + ["---:"] * (len(head) - 1))]
    for row in rows:
        record: dict[str, Any] = row.to_record()
        shares = [f"{100 * record[name]:.1f}" for name in COLUMNS]
        spent = f"{row.milliseconds:.1f}" if row.milliseconds else ""
        lines.append(_line([row.name, str(row.scenes), str(row.objects), *shares, spent]))
    return "\n".join(lines)


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"
