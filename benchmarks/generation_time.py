"""What an added object costs inside Blender: all draws, settling, and making the Blender object.

    OMP_NUM_THREADS=1 python benchmarks/generation_time.py [--rooms 20] --out docs/results/generation_time.json

With the shipped models. Each room is emptied to its shell, opened in Blender and furnished again, without and with
behaviour: processor time. Then a cold start: one object in a new process, seconds on the clock.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

import bpy
import numpy as np

import unisg_blender
from unisg_blender.blender import new_file, read_scene, write_rows, write_scene
from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.experiments.rooms.cases import Case, case_of
from unisg_blender.generate import Generator
from unisg_blender.worlds import WORLDS

PRETRAINED = Path(unisg_blender.__file__).parent / "pretrained"
ROOMS = ("operating-room", "living-room")

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
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=int, default=20)
    parser.add_argument("--first", type=int, default=100_000)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    rows = [of_world(world, range(args.first, args.first + args.rooms)) for world in ROOMS]
    print(markdown_table(list(rows[0]), [[str(value) for value in row.values()] for row in rows]))
    if args.out is not None:
        write_results(args.out, {"blender": bpy.app.version_string, "load": os.getloadavg()[0], "rows": rows})


def of_world(world: str, seeds: range) -> dict[str, str | float]:
    """Milliseconds an object, without and with behaviour, and the seconds of a cold start."""
    model = PRETRAINED / f"{world.replace('-', '_')}.onnx"
    generator = Generator.load(model)
    cases = [case_of(WORLDS[world](seed), generator.categories) for seed in seeds]
    known = [case for case in cases if case is not None]
    row: dict[str, str | float] = {"world": world, "rooms": len(known)}
    for name, behaviour in (("bare", False), ("behaviour", True)):
        spent = np.array([_furnish(generator, case, seed, behaviour) for seed, case in enumerate(known)])[1:]
        reading, placing, making = np.median(spent, axis=0).tolist()
        total = spent.sum(axis=1)
        row |= {
            f"{name}_ms": float(np.median(total)), f"{name}_p95_ms": float(np.quantile(total, 0.95)),
            f"{name}_reading_ms": reading, f"{name}_placing_ms": placing, f"{name}_making_ms": making,
        }  # fmt: skip
    return row | _cold(model, known[0])


def _furnish(generator: Generator, case: Case, seed: int, behaviour: bool) -> tuple[float, float, float]:
    """Milliseconds an object for reading the scene, placing, and making the objects."""
    new_file()
    write_scene(case.shell, bpy.context.scene)
    times = [time.process_time()]
    scene = read_scene(bpy.context.scene)
    times.append(time.process_time())
    result = generator.add(scene, case.wanted, seed, assets=case.assets, behaviour=behaviour)
    times.append(time.process_time())
    write_rows(result.scene, result.rows, bpy.context.scene)
    times.append(time.process_time())
    reading, placing, making = np.diff(times) * 1e3 / sum(case.wanted.values())
    return reading, placing, making


def _cold(model: Path, case: Case) -> dict[str, float]:
    """Seconds for one object in a new process: to import Blender's module, and for the rest."""
    new_file()
    write_scene(case.real, bpy.context.scene)
    path = Path(bpy.app.tempdir or "/tmp") / "unisg-cold.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    name = next(iter(case.wanted))
    words = [sys.executable, "-c", COLD, str(model), str(path), name]
    lines = [subprocess.run(words, capture_output=True, text=True, check=True, timeout=300).stdout for _ in range(3)]
    found = np.array([[float(value) for value in line.strip().splitlines()[-1].split()] for line in lines])
    path.unlink()
    blender, rest = np.median(found, axis=0).tolist()
    return {"entities": len(case.real), "cold_bpy_s": blender, "cold_rest_s": rest}


if __name__ == "__main__":
    main()
