"""Does the memory of a process grow that makes room after room?

    python benchmarks/worker_memory.py [--rooms N] [--whole N] --out docs/results/worker_memory.json

One process does all the jobs of a batch, as a worker does until it is replaced. Resident memory after each tenth of:
``files``, a Blender file opened, a thing put into it, saved as another one; ``whole``, living rooms from nothing,
each packed as a part of a dataset. What is written is removed again.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

from unisg_blender.batches.batch_plan import BatchOptions, chunk_jobs, plan_rooms
from unisg_blender.batches.room_makers import GENERATED
from unisg_blender.experiments.reports import write_results
from unisg_blender.formats import write_scene_file
from unisg_blender.pretrained import find_generator
from unisg_blender.runtime.serving_process import handle
from unisg_blender.worlds import living_room

TENTHS = 10
HOW = {"bulk": False, "settle": True, "behaviour": True, "on": "", "beside": "", "within": "", "words": {}}
ADDED = {"Cup": 1}


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", type=int, default=5000, help="files of them")
    parser.add_argument("--whole", type=int, default=500, help="whole ones")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory(prefix="unisg-") as name:
        base = Path(name, "base.blend")
        write_scene_file(living_room(0), base)
        whole = grown("whole", [], args.whole, None, "dataset")
        for row in chain(whole, grown("files", [base], args.rooms, ADDED, "blend")):
            rows.append(row)
            write_results(args.out, {"rows": rows})


def grown(
    kind: str, scenes: list[Path], rooms: int, add: dict[str, int] | None, ending: str
) -> Iterator[dict[str, Any]]:
    """A row for each tenth of the rooms."""
    settings = {"model": str(find_generator("living_room")), "add": add, "variation": None, "mapping": None}
    options = BatchOptions(GENERATED, settings | {"assets": "", "how": HOW}, ending, here=True)
    made, step, started = 0, rooms / TENTHS, time.process_time()
    with tempfile.TemporaryDirectory(prefix="unisg-") as name:
        folder, parts = Path(name, "rooms"), Path(name, "parts")
        for job in chunk_jobs(plan_rooms(scenes, rooms, 0, kind), options, folder, parts):
            for path in (folder, parts):
                path.mkdir(exist_ok=True)
            answer = handle(job | {"left_out": {}})
            failed = [one for one in answer.get("records", [answer]) if one["status"] != "ok"]
            assert not failed, failed
            for path in (*folder.iterdir(), *parts.iterdir()):
                path.unlink()
            before, made = made, made + len(job["tasks"])
            if int(before / step) < int(made / step):
                yield {"kind": kind, "rooms": made, "cpu_s": time.process_time() - started, **memory()}


def memory() -> dict[str, float]:
    """Megabytes that are resident now, and that were at most."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {"resident_mb": pages * resource.getpagesize() / 1e6, "most_mb": most * 1024 / 1e6}


if __name__ == "__main__":
    main()
