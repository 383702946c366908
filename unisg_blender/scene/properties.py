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
from .action_data import ActionData, actions_from_json
from .component_table import table
from .graph import SceneGraph
from .lesson_node import LessonNode, lesson_from_json
from .relation import Relation, relations_from_json

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


def property_tables(rows: Sequence[ObjectProperties]) -> dict[str, Any]:
    """The component tables that come from custom properties, from one record per row."""
    actions = [(row, action) for row, record in enumerate(rows) for action in record.actions]
    relations = [(row, relation) for row, record in enumerate(rows) for relation in record.relations]
    lessons = [(row, record.lsa) for row, record in enumerate(rows) if record.lsa is not None]
    others = [(row, record.others) for row, record in enumerate(rows) if record.others]
    tables = dict[str, Any](recording.recording_tables([record.recording for record in rows]))
    if actions:
        tables["actions"] = table([row for row, _ in actions], data=[action for _, action in actions])
    if relations:
        tables["relations"] = table(
            [row for row, _ in relations],
            kind=[relation.kind for _, relation in relations],
            target=[relation.target for _, relation in relations],
        )
    if lessons:
        tables["lsa"] = table([row for row, _ in lessons], data=[lesson for _, lesson in lessons])
    if others:
        texts = [json.dumps(values, ensure_ascii=False, sort_keys=True) for _, values in others]
        tables["properties"] = table([row for row, _ in others], json=texts)
    return tables


def relations_of(graph: SceneGraph, row: int) -> tuple[Relation, ...]:
    """The relations whose subject is ``row``."""
    return tuple(Relation(kind, target) for _, kind, target in graph.entries("relations", "kind", "target", row=row))
