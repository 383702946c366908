"""What generating costs beside another checkout of this repository, and whether the same rooms come of it.

    git worktree add OTHER COMMIT
    python benchmarks/beside_another.py OTHER [--rooms N] --out results.json

Both make each room one right after the other, each in a process of its own, so that what else a machine does is the
same for both; processor time. The rooms are compared bit for bit.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.experiments.reports import write_results

KINDS = (("living_room", False), ("operating_room", False), ("operating_room", True))
MAKER = """
import hashlib, json, sys, tempfile, time
from pathlib import Path
import numpy as np
from unisg_blender.formats.json_scenes import write_json
from unisg_blender.generate import Generator
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder
generator, nothing = Generator.load(find_generator(sys.argv[1])), SceneBuilder("Room").build()
path = Path(tempfile.mkdtemp(prefix="unisg-"), "room.json")
for line in sys.stdin:
    counts = generator.sample_counts(np.random.default_rng(int(line)), nothing)
    begun = time.process_time()
    made = generator.add(nothing, counts, int(line), behaviour=sys.argv[2] == "True")
    spent = time.process_time() - begun
    write_json(made.scene, path)
    print(json.dumps([spent, made.added, hashlib.sha256(path.read_bytes()).hexdigest()]), flush=True)
"""


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path)
    parser.add_argument("--rooms", type=int, default=10)
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    rows = []
    for model, behaviour in KINDS:
        rows.append({"model": model, "behaviour": behaviour, **compared(args.other, model, behaviour, args.rooms)})
        print(rows[-1], flush=True)
        write_results(args.out, {"load": os.getloadavg()[0], "rows": rows})


def compared(other: Path, model: str, behaviour: bool, rooms: int) -> dict[str, Any]:
    """Milliseconds an object there and here, their ratio, and how many rooms are the same."""
    found: list[list[tuple[float, int, str]]] = [[], []]
    with ExitStack() as stack:
        makers = [stack.enter_context(_maker(folder, model, behaviour)) for folder in (other, Path())]
        for seed in range(rooms + 1):  # the first one loads what is loaded once
            for place in (0, 1) if seed % 2 else (1, 0):
                maker = makers[place]
                assert maker.stdin is not None
                assert maker.stdout is not None
                maker.stdin.write(f"{seed}\n")
                maker.stdin.flush()
                found[place].append(tuple(json.loads(maker.stdout.readline())))
        for maker in makers:
            maker.stdin.close()  # type: ignore[union-attr]
    spent = np.array([[room[:2] for room in rooms[1:]] for rooms in found], np.float64)
    there, here = (1e3 * each[:, 0].sum() / each[:, 1].sum() for each in spent)
    same = sum(one[2] == two[2] for one, two in zip(*found, strict=True))
    return {"rooms": len(found[0]), "same": same, "there_ms": there, "here_ms": here, "ratio": here / there}


def _maker(folder: Path, model: str, behaviour: bool) -> subprocess.Popen[str]:
    """A process that makes rooms with the library of a folder."""
    words, pipe = [sys.executable, "-c", MAKER, model, str(behaviour)], subprocess.PIPE
    setting = os.environ | {"OMP_NUM_THREADS": "1"}
    return subprocess.Popen(words, cwd=folder, env=setting, stdin=pipe, stdout=pipe, text=True)


if __name__ == "__main__":
    main()
