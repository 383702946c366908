"""From a move of the mouse to the ghost: what pointing into a room costs, and looking at the room before.

    OMP_NUM_THREADS=1 python benchmarks/pointing.py [--moves 300] --out docs/results/pointing.json

An operating room, and the same with more and more things in it. For each category a way is moved over what may
hold it, a few centimetres at a time; milliseconds of each move, on the clock and of processor time (``work``), drawing
apart. Then seconds for what is looked at in the background: the room anew, another category of the same room.
"""

from __future__ import annotations

import argparse
import os
import time
from pathlib import Path

import numpy as np

from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.generate import Generator
from unisg_blender.generate.pointing.ghosts import ghost_near
from unisg_blender.generate.pointing.placing_room import PlacingRoom, Wanted
from unisg_blender.geometry.arrays import Floats
from unisg_blender.pretrained import shipped_generators
from unisg_blender.scene import SceneGraph
from unisg_blender.spatial.objects import scene_objects
from unisg_blender.worlds import operating_room

CATEGORIES = ("Stool", "Monitor", "Clock", "Scalpel", "Supply Box")
MORE = ("Supply Box", "Vial", "Syringe", "Swab", "Clamp", "Forceps", "Stool", "Kick Bucket", "Supply Panel")
SIZES = (100, 300)
STEP = 0.04
"""Metres of a move."""


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--moves", type=int, default=300)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    generator = Generator.load(next(path for path in shipped_generators() if path.stem == "operating_room"))
    rows = []
    for size in SIZES:
        scene = filled(generator, operating_room(5), size)
        rows.append({"asked": size, **measured(generator, scene, args.moves)})
    print(markdown_table(list(rows[0]), [[str(value) for value in row.values()] for row in rows]))
    if args.out is not None:
        write_results(args.out, {"load": os.getloadavg()[0], "rows": rows})


def filled(generator: Generator, scene: SceneGraph, size: int) -> SceneGraph:
    """The scene with so many objects, or a few less where there is no room for more."""
    for seed in range(6):
        left = size - len(scene_objects(scene, ()))
        if left <= 0:
            break
        counts = {name: max(left // len(MORE), 1) for name in MORE}
        scene = generator.add(scene, counts, seed, behaviour=False).scene
    return scene


def measured(generator: Generator, scene: SceneGraph, moves: int) -> dict[str, float]:
    """Milliseconds of the moves of all categories, and seconds of looking at the room."""
    spent, looked, before = [], [], None
    work = []
    for category in CATEGORIES:
        start = time.perf_counter()
        before = PlacingRoom.of(generator, scene, Wanted(category), before=before)
        looked.append(time.perf_counter() - start)
        for point in _way(before, moves):
            start, began = time.perf_counter(), time.process_time()
            ghost_near(before, point)
            spent.append(1e3 * (time.perf_counter() - start))
            work.append(1e3 * (time.process_time() - began))
    assert before is not None
    return {
        "objects": len(scene_objects(scene, ())), "triangles": len(before.check.around.triangles), "moves": len(spent),
        "median_ms": float(np.median(spent)), "p95_ms": float(np.quantile(spent, 0.95)), "worst_ms": max(spent),
        "work_median_ms": float(np.median(work)), "work_p95_ms": float(np.quantile(work, 0.95)),
        "work_worst_ms": max(work),
        "look_s": looked[0], "another_s": float(np.median(looked[1:])),
    }  # fmt: skip


def _way(room: PlacingRoom, moves: int) -> Floats:
    """Points (moves, 3) of a way over what may hold the thing, metres; it turns now and then."""
    rng = np.random.default_rng(0)
    points = [room.map.aim[int(rng.integers(len(room.map)))]]
    heading = rng.uniform(-np.pi, np.pi)
    while len(points) < moves:
        heading += rng.normal(0, 0.3)
        step = points[-1] + STEP * np.array([np.cos(heading), np.sin(heading), 0.0])
        away = np.linalg.norm(room.map.aim - step, axis=1).min()
        points.append(step if away < 10 * STEP else room.map.aim[int(rng.integers(len(room.map)))])
    return np.array(points)


if __name__ == "__main__":
    main()
