"""Assets on disk: one safetensors file, meshes read when they are asked for."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from ..errors import UniSGError
from ..scene import TYPES, Material, Mesh, SceneGraph, table
from ..scene.actions import actions_from_json, actions_to_json
from .assets import Asset
from .shards import write_file

VERSION = 1
_ARRAYS = ("points", "corners", "offsets", "edges", "normals", "material_index")


def save_assets(
    path: Path,
    assets: Iterable[Asset],
    parts: Mapping[str, NDArray[np.float32]] | None = None,
    outlines: Mapping[str, NDArray[np.float32]] | None = None,
) -> None:
    """Write assets, and boxes and floor outlines by mesh checksum; whole or not at all."""
    arrays: dict[str, NDArray[Any]] = {}
    places: dict[str, int] = {}
    index: dict[str, Any] = {"version": VERSION, "assets": [], "meshes": [], "materials": {}}
    for asset in assets:
        numbers = [_put_mesh(mesh, index, arrays, places) for mesh in asset.graph.meshes]
        index["assets"].append(_asset_record(asset, numbers))
        index["materials"] |= {name: _material_record(value) for name, value in asset.graph.materials.items()}
    for kind, shapes in (("parts", parts or {}), ("outlines", outlines or {})):
        index[kind] = list(shapes)
        sizes = [len(shape) for shape in shapes.values()]
        arrays[f"{kind}.ptr"] = np.cumsum([0, *sizes], dtype=np.int64)
        flat = [shape.reshape(len(shape), -1) for shape in shapes.values()]
        arrays[kind] = np.concatenate(flat).astype(np.float32) if flat else np.zeros((0, 1), np.float32)
    write_file(path, save(arrays, {"unisg": json.dumps(index, ensure_ascii=False)}))


def _put_mesh(mesh: Mesh, index: dict[str, Any], arrays: dict[str, NDArray[Any]], places: dict[str, int]) -> int:
    key = f"{mesh.checksum} {mesh.name} {mesh.materials}"
    if key in places:
        return places[key]
    places[key] = number = len(index["meshes"])
    index["meshes"].append({"name": mesh.name, "materials": list(mesh.materials), "uvs": list(mesh.uvs)})
    for name in _ARRAYS:
        if (values := getattr(mesh, name)) is not None:
            arrays[f"mesh.{number}.{name}"] = np.ascontiguousarray(values)
    for layer, uv in enumerate(mesh.uvs.values()):
        arrays[f"mesh.{number}.uv.{layer}"] = np.ascontiguousarray(uv)
    return number


def _asset_record(asset: Asset, meshes: list[int]) -> dict[str, Any]:
    graph = asset.graph
    actions = graph.components.get("actions")
    return {
        "category": asset.category,
        "targets": dict(asset.targets),
        "name": list(graph.name),
        "uid": list(graph.uid),
        "type": [TYPES[kind] for kind in graph.type],
        "parent": graph.parent.tolist(),
        "categories": [graph.category_name(row) for row in range(len(graph))],
        "local": graph.local.reshape(-1, 16).tolist(),
        "mesh": [meshes[place] if place >= 0 else -1 for place in graph.mesh],
        "actions": [] if actions is None else [actions.rows.tolist(), actions_to_json(tuple(actions.columns["data"]))],
    }


def _material_record(material: Material) -> list[Any]:
    return [list(material.base_color), material.metallic, material.roughness]


class AssetFile:
    """An assets file, opened; meshes are read when they are asked for.

    Raises
    ------
    UniSGError
        If the file is missing, damaged, something else, or of a newer version.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            with safe_open(str(path), framework="numpy") as file:
                self.index = json.loads((file.metadata() or {})["unisg"])
        except (OSError, SafetensorError, KeyError, ValueError) as error:
            raise UniSGError(f"{path} is no assets file ({error}): train or export again") from None
        if self.index.get("version", 0) > VERSION:
            raise UniSGError(f"{path} was written by a newer version of this software: update it")
        self._meshes: dict[int, Mesh] = {}

    def numbers(self, category: str) -> list[int]:
        """Numbers of the assets of a category ("" for room shells)."""
        return [place for place, record in enumerate(self.index["assets"]) if record["category"] == category]

    def asset(self, number: int) -> Asset:
        """One asset."""
        record = self.index["assets"][number]
        used = sorted({place for place in record["mesh"] if place >= 0})
        with safe_open(str(self.path), framework="numpy") as file:
            meshes = tuple(self._mesh(file, place) for place in used)
        vocabulary = tuple(sorted(set(record["categories"]) - {""}))
        slots = {slot for mesh in meshes for slot in mesh.materials}
        materials = [(name, value) for name, value in self.index["materials"].items() if name in slots]
        graph = SceneGraph(
            name=tuple(record["name"]),
            uid=tuple(record["uid"]),
            type=np.array([TYPES.index(kind) for kind in record["type"]], np.int8),
            parent=np.array(record["parent"], np.int32),
            category=np.array([vocabulary.index(name) if name else -1 for name in record["categories"]], np.int32),
            vocabulary=vocabulary,
            local=np.array(record["local"]).reshape(-1, 4, 4),
            mesh=np.array([used.index(place) if place >= 0 else -1 for place in record["mesh"]], np.int32),
            meshes=meshes,
            materials={name: Material(name, tuple(color), metal, rough) for name, (color, metal, rough) in materials},
        )
        if record["actions"]:
            rows, text = record["actions"]
            graph = graph.with_component("actions", table(rows, data=actions_from_json(text)))
        return Asset(record["category"], graph, record["targets"])

    def _mesh(self, file: Any, number: int) -> Mesh:
        if number not in self._meshes:
            record, keys = self.index["meshes"][number], set(file.keys())
            arrays = {name: file.get_tensor(key) for name in _ARRAYS if (key := f"mesh.{number}.{name}") in keys}
            uvs = {layer: file.get_tensor(f"mesh.{number}.uv.{place}") for place, layer in enumerate(record["uvs"])}
            self._meshes[number] = Mesh(record["name"], **arrays, uvs=uvs, materials=tuple(record["materials"]))
        return self._meshes[number]

    def shapes(self, kind: str) -> dict[str, NDArray[np.float32]]:
        """Boxes ("parts", each (K, 2, 3)) or floor outlines ("outlines", each (K, 2)) by mesh checksum."""
        with safe_open(str(self.path), framework="numpy") as file:
            values, ptr = file.get_tensor(kind), file.get_tensor(f"{kind}.ptr")
        shape = (-1, 2, 3) if kind == "parts" else (-1, 2)
        return {
            key: values[start:stop].reshape(shape)
            for key, start, stop in zip(self.index[kind], ptr[:-1], ptr[1:], strict=True)
        }
