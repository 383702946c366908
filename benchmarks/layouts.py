"""Support prediction in rooms that others designed: average precision and F1 of each method, as Markdown and JSON.

    python benchmarks/layouts.py FOLDER --model MODEL.onnx --out docs/results/layouts.json

FOLDER has ithor/objects.json, virtualhome/*_graph.json, tdw/floorplan_layouts.json and models_core.json.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from unisg_blender.experiments.layouts.designed_rooms import read_layouts
from unisg_blender.experiments.layouts.designed_supports import (
    OURS,
    by_boxes,
    by_model,
    by_rule,
    by_rule_on_top,
    by_topology,
    support_table,
    times,
)
from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.generate import Generator
from unisg_blender.predict.support_prediction import TopologyModel


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--model", type=Path, action="append", default=[])
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    rooms = read_layouts(args.folder)
    topology = TopologyModel()
    methods = [
        ("geometric rule", by_rule, 0.5),
        ("geometric rule, on top of only", by_rule_on_top, 0.5),
        ("boxes: overlap and gap", by_boxes, 0.5),
        ("topology network", by_topology(topology), topology.threshold),
    ]
    known = {}
    for path in args.model:
        generator = Generator.load(path)
        learned = by_model(generator)
        methods += [(path.stem, learned, 0.5), (f"{path.stem} x boxes", times(learned, by_boxes), 0.1)]
        names = sorted({name for room in rooms for name in room.graph.vocabulary})
        known[path.stem] = [name for name in names if OURS.get(name, name) in generator.categories]
    rows = [row.to_record() for row in support_table(rooms, methods)]
    cells = [
        [f"{row['room']}: {row['method']}", str(row["objects"]), str(row["pairs"])]
        + [f"{row[name]:.3f}" for name in ("average_precision", "f1")]
        for row in rows
    ]
    print(markdown_table(["room and method", "things", "pairs", "average precision", "F1"], cells))
    if args.out is not None:
        write_results(args.out, {"rows": rows, "known_categories": known})


if __name__ == "__main__":
    main()
