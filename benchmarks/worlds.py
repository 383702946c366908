"""What the procedural rooms hold: rooms, things, categories, sizes, floors, faults, of the rooms of unisg-rooms.

    python benchmarks/worlds.py [--rooms N] --out docs/results/worlds.json

``--rooms``: at most so many of each part, for a first look. Nothing is timed.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.experiments.reports import write_results
from unisg_blender.experiments.rooms.frozen_rooms import PARTS, FrozenPart
from unisg_blender.geometry.polygon import area
from unisg_blender.metrics.scene_validity import measure_scene, summarise
from unisg_blender.scene import SceneGraph
from unisg_blender.spatial import find_objects
from unisg_blender.spatial.floor_plan import room_outline
from unisg_blender.worlds import WORLDS

SHAPES = {4: "rectangular", 5: "slanted", 6: "square"}
"""What is cut off a corner of a room, by how many corners it then has."""


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=int)
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    parts, categories = [], []
    for part in PARTS:
        seeds = range(part.seed, part.seed + min(args.rooms or part.count, part.count))
        graphs = [WORLDS[part.world](seed) for seed in seeds]
        parts.append(of_part(part, graphs))
        print(parts[-1])
        if part.folder.endswith("training"):
            categories += list(of_categories(part.world, graphs))
    write_results(args.out, {"parts": parts, "categories": categories})


def of_part(part: FrozenPart, graphs: Sequence[SceneGraph]) -> dict[str, Any]:
    """Counts and measures of some rooms of one world."""
    reports = [measure_scene(graph) for graph in graphs]
    outlines = [room_outline(graph) for graph in graphs]
    shapes = [SHAPES[len(outline)] for outline in outlines]
    kinds = [len(set(graph.category[graph.category >= 0])) for graph in graphs]
    actions = [len(graph.components["actions"].rows) if "actions" in graph.components else 0 for graph in graphs]
    return {
        "folder": part.folder, "world": part.world, "rooms": len(graphs), "first_seed": part.seed,
        "last_seed": part.seed + len(graphs) - 1, "actions": sum(actions),
        "categories": len({name for graph in graphs for name in graph.vocabulary}),
        **spread("things", [int(report.counted.sum()) for report in reports]), **spread("kinds", kinds),
        **spread("actions_each", actions), **spread("floor", [abs(area(outline)) for outline in outlines]),
        **{shape: shapes.count(shape) for shape in SHAPES.values()}, **summarise(reports),
    }  # fmt: skip


def spread(name: str, values: Sequence[float]) -> dict[str, float]:
    """The least, the median and the most of some values, by name."""
    return {f"{name}_least": min(values), f"{name}_median": float(np.median(values)), f"{name}_most": max(values)}


def of_categories(world: str, graphs: Sequence[SceneGraph]) -> Iterator[dict[str, Any]]:
    """A row for each category: in how many rooms, how many a room, median size in metres, on which levels."""
    sizes: dict[str, list[np.ndarray]] = {}
    levels: dict[str, list[int]] = {}
    rooms: dict[str, set[int]] = {}
    for number, graph in enumerate(graphs):
        level, objects = measure_scene(graph).level, find_objects(graph)
        for obj, row in enumerate(objects.rows):
            name = graph.category_name(row)
            sizes.setdefault(name, []).append(2 * objects.oriented.half[obj])
            levels.setdefault(name, []).append(int(level[row]))
            rooms.setdefault(name, set()).add(number)
    for name in sorted(sizes):
        usual = [
            number for number in sorted(set(levels[name])) if levels[name].count(number) > 0.02 * len(levels[name])
        ]
        x, y, z = np.median(sizes[name], axis=0).tolist()
        yield {
            "world": world, "category": name, "in_rooms": len(rooms[name]) / len(graphs),
            "each": len(sizes[name]) / len(graphs), "x": x, "y": y, "z": z, "levels": ", ".join(map(str, usual)),
        }  # fmt: skip


if __name__ == "__main__":
    main()
