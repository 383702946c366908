"""Datasets at scale, measured.

    python benchmarks/dataset.py million [--scenes N] [--objects K] [--folder DIR]
    python benchmarks/dataset.py jobs FILES... [--repeat K]

``million`` writes synthetic columns (no world builder), then reads them back in a
process of its own: random access, a pass over everything, and batches of 128
scenes against PyG's InMemoryDataset + DataLoader on the same scenes in the same
process. ``jobs`` exports files with one and with two jobs in turn. Both print
JSON, and write it to ``--out FILE``.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.dataset import open_dataset
from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset
from unisg_blender.dataset.format import writer
from unisg_blender.dataset.format.columns import Columns, Vocabulary
from unisg_blender.dataset.format.encoding import Sample, encode_scenes, widths
from unisg_blender.dataset.format.schema import COLUMNS, STRINGS, TABLES, table_of
from unisg_blender.experiments.reports import write_results
from unisg_blender.poses import FORMS
from unisg_blender.scene import SceneBuilder, mesh_from_faces

FORM = "quaternion"
MESHES, CATEGORIES, BATCH, SUBSET = 64, 30, 128, 8192


def main() -> None:
    """Run one of the measurements."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("million", "read", "jobs"))
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--scenes", type=int, default=1_000_000)
    parser.add_argument("--objects", type=int, default=15)
    parser.add_argument("--folder", type=Path, help="where the dataset goes (a temporary folder)")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--out", type=Path, help="write what was measured to this file")
    args = parser.parse_args()
    folder = args.folder or Path(tempfile.mkdtemp(prefix="unisg-dataset-"))
    measure: dict[str, Callable[[], dict[str, Any]]] = {
        "million": lambda: million(folder, args.scenes, args.objects),
        "read": lambda: read(folder),
        "jobs": lambda: jobs(args.files, args.repeat),
    }
    record = measure[args.what]()
    if args.folder is None:
        shutil.rmtree(folder, ignore_errors=True)
    print(json.dumps(record, indent=1))
    if args.out is not None:
        write_results(args.out, record)


def million(folder: Path, scenes: int, objects: int) -> dict[str, Any]:
    """Write the synthetic dataset here, read it in another process, so that each has its own peak of memory."""
    start = time.perf_counter()
    write_synthetic(folder, scenes, objects)
    record = {"scenes": scenes, "objects": objects, "write_seconds": time.perf_counter() - start}
    record["write_peak_mib"] = peak_mib()
    record["size_mib"] = sum(path.stat().st_size for path in folder.iterdir()) / 2**20
    command = [sys.executable, __file__, "read", "--folder", str(folder)]
    run = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, timeout=3600)
    return record | json.loads(run.stdout)


def peak_mib() -> float:
    """Most memory that was resident at a time, mapped files included."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def write_synthetic(folder: Path, scenes: int, objects: int) -> None:
    """Scenes with random poses, parents, categories and supports, shard by shard."""
    folder.mkdir(parents=True, exist_ok=True)
    out = writer.DatasetWriter(folder, FORM, {"categories": [f"Thing {number}" for number in range(CATEGORIES)]})
    out.vocabulary.place("relations", "on_top_of")
    rng = np.random.default_rng(0)
    meshes = mesh_columns()
    for first in range(0, scenes, writer.SCENES_PER_SHARD):
        out.add(synthetic(min(writer.SCENES_PER_SHARD, scenes - first), objects, rng, meshes))
    out.finish()


def mesh_columns() -> Columns:
    """The mesh table: triangles of different sizes."""
    builder = SceneBuilder()
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    for number in range(MESHES):
        mesh = mesh_from_faces(f"mesh {number}", corners * (number + 1), [[0, 1, 2]])
        builder.add(f"{number:02}", uid=f"{number}", mesh=mesh)
    columns = encode_scenes([Sample(builder.build())], FORM, Vocabulary())
    return {key: value for key, value in columns.items() if table_of(key) == "mesh"}


def synthetic(scenes: int, objects: int, rng: np.random.Generator, meshes: Columns) -> Columns:
    """Columns of random scenes, each with a relation per object."""
    count = scenes * objects
    size = widths(FORM)
    columns: Columns = dict(meshes)
    for key, column in COLUMNS.items():
        if key not in columns:
            shape = [size[item] if isinstance(item, str) else item for item in column.shape]
            columns[key] = np.zeros((0, *shape), column.dtype)
    for table in TABLES:
        rows = {"entity": objects, "relation": objects - 1}.get(table, 0)
        columns[f"{table}.ptr"] = np.arange(scenes + 1, dtype=np.int64) * rows
    place = np.tile(np.arange(objects), scenes)
    parent = np.where(place > 0, (rng.random(count) * place).astype(np.int64), -1)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]
    poses[:, :3, 3] = rng.normal(size=(count, 3))
    mesh = rng.integers(0, MESHES, count).astype(np.int32)
    below = place > 0
    columns |= {
        "scene.label": rng.integers(0, 1, scenes).astype(np.int32) - 1,
        "entity.parent": parent.astype(np.int32),
        "entity.category": rng.integers(0, CATEGORIES, count).astype(np.int32),
        "entity.type": np.zeros(count, np.int8),
        "entity.mesh": mesh,
        "entity.features": FORMS[FORM].encode(poses, stretch=True).astype(np.float32),
        "entity.bounds": columns["mesh.bounds"][mesh],
        "relation.subject": place[below].astype(np.int32),
        "relation.target": parent[below].astype(np.int32),
        "relation.kind": np.zeros(below.sum(), np.int32),
    }
    lengths = {
        "entity.name": (count, 8),
        "entity.uid": (count, 16),
        "scene.title": (scenes, 8),
        "scene.source": (scenes, 8),
    }
    for key in STRINGS:
        if table_of(key) != "mesh":
            number, length = lengths.get(key, (0, 0))
            columns[f"{key}.bytes"] = rng.integers(97, 123, number * length, dtype=np.uint8)
            columns[f"{key}.offsets"] = np.arange(number + 1, dtype=np.int64) * length
    return columns


def read(folder: Path) -> dict[str, Any]:
    """Random access, a pass over everything, and batches, in this process."""
    record: dict[str, Any] = {}
    rng = np.random.default_rng(1)
    dataset = open_dataset(folder)
    record["first_touch_ms"] = median_ms(dataset.__getitem__, dataset.starts[:-1][:20].tolist())
    start = time.perf_counter()
    total = 0.0
    for number in range(len(dataset.manifest["shards"])):
        total += float(dataset.shard(number)["entity.features"].sum())
    record["pass_seconds"] = time.perf_counter() - start
    numbers = rng.integers(0, len(dataset), 20_000).tolist()
    times = timed(lambda number: dataset[number].features.sum(), numbers)
    record["access_ms"] = {name: float(np.percentile(times, q)) for name, q in (("median", 50), ("p99", 99))}
    record["read_peak_mib"] = peak_mib()
    return record | batches(folder, rng)


def timed(call: Callable[[Any], object], arguments: list[Any]) -> list[float]:
    """Milliseconds of each call."""
    times = []
    for argument in arguments:
        start = time.perf_counter()
        call(argument)
        times.append(1000 * (time.perf_counter() - start))
    return times


def median_ms(call: Callable[[Any], object], arguments: list[Any]) -> float:
    """Median milliseconds of a call."""
    return statistics.median(timed(call, arguments))


def batches(folder: Path, rng: np.random.Generator) -> dict[str, Any]:
    """128 scenes as one batch: straight from columns, and by PyG from memory; full graphs and bare ones."""
    import torch
    from torch_geometric.data import InMemoryDataset
    from torch_geometric.loader import DataLoader

    from unisg_blender.dataset import UniSGDataset

    torch.set_num_threads(1)
    graphs = UniSGDataset(folder)
    draws = [rng.permutation(SUBSET)[:BATCH].tolist() for _ in range(30)]
    wide = [rng.integers(0, len(graphs), BATCH).tolist() for _ in range(30)]
    for draw in draws[:3]:
        graphs.batch(draw)
    record = {"ours_ms": median_ms(graphs.batch, draws), "ours_whole_dataset_ms": median_ms(graphs.batch, wide)}
    record["ours_peak_mib"] = peak_mib()

    class Memory(InMemoryDataset):
        def __init__(self, scenes: list[Any]) -> None:
            super().__init__(None)
            self.data, self.slices = self.collate(scenes)

    scenes = [graphs[number] for number in range(SUBSET)]
    for name, chosen in (("full", scenes), ("bare", [bare(scene) for scene in scenes])):
        memory = Memory(chosen)
        memory._data_list = None  # as it is after loading: scenes are cut out of the collated tensors
        loaded = DataLoader(memory, batch_size=BATCH, sampler=[number for draw in draws for number in draw])
        times, steps = [], iter(loaded)
        for _ in range(10):
            start = time.perf_counter()
            next(steps)
            times.append(1000 * (time.perf_counter() - start))
        record[f"pyg_{name}_ms"] = statistics.median(times)
        record[f"ratio_{name}"] = record[f"pyg_{name}_ms"] / record["ours_ms"]
    return {"batch_of": BATCH, "subset": SUBSET, "load_average": os.getloadavg()[0]} | record


def bare(scene: Any) -> Any:
    """Only poses, categories, hierarchy and supports: the least that a task could do with."""
    from torch_geometric.data import HeteroData

    data = HeteroData()
    data["entity"].x, data["entity"].category = scene["trs"].x, scene["entity"].category
    for kind in ("parent_of", "on_top_of"):
        data["entity", kind, "entity"].edge_index = scene["entity", kind, "entity"].edge_index
    return data


def jobs(files: list[Path], repeat: int) -> dict[str, Any]:
    """Files per second with one and with two jobs, in turn."""
    seconds: dict[int, list[float]] = {1: [], 2: []}
    count = 0
    for _ in range(repeat):
        for number in seconds:
            with tempfile.TemporaryDirectory() as folder:
                start = time.perf_counter()
                count = len(export_dataset(files, Path(folder) / "ds", ExportOptions(), jobs=number))
                seconds[number].append(time.perf_counter() - start)
    ratios = [one / two for one, two in zip(seconds[1], seconds[2], strict=True)]
    return {
        "files": count,
        "seconds": seconds,
        "files_per_second": {number: count / statistics.median(times) for number, times in seconds.items()},
        "two_jobs_over_one": statistics.median(ratios),
        "load_average": os.getloadavg()[0],
    }


if __name__ == "__main__":
    main()
