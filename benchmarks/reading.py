"""How fast Blender scenes are read, against Blender's own glTF exporter in the same process.

python benchmarks/reading.py [--out docs/results/reading.json] [--objects N] [--repeat K]
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import bpy
import numpy as np

from unisg_blender.blender import ReadReport, new_file, read_scene
from unisg_blender.experiments.reports import write_results
from unisg_blender.runtime.output_capture import captured_output

SHARED_LIMIT, DISTINCT_LIMIT = 1 / 30, 1 / 10
CHILDREN = 10


def main() -> None:
    """Measure both scenes, print a table, write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path)
    parser.add_argument("--objects", type=int, default=10_000)
    parser.add_argument("--repeat", type=int, default=5, help="readings of each scene; the median counts")
    args = parser.parse_args()
    matrices = partial(read_scene, geometry="none", details=False)
    rows = measure(make_shared, {"one shared mesh, hierarchy and matrices": (matrices, SHARED_LIMIT)}, args)
    readers = {
        "hierarchy and matrices": matrices,
        "geometry": partial(read_scene, details=False),
        "everything": read_scene,
        "everything and what is lost": lambda: read_scene(report=ReadReport()),
    }
    distinct = {f"distinct 500-vertex meshes, {name}": (read, DISTINCT_LIMIT) for name, read in readers.items()}
    rows += measure(make_distinct, distinct, args)
    for row in rows:
        print(
            f"{row['scene']:55}{row['objects']:>7} objects  read {row['read_s']:8.4f} s  glTF {row['gltf_s']:8.3f} s  "
            f"1/{row['gltf_s'] / row['read_s']:.1f} (target 1/{1 / row['target']:.0f})"
        )
    if args.out is not None:
        write_results(args.out, {"blender": bpy.app.version_string, "repeat": args.repeat, "rows": rows})


def measure(
    make: Callable[[int], None], readers: dict[str, tuple[Callable[[], object], float]], args: argparse.Namespace
) -> list[dict[str, object]]:
    """Seconds for each way of reading (median) and for one glTF export of the same scene, which Blender has evaluated.

    ``readers`` holds by name what reads, and the share of the export's time that it may take.
    """
    new_file()
    make(args.objects)
    bpy.context.evaluated_depsgraph_get()
    times = {name: statistics.median(seconds(read) for _ in range(args.repeat)) for name, (read, _) in readers.items()}
    with tempfile.TemporaryDirectory() as folder, captured_output():
        export = seconds(lambda: bpy.ops.export_scene.gltf(filepath=f"{folder}/scene.glb", export_extras=True))
    return [
        {"scene": name, "objects": args.objects, "read_s": spent, "gltf_s": export, "ratio": spent / export}
        | {"target": readers[name][1]}
        for name, spent in times.items()
    ]


def seconds(work: Callable[[], object]) -> float:
    """How long something takes."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def make_shared(count: int) -> None:
    """A tree of objects that share a cube, ten children each."""
    mesh = bpy.data.meshes.new("Cube")
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata(corners, [], faces)
    _make_tree([mesh] * count)


def make_distinct(count: int) -> None:
    """A tree of objects with a sphere of their own, bumpy by its number, with custom properties."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=29, ring_count=18)
    first = bpy.context.object.data
    points = np.empty(3 * len(first.vertices), np.float32)
    first.attributes["position"].data.foreach_get("vector", points)
    bpy.data.objects.remove(bpy.context.object)
    meshes = []
    for number in range(count):
        mesh = first.copy()
        bumps = 1 + 0.1 * np.sin(number + np.arange(len(points)))
        mesh.attributes["position"].data.foreach_set("vector", (points * bumps).astype(np.float32))
        meshes.append(mesh)
    _make_tree(meshes)
    for number, item in enumerate(bpy.context.scene.objects):
        item["unisg_category"] = f"Category {number % 20}"
        item["weight"] = float(number)


def _make_tree(meshes: list[bpy.types.Mesh]) -> None:
    collection = bpy.data.collections.new("Tree")
    items = [bpy.data.objects.new(f"Object.{number:05d}", mesh) for number, mesh in enumerate(meshes)]
    for number, item in enumerate(items):
        collection.objects.link(item)
        if number:
            item.parent = items[(number - 1) // CHILDREN]
            item.location, item.rotation_euler = (number % 7, 1.0, 0.5), (0.1 * number, 0.2, 0.3)
    bpy.context.scene.collection.children.link(collection)


if __name__ == "__main__":
    main()
