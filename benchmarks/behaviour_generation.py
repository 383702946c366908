"""How well new objects get their behaviour: the network beside simple rules, as Markdown and JSON.

    python benchmarks/behaviour_generation.py --out docs/results/behaviour_generation.json

With the shipped models, in rooms of unisg-rooms that they were not trained on. Also furnishes ``--rooms`` rooms of each
kind out of nothing, each with its lesson, and plays these.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.behaviour import check_scene, operations
from unisg_blender.experiments.behaviour.behaviour_benchmark import compare_behaviour, plays_to_the_end
from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.generate import Generator
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder
from unisg_blender.worlds import WORLDS

FIRST = 100_000
"""The seed of the first test room."""

ROOMS = ("operating-room", "living-room")
COLUMNS = (
    "scenes", "actions", "recall", "usual_recall", "precision", "exact", "entities", "stage", "order", "thresholds",
    "pose_cm", "pose_degrees", "answers", "sound", "played", "milliseconds",
)  # fmt: skip


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--play", type=int, default=30)
    parser.add_argument("--rooms", type=int, default=15)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    rows, rooms = [], []
    for world in ROOMS:
        generator = Generator.load(find_generator(world.replace("-", "_")))
        graphs = [WORLDS[world](FIRST + number) for number in range(args.scenes)]
        found = compare_behaviour(generator, graphs, 0, args.play, lambda name: print(name, file=sys.stderr))
        rows += [{"world": world} | row.to_record() for row in found]
        rooms += [{"world": world} | whole_room(generator, seed) for seed in range(args.rooms)]
    print(markdown_table(["", *COLUMNS], ([str(row[name]) for name in ("name", *COLUMNS)] for row in rows)))
    if args.out is not None:
        write_results(args.out, {"scenes": args.scenes, "play": args.play, "rows": rows, "rooms": rooms})


def whole_room(generator: Generator, seed: int) -> dict[str, Any]:
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
