"""Assets on disk: one safetensors file, meshes read when they are asked for."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from ...errors import UniSGError
from ...runtime.atomic_files import DamagedError, check_plain, write_file
from ...runtime.json_records import from_record, parse_json
from ...scene import TYPES, Material, Mesh, SceneGraph, table
from ...scene.action_data import actions_from_json, actions_to_json
from ...scene.mesh import check_mesh
from .asset import Asset

VERSION = 1
_ARRAYS = ("points", "corners", "offsets", "edges", "normals", "material_index")

Arrays = dict[str, NDArray[Any]]
Shapes = Mapping[str, NDArray[np.float32]]
"""Boxes or outlines by mesh checksum."""


def pack_assets(
    assets: Iterable[Asset], parts: Shapes | None = None, outlines: Shapes | None = None, sources: Sequence[str] = ()
) -> tuple[Arrays, dict[str, Any]]:
    """Assets, and boxes and floor outlines of meshes, as arrays and a JSON-ready index.

    ``sources`` says where each asset comes from, if that is to be kept.
    """
    arrays: Arrays = {}
    places: dict[str, int] = {}
    index: dict[str, Any] = {"version": VERSION, "assets": [], "meshes": [], "materials": {}}
    for number, asset in enumerate(assets):
        renamed = _put_materials(asset.graph.materials, index["materials"])
        meshes = [_put_mesh(mesh, renamed, index, arrays, places) for mesh in asset.graph.meshes]
        origin = {"source": sources[number], "key": asset.key, "faces": asset.faces} if sources else {}
        index["assets"].append(_asset_record(asset, meshes) | origin)
    for kind, shapes in (("parts", parts or {}), ("outlines", outlines or {})):
        index[kind] = list(shapes)
        sizes = [len(shape) for shape in shapes.values()]
        arrays[f"{kind}.ptr"] = np.cumsum([0, *sizes], dtype=np.int64)
        flat = [shape.reshape(len(shape), -1) for shape in shapes.values() if len(shape)]
        arrays[kind] = np.concatenate(flat).astype(np.float32) if flat else np.zeros((0, 1), np.float32)
    return arrays, index


def assets_bytes(arrays: Arrays, index: Mapping[str, Any]) -> bytes:
    """What :func:`pack_assets` gives, as the bytes of an assets file."""
    return save(arrays, {"unisg": json.dumps(index)})  # ASCII: paths need not be Unicode


def save_assets(path: Path, assets: Iterable[Asset]) -> None:
    """Write an assets file without boxes and outlines; whole or not at all."""
    write_file(path, assets_bytes(*pack_assets(assets)))


def _put_materials(materials: Mapping[str, Material], known: dict[str, list[Any]]) -> dict[str, str]:
    """Take in materials; returns other names for those whose names stand for something else already."""
    renamed = {}
    for name, material in materials.items():
        record, free, number = _material_record(material), name, 0
        while known.setdefault(free, record) != record:
            number += 1
            free = f"{name}.{number:03d}"
        renamed[name] = free
    return renamed


def _put_mesh(
    mesh: Mesh, renamed: Mapping[str, str], index: dict[str, Any], arrays: Arrays, places: dict[str, int]
) -> int:
    materials = [renamed.get(name, name) for name in mesh.materials]
    key = f"{mesh.checksum} {mesh.name} {materials}"
    if key in places:
        return places[key]
    places[key] = number = len(index["meshes"])
    index["meshes"].append({"name": mesh.name, "materials": materials, "uvs": list(mesh.uvs)})
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


@dataclass(frozen=True)
class IndexRecord:
    """What the index of an assets file holds; each asset and mesh is looked at when it is asked for."""

    assets: tuple[CategoryRecord, ...]
    meshes: list[Any]
    materials: Mapping[str, tuple[tuple[float, ...], float, float]]
    version: int = 0
    parts: tuple[str, ...] = ()
    outlines: tuple[str, ...] = ()
    extra: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class CategoryRecord:
    """What is known of every asset without opening it."""

    category: str
    extra: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class AssetRecord:
    """An asset."""

    category: str
    targets: Mapping[str, str]
    name: tuple[str, ...]
    uid: tuple[str, ...]
    type: tuple[str, ...]
    parent: tuple[int, ...]
    categories: tuple[str, ...]
    local: tuple[tuple[float, ...], ...]
    mesh: tuple[int, ...]
    actions: list[Any]
    extra: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class MeshRecord:
    """A mesh of assets."""

    name: str
    materials: tuple[str, ...]
    uvs: tuple[str, ...]


class Assets:
    """Assets by number; meshes are fetched when they are asked for.

    Parameters
    ----------
    index
        As :func:`pack_assets` gives it.
    fetch
        Gives those of some arrays, by name, that there are.
    """

    def __init__(self, index: dict[str, Any], fetch: Callable[[Iterable[str]], Arrays]) -> None:
        self.index = index
        self._fetch = fetch
        self._meshes: dict[int, Mesh] = {}
        self._shapes: dict[str, dict[str, NDArray[np.float32]]] = {}

    def numbers(self, category: str) -> list[int]:
        """Numbers of the assets of a category ("" for room shells)."""
        return [place for place, record in enumerate(self.index["assets"]) if record["category"] == category]

    def asset(self, number: int) -> Asset:
        """One asset; DamagedError if it is not what was written."""
        try:
            return self._asset(from_record(AssetRecord, self.index["assets"][number], f"asset {number}"))
        except (UniSGError, ValueError, IndexError, KeyError, TypeError, OverflowError) as error:
            raise DamagedError(f"asset {number} is damaged ({error}): train or export again") from None

    def _asset(self, record: AssetRecord) -> Asset:
        used = sorted({place for place in record.mesh if place >= 0})
        meshes = tuple(map(self._mesh, used))
        vocabulary = tuple(sorted(set(record.categories) - {""}))
        slots = {slot for mesh in meshes for slot in mesh.materials}
        materials = [(name, value) for name, value in self.index["materials"].items() if name in slots]
        graph = SceneGraph(
            name=tuple(record.name),
            uid=tuple(record.uid),
            type=np.array([TYPES.index(kind) for kind in record.type], np.int8),
            parent=np.array(record.parent, np.int32),
            category=np.array([vocabulary.index(name) if name else -1 for name in record.categories], np.int32),
            vocabulary=vocabulary,
            local=np.array(record.local).reshape(-1, 4, 4),
            mesh=np.array([used.index(place) if place >= 0 else -1 for place in record.mesh], np.int32),
            meshes=meshes,
            materials={name: Material(name, tuple(color), metal, rough) for name, (color, metal, rough) in materials},
        )
        if record.actions:
            rows, text = record.actions
            if not isinstance(text, str):
                raise ValueError("its actions are no text")
            graph = graph.with_component("actions", table(rows, data=actions_from_json(text)))
        return Asset(record.category, graph.validate(), record.targets)

    def _mesh(self, number: int) -> Mesh:
        if number not in self._meshes:
            record, key = from_record(MeshRecord, self.index["meshes"][number], f"mesh {number}"), f"mesh.{number}."
            layers = [f"{key}uv.{place}" for place in range(len(record.uvs))]
            found = self._fetch([*(key + name for name in _ARRAYS), *layers])
            arrays = {name: found[key + name] for name in _ARRAYS if key + name in found}
            uvs = {layer: found[name] for layer, name in zip(record.uvs, layers, strict=True)}
            mesh = Mesh(record.name, **arrays, uvs=uvs, materials=record.materials)
            check_mesh(mesh)
            self._meshes[number] = mesh
        return self._meshes[number]

    def shapes(self, kind: str) -> dict[str, NDArray[np.float32]]:
        """Boxes ("parts", each (K, 2, 3)) or floor outlines ("outlines", each (K, 2)) by mesh checksum."""
        if kind not in self._shapes:
            shape = (-1, 2, 3) if kind == "parts" else (-1, 2)
            try:
                found = self._fetch([kind, f"{kind}.ptr"])
                values, ptr = found[kind], found[f"{kind}.ptr"]
                if values.dtype != np.float32 or not np.isfinite(values).all():
                    raise ValueError("no finite float32")
                self._shapes[kind] = {
                    key: values[start:stop].reshape(shape)
                    for key, start, stop in zip(self.index[kind], ptr[:-1], ptr[1:], strict=True)
                }
            except (ValueError, KeyError, TypeError, IndexError) as error:
                raise DamagedError(f"the {kind} of the assets are damaged ({error}): train or export again") from None
        return self._shapes[kind]


class AssetFile(Assets):
    """An assets file, opened.

    Raises
    ------
    UniSGError
        If the file is missing, damaged, something else, or of a newer version.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            check_plain(path)
            with safe_open(str(path), framework="numpy") as file:
                index = parse_json((file.metadata() or {})["unisg"], "its index")
                known = from_record(IndexRecord, index, "its index")
        except (OSError, SafetensorError, KeyError, UniSGError) as error:
            raise UniSGError(f"{path} is no assets file ({error}): train or export again") from None
        if known.version > VERSION:
            raise UniSGError(f"{path} was written by a newer version of this software: update it")
        super().__init__(index, self._read)

    def _read(self, names: Iterable[str]) -> Arrays:
        with safe_open(str(self.path), framework="numpy") as file:
            there = set(file.keys())
            return {name: file.get_tensor(name) for name in names if name in there}
