"""The custom properties of new objects, from the components of their rows."""

from __future__ import annotations

import json

import bpy

from ...runtime.read_report import ReadReport
from ...scene.action_data import actions_to_json
from ...scene.components import ACTIONS, LSA, PROPERTIES
from ...scene.graph import TYPES, SceneGraph
from ...scene.lesson_node import lesson_to_json
from ...scene.properties import ACTIONS as ACTIONS_KEY
from ...scene.properties import CATEGORY, RELATIONS, UID, relations_of
from ...scene.properties import LSA as LSA_KEY
from ...scene.recording_tables import KEY as RECORDING_KEY
from ...scene.recording_tables import recorded_of, recorded_to_json
from ...scene.relation import relations_to_json
from ..helper_objects import TYPE
from ..id_properties import set_custom_properties


def row_properties(graph: SceneGraph, row: int) -> dict[str, object]:
    """The custom properties that say what a row's components hold."""
    values: dict[str, object] = {}
    for _, text in graph.entries(PROPERTIES, "json", row=row):
        values |= json.loads(text)
    values[UID] = graph.uid[row]
    if graph.category[row] >= 0:
        values[CATEGORY] = graph.category_name(row)
    if actions := [action for _, action in graph.entries(ACTIONS, "data", row=row)]:
        values[ACTIONS_KEY] = actions_to_json(actions)
    relations = relations_of(graph, row)
    if relations:
        values[RELATIONS] = relations_to_json(relations)
    for _, lesson in graph.entries(LSA, "data", row=row):
        values[LSA_KEY] = lesson_to_json(lesson)
    recorded = recorded_of(graph, row)
    if recorded is not None:
        values[RECORDING_KEY] = recorded_to_json(recorded)
    return values


def write_properties(graph: SceneGraph, row: int, item: bpy.types.Object, report: ReadReport) -> None:
    """Set the custom properties of the object that stands for a row."""
    kind = TYPES[graph.type[row]]
    if item.type == "MESH" and kind != "MESH":
        item[TYPE] = kind
    refused = set_custom_properties(item, row_properties(graph, row))
    if refused:
        report.add(item.name, f"custom properties that Blender cannot hold: {', '.join(sorted(refused))}")
