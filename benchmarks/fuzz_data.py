"""Hostile models and datasets for :mod:`.fuzz`: their checksums are right, what they say is not."""

from __future__ import annotations

import copy
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.dataset import open_dataset, write_dataset
from unisg_blender.dataset.dataset_description import describe_dataset
from unisg_blender.dataset.format.gather import gather
from unisg_blender.dataset.format.shards import map_shard, pack_shard
from unisg_blender.dataset.rebuild import to_scenegraph
from unisg_blender.generate import Generator
from unisg_blender.predict.category_model import LabelModel
from unisg_blender.predict.category_proposals import propose_categories
from unisg_blender.predict.scene_kind import SceneModel
from unisg_blender.predict.support_prediction import TopologyModel
from unisg_blender.pretrained import FOLDER
from unisg_blender.runtime.atomic_files import checksum
from unisg_blender.runtime.onnx_session import KEY
from unisg_blender.scene import SceneBuilder
from unisg_blender.worlds import cubes, living_room

Case = Callable[[], object]
Random = np.random.Generator

NONSENSE: tuple[Any, ...] = (
    None, True, 0, -1, 1, 3.5, 10**9, -(10**9), 2**63, 10**400, 1e308, float("nan"), float("inf"), "", "x", "\ud800",
    "../../etc/passwd", "x" * 300, [], {}, [[]], [None], {"": {}}, [1, 2, 3], ["a", 1],
)  # fmt: skip


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The ways to all that stands in JSON-ready values, one or two of long lists."""
    found = [path] if path else []
    if isinstance(value, dict):
        return found + [way for key in value for way in places(value[key], (*path, key))]
    if isinstance(value, list):
        return found + [way for place in range(min(2, len(value))) for way in places(value[place], (*path, place))]
    return found


def mutated(value: Any, rng: Random) -> Any:
    """JSON-ready values with one to three entries replaced, removed or added."""
    value = copy.deepcopy(value)
    for _ in range(rng.integers(1, 4)):
        ways = places(value)
        if not ways:
            return value
        *way, last = ways[rng.integers(len(ways))]
        holder = value
        for key in way:
            holder = holder[key]
        choice = rng.random()
        if choice < 0.2:
            del holder[last]
        elif choice < 0.3 and isinstance(holder, list):
            holder.append(copy.deepcopy(holder[last]))
        else:
            holder[last] = copy.deepcopy(NONSENSE[rng.integers(len(NONSENSE))])
    return value


def with_other_bytes(data: bytes, rng: Random) -> bytes:
    """Some bytes changed, removed or doubled, or the end cut off."""
    changed = bytearray(data)
    for _ in range(rng.integers(1, 6)):
        place, size = int(rng.integers(len(changed))), int(rng.integers(1, 9))
        choice = rng.integers(4)
        if choice == 0:
            changed[place : place + size] = rng.bytes(size)
        elif choice == 1:
            del changed[place : place + size]
        elif choice == 2:
            changed[place:place] = changed[place : place + size]
        else:
            changed[place : place + 4] = np.float32(rng.choice([np.nan, np.inf, 1e38, 0.0])).tobytes()
    return bytes(changed[: rng.integers(1, len(changed))] if rng.random() < 0.1 else changed)


def prepare_models(folder: Path) -> Callable[[Random], Case]:
    """Every kind of model that is shipped, with other metadata, other bytes, other tensors."""
    scene = living_room(0)
    asks: dict[str, Callable[[Path], object]] = {
        "operating_room_paper.onnx": lambda path: _generate(path, {"Scalpel": 1}),
        "living_room.onnx": lambda path: _generate(path, {"Cup": 1}),
        "living_room.behaviour.onnx": lambda path: _generate(path.with_name("living_room.onnx"), {"Cup": 1}),
        "living_room.assets.safetensors": lambda path: _generate(path.with_name("living_room.onnx"), {"Cup": 1}),
        "classifier.onnx": lambda path: SceneModel(path).classify(scene),
        "topology.onnx": lambda path: TopologyModel(path).find(scene),
        "labels.safetensors": lambda path: propose_categories(
            cubes(0), LabelModel.load(path), rows=range(3), use=("shape", "name")
        ),
    }
    names = sorted(asks)
    for path in FOLDER.iterdir():
        if path.suffix in (".onnx", ".safetensors"):
            shutil.copy(path, folder / path.name)

    def make(rng: Random) -> Case:
        name = names[rng.integers(len(names))]
        data = (FOLDER / name).read_bytes()
        metadata = rng.random() < 0.7
        change = (_metadata_changed if metadata else with_other_bytes) if name.endswith(".onnx") else _packed_changed
        changed = change(data, rng)

        def case() -> None:
            try:
                (folder / name).write_bytes(changed)
                asks[name](folder / name)
            finally:
                (folder / name).write_bytes(data)

        return case

    return make


def _generate(path: Path, counts: dict[str, int]) -> None:
    generator = Generator.load(path)
    generator.sample_counts(np.random.default_rng(0))
    scene = living_room(0) if "Cup" in counts else SceneBuilder("Room").build()
    generator.add(scene, counts, seed=0, behaviour=True)


def _metadata_changed(data: bytes, rng: Random) -> bytes:
    import onnx

    model = onnx.load_from_string(data)
    for entry in model.metadata_props:
        if entry.key == KEY:
            entry.value = _text(mutated(json.loads(entry.value), rng))
    return model.SerializeToString()


def _text(value: Any) -> str:
    return json.dumps(value).encode("utf-8", "surrogatepass").decode("utf-8", "replace")


def _packed_changed(data: bytes, rng: Random) -> bytes:
    """Another safetensors file: metadata or arrays changed, or bytes."""
    from safetensors.numpy import load, save

    if rng.random() < 0.3:
        return with_other_bytes(data, rng)
    size = int.from_bytes(data[:8], "little")
    notes = json.loads(data[8 : 8 + size])["__metadata__"]
    arrays = dict(sorted(load(data).items()))  # safetensors shuffles them
    if rng.random() < 0.5:
        key = next((key for key in notes if notes[key].startswith("{")), next(iter(notes)))
        notes[key] = _text(mutated(json.loads(notes[key]), rng))
    else:
        arrays = with_other_arrays(arrays, rng)
    return save({key: np.ascontiguousarray(values) for key, values in arrays.items()}, notes)


def with_other_arrays(arrays: dict[str, np.ndarray], rng: Random) -> dict[str, np.ndarray]:
    """One or two arrays removed, cut, of another type or shape, or with other values."""
    arrays = dict(arrays)
    for _ in range(rng.integers(1, 3)):
        key = list(arrays)[rng.integers(len(arrays))]
        values = arrays[key]
        choice = rng.integers(7)
        if choice == 0 and len(arrays) > 1:
            del arrays[key]
        elif choice == 1:
            arrays[key] = values[: rng.integers(len(values) + 1)] if values.ndim else values
        elif choice == 2:
            kinds = [np.float64, np.float32, np.int64, np.int32, np.int8, np.uint8, np.bool_]
            with np.errstate(all="ignore"):
                arrays[key] = values.astype(kinds[rng.integers(len(kinds))])
        elif choice == 3:
            arrays[key] = values.reshape(-1) if rng.random() < 0.5 else values[..., None]
        elif choice == 4:
            arrays[key] = np.concatenate([values, values]) if values.ndim else values
        elif values.size:
            values = values.copy()
            bad = [-1, -2, 127, 0, 1, 100] if values.dtype.itemsize == 1 else [-1, -2, 2**31 - 1, -(2**31), 0, 7]
            bad = [np.nan, np.inf, -1e38, 0.0] if values.dtype.kind == "f" else bad
            with np.errstate(all="ignore"):
                worse = np.array(bad[rng.integers(len(bad))]).astype(values.dtype)
            values.reshape(-1)[rng.integers(values.size)] = worse
            arrays[key] = values
    return arrays


def prepare_datasets(folder: Path) -> Callable[[Random], Case]:
    """A small dataset of rooms with lessons, with other columns, another manifest, other assets."""
    whole = folder / "whole"
    write_dataset([living_room(0), cubes(0), living_room(1)], whole, "dual_quaternion")
    manifest = json.loads((whole / "manifest.json").read_text())
    shard = map_shard(whole / manifest["shards"][0]["file"])
    columns, notes = {key: np.array(values) for key, values in shard.columns.items()}, shard.notes

    def make(rng: Random) -> Case:
        broken = folder / "broken"
        shutil.rmtree(broken, ignore_errors=True)
        shutil.copytree(whole, broken)
        record, choice = copy.deepcopy(manifest), rng.random()
        if choice < 0.6:
            _replace(broken, record["shards"][0], pack_shard(with_other_arrays(columns, rng), notes))
        elif choice < 0.7:
            old = (broken / record["shards"][0]["file"]).read_bytes()
            _replace(broken, record["shards"][0], with_other_bytes(old, rng))
        elif choice < 0.8:
            _replace(broken, record["assets"], _packed_changed((broken / record["assets"]["file"]).read_bytes(), rng))
        else:
            record = mutated(record, rng)
        (broken / "manifest.json").write_text(_text(record))
        return lambda: look_at(broken)

    return make


def _replace(folder: Path, entry: dict[str, Any], data: bytes) -> None:
    (folder / entry["file"]).write_bytes(data)
    entry["sha256"] = checksum(data)


def look_at(path: Path) -> None:
    """Everything that is read of a dataset."""
    describe_dataset(path)
    dataset = open_dataset(path)
    dataset.check()
    dataset.split([0.5, 0.5], 0)
    for scene in dataset:
        graph = to_scenegraph(scene)
        assert len(graph) == len(scene)
        _ = scene.label, scene.title, scene.source, scene.categories
    gather(dataset, range(len(dataset)))
    dataset.columns(0, len(dataset))
    assets = dataset.assets()
    if assets is not None:
        for number in range(min(3, len(assets.index["assets"]))):
            assets.asset(number)
        for kind in ("parts", "outlines"):
            assets.shapes(kind)
