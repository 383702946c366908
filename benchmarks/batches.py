"""What rooms and pictures cost in batches, beside a loop of single calls and beside the generator alone.

    python benchmarks/batches.py [--rooms N] --out docs/results/batches.json

Processor seconds of all processes, so that what else a machine does hardly shows, and bytes on disk, each for a room.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from unisg_blender.experiments.reports import write_results

MODEL = ["generate", "--model", "living_room"]
ALONE = """
import json, resource, sys, time
import numpy as np
from unisg_blender.generate import Generator
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder
generator = Generator.load(find_generator("living_room"))
nothing, objects = SceneBuilder("Room").build(), 0
before = resource.getrusage(resource.RUSAGE_SELF)
for seed in range(int(sys.argv[1])):
    counts = generator.sample_counts(np.random.default_rng(seed), nothing)
    objects += generator.add(nothing, counts, seed).added
used = resource.getrusage(resource.RUSAGE_SELF)
print(json.dumps([used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime, objects]))
"""


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=int, default=32)
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory(prefix="unisg-") as name:
        for row in measured(Path(name), args.rooms, max(2, args.rooms // 8)):
            print(row, flush=True)
            rows.append({"work": "", "rooms": 0, "cpu_s": None, "wall_s": None, "kb": None, "files": None} | row)
    write_results(args.out, {"rows": rows})


def measured(folder: Path, rooms: int, few: int) -> Iterator[dict[str, Any]]:
    """A row for each kind of work; ``few`` are made one by one."""
    loop = [[*MODEL, "--seed", str(seed), "--out", str(folder / f"{seed}.json")] for seed in range(few)]
    yield {"work": "loop json", "rooms": few, **cost(loop, few)}
    done = subprocess.run([sys.executable, "-c", ALONE, str(rooms)], capture_output=True, text=True, check=True)
    seconds, objects = json.loads(done.stdout)
    yield {"work": "generator alone", "rooms": rooms, "cpu_s": seconds / rooms, "objects": objects / rooms}
    for work, words in {
        "batch dataset": [*MODEL, "--format", "dataset", "--jobs", "1"],
        "world dataset": ["world", "operating-room", "--format", "dataset", "--jobs", "2"],
        "world blend": ["world", "operating-room", "--format", "blend", "--jobs", "2"],
    }.items():
        out = folder / work.replace(" ", "-")
        made = cost([[*words, "--count", str(rooms), "--out", str(out)]], rooms)
        yield {"work": work, "rooms": rooms, **made, **size(out, rooms)}
    scenes, out = sorted((folder / "world-blend").glob("*.blend"))[:few], folder / "pictures"
    words = ["render", *map(str, scenes), "--views", "eye=4", "--samples", "1", "--jobs", "1", "--out", str(out)]
    yield {"work": "pictures", "rooms": 4 * few, **cost([words], 4 * few), **size(out, 4 * few)}


def cost(calls: list[list[str]], rooms: int) -> dict[str, float]:
    """Processor and elapsed seconds for a room, of some calls of ``unisg``."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    for words in calls:
        subprocess.run([sys.executable, "-m", "unisg_blender", *words, "-q"], check=False)
    used, elapsed = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - begun
    spent = used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime
    return {"cpu_s": spent / rooms, "wall_s": elapsed / rooms}


def size(folder: Path, rooms: int) -> dict[str, float]:
    """Kilobytes and files for a room."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {"kb": sum(path.stat().st_size for path in files) / 1000 / rooms, "files": len(files) / rooms}


if __name__ == "__main__":
    main()
