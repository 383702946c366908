"""Whether the classifier of scenes knows unseen ones of its kinds, as they are and turned, and refuses others.

    python benchmarks/scene_kinds.py [--scenes 40] [--others FOLDER] --out docs/results/scene_kinds.json

``--others``: scene files of no kind that it knows.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.errors import UniSGError
from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.formats import read_scene_file
from unisg_blender.generate import Generator
from unisg_blender.predict.scene_kind import SceneModel
from unisg_blender.pretrained import find_generator
from unisg_blender.runtime.file_endings import READABLE
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.worlds import WORLDS

KINDS = ("operating-room", "living-room", "cubes")
FIRST, FURNISHED = 900_000, 5


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=40)
    parser.add_argument("--others", type=Path)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    model = SceneModel()
    rows = []
    for world in KINDS:
        graphs = [WORLDS[world](FIRST + number) for number in range(args.scenes)]
        rows.append(told(model, "as made", world, graphs))
        rows.append(told(model, "turned", world, (turned(graph, number) for number, graph in enumerate(graphs))))
    rows += [told(model, "furnished by the model", world, furnished(world)) for world in KINDS[:2]]
    if args.others is not None:
        rows.append(told(model, "by others", "", read(args.others)))
    print(markdown_table(list(rows[0]), [[str(value) for value in row.values()] for row in rows]))
    if args.out is not None:
        write_results(args.out, {"rows": rows})


def told(model: SceneModel, how: str, kind: str, graphs: Iterable[SceneGraph]) -> dict[str, Any]:
    """How often the right kind is told and how often none, the chances, how far the scenes lie from those learned."""
    found = [model.classify(graph) for graph in graphs]
    likeliest = [max(one.chances.values()) for one in found]
    distances = [one.distance for one in found if one.distance is not None]
    return {
        "how": how, "kind": kind, "scenes": len(found), "right": sum(one.nearest == kind for one in found),
        "refused": sum(one.foreign for one in found), "least_chance": min(likeliest),
        "surer_than_99": sum(chance > 0.99 for chance in likeliest),
        "nearest": min(distances), "farthest": max(distances),
    }  # fmt: skip


def turned(graph: SceneGraph, seed: int) -> SceneGraph:
    """The whole scene turned about the vertical, by an angle drawn with the seed."""
    angle, turn, local = np.random.default_rng(seed).uniform(-np.pi, np.pi), np.eye(4), graph.local.copy()
    turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    roots = graph.parent < 0
    local[roots] = turn @ local[roots]
    return graph.replace(local=local)


def furnished(world: str) -> Iterator[SceneGraph]:
    """Rooms that the shipped generator makes out of nothing."""
    generator = Generator.load(find_generator(world.replace("-", "_")))
    for seed in range(FURNISHED):
        counts = generator.sample_counts(np.random.default_rng(seed))
        yield generator.add(SceneBuilder("Room").build(), counts, seed, behaviour=True).scene


def read(folder: Path) -> Iterator[SceneGraph]:
    """The scenes of a folder that can be read and hold something."""
    for path in sorted(path for path in folder.rglob("*") if path.suffix in READABLE):
        try:
            graph = read_scene_file(path)[0]
        except UniSGError:
            continue
        if len(graph):
            yield graph


if __name__ == "__main__":
    main()
