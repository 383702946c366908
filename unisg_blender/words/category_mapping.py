"""Categories for scenes that nobody labelled: from the names of objects and collections, by a mapping file."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from ..errors import UniSGError
from ..runtime.atomic_files import read_plain
from ..runtime.json_records import parse_json
from ..scene import SceneGraph, Table
from ..scene.assembly import index_categories
from ..scene.components import COLLECTIONS, INSTANCES
from ..scene.structure_marks import NOTHING, ROOM_MARK, THING, with_marks, with_parts

SECTIONS = ("objects", "collections", "scenes", "words", "structure", "rooms")

PARTS = ("Floor", "Wall", "Ceiling", "Door", "Window", THING, NOTHING)
"""What the section ``structure`` says of things."""

Patterns = Mapping[str, Mapping[str, str]]
"""For each of :data:`SECTIONS` a mapping from pattern to name; the first pattern that fits counts."""


def read_mapping(path: str | os.PathLike[str]) -> dict[str, dict[str, str]]:
    """Read a mapping file, JSON or TOML.

    It has up to six sections. Three are tables from pattern to name: ``objects``
    and ``collections`` give categories, ``scenes`` (patterns of the file's path)
    the kind of scene. Patterns are those of the shell, case does not count. ``words``
    says what a word for things means, in any name: ``{"Nightstand": "Cabinet"}``; "" is nothing. Two correct what is
    recognised of the building, whatever category there was: ``structure`` maps patterns of names to one of
    :data:`PARTS`, ``rooms`` patterns of the name of a floor, or of anything in a room, to what that room is ("none":
    it is no room).

    Raises
    ------
    UniSGError
        If the file cannot be read or has another form.
    """
    path = Path(path)
    try:
        text = read_plain(path).decode("utf-8")
        content = tomllib.loads(text) if path.suffix.lower() == ".toml" else parse_json(text, f"the mapping {path}")
    except OSError as error:
        raise UniSGError(f"cannot read the mapping {path}: {error.strerror}") from None
    except (ValueError, RecursionError) as error:
        raise UniSGError(f"the mapping {path} is not valid TOML: {error}") from None
    return checked_mapping(content, str(path))


def checked_mapping(content: Any, name: str = "mapping") -> dict[str, dict[str, str]]:
    """The mapping itself; UniSGError if it does not have the form that :func:`read_mapping` describes."""
    if not isinstance(content, dict) or not content or not set(content) <= set(SECTIONS):
        raise UniSGError(f"{name} must have the sections {', '.join(SECTIONS)} and no others")
    for section, patterns in content.items():
        if not isinstance(patterns, dict) or not all(
            isinstance(value, str) and (value or section == "words") for value in patterns.values()
        ):
            raise UniSGError(f"{name}: the section {section!r} must map patterns to names")
    for pattern, part in content.get("structure", {}).items():
        if part.casefold() not in map(str.casefold, PARTS):
            raise UniSGError(
                f"{name}: {pattern!r} cannot be {part!r}: the section 'structure' knows {', '.join(PARTS)}"
            )
    return content


def first_match(patterns: Mapping[str, str], names: Iterable[str]) -> str:
    """The name that stands behind the first pattern that fits one of the names; "" if none does."""
    candidates = [name.casefold() for name in names]
    for pattern, result in patterns.items():
        if any(fnmatchcase(name, pattern.casefold()) for name in candidates):
            return result
    return ""


def apply_mapping(graph: SceneGraph, mapping: Patterns, groups: Sequence[str] = ()) -> SceneGraph:
    """The scene with categories for the entities that have none: by their names first, then by their collections.

    What is instanced is in the collection that is instanced, too. The entity that
    shows a collection is not named once more as what the collection holds.

    Parameters
    ----------
    groups
        Collections that everything is in, beside those that the scenegraph knows.
    """
    members: dict[int, list[str]] = {}
    for row, path in graph.entries(COLLECTIONS, "path"):
        members.setdefault(row, []).extend(path)
    names = [
        graph.category_name(row)
        or first_match(mapping.get("objects", {}), [graph.name[row]])
        or first_match(mapping.get("collections", {}), [*groups, *members.get(row, ())])
        for row in range(len(graph))
    ]
    instances = graph.components.get(INSTANCES)
    if instances is not None:
        graph = graph.with_component(INSTANCES, _mapped_instances(instances, mapping))
        for row, prototype in graph.entries(INSTANCES, "prototype"):
            if graph.category[row] < 0 and names[row] in prototype.vocabulary:
                names[row] = ""
    category, vocabulary = index_categories(names)
    return _corrected(graph.replace(category=category, vocabulary=vocabulary), mapping)


def _corrected(graph: SceneGraph, mapping: Patterns) -> SceneGraph:
    """The scene with what the mapping says of its building and rooms."""
    found = {row: first_match(mapping.get("structure", {}), [name]) for row, name in enumerate(graph.name)}
    graph = with_parts(graph, {row: part for row, part in found.items() if part})
    kinds = {row: first_match(mapping.get("rooms", {}), [name]) for row, name in enumerate(graph.name)}
    return with_marks(graph, ROOM_MARK, {row: kind for row, kind in kinds.items() if kind})


def _mapped_instances(instances: Table, mapping: Patterns) -> Table:
    """The instances with mapped prototypes, each of which stays one object."""
    mapped: dict[int, SceneGraph] = {}
    column = instances.columns["prototype"].copy()
    for place, (prototype, source) in enumerate(zip(column, instances.columns["source"], strict=True)):
        if id(prototype) not in mapped:
            mapped[id(prototype)] = apply_mapping(prototype, mapping, [prototype.title] * (source == "COLLECTION"))
        column[place] = mapped[id(prototype)]
    return Table(instances.rows, {**instances.columns, "prototype": column})


def scene_label(source: str, mapping: Patterns) -> str:
    """The kind of scene that a file holds, "" if no pattern fits its path."""
    return first_match(mapping.get("scenes", {}), [source])
