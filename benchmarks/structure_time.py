"""What structure costs: a file of about 1,000 objects is read, and read with its rooms recognised.

    python benchmarks/structure_time.py [--rooms 14] [--repeat 7] [--out docs/results/structure_time.json]

Living rooms side by side, without categories, in one .blend file. Seconds of CPU time, medians.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np

from unisg_blender.experiments.reports import write_results
from unisg_blender.formats import read_scene_file, write_scene_file
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.spatial.structure import recognise_structure
from unisg_blender.worlds import WORLDS

APART = 12.0
"""Metres from a room to the next."""


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=int, default=14)
    parser.add_argument("--repeat", type=int, default=7)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rooms.blend"
        write_scene_file(side_by_side(args.rooms), path)
        spent = [once(path) for _ in range(args.repeat)]
    read, structure = (statistics.median(column[key] for column in spent[1:]) for key in ("read", "structure"))
    record = {
        "objects": spent[0]["objects"], "triangles": spent[0]["triangles"],
        "rooms": spent[0]["rooms"], "surfaces": spent[0]["surfaces"], "read_s": round(read, 3),
        "structure_s": round(structure, 3), "times": round((read + structure) / read, 2),
    }  # fmt: skip
    print(record)
    if args.out is not None:
        write_results(args.out, record)


def side_by_side(count: int) -> SceneGraph:
    """Living rooms of several seeds in a row, their categories and relations left out."""
    builder = SceneBuilder("Rooms")
    for number in range(count):
        graph = WORLDS["living-room"](number)
        start = len(builder._names)
        for row in range(len(graph)):
            parent = int(graph.parent[row])
            local = graph.local[row].copy()
            if parent < 0:
                local[0, 3] += APART * number
            mesh = graph.meshes[graph.mesh[row]] if graph.mesh[row] >= 0 else None
            name = f"{graph.name[row]} {number}"
            builder.add(
                name, uid=f"{number} {row}", parent=parent + start if parent >= 0 else -1, local=local, mesh=mesh
            )
    return builder.build()


def once(path: Path) -> dict[str, float]:
    """Seconds to read a file, and to recognise its structure; what there is."""
    start = time.process_time()
    graph = read_scene_file(path)[0]
    read = time.process_time()
    structure = recognise_structure(graph)
    end = time.process_time()
    triangles = sum(len(graph.meshes[mesh].triangles) for mesh in graph.mesh if mesh >= 0)
    return {
        "read": read - start, "structure": end - read, "objects": len(graph), "rooms": len(structure.rooms),
        "surfaces": len(structure.surfaces), "triangles": int(np.sum(triangles)),
    }  # fmt: skip


if __name__ == "__main__":
    main()
