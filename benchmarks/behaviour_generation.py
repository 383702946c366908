"""How well new objects get their behaviour: the network beside simple rules, as Markdown and JSON.

    python benchmarks/behaviour_generation.py MODEL.onnx --data TEST_ROOMS --scenes 300 --play 100 --out FILE.json

MODEL.behaviour.onnx must lie beside the model. Also furnishes ``--rooms`` rooms with a lesson each and plays these.
"""

from __future__ import annotations

import argparse
import sys
import time
from itertools import islice
from pathlib import Path

import numpy as np

from unisg_blender.behaviour import check_scene, operations
from unisg_blender.dataset.format.reader import open_dataset
from unisg_blender.dataset.scenes_with_shapes import scenes_with_shapes
from unisg_blender.experiments.behaviour.behaviour_benchmark import compare_behaviour, plays_to_the_end
from unisg_blender.experiments.reports import machine, markdown_table, write_json
from unisg_blender.generate import Generator
from unisg_blender.scene import SceneBuilder

COLUMNS = (
    "scenes", "actions", "recall", "usual_recall", "precision", "exact", "entities", "stage", "order", "thresholds",
    "pose_cm", "pose_degrees", "answers", "sound", "played", "milliseconds",
)  # fmt: skip


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=Path)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--play", type=int, default=100)
    parser.add_argument("--rooms", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    generator = Generator.load(args.model)
    graphs = list(islice(scenes_with_shapes(open_dataset(args.data)), args.scenes))
    rows = compare_behaviour(generator, graphs, args.seed, args.play, lambda name: print(name, file=sys.stderr))
    records = [row.to_record() for row in rows]
    cells = ([str(record[name]) for name in ("name", *COLUMNS)] for record in records)
    print(markdown_table(["", *COLUMNS], cells))
    rooms = [whole_room(generator, args.seed + number) for number in range(args.rooms)]
    for room in rooms:
        print(room)
    if args.out is not None:
        write_json(args.out, {"machine": machine(), "rows": records, "rooms": rooms})


def whole_room(generator: Generator, seed: int) -> dict[str, object]:
    """Furnish a room out of nothing, and play its lesson."""
    counts = generator.sample_counts(np.random.default_rng(seed))
    start = time.process_time()
    made = generator.add(SceneBuilder("Room").build(), counts, seed)
    spent = time.process_time() - start
    return {
        "seed": seed, "objects": made.added, "refused": len(made.refused), "actions": made.actions,
        "lessons": len(operations(made.scene)), "problems": [item.message for item in check_scene(made.scene)],
        "played": plays_to_the_end(made.scene), "notes": sorted({item.note for item in made.objects if item.note}),
        "seconds": round(spent, 2),
    }  # fmt: skip


if __name__ == "__main__":
    main()
