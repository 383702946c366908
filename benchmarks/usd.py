"""How long scenes of 1,000 to 100,000 objects take through USD, and how that compares with Blender's own exporter.

    OMP_NUM_THREADS=1 python benchmarks/usd.py [--sizes 1000 10000 100000] [--runs 3] [--out docs/results/usd.json]

Prints the table of growth with what it says of it, and the comparison. Every size
runs in a process of its own, so that its peak memory is its own. On a busy machine
the columns of processor time are the ones to look at.
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from unisg_blender.experiments.reports import write_results

PARTS_PER_MESH = 10


def grid_scene(count: int) -> object:
    """``count`` objects, a tenth as many distinct meshes of 162 points, hierarchies of ten, categories, relations."""
    from unisg_blender.scene import Columns, Mesh, Relation, assemble
    from unisg_blender.scene.properties import ObjectProperties

    rng = np.random.default_rng(0)
    side = 9
    corner = np.arange(side * (side - 1)).reshape(side - 1, side)[:, :-1].reshape(-1)
    corners = np.stack([corner, corner + 1, corner + side + 1, corner + side], axis=1).astype(np.int32)
    points = rng.normal(size=(count // PARTS_PER_MESH, 2 * side * side, 3)).astype(np.float32)
    offsets = np.arange(0, corners.size + 1, 4, dtype=np.int32)
    meshes = [Mesh(f"Mesh.{index}", part, corners.reshape(-1), offsets) for index, part in enumerate(points)]
    local = np.tile(np.eye(4), (count, 1, 1))
    local[:, :3, :3] = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]
    local[:, :3, 3] = rng.normal(size=(count, 3))
    rows = np.arange(count)
    return assemble(
        Columns(
            name=[f"Object.{row}" for row in rows],
            type=["MESH"] * count,
            parent=np.where(rows % 10 == 0, -1, rows - rows % 10),
            local=local,
            mesh=rows % len(meshes),
            meshes=meshes,
            properties=[
                ObjectProperties(
                    f"Kind {row % 50}", f"{row:032x}", relations=(Relation("beside", f"{row - row % 10:032x}"),)
                )
                for row in rows
            ],
        )
    )


def timed(record: dict[str, float], name: str, work: Callable[[], object]) -> object:
    """The result; puts seconds on the clock, and of processor time, into ``record``."""
    start, busy = time.perf_counter(), time.process_time()
    result = work()
    record[f"{name}_s"], record[f"{name}_cpu_s"] = time.perf_counter() - start, time.process_time() - busy
    return result


def measure_usd(count: int) -> dict[str, float]:
    """Write, read, write again and read back a scene of ``count`` objects; check that it is the same."""
    from unisg_blender.usd import read_usd, write_usd

    graph = grid_scene(count)
    record: dict[str, float] = {"objects": count, "meshes": len(graph.meshes)}
    with tempfile.TemporaryDirectory() as folder:
        path, again = Path(folder, "scene.usdc"), Path(folder, "again.usdc")
        timed(record, "write", lambda: write_usd(graph, path))
        found = timed(record, "read", lambda: read_usd(path))
        timed(record, "rewrite", lambda: write_usd(found, again))
        back = timed(record, "read_back", lambda: read_usd(again))
        record["file_MB"] = path.stat().st_size / 1e6
    assert back.uid == graph.uid
    assert len(back.meshes) == len(graph.meshes)
    assert np.array_equal(back.local, graph.local)
    assert np.array_equal(back.parent, graph.parent)
    record["peak_GiB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return record


def measure_blender(count: int, shared: bool) -> dict[str, float]:
    """Our reader and writer against ``bpy.ops.wm.usd_export``, on the same Blender scene in the same process."""
    import bpy

    from unisg_blender.blender import read_scene
    from unisg_blender.usd import write_usd

    _fill_blender(count, shared)
    with tempfile.TemporaryDirectory() as folder:
        write_usd(read_scene(), Path(folder, "warm.usdc"))
        record: dict[str, float] = {"objects": count}
        timed(record, "blender", lambda: bpy.ops.wm.usd_export(filepath=str(Path(folder, "blender.usdc"))))
        graph = timed(record, "read", read_scene)
        timed(record, "write", lambda: write_usd(graph, Path(folder, "ours.usdc")))
    for kind in ("s", "cpu_s"):
        record[f"ratio_{kind}"] = (record[f"read_{kind}"] + record[f"write_{kind}"]) / record[f"blender_{kind}"]
    return record


def _fill_blender(count: int, shared: bool) -> None:
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    rng = np.random.default_rng(0)
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = None
    for row, place in enumerate(rng.normal(size=(count, 3)) * 50):
        if mesh is None or not shared:
            mesh = bpy.data.meshes.new(f"Box.{row}")
            mesh.from_pydata(corners, [], faces)
        item = bpy.data.objects.new(f"Object.{row}", mesh)
        item.location = place
        bpy.context.scene.collection.objects.link(item)
    bpy.context.view_layer.update()


def _in_own_process(case: list[str], runs: int) -> dict[str, float]:
    """Medians over several processes; every measurement is printed to stderr as it comes."""
    found = []
    for _ in range(runs):
        answer = subprocess.run(
            [sys.executable, __file__, "--case", *case], stdout=subprocess.PIPE, check=True, timeout=3600, text=True
        )
        found.append(json.loads(answer.stdout.splitlines()[-1]))
        print(found[-1], file=sys.stderr, flush=True)
    return {name: statistics.median(record[name] for record in found) for name in found[0]}


def _print_table(rows: list[dict[str, float]]) -> None:
    names = list(rows[0])
    print("| " + " | ".join(names) + " |\n|" + "---|" * len(names))
    for row in rows:
        print(
            "| "
            + " | ".join(f"{row[name]:,.0f}" if row[name] == int(row[name]) else f"{row[name]:.2f}" for name in names)
            + " |"
        )
    print(flush=True)


def _growth(rows: list[dict[str, float]]) -> str:
    """How times and memory grow from the smallest scene to the largest, in words."""
    first, last = rows[0], rows[-1]
    parts = [
        f"{name.replace('_', ' ')} {last[f'{name}_cpu_s'] / first[f'{name}_cpu_s']:.1f}"
        for name in ("write", "read", "rewrite", "read_back")
    ]
    size = last["objects"] / first["objects"]
    text = f"{size:g} times as many objects take this many times as long (processor time): {', '.join(parts)}."
    return f"{text} Peak memory {last['peak_GiB']:.2f} GiB of 4."


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=[1_000, 10_000, 100_000])
    parser.add_argument("--no-blender", action="store_true", help="leave out the comparison with Blender's exporter")
    parser.add_argument("--runs", type=int, default=3, help="the tables show medians over so many processes")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--case", nargs="+", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.case:
        kind, count = args.case[0], int(args.case[1])
        record = measure_usd(count) if kind == "usd" else measure_blender(count, kind == "shared")
        print(json.dumps(record), flush=True)
        return
    rows = [_in_own_process(["usd", str(size)], args.runs) for size in sorted(args.sizes)]
    _print_table(rows)
    print(_growth(rows), flush=True)
    record = {"runs": args.runs, "sizes": rows}
    if not args.no_blender:
        found = [_in_own_process([kind, "10000"], args.runs) for kind in ("shared", "distinct")]
        _print_table(found)
        for kind, row in zip(("one shared mesh", "10,000 distinct meshes"), found, strict=True):
            print(
                f"{kind}: ours / Blender's {row['ratio_cpu_s']:.3f} in processor time, {row['ratio_s']:.3f} in seconds"
            )
        record["beside_blender"] = [{"meshes": "shared"} | found[0], {"meshes": "distinct"} | found[1]]
    if args.out is not None:
        write_results(args.out, record)


if __name__ == "__main__":
    main()
