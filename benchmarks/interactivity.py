"""Lessons as behaviour graphs: how large they are, what a tick costs, whether Babylon.js tells what our player tells.

    python benchmarks/interactivity.py [--rooms N] [--checked N] --out docs/results/interactivity.json

Needs node, and the packages of packaging/player (`make test-web` gets them). Each room's rehearsal is fed to the engine
tick by tick; milliseconds of processor time are the median of a room's ticks, of which the table has the median.
Contact in graphs is that of boxes by their axes, of which our player is asked too; `exact_alike` says in how many rooms
it tells the same when it is asked for exact distances, `moments_otherwise` at how many moments of all it does not.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

from unisg_blender.behaviour import moments, rehearse
from unisg_blender.experiments.reports import write_results
from unisg_blender.interactivity import LessonGraph, lesson_graph
from unisg_blender.scene import SceneGraph
from unisg_blender.worlds import living_room, operating_room

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.interactivity.playing import told_by_player  # noqa: E402
from tests.web.engine_ticks import ticks_of, told_by_engine  # noqa: E402

PLAYER = ROOT / "packaging" / "player"
WORLDS: dict[str, Callable[[int], SceneGraph]] = {"operating room": operating_room, "living room": living_room}
AT_ONCE = 100


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rooms", type=int, default=10, help="of each kind that are played")
    parser.add_argument("--checked", type=int, default=1000, help="of each kind whose graphs are checked")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    rows = []
    for world, make in WORLDS.items():
        played = [_played(lesson_graph(make(seed))) for seed in range(args.rooms)]
        rows.append({
            "world": world, "rooms": args.rooms, "told_alike": sum(each["alike"] for each in played),
            "most_actions": max(each["actions"] for each in played),
            "most_kb": max(each["kb"] for each in played),
            "ms": median(each["ms"] for each in played),
            "exact_alike": sum(not each["otherwise"] for each in played),
            "moments": sum(each["moments"] for each in played),
            "moments_otherwise": sum(each["otherwise"] for each in played),
            "checked": args.checked, "faults": _faults(make, args.checked),
        })  # fmt: skip
        print(rows[-1], flush=True)
        write_results(args.out, {"rows": rows})


def _played(compiled: LessonGraph) -> dict[str, Any]:
    steps = list(moments(compiled.lesson.graph, rehearse(compiled.lesson)))
    ticks, wanted = ticks_of(compiled, steps), told_by_player(compiled, steps)
    with tempfile.TemporaryDirectory() as folder:
        told, milliseconds = told_by_engine(compiled, ticks, str(PLAYER), Path(folder))
    exact = told_by_player(compiled, steps, {})
    return {
        "alike": told == wanted,
        "moments": len(steps),
        "otherwise": sum(one != other for one, other in zip(wanted, exact, strict=True)),
        "actions": len(compiled.lesson.checks.actions),
        "kb": len(json.dumps(compiled.graph, separators=(",", ":"))) / 1000,
        "ms": milliseconds,
    }


def _faults(make: Callable[[int], SceneGraph], count: int) -> int:
    """How many graphs the strict validator finds fault with."""
    faults = 0
    with tempfile.TemporaryDirectory() as folder:
        for start in range(0, count, AT_ONCE):
            compiled = [lesson_graph(make(seed)) for seed in range(start, min(start + AT_ONCE, count))]
            found = [
                {"extension": {"graphs": [each.graph], "graph": 0}, "nodes": len(each.lesson.graph)}
                for each in compiled
            ]
            path = Path(folder, "graphs.json")
            path.write_text(json.dumps(found))
            words = ["node", "validate_graphs.mjs", str(path)]
            run = subprocess.run(words, cwd=PLAYER, capture_output=True, text=True, check=True, timeout=600)
            faults += json.loads(run.stdout.splitlines()[-1])["faults"]
    return faults


if __name__ == "__main__":
    main()
