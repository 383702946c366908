"""What the worlds make of a few seeds, in numbers that say where a change is: ``python -m tests.worlds.recorded``.

A change of a world moves the published tables of generators: whoever makes one means it, and records anew.
"""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.scene import SceneGraph
from unisg_blender.scene.action_data import actions_to_json
from unisg_blender.scene.hierarchy import world_matrices
from unisg_blender.scene.lesson_node import lesson_to_json
from unisg_blender.worlds import WORLDS

FILE = Path(__file__).with_name("recorded.json")
SEEDS = {"operating-room": range(8), "living-room": range(8), "cubes": range(3)}


def summary(graph: SceneGraph) -> dict[str, Any]:
    """A scene in numbers: metres and the entries of world matrices, summed over the objects of each category."""
    places: dict[str, Any] = defaultdict(lambda: np.zeros((3, 4)))
    sizes: dict[str, Any] = defaultdict(lambda: np.zeros(6))
    counts: Counter[str] = Counter()
    for row, world in enumerate(world_matrices(graph)):
        category = graph.category_name(row)
        counts[category] += 1
        places[category] += world[:3] * (1 + row % 5)  # so that two objects cannot change places unseen
        if graph.mesh[row] >= 0:
            points = graph.meshes[graph.mesh[row]].points
            sizes[category] += [*points.mean(axis=0), *np.abs(points).mean(axis=0)]
    said: Counter[str] = Counter()
    for name, table in sorted(graph.components.items()):
        if name == "relations":
            said.update(table.columns["kind"])
        else:
            write = {"actions": lambda action: actions_to_json([action]), "lsa": lesson_to_json}[name]
            said.update(
                {name: len(table.rows), f"{name} characters": sum(len(write(value)) for value in table.columns["data"])}
            )
    return {
        "categories": dict(sorted(counts.items())),
        "places": {name: np.round(places[name], 4).ravel().tolist() for name in sorted(places)},
        "sizes": {name: np.round(sizes[name], 4).tolist() for name in sorted(sizes)},
        "said": dict(sorted(said.items())),
    }


def all_summaries() -> dict[str, list[dict[str, Any]]]:
    return {name: [summary(WORLDS[name](seed)) for seed in seeds] for name, seeds in SEEDS.items()}


if __name__ == "__main__":
    FILE.write_text(json.dumps(all_summaries(), indent=None, separators=(",", ":")) + "\n", encoding="utf-8")
