"""The custom properties that make any file a UniSG scene, and how their values become components.

Every tool may set them; all values are strings, because only strings pass
unharmed through Blender's own USD and glTF exporters.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..errors import UniSGError
from . import recording_tables as recording
from .action_data import ActionData, actions_from_json, actions_to_json
from .component_table import Table, entry_table
from .graph import SceneGraph
from .lesson_node import LessonNode, lesson_from_json, lesson_to_json
from .relation import Relation, relations_from_json, relations_to_json

CATEGORY = "unisg_category"
UID = "unisg_uid"
ACTIONS = "unisg_actions"
RELATIONS = "unisg_relations"
LSA = "unisg_lsa"
NAMES = (CATEGORY, UID, ACTIONS, RELATIONS, LSA, recording.KEY)


@dataclass(frozen=True)
class ObjectProperties:
    """The custom properties of one object, decoded."""

    category: str = ""
    uid: str = ""
    actions: tuple[ActionData, ...] = ()
    relations: tuple[Relation, ...] = ()
    lsa: LessonNode | None = None
    recording: recording.Recorded | None = None
    others: Mapping[str, Any] = field(default_factory=dict)
    problems: tuple[str, ...] = ()


def decode_properties(values: Mapping[str, Any]) -> ObjectProperties:
    """Decode an object's custom properties.

    A value that cannot be read is kept among ``others`` as it is, and what is
    wrong with it stands in ``problems``: one bad object does not spoil a scene.
    """
    decoded: dict[str, Any] = {"category": "", "uid": "", "actions": (), "relations": (), "lsa": None}
    others = {key: value for key, value in values.items() if key not in NAMES}
    problems = []
    readers: dict[str, Callable[[str], Any]] = {
        "actions": actions_from_json,
        "relations": relations_from_json,
        "lsa": lesson_from_json,
        "recording": recording.recorded_from_json,
        "category": str.strip,
        "uid": str.strip,
    }
    for name, read in readers.items():
        key = f"unisg_{name}"
        if key not in values:
            continue
        try:
            if not isinstance(values[key], str):
                raise UniSGError(f"{key} must be a string")
            decoded[name] = read(values[key])
        except UniSGError as error:
            others[key] = values[key]
            problems.append(str(error))
    return ObjectProperties(**decoded, others=others, problems=tuple(problems))


def encode_properties(graph: SceneGraph, row: int) -> dict[str, Any]:
    """The custom properties that say what a row's components hold."""
    values: dict[str, Any] = {}
    for _, text in graph.entries("properties", "json", row=row):
        values |= json.loads(text)
    values[UID] = graph.uid[row]
    if graph.category[row] >= 0:
        values[CATEGORY] = graph.category_name(row)
    if actions := [action for _, action in graph.entries("actions", "data", row=row)]:
        values[ACTIONS] = actions_to_json(actions)
    if relations := relations_of(graph, row):
        values[RELATIONS] = relations_to_json(relations)
    for _, lesson in graph.entries("lsa", "data", row=row):
        values[LSA] = lesson_to_json(lesson)
    recorded = recording.recorded_of(graph, row)
    if recorded is not None:
        values[recording.KEY] = recording.recorded_to_json(recorded)
    return values


def property_tables(rows: Sequence[ObjectProperties]) -> dict[str, Table]:
    """The component tables that come from custom properties, from one record per row."""
    each = list(enumerate(rows))
    texts = (
        (row, json.dumps(record.others, ensure_ascii=False, sort_keys=True)) for row, record in each if record.others
    )
    tables = recording.recording_tables([record.recording for record in rows]) | {
        "actions": entry_table(((row, action) for row, record in each for action in record.actions), "data"),
        "relations": entry_table(
            ((row, relation.kind, relation.target) for row, record in each for relation in record.relations),
            "kind", "target",
        ),
        "lsa": entry_table(((row, record.lsa) for row, record in each if record.lsa is not None), "data"),
        "properties": entry_table(texts, "json"),
    }  # fmt: skip
    return {name: found for name, found in tables.items() if len(found.rows)}


def relations_of(graph: SceneGraph, row: int) -> tuple[Relation, ...]:
    """The relations whose subject is ``row``."""
    return tuple(Relation(kind, target) for _, kind, target in graph.entries("relations", "kind", "target", row=row))
