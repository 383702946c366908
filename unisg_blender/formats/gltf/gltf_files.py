"""A scenegraph as glTF 2.0: what every viewer shows, and for our own reading the scene to the last bit.

The view: a node for each entity, its custom properties as ``extras`` (categories, uids, actions, relations and lessons
as :mod:`~...scene.properties` writes them), instances as nodes of their own. The scene: the record of
:mod:`..json_scenes` and the arrays of its meshes as buffer views that viewers pass over; ``extras`` say which. It
counts only where the view is still the one that was written beside it: what another tool has changed is read as any
glTF file is.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...runtime.atomic_files import checksum, read_plain, write_file
from ...runtime.json_records import check_version, parse_json
from ...runtime.read_report import ReadReport
from ...scene import SceneGraph
from ...scene.components import ANIMATION
from ...scene.realize_instances import realize
from ..json_scenes import ARRAYS, KEY, VERSION, RecordReader, RecordWriter, damaged
from .gltf_buffers import Buffers
from .gltf_container import packed, unpacked
from .gltf_lessons import add_lessons
from .gltf_meshes import MeshWriter
from .gltf_motion import animations
from .gltf_nodes import LIGHTS, NodeWriter

VIEW = "unisg_view"
"""In the file's extras: the checksum of the nodes that were written beside the scene."""


def write_gltf(graph: SceneGraph, path: Path, whole: bool = True) -> ReadReport:
    """Write a scenegraph as ``.glb`` or ``.gltf``; returns what other viewers will not show of it.

    The file is complete, or is not written at all. Without ``whole`` it is for viewers only: smaller, and read back as
    any glTF file is.

    Raises
    ------
    UniSGError
        If the file cannot be written.
    """
    report, buffers = ReadReport(), Buffers()
    document = _document(realize(graph), buffers, report)
    if whole:
        document["extras"] = {KEY: _scene_view(graph, buffers), VIEW: _view(document)}
    if buffers.views:
        document |= {"bufferViews": buffers.views}
    if buffers.accessors:
        document |= {"accessors": buffers.accessors}
    write_file(path, packed(document, buffers.data, path.suffix.lower() == ".glb"))
    return report


def read_own_gltf(path: Path) -> SceneGraph | None:
    """The scene that :func:`write_gltf` wrote; None for a file that it did not write, or that was changed since.

    Raises
    ------
    UniSGError
        If the scene in it is damaged, or was written by a newer version.
    """
    try:
        content = read_plain(path)
        if VIEW.encode() not in content:
            return None
        document, data = unpacked(content, str(path))
        extras = document["extras"]
        unchanged = KEY in extras and extras[VIEW] == _view(document)
    except (OSError, UniSGError, LookupError, TypeError, ValueError):
        return None  # what is wrong with it is for Blender's reader to say
    if not unchanged:
        return None
    with damaged(path):
        views = [data[view["byteOffset"] :][: view["byteLength"]] for view in document["bufferViews"]]
        record = parse_json(views[extras[KEY]], "its record")
    check_version(record.get(KEY), f"cannot read {path}: it has", VERSION)
    with damaged(path):
        record["meshes"] = [_with_arrays(mesh, views) for mesh in record["meshes"]]
        return RecordReader(record).scene(record)


def _document(graph: SceneGraph, buffers: Buffers, report: ReadReport) -> dict[str, Any]:
    from ... import __version__

    meshes = MeshWriter(buffers, graph.materials)
    nodes = NodeWriter(graph, meshes, report)
    roots = np.flatnonzero(graph.parent < 0).tolist()
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": f"UniSG for Blender {__version__}"},
        "scene": 0,
        "scenes": [{"name": graph.title} | ({"nodes": roots} if roots else {})],
    }
    moving = animations(graph, buffers, report) if ANIMATION in graph.components else []
    parts = {"nodes": nodes.nodes, "meshes": meshes.meshes, "materials": meshes.materials, "cameras": nodes.cameras}
    document |= {name: found for name, found in (parts | {"animations": moving}).items() if found}
    if nodes.lights:
        document |= {"extensionsUsed": [LIGHTS], "extensions": {LIGHTS: {"lights": nodes.lights}}}
    add_lessons(graph, document, report)
    return document


def _view(document: Any) -> str:
    seen = [document.get(key) for key in ("scenes", "nodes", "meshes", "materials")]
    return checksum(json.dumps(seen, sort_keys=True).encode())


def _scene_view(graph: SceneGraph, buffers: Buffers) -> int:
    """Store a scene; the number of the view with its record as JSON."""
    writer = RecordWriter()
    record = {KEY: VERSION} | writer.scene(graph)
    meshes = [
        {"name": mesh.name, "materials": mesh.materials}
        | {name: _stored(values, buffers) for name in ARRAYS if (values := getattr(mesh, name)) is not None}
        | {"uvs": {name: _stored(values, buffers) for name, values in mesh.uvs.items()}}
        for mesh in writer.meshes
    ]
    text = json.dumps(record | {"meshes": meshes, "prototypes": writer.prototypes})
    return buffers.view(np.frombuffer(text.encode(), np.uint8))


def _stored(values: NDArray[Any], buffers: Buffers) -> Any:
    """Where an array is; [] for an empty one, for which there is no view."""
    return {"view": buffers.view(values), "dtype": values.dtype.str} if values.size else []


def _with_arrays(mesh: dict[str, Any], views: Sequence[bytes]) -> dict[str, Any]:
    """The record of a mesh, its arrays in the place of what says where they are."""

    def taken(stored: Any) -> Any:
        """The array of a view."""
        return np.frombuffer(views[stored["view"]], stored["dtype"]) if stored else stored

    found = {name: taken(mesh[name]) for name in ARRAYS if name in mesh}
    return mesh | found | {"uvs": {name: taken(value) for name, value in mesh["uvs"].items()}}
