"""How long one frame of checking takes, for 10,000 actions and more: ``python benchmarks/behaviour.py [--out FILE]``.

Every entity moves and every tool's trigger is pressed in every frame. "mixed" has a
fifth of each type. "far" is what scenes are like: objects are where nothing happens.
In the rows of Insert, Remove and Tool every pose is within its distance, so that every
angle is decided. The rows of Use differ in how hard the contact is to see: cubes of 10 cm
inside each other; beside each other, near enough; rods of 40 cm that touch with their
tips; rods that cross without touching; cubes corner to corner, within the distance only
just. "single precision" has matrices as Blender keeps them. Times are those of the
processor, on one thread with OMP_NUM_THREADS=1.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from unisg_blender.behaviour import compile_actions, moment, start, step
from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.scene import ActionData, SceneBuilder, SceneGraph, Thresholds, mesh_from_faces, world_matrices

POSE = (*np.eye(4).ravel(),)
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


MIXED = ("Insert", "Remove", "Use", "Tool", "Question")
CUBE, ROD = (0.05, 0.05, 0.05), (0.01, 0.01, 0.2)


@dataclass(frozen=True)
class Mixture:
    """Kinds of actions in turn; the tool's place and turn (rotation vector) beside its target, and its half sizes."""

    kinds: Sequence[str]
    place: tuple[float, float, float]
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)
    half: tuple[float, float, float] = CUBE
    distance: float | None = 0.2
    single: bool = False


MIXTURES = {
    "mixed, all near": Mixture(MIXED, (0.04, 0.04, 0.04)),
    "mixed, all near, single precision": Mixture(MIXED, (0.04, 0.04, 0.04), single=True),
    "mixed, all far": Mixture(MIXED, (0.4, 0.4, 0.4)),
    "Insert": Mixture(("Insert",), (0.04, 0.04, 0.04)),
    "Remove": Mixture(("Remove",), (0.04, 0.04, 0.04)),
    "Use, inside each other": Mixture(("Use",), (0.04, 0.04, 0.04)),
    "Use, beside each other": Mixture(("Use",), (0.14, 0.14, 0.14)),
    "Use, tip to tip": Mixture(("Use",), (0.1, 0.0, 0.28), (0.0, 0.9, 0.0), ROD, None),
    "Use, apart and crossing": Mixture(("Use",), (0.03, 0.0, 0.0), (1.5, 0.0, 0.0), ROD, None),
    "Use, only just": Mixture(("Use",), (0.11, 0.09, 0.02), (0.2, 0.1, 0.7), CUBE, 0.0211),
    "Tool": Mixture(("Tool",), (0.04, 0.04, 0.04)),
    "Question": Mixture(("Question",), (0.04, 0.04, 0.04)),
}


def crowd(mixture: Mixture, count: int) -> SceneGraph:
    """``count`` actions, each with a target and a tool of its own on a wide grid."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    body = mesh_from_faces("body", corners * mixture.half, FACES)
    random = np.random.default_rng(0)
    beside = np.eye(4)
    beside[:3, :3] = Rotation.from_rotvec(mixture.turn).as_matrix()
    beside[:3, 3] = mixture.place
    builder = SceneBuilder()
    for number in range(count):
        local = np.eye(4)
        local[:3, :3] = np.linalg.qr(random.normal(size=(3, 3)))[0]
        local[:3, 3] = number % 100, number // 100, 0
        target = builder.add(f"Target {number}", uid=f"target{number}", local=local, mesh=body)
        builder.add(f"Tool {number}", uid=f"tool{number}", parent=target, local=beside, mesh=body)
        kind = mixture.kinds[number % len(mixture.kinds)]
        posed = kind in ("Insert", "Remove")
        action = ActionData(
            f"a{number}", kind, targets=(f"target{number}",), tools=() if posed else (f"tool{number}",),
            frame=f"tool{number}" if posed else "", reference=POSE if posed else None,
            thresholds=Thresholds(mixture.distance, 0.1, hold=0.5), answers=("yes", "no"), correct=(0,),
        )  # fmt: skip
        builder.add(f"Owner {number}", uid=f"owner{number}", actions=(action,))
    return builder.build()


def frame_times(graph: SceneGraph, frames: int, single: bool) -> tuple[list[float], int]:
    """Seconds of processor time per frame of checking, after one frame to warm up, and how many conditions held."""
    checks = compile_actions(graph)
    state, rest = start(checks), world_matrices(graph)
    everyone = [uid for uid in graph.uid if uid.startswith("tool")]
    times = []
    for frame in range(frames + 1):
        world = rest + 0
        world[:, :3, 3] += 0.001 * frame
        if single:
            world = world.astype(np.float32).astype(np.float64)
        now = moment(graph, frame / 60, world, trigger=everyone, answers={"a4": (0,)})
        begin = time.process_time()
        state = step(checks, state, now)
        times.append(time.process_time() - begin)
    return times[1:], int(state.met.sum())


def rows(count: int, frames: int) -> list[dict[str, float | str]]:
    """One row of figures per mixture, in milliseconds."""
    result: list[dict[str, float | str]] = []
    for name, mixture in MIXTURES.items():
        spent, held = frame_times(crowd(mixture, count), frames, mixture.single)
        times = np.array(spent) * 1000
        result.append(
            {
                "actions": name,
                "count": count,
                "held": held,
                "least_ms": float(times.min()),
                "median_ms": float(np.median(times)),
                "p95_ms": float(np.quantile(times, 0.95)),
            }
        )
    return result


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    found = rows(args.count, args.frames)
    print(
        markdown_table(
            list(found[0]), [[f"{v:.2f}" if isinstance(v, float) else str(v) for v in row.values()] for row in found]
        )
    )
    if args.out is not None:
        write_results(args.out, {"frames": args.frames, "rows": found})


if __name__ == "__main__":
    main()
