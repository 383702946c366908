"""From scenegraphs to columns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...behaviour.lesson.action_vector import WIDTH as ACTION_WIDTH
from ...behaviour.lesson.behaviour_links import NODE_CHANNELS
from ...errors import UniSGError, did_you_mean
from ...poses import FORMS
from ...poses.forms import STRETCH_WIDTH
from ...scene import Mesh, SceneGraph, local_bounds
from .behaviour_rows import behaviour_rows, relation_rows
from .columns import COLUMN_TABLES, Columns, Vocabulary, in_order_of_appearance, pack_strings
from .schema import COLUMNS, MESH_CHANNELS, STRINGS, TABLES

MeshEncoder = Callable[[Mesh], NDArray[np.floating]]
"""Gives a feature vector (K,) of a mesh; K is the same for all meshes."""


@dataclass(frozen=True)
class Sample:
    """A scene for a dataset: ``source`` says where it comes from, ``label`` which kind of scene it is ("" unknown)."""

    graph: SceneGraph
    source: str = ""
    label: str = ""


def as_sample(item: SceneGraph | Sample) -> Sample:
    """A bare scenegraph as a sample whose source is its title."""
    return item if isinstance(item, Sample) else Sample(item, item.title)


def known_form(name: str) -> str:
    """The name itself; UniSGError if there is no such form."""
    if name not in FORMS:
        raise UniSGError(f"unknown form {name!r}{did_you_mean(name, FORMS)}: choose one of {', '.join(FORMS)}")
    return name


def widths(form: str, mesh_width: int = 0) -> dict[str, int]:
    """The widths that :data:`.schema.COLUMNS` names."""
    return {
        "features": FORMS[form].width + STRETCH_WIDTH,
        "action": ACTION_WIDTH,
        "node": len(NODE_CHANNELS),
        "descriptor": len(MESH_CHANNELS),
        "mesh_feature": mesh_width,
    }


def encode_scenes(
    samples: Sequence[Sample], form: str, vocabulary: Vocabulary, mesh_encoder: MeshEncoder | None = None
) -> Columns:
    """Columns of one or more scenes, their names numbered by ``vocabulary`` (which takes in new ones).

    Poses are float32 features of ``form`` with stretch, bounds float32 metres in
    each object's frame.

    Raises
    ------
    PoseError
        If a local matrix holds NaN or infinity, or is not affine.
    """
    meshes = _MeshTable(mesh_encoder)
    scenes = [_scene_rows(sample, vocabulary, meshes) for sample in samples]
    local = np.concatenate([scene.pop("local") for scene in scenes])
    features = FORMS[form].encode(local, stretch=True)
    scenes.append(meshes.rows() | {"entity.features": features})
    size = widths(form, meshes.width)
    columns: Columns = {}
    for key, column in COLUMNS.items():
        shape = (-1, *(size[item] if isinstance(item, str) else item for item in column.shape))
        columns[key] = _stack([scene[key] for scene in scenes if key in scene], column.dtype, shape)
    for key in STRINGS:
        texts = [text for scene in scenes for text in scene.get(key, ())]
        columns[f"{key}.bytes"], columns[f"{key}.offsets"] = pack_strings(texts)
    for table in TABLES:
        key = next(key for key, of in COLUMN_TABLES.items() if of == table and key != "entity.features")
        columns[f"{table}.ptr"] = np.cumsum([0, *(len(scene[key]) for scene in scenes[:-1])], dtype=np.int64)
    return columns


def _stack(parts: list[Any], dtype: str, shape: tuple[int, ...]) -> NDArray[Any]:
    """Rows of all scenes in one array; lists of numbers and lists of vectors alike."""
    width = int(np.prod(shape[1:]))
    flat = [np.asarray(part, dtype).reshape(-1) for part in parts]
    whole = np.concatenate(flat) if flat else np.zeros(0, dtype)
    return whole.reshape(len(whole) // width if width else sum(map(len, parts)), *shape[1:])


def _scene_rows(sample: Sample, vocabulary: Vocabulary, meshes: _MeshTable) -> dict[str, Any]:
    graph = sample.graph
    used = graph.category[graph.category >= 0]
    found = {
        int(index): vocabulary.place("categories", graph.vocabulary[index]) for index in in_order_of_appearance(used)
    }
    moved = graph.components.get("world")
    return {
        "local": graph.local,
        "scene.label": [vocabulary.place("scenes", sample.label)],
        "scene.title": [graph.title],
        "scene.source": [sample.source],
        "entity.name": graph.name,
        "entity.uid": graph.uid,
        "entity.parent": graph.parent,
        "entity.category": [found.get(index, -1) for index in graph.category.tolist()],
        "entity.type": graph.type,
        "entity.mesh": meshes.places(graph),
        "entity.bounds": local_bounds(graph),
        "world.entity": [] if moved is None else moved.rows,
        "world.matrix": [] if moved is None else np.stack(list(moved.columns["matrix"]))[:, :3],
        **relation_rows(graph, vocabulary),
        **behaviour_rows(graph),
    }


@dataclass
class _MeshTable:
    """The meshes of some scenes, each once."""

    encoder: MeshEncoder | None
    _rows: dict[str, int] = field(default_factory=dict)
    _meshes: list[Mesh] = field(default_factory=list)
    _features: list[NDArray[np.float32]] = field(default_factory=list)

    @property
    def width(self) -> int:
        """Width of the encoder's output; 0 without one or before the first mesh."""
        return len(self._features[0]) if self._features else 0

    def places(self, graph: SceneGraph) -> NDArray[np.int32]:
        """Rows of the table for the entities of a scene, whose meshes are taken in; -1 for none."""
        place = np.full(len(graph.meshes) + 1, -1, np.int32)
        for index in in_order_of_appearance(graph.mesh[graph.mesh >= 0]):
            place[index] = self._row(graph.meshes[index])
        return place[graph.mesh]

    def _row(self, mesh: Mesh) -> int:
        if mesh.checksum not in self._rows:
            self._rows[mesh.checksum] = len(self._meshes)
            self._meshes.append(mesh)
            if self.encoder is not None:
                self._features.append(_checked_feature(self.encoder(mesh), mesh, self.width))
        return self._rows[mesh.checksum]

    def rows(self) -> dict[str, Any]:
        """The mesh columns."""
        bounds = np.array([mesh.bounds for mesh in self._meshes]).reshape(-1, 2, 3)
        sizes = np.array([(len(mesh.points), len(mesh.offsets) - 1) for mesh in self._meshes]).reshape(-1, 2)
        descriptor = [bounds[:, 1] - bounds[:, 0], bounds.mean(axis=1), np.log10(sizes + 1)]
        return {
            "mesh.checksum": [np.frombuffer(bytes.fromhex(mesh.checksum), np.uint8) for mesh in self._meshes],
            "mesh.bounds": bounds,
            "mesh.descriptor": np.concatenate(descriptor, axis=1),
            "mesh.feature": self._features if self.width else np.zeros((len(self._meshes), 0)),
            "mesh.name": [mesh.name for mesh in self._meshes],
        }


def _checked_feature(feature: Any, mesh: Mesh, width: int) -> NDArray[np.float32]:
    vector = np.asarray(feature, np.float32)
    if vector.ndim != 1 or (width and len(vector) != width) or not np.isfinite(vector).all():
        raise UniSGError(f"the mesh encoder gave no finite vector of the usual width for mesh {mesh.name!r}")
    return vector
