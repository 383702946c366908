"""How right and how fast relations are found in scenes whose makers say what stands on what.

    OMP_NUM_THREADS=1 python benchmarks/relations.py --out docs/results/relations.json

The geometric rule and the shipped network (which tells "on top of" only), in scenes that nothing was trained on; and
the rule on many pairs of stacked boxes. Seconds are processor time.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.predict.support_prediction import TopologyModel
from unisg_blender.scene import SceneBuilder, SceneGraph, mesh_from_faces
from unisg_blender.spatial import find_relations
from unisg_blender.worlds import WORLDS

MADE = ("cubes", "living-room", "operating-room")
KINDS = ("on_top_of", "inside")
SIZES = (1_000, 4_000, 16_000)
Pairs = set[tuple[int, int]]
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (0, 2)]) * 0.2
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=6)
    parser.add_argument("--first", type=int, default=900)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    seeds = range(args.first, args.first + args.scenes)
    rows = [row for world in MADE for row in of_world(world, [WORLDS[world](seed) for seed in seeds])]
    times = [{"things": size, "seconds": timed(find_relations, stacks(size))[1]} for size in SIZES]
    for table in (rows, times):
        print(markdown_table(list(table[0]), [[str(value) for value in row.values()] for row in table]))
    if args.out is not None:
        write_results(args.out, {"scenes": args.scenes, "first_seed": args.first, "worlds": rows, "times": times})


def of_world(world: str, graphs: Sequence[SceneGraph]) -> list[dict[str, Any]]:
    """A row for each way of finding a kind of relation."""
    model = TopologyModel()
    rule = [timed(find_relations, graph) for graph in graphs]
    network = [timed(model.find, graph) for graph in graphs]
    told = {"rule": rule, "network": network}
    return [
        {"world": world, "kind": kind, "way": way}
        | scores([of_kind(graph_relations(graph), kind) for graph in graphs], [of_kind(f, kind) for f, _ in found])
        | {"seconds": float(np.median([spent for _, spent in found]))}
        for kind in KINDS
        for way, found in told.items()
        if way == "rule" or kind == "on_top_of"
    ]


def graph_relations(graph: SceneGraph) -> list[tuple[Any, ...]]:
    """What the maker of a scene says: rows of subject, kind, row of target."""
    return [(row, kind, graph.row_of_uid[uid]) for row, kind, uid in graph.entries("relations", "kind", "target")]


def of_kind(found: Iterable[tuple[Any, ...]], kind: str) -> Pairs:
    """The pairs of one kind."""
    return {(entry[0], entry[2]) for entry in found if entry[1] == kind}


def scores(true: Sequence[Pairs], found: Sequence[Pairs]) -> dict[str, float | None]:
    """Precision, recall and F1 over all pairs of some scenes; None where there is nothing to divide by."""
    right = sum(len(one & other) for one, other in zip(true, found, strict=True))
    said, edges = sum(map(len, found)), sum(map(len, true))
    return {
        "edges": edges, "precision": right / said if said else None, "recall": right / edges if edges else None,
        "f1": 2 * right / (said + edges) if said + edges else None,
    }  # fmt: skip


def timed(find: Callable[[SceneGraph], list[Any]], graph: SceneGraph) -> tuple[list[Any], float]:
    """What is found in a scene, and seconds of processor time."""
    start = time.process_time()
    return find(graph), time.process_time() - start


def stacks(count: int) -> SceneGraph:
    """``count`` boxes, two by two on a grid."""
    builder, box = SceneBuilder("Stacks"), mesh_from_faces("Box", CORNERS, FACES)
    side = int(np.ceil(np.sqrt(count / 2)))
    for number in range(count):
        local = np.eye(4)
        local[:3, 3] = number // 2 % side, number // 2 // side, 0.4 * (number % 2)
        builder.add(f"Box {number}", uid=f"{number}", local=local, mesh=box)
    return builder.build()


if __name__ == "__main__":
    main()
