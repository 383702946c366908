"""Names, identities, behaviour, relations and custom properties of entities."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...errors import UniSGError
from ...runtime.json_records import parse_json
from ...scene import properties
from ...scene.properties import ObjectProperties, decode_properties
from ...scene.relation import Relation
from .. import schema
from ..names import true_name
from .entity_selection import Entities

_OWN = {
    schema.UID: properties.UID,
    schema.CATEGORY: properties.CATEGORY,
    schema.ACTIONS: properties.ACTIONS,
    schema.LSA: properties.LSA,
    schema.RELATIONS: properties.RELATIONS,
}
_BLENDER_NAME = "userProperties:blender:object_name"
_STANDARD = ("xformOp", "primvars:", "inputs:", "outputs:", "unisg:", "subsetFamily:", "material:binding")
_OF_MESHES = frozenset(
    (
        "points",
        "faceVertexCounts",
        "faceVertexIndices",
        "normals",
        "extent",
        "subdivisionScheme",
        "visibility",
        "purpose",
    )
)


@dataclass(frozen=True)
class Entry:
    """What one prim says about its entity: ``related`` holds (kind, paths of targets)."""

    name: str
    type: str
    stored: ObjectProperties
    related: tuple[tuple[str, tuple[Any, ...]], ...]

    def with_relations(self, uid_of_path: dict[Any, str]) -> ObjectProperties:
        """The properties with relations whose targets are named by uid; targets that are no entities are left out."""
        if not self.related:
            return self.stored
        pairs = [
            Relation(kind, uid_of_path[path]) for kind, paths in self.related for path in paths if path in uid_of_path
        ]
        return replace(self.stored, relations=(*pairs, *self.stored.relations))


def read_entries(found: Entities, tick: Callable[[], None] = lambda: None) -> list[Entry]:
    """What all prims say about their entities; ``tick`` is called once for each."""
    entries = []
    for prim, shape in zip(found.prim, found.shape, strict=True):
        entries.append(_entry(prim, shape))
        tick()
    return entries


def _entry(prim: Any, shape: Any) -> Entry:
    values: dict[str, Any] = {}
    related = []
    name, kind = true_name(prim), ""
    if shape is not None and shape != prim:
        values |= _custom_values(shape, shape.GetAuthoredPropertyNames())
    authored = prim.GetAuthoredPropertyNames()
    values |= _custom_values(prim, authored)
    for item in authored:
        if item in _OWN:
            values[_OWN[item]] = plain(prim.GetAttribute(item).Get())
        elif item == schema.LABELS and schema.CATEGORY not in authored:
            labels = prim.GetAttribute(item).Get()
            values |= {properties.CATEGORY: str(labels[0])} if labels else {}
        elif item == schema.TYPE:
            kind = str(prim.GetAttribute(item).Get())
        elif item == schema.PROPERTIES:
            values |= _json_values(prim, prim.GetAttribute(item).Get())
        elif item == _BLENDER_NAME:
            name = str(prim.GetAttribute(item).Get())
        elif item.startswith(schema.RELATION):
            related.append((item[len(schema.RELATION) :], tuple(prim.GetRelationship(item).GetTargets())))
    stored = decode_properties(values)
    for problem in stored.problems:
        warnings.warn(f"{prim.GetPath()}: {problem}", stacklevel=2)
    return Entry(name, kind, stored, tuple(related))


def _custom_values(prim: Any, authored: Sequence[str]) -> dict[str, Any]:
    """Custom properties as Blender's exporter names them, and custom attributes of other tools."""
    values = {}
    for name in authored:
        if name.startswith("userProperties:blender:"):
            continue
        if name.startswith(schema.USER):
            key = name[len(schema.USER) :]
        elif name in _OF_MESHES or name.startswith(_STANDARD) or not prim.GetAttribute(name).IsCustom():
            continue
        else:
            key = name
        value = plain(prim.GetAttribute(name).Get())
        if value is None:
            warnings.warn(f"{prim.GetPath()}: {name} has no value that can be kept", stacklevel=2)
        else:
            values[key] = value
    return values


def _json_values(prim: Any, text: str) -> dict[str, Any]:
    try:
        values = parse_json(text, schema.PROPERTIES)
    except (UniSGError, AttributeError):
        values = None
    if not isinstance(values, dict):
        warnings.warn(f"{prim.GetPath()}: {schema.PROPERTIES} is no JSON object", stacklevel=2)
        return {}
    return values


def plain(value: Any) -> Any:
    """A USD value as JSON has it; None for one that has no such form."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if hasattr(value, "path") and hasattr(value, "resolvedPath"):  # an asset path
        return value.path
    try:
        if hasattr(value, "GetReal"):  # a quaternion, scalar first as in Blender
            return [float(value.GetReal()), *(float(part) for part in value.GetImaginary())]
        array = np.asarray(value)
    except (TypeError, ValueError):
        return None
    if array.dtype.kind in "bifu":
        return array.tolist()
    return [str(item) for item in value] if hasattr(value, "__len__") else None
