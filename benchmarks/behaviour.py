"""How long one frame of checking takes, for 10,000 actions and more: ``python benchmarks/behaviour.py [--json]``.

Every entity moves and every tool's trigger is pressed in every frame. "mixed" has a
fifth of each type. "far" is what scenes are like: things are where nothing happens.
In all other rows every pose is within its distance (every angle is computed) and
every box in contact or, for "corners", near without touching.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence

import numpy as np

from unisg_blender.scene import ActionData, SceneBuilder, SceneGraph, Thresholds, mesh_from_faces, world_matrices
from unisg_blender.scene.behaviour import compile_actions, moment, start, step

POSE = (*np.eye(4).ravel(),)
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


MIXED = ("Insert", "Remove", "Use", "Tool", "Question")


def crowd(kinds: Sequence[str], count: int, gap: float) -> SceneGraph:
    """``count`` actions, each with a target and a tool cube of its own on a wide grid, of the kinds in turn."""
    corners = np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.05, 0.05)])
    cube = mesh_from_faces("cube", corners, FACES)
    random = np.random.default_rng(0)
    builder = SceneBuilder()
    for number in range(count):
        local = np.eye(4)
        local[:3, :3] = np.linalg.qr(random.normal(size=(3, 3)))[0]
        local[:3, 3] = number % 100, number // 100, 0
        target = builder.add(f"Target {number}", uid=f"target{number}", local=local, mesh=cube)
        beside = np.eye(4)
        beside[:3, 3] = gap
        builder.add(f"Tool {number}", uid=f"tool{number}", parent=target, local=beside, mesh=cube)
        kind = kinds[number % len(kinds)]
        posed = kind in ("Insert", "Remove")
        action = ActionData(
            f"a{number}", kind, targets=(f"target{number}",), tools=() if posed else (f"tool{number}",),
            frame=f"tool{number}" if posed else "", reference=POSE if posed else None,
            thresholds=Thresholds(0.2, 0.1, hold=0.5), answers=("yes", "no"), correct=(0,),
        )  # fmt: skip
        builder.add(f"Owner {number}", uid=f"owner{number}", actions=(action,))
    return builder.build()


def frame_times(graph: SceneGraph, frames: int) -> list[float]:
    """Seconds of processor time per frame of checking, after one frame to warm up."""
    checks = compile_actions(graph)
    state, rest = start(checks), world_matrices(graph)
    everyone = [uid for uid in graph.uid if uid.startswith("tool")]
    times = []
    for frame in range(frames + 1):
        now = moment(graph, frame / 60, rest + 0, trigger=everyone, answers={"a3": (0,)})
        now.world[:, :3, 3] += 0.001 * frame
        begin = time.process_time()
        state = step(checks, state, now)
        times.append(time.process_time() - begin)
    return times[1:]


def rows(count: int, frames: int) -> list[dict[str, float | str]]:
    """One row of figures per mixture, in milliseconds."""
    mixtures: dict[str, tuple[Sequence[str], float]] = {
        "mixed, all near": (MIXED, 0.04),
        "mixed, all far": (MIXED, 0.4),
        "Insert": (("Insert",), 0.04),
        "Remove": (("Remove",), 0.04),
        "Use": (("Use",), 0.04),
        "Use, corners": (("Use",), 0.14),
        "Tool": (("Tool",), 0.04),
        "Question": (("Question",), 0.04),
    }
    result: list[dict[str, float | str]] = []
    for name, (kinds, gap) in mixtures.items():
        times = np.array(frame_times(crowd(kinds, count, gap), frames)) * 1000
        result.append(
            {
                "actions": name,
                "count": count,
                "median_ms": float(np.median(times)),
                "p95_ms": float(np.quantile(times, 0.95)),
            }
        )
    return result


def main(show: Callable[[str], None] = print) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    found = rows(args.count, args.frames)
    if args.json:
        show(json.dumps(found))
        return
    show("| actions | number | median ms per frame | 95 % of frames below, ms |\n|---|---|---|---|")
    for row in found:
        show(f"| {row['actions']} | {row['count']} | {row['median_ms']:.2f} | {row['p95_ms']:.2f} |")


if __name__ == "__main__":
    main()
