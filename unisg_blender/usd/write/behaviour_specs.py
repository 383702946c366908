"""Actions, lessons, relations and custom properties as attributes and relationships of entities."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

from pxr import Sdf

from ...scene import components
from ...scene.action_data import ActionData, actions_to_json
from ...scene.component_table import Table
from ...scene.graph import SceneGraph
from ...scene.lesson_node import lesson_to_json
from ...scene.relation import Relation, relations_to_json
from .. import schema
from ..names import clean
from .specs import Types, custom, relationship


def write_behaviour(prims: Sequence[Any], graph: SceneGraph) -> None:
    """Author what entities carry beside place and shape."""
    _each_row(graph, components.ACTIONS, lambda row, found: _write_actions(prims, graph, row, found["data"]))
    _each_row(graph, components.LSA, lambda row, found: _text(prims[row], schema.LSA, lesson_to_json(found["data"][0])))
    _each_row(
        graph,
        components.RELATIONS,
        lambda row, found: _write_relations(prims, graph, row, list(map(Relation, found["kind"], found["target"]))),
    )
    _each_row(
        graph, components.PROPERTIES, lambda row, found: _write_properties(prims[row], json.loads(found["json"][0]))
    )


def _each_row(graph: SceneGraph, name: str, write: Any) -> None:
    found: Table | None = graph.components.get(name)
    for row, values in () if found is None else found.groups():
        write(row, values)


def _text(prim: Any, name: str, text: str) -> None:
    custom(prim, name, Types.String, clean(text))


def _write_actions(prims: Sequence[Any], graph: SceneGraph, row: int, actions: Sequence[ActionData]) -> None:
    """The actions as JSON, and for USD tools relationships to all targets and tools."""
    _text(prims[row], schema.ACTIONS, actions_to_json(actions))
    for name, uids in (
        (schema.TARGETS, [uid for action in actions for uid in action.targets]),
        (schema.TOOLS, [uid for action in actions for uid in action.tools]),
    ):
        paths = [prims[graph.row_of_uid[uid]].path for uid in uids if uid in graph.row_of_uid]
        if paths:
            relationship(prims[row], name, paths)


def _write_relations(prims: Sequence[Any], graph: SceneGraph, row: int, relations: Sequence[Relation]) -> None:
    """One relationship per kind; as JSON those that USD cannot name or whose target is not in the scene."""
    paths: dict[str, list[Any]] = {}
    others = []
    for relation in relations:
        target = graph.row_of_uid.get(relation.target)
        if target is None or not Sdf.Path.IsValidIdentifier(relation.kind):
            others.append(relation)
        else:
            paths.setdefault(relation.kind, []).append(prims[target].path)
    for kind, targets in paths.items():
        relationship(prims[row], schema.RELATION + kind, targets)
    if others:
        _text(prims[row], schema.RELATIONS, relations_to_json(tuple(others)))


def _write_properties(prim: Any, values: dict[str, Any]) -> None:
    """Custom properties as Blender's own exporter names them; as JSON those that it has no form for."""
    others = {}
    for key, value in values.items():
        kind = _property_type(value)
        if kind is None or not Sdf.Path.IsValidNamespacedIdentifier(key):
            others[key] = value
        else:
            custom(prim, schema.USER + key, kind, value)
    if others:
        _text(prim, schema.PROPERTIES, json.dumps(others, ensure_ascii=False, sort_keys=True))


def _property_type(value: Any) -> Any:
    """The USD type that gives the value back as it is, None if there is none."""
    if isinstance(value, bool):
        return Types.Bool
    if isinstance(value, int) and abs(value) < 2**63:
        return Types.Int if abs(value) < 2**31 else Types.Int64
    if isinstance(value, float) and math.isfinite(value):
        return Types.Double
    if isinstance(value, str) and value == clean(value):
        return Types.String
    if isinstance(value, list) and value:
        kinds = {type(item) for item in value}
        if kinds == {float}:
            return Types.DoubleArray
        if kinds == {int} and all(abs(item) < 2**31 for item in value):
            return Types.IntArray
        if kinds == {str} and all(item == clean(item) for item in value):
            return Types.StringArray
    return None
