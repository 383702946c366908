"""What an added object costs inside Blender: all draws, settling, and making the Blender object.

    python benchmarks/generation_time.py unisg_blender/pretrained/operating_room.onnx --world operating-room --rooms 20

Each room is emptied to its shell, opened in Blender and furnished again. Wall-clock time on one core: set
OMP_NUM_THREADS=1. Then the same with behaviour, and a cold start: one object in a new process, from starting Python on.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from pathlib import Path

import bpy
import numpy as np

from unisg_blender.blender import new_file, read_scene, write_rows, write_scene
from unisg_blender.experiments.rooms.cases import Case, case_of
from unisg_blender.generate import Generator
from unisg_blender.worlds import WORLDS

COLD = """
import sys, time
start = time.perf_counter()
import bpy
ready = time.perf_counter()
from unisg_blender.blender import read_scene, write_rows
from unisg_blender.generate import Generator
bpy.ops.wm.open_mainfile(filepath=sys.argv[2])
generator = Generator.load(sys.argv[1])
result = generator.add(read_scene(bpy.context.scene), {sys.argv[3]: 1}, seed=0, behaviour=False)
write_rows(result.scene, result.rows, bpy.context.scene)
print(ready - start, time.perf_counter() - ready, flush=True)
import os
os._exit(0)
"""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=Path)
    parser.add_argument("--world", default="operating-room", choices=WORLDS)
    parser.add_argument("--rooms", type=int, default=20)
    parser.add_argument("--first", type=int, default=100_000)
    args = parser.parse_args()
    generator = Generator.load(args.model)
    cases = [case_of(WORLDS[args.world](args.first + number), generator.categories) for number in range(args.rooms)]
    known = [case for case in cases if case is not None]
    for behaviour in (False, True):
        spent = np.array([_furnish(generator, case, seed, behaviour) for seed, case in enumerate(known)])[1:]
        total = spent.sum(axis=1)
        print(
            f"{'with' if behaviour else 'without'} behaviour, ms an object: median {np.median(total):.2f}, "
            f"of it reading {np.median(spent[:, 0]):.2f}, placing {np.median(spent[:, 1]):.2f}, "
            f"Blender objects {np.median(spent[:, 2]):.2f}; 95 % of the rooms below {np.quantile(total, 0.95):.2f}"
        )
    _cold(args.model, known[0])


def _furnish(generator: Generator, case: Case, seed: int, behaviour: bool) -> tuple[float, float, float]:
    """Milliseconds an object for reading the scene, placing, and making the objects."""
    new_file()
    write_scene(case.shell, bpy.context.scene)
    times = [time.perf_counter()]
    scene = read_scene(bpy.context.scene)
    times.append(time.perf_counter())
    result = generator.add(scene, case.wanted, seed, assets=case.assets, behaviour=behaviour)
    times.append(time.perf_counter())
    write_rows(result.scene, result.rows, bpy.context.scene)
    times.append(time.perf_counter())
    reading, placing, making = np.diff(times) * 1e3 / sum(case.wanted.values())
    return reading, placing, making


def _cold(model: Path, case: Case) -> None:
    """One object in a new process."""
    new_file()
    write_scene(case.real, bpy.context.scene)
    path = Path(bpy.app.tempdir or "/tmp") / "unisg-cold.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    name = next(iter(case.wanted))
    words = [sys.executable, "-c", COLD, str(model), str(path), name]
    lines = [subprocess.run(words, capture_output=True, text=True, check=True, timeout=300).stdout for _ in range(3)]
    found = np.array([[float(value) for value in line.strip().splitlines()[-1].split()] for line in lines])
    blender, rest = np.median(found, axis=0)
    print(
        f"cold start, median of 3: importing bpy {blender:.2f} s; opening a room of {len(case.real)} entities, "
        f"loading the model, adding one {name}: {rest:.2f} s"
    )
    path.unlink()


if __name__ == "__main__":
    main()
