"""A scene as JSON: all of it, with names for what the numbers are, so that other programs and people can read it.

The file is an object with ``unisg_scene`` (the version), the scene and what it shares with the prototypes of its
instances: ``meshes`` and ``prototypes``, which have the form of the scene. A scene has ``title``, ``vocabulary``,
``mesh_numbers`` (its own meshes among those of the file), ``materials``, ``components`` (for each table ``rows``
and ``columns``), perhaps ``frames`` (the one that is shown, range, rate), and ``entities``: each with name, uid, type,
category, uid of the parent, number of the mesh, and matrices ``local`` and ``world`` (rows; metres). ``world`` and
``actions`` are said once more for other programs and are not read back.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..runtime.atomic_files import check_plain, read_plain, write_file
from ..runtime.json_records import check_version, from_record, parse_json, to_record
from ..scene import ActionData, FrameRange, LessonNode, Material, Mesh, SceneGraph, Table
from ..scene.graph import TYPE_INDEX
from ..scene.lesson_node import lesson_from_json
from ..scene.mesh import check_mesh, shown_slots
from ..scene.scene_text import to_records

KEY = "unisg_scene"
VERSION = 1
HEAD = 200
"""Bytes at the start of a file among which its key is looked for."""

ARRAYS = ("points", "corners", "offsets", "edges", "normals", "material_index")


def write_json(graph: SceneGraph, path: Path) -> None:
    """Write a scenegraph as JSON; the file is complete, or is not written at all.

    Raises
    ------
    UniSGError
        If the file cannot be written, or a component holds values that have no JSON form.
    """
    writer = RecordWriter()
    record = {KEY: VERSION} | writer.scene(graph)
    record |= {"meshes": [writer.mesh(mesh) for mesh in writer.meshes], "prototypes": writer.prototypes}
    write_file(path, json.dumps(record))


def is_own_scene(path: Path) -> bool:
    """Whether a file begins as :func:`write_json` begins; that it cannot be read is for its reader to say."""
    try:
        check_plain(path)
        with open(path, "rb") as file:
            return KEY.encode() in file.read(len(KEY) + HEAD)
    except OSError:
        return True


def read_json(path: Path) -> SceneGraph:
    """The scenegraph that :func:`write_json` wrote.

    Raises
    ------
    UniSGError
        If the file cannot be read, is no such file, or was written by another version.
    """
    try:
        record = parse_json(read_plain(path), f"cannot read {path}: it")
    except OSError as error:
        raise UniSGError(f"cannot read {path}: {error.strerror or error}") from None
    if not isinstance(record, dict) or KEY not in record:
        raise UniSGError(f"cannot read {path}: it holds no scene with its geometry; convert or generate it again")
    check_version(record[KEY], f"cannot read {path}: it has", VERSION)
    with damaged(path):
        return RecordReader(record).scene(record)


@contextmanager
def damaged(path: Path) -> Iterator[None]:
    """Whatever a record raises that is not whole becomes one UniSGError."""
    try:
        yield
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError, UniSGError) as error:
        raise UniSGError(f"cannot read {path}: the scene in it is damaged: {error}") from None


class RecordWriter:
    """Records of scenes; meshes and prototypes are numbered as they are met."""

    def __init__(self) -> None:
        self.meshes: dict[Mesh, int] = {}
        self.prototypes: list[dict[str, Any]] = []
        self._numbers: dict[SceneGraph, int] = {}

    def scene(self, graph: SceneGraph) -> dict[str, Any]:
        """A scene, its meshes by their numbers in the file."""
        numbers = [self.meshes.setdefault(mesh, len(self.meshes)) for mesh in graph.meshes]
        entities = [
            record | {"mesh": numbers[mesh] if mesh >= 0 else None}
            for record, mesh in zip(to_records(graph), graph.mesh.tolist(), strict=True)
        ]
        frames = {} if graph.frames is None else {"frames": to_record(graph.frames)}
        return frames | {
            "title": graph.title,
            "entities": entities,
            "vocabulary": graph.vocabulary,
            "mesh_numbers": numbers,
            "materials": [to_record(material) for material in graph.materials.values()],
            "components": {name: self._table(name, found) for name, found in graph.components.items()},
        }

    def mesh(self, mesh: Mesh) -> dict[str, Any]:
        """A mesh with all its arrays."""
        arrays = {name: getattr(mesh, name) for name in ARRAYS}
        record: dict[str, Any] = {"name": mesh.name, "materials": mesh.materials}
        record |= {name: values.tolist() for name, values in arrays.items() if values is not None}
        return record | {"uvs": {name: values.tolist() for name, values in mesh.uvs.items()}}

    def _table(self, name: str, found: Table) -> dict[str, Any]:
        columns = {key: self._array(values, f"{name}.{key}") for key, values in found.columns.items()}
        return {"rows": found.rows.tolist(), "columns": columns}

    def _array(self, values: NDArray[Any], name: str) -> dict[str, Any]:
        flat = values.reshape(-1).tolist()
        plain = [self._value(value, name) for value in flat] if values.dtype == object else flat
        return {"dtype": values.dtype.str, "shape": values.shape, "values": plain}

    def _value(self, value: Any, name: str) -> Any:
        if value is None or isinstance(value, str | bool | int | float):
            return value
        if isinstance(value, list):
            return [self._value(item, name) for item in value]
        if isinstance(value, tuple):
            return {"tuple": [self._value(item, name) for item in value]}
        if isinstance(value, dict) and all(isinstance(key, str) for key in value):
            return {"object": {key: self._value(item, name) for key, item in value.items()}}
        if isinstance(value, np.ndarray):
            return {"array": self._array(value, name)}
        if isinstance(value, ActionData):
            return {"action": to_record(value)}
        if isinstance(value, LessonNode):
            return {"lesson": to_record(value)}
        if isinstance(value, SceneGraph):
            return {"prototype": self._prototype(value)}
        raise UniSGError(f"the component {name} holds values that JSON cannot: make them numbers or text")

    def _prototype(self, graph: SceneGraph) -> int:
        if graph not in self._numbers:
            record = self.scene(graph)  # what it instances itself comes before it
            self._numbers[graph] = len(self.prototypes)
            self.prototypes.append(record)
        return self._numbers[graph]


class RecordReader:
    """Scenes out of their records."""

    def __init__(self, record: Mapping[str, Any]) -> None:
        self._meshes = [_mesh(each) for each in record["meshes"]]
        self._prototypes: list[SceneGraph] = []
        self._prototypes.extend(map(self.scene, record["prototypes"]))

    def scene(self, record: Mapping[str, Any]) -> SceneGraph:
        """The scene of a record, with the meshes and prototypes of the file."""
        entities, vocabulary = record["entities"], tuple(record["vocabulary"])
        rows = {entity["uid"]: row for row, entity in enumerate(entities)}
        parent = [-1 if (uid := each["parent"]) is None else rows[uid] for each in entities]
        place = {number: index for index, number in reversed(list(enumerate(record["mesh_numbers"])))}
        category = {name: index for index, name in enumerate(vocabulary)} | {"": -1}
        return SceneGraph(
            name=_column(entities, "name"),
            uid=_column(entities, "uid"),
            type=np.array([TYPE_INDEX[each["type"]] for each in entities], np.int8),
            parent=np.array(parent, np.int32),
            category=np.array([category[each["category"]] for each in entities], np.int32),
            vocabulary=vocabulary,
            local=np.array([each["local"] for each in entities], np.float64).reshape(len(entities), 4, 4),
            mesh=np.array([-1 if each["mesh"] is None else place[each["mesh"]] for each in entities], np.int32),
            meshes=tuple(self._meshes[number] for number in record["mesh_numbers"]),
            materials={each["name"]: from_record(Material, each, "material") for each in record["materials"]},
            components={name: self._table(found) for name, found in record["components"].items()},
            title=record["title"],
            frames=from_record(FrameRange, record["frames"], "the record of frames") if "frames" in record else None,
        ).validate()

    def _table(self, record: Mapping[str, Any]) -> Table:
        rows = np.array(record["rows"], np.int32)
        return Table(rows, {name: self._array(values) for name, values in record["columns"].items()})

    def _array(self, record: Mapping[str, Any]) -> NDArray[Any]:
        dtype = np.dtype(record["dtype"])
        if not dtype.hasobject:
            return np.array(record["values"], dtype).reshape(record["shape"])
        values = np.empty(len(record["values"]), object)
        for place, value in enumerate(record["values"]):  # one by one: numpy would unpack tuples
            values[place] = self._value(value)
        return values.reshape(record["shape"])

    def _value(self, value: Any) -> Any:
        if isinstance(value, list):
            return [self._value(item) for item in value]
        if not isinstance(value, dict):
            return value
        ((kind, content),) = value.items()
        match kind:
            case "tuple":
                return tuple(self._value(item) for item in content)
            case "object":
                return {key: self._value(item) for key, item in content.items()}
            case "array":
                return self._array(content)
            case "action":
                return from_record(ActionData, content, "action")
            case "lesson":
                return lesson_from_json(json.dumps(content))
            case "prototype":
                return self._prototypes[content]
        raise ValueError(f"a value of the kind {kind!r} is unknown")


def _column(entities: Sequence[Mapping[str, Any]], name: str) -> tuple[str, ...]:
    return tuple(str(each[name]) for each in entities)


def _mesh(record: Mapping[str, Any]) -> Mesh:
    def array(name: str, dtype: type[np.generic], *shape: int) -> Any:
        return np.array(record[name], dtype).reshape(*shape) if name in record else None

    mesh = Mesh(
        name=record["name"],
        points=array("points", np.float32, -1, 3),
        corners=array("corners", np.int32, -1),
        offsets=array("offsets", np.int32, -1),
        edges=array("edges", np.int32, -1, 2),
        normals=array("normals", np.float32, -1, 3),
        uvs={name: np.array(values, np.float32).reshape(-1, 2) for name, values in record["uvs"].items()},
        material_index=array("material_index", np.int32, -1),
        materials=tuple(record["materials"]),
    )
    if mesh.material_index is not None:
        mesh = replace(mesh, material_index=shown_slots(mesh.material_index, len(mesh.materials)))
    check_mesh(mesh)
    return mesh
