"""The columns of a dataset: what a shard holds, in which order and type.

A shard is one safetensors file. Its columns belong to tables; ``entity.parent``
is the column ``parent`` of the table ``entity``. Scene ``i`` owns the rows
``ptr[i]:ptr[i + 1]`` of a table, with ``ptr`` the table's column ``table.ptr``.
Row numbers inside a scene count from the scene's first row. Strings are UTF-8:
string ``k`` is ``bytes[offsets[k]:offsets[k + 1]]``. ``docs/dataset.md`` is the
description for readers of other makes.
"""

from __future__ import annotations

from dataclasses import dataclass

SCHEMA = "unisg-dataset"
VERSION = 1

MESH_CHANNELS = (
    "size_x", "size_y", "size_z", "center_x", "center_y", "center_z", "log10_points", "log10_faces",
)  # fmt: skip
"""Channels of ``mesh.descriptor``: box in metres, and decimal logarithms of (count + 1)."""

INFO_CHANNELS = ("entities", "trs", "meshes", "actions")
"""Channels of the info nodes: numbers of nodes directly under an entity."""


@dataclass(frozen=True)
class Column:
    """One array of a shard: ``dtype`` and the ``shape`` of a row; a name in the shape is a width of the dataset."""

    dtype: str
    shape: tuple[int | str, ...]
    meaning: str


COLUMNS: dict[str, Column] = {
    "scene.label": Column("int32", (), "kind of scene, position in vocabulary 'scenes'; -1 for none"),
    "entity.parent": Column("int32", (), "row of the parent within the scene; -1 for a root"),
    "entity.category": Column("int32", (), "position in vocabulary 'categories'; -1 for none"),
    "entity.type": Column("int8", (), "object type, position in the manifest's 'types'"),
    "entity.mesh": Column("int32", (), "row of the shard's mesh table; -1 for none"),
    "entity.features": Column("float32", ("features",), "child-to-parent pose in the dataset's form, then stretch"),
    "entity.bounds": Column("float32", (2, 3), "lowest and highest corner of the mesh in the object's frame, metres"),
    "world.entity": Column("int32", (), "entity whose evaluated world matrix a constraint sets"),
    "world.matrix": Column("float32", (3, 4), "upper rows of that world matrix, metres"),
    "relation.subject": Column("int32", (), "entity that stands in the relation"),
    "relation.target": Column("int32", (), "entity to which it does"),
    "relation.kind": Column("int32", (), "position in vocabulary 'relations'"),
    "action.entity": Column("int32", (), "entity that the action belongs to"),
    "action.vector": Column("float32", ("action",), "the action as a fixed vector; manifest 'action_channels'"),
    "action.mask": Column("bool", ("action",), "which slots of the vector are in use"),
    "lesson.vector": Column("float32", ("node",), "a lesson; manifest 'node_channels'"),
    "stage.vector": Column("float32", ("node",), "a stage; manifest 'node_channels'"),
    "link.kind": Column("int8", (), "position in the manifest's 'link_kinds': (source table, relation, target table)"),
    "link.source": Column("int32", (), "row of the source table"),
    "link.target": Column("int32", (), "row of the target table"),
    "operation.entity": Column("int32", (), "entity that carries the Lesson-Stage-Action tree"),
    "mesh.checksum": Column("uint8", (16,), "blake2b digest of the geometry"),
    "mesh.bounds": Column("float32", (2, 3), "lowest and highest corner in the object's frame, metres"),
    "mesh.descriptor": Column("float32", ("descriptor",), "box and complexity; manifest 'mesh_channels'"),
    "mesh.feature": Column("float32", ("mesh_feature",), "output of a mesh encoder; width 0 without one"),
}

STRINGS: dict[str, str] = {
    "scene.title": "name of the scene",
    "scene.source": "file (or maker) it comes from",
    "entity.name": "names, which may repeat",
    "entity.uid": "identifiers, unique in the scene",
    "action.record": "the whole action as JSON, as in the custom property unisg_actions",
    "lesson.name": "what a learner reads",
    "stage.name": "what a learner reads",
    "operation.record": "the whole Lesson-Stage-Action tree as JSON, as in the custom property unisg_lsa",
    "mesh.name": "name of the mesh",
}

TABLES = ("entity", "world", "relation", "action", "lesson", "stage", "link", "operation")
"""Tables with a ``ptr``: their rows belong to scenes. ``scene`` has one row each, ``mesh`` belongs to the shard."""

VOCABULARIES = ("categories", "relations", "scenes")

REFERENCES = {"entity.category": "categories", "relation.kind": "relations", "scene.label": "scenes"}
"""Columns that hold positions in a vocabulary of the dataset."""


def table_of(key: str) -> str:
    """The table that a column belongs to."""
    return key.split(".", 1)[0]
