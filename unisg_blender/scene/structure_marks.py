"""What a user says of the building where it is recognised wrongly: marks, kept as custom properties of entities.

What is a floor, a wall, a ceiling, a door or a window is said by its category. Two marks say the rest. That of parts,
``unisg_structure``, is "thing" for what is no building though it may look like one, or "nothing" for what is not there
for anybody: a sky, a collision hull. That of rooms, ``unisg_room``, says of the room that an entity is in which kind it
is, or "none": it is no room. What is locked by ``unisg_lock`` is moved by nobody but the user.
"""

from __future__ import annotations

import json
from collections.abc import Mapping

from .assembly import index_categories
from .categories import STRUCTURE
from .component_table import table
from .components import PROPERTIES
from .graph import SceneGraph

PART_MARK, ROOM_MARK = "unisg_structure", "unisg_room"

THING, NOTHING = "thing", "nothing"
"""Marks of parts."""

LOCK, OPEN = "unisg_lock", ("", "0", "no", "false", "none")
"""The mark of what is locked, and its values that say nothing."""

NO_ROOM = "none"
"""The mark of what is no room."""


def marks(graph: SceneGraph, key: str) -> dict[int, str]:
    """The marks of one kind by row, in small letters."""
    found = {}
    for row, text in graph.entries(PROPERTIES, "json"):
        if f'"{key}"' in text:
            value = json.loads(text).get(key)
            if isinstance(value, str) and value.strip():
                found[row] = value.strip().casefold()
    return found


def is_lock(value: object) -> bool:
    """Whether a value of :data:`LOCK` says that something is locked."""
    return str(value).strip().casefold() not in OPEN


def locked_rows(graph: SceneGraph) -> set[int]:
    """The rows of the entities that are locked; a tick in Blender is as good as a word."""
    marked = ((row, text) for row, text in graph.entries(PROPERTIES, "json") if f'"{LOCK}"' in text)
    return {row for row, text in marked if is_lock(json.loads(text).get(LOCK, ""))}


def with_marks(graph: SceneGraph, key: str, marked: Mapping[int, str]) -> SceneGraph:
    """The scenegraph with marks of one kind at some rows, "" for none."""
    if not marked:
        return graph
    texts = dict(graph.entries(PROPERTIES, "json"))
    for row, value in marked.items():
        record = json.loads(texts.get(row, "{}"))
        record.pop(key, None)
        record |= {key: value} if value else {}
        texts[row] = json.dumps(record, ensure_ascii=False, sort_keys=True) if record else ""
    kept = {row: text for row, text in sorted(texts.items()) if text}
    return graph.with_component(PROPERTIES, table(list(kept), json=list(kept.values())))


def with_parts(graph: SceneGraph, parts: Mapping[int, str]) -> SceneGraph:
    """The scenegraph with what the user says of rows: a category of the building, or :data:`THING`, :data:`NOTHING`.

    What is a thing, or nothing, has no category of the building any more.
    """
    if not parts:
        return graph
    names = [graph.category_name(row) for row in range(len(graph))]
    said = {}
    for row, part in parts.items():
        names[row], said[row] = part_category(part, names[row])
    category, vocabulary = index_categories(names)
    return with_marks(graph.replace(category=category, vocabulary=vocabulary), PART_MARK, said)


def part_category(part: str, category: str) -> tuple[str, str]:
    """The category and the mark of what the user says of a thing that has some category."""
    named = part.strip().capitalize()
    if named in STRUCTURE:
        return named, ""
    return "" if category in STRUCTURE else category, part.strip().casefold()
