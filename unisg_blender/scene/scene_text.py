"""A scenegraph in words: what ``unisg inspect`` prints."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from .graph import TYPES, SceneGraph
from .hierarchy import world_matrices
from .lesson_node import LessonNode


def entity_lines(graph: SceneGraph) -> list[str]:
    """One line per entity, indented by depth."""
    depth: list[int] = []
    for above in graph.parent:  # parents come first
        depth.append(depth[above] + 1 if above >= 0 else 0)
    return ["  " * depth[row] + _entity_line(graph, row) for row in range(len(graph))]


def _entity_line(graph: SceneGraph, row: int) -> str:
    parts = [
        graph.name[row].encode("unicode_escape").decode() if not graph.name[row].isprintable() else graph.name[row]
    ]
    if graph.category[row] >= 0:
        parts.append(f"[{graph.category_name(row)}]")
    parts.append(TYPES[graph.type[row]].lower())
    if graph.mesh[row] >= 0:
        mesh = graph.meshes[graph.mesh[row]]
        parts.append(f"{mesh.name}: {len(mesh.points)} points, {len(mesh.offsets) - 1} faces")
    x, y, z = graph.local[row, :3, 3]
    parts.append(f"at ({x:.3f}, {y:.3f}, {z:.3f})")
    parts += [f"<{action.type} {action.name!r}>" for _, action in graph.entries("actions", "data", row=row)]
    return "  ".join(parts)


def lesson_lines(graph: SceneGraph) -> list[str]:
    """One line per part of the lessons, indented by depth."""
    return [line for _, operation in graph.entries("lsa", "data") for line in _lesson_lines(operation, 0)]


def _lesson_lines(node: LessonNode, depth: int) -> list[str]:
    marks = " (optional)" * node.optional + " (any order)" * (not node.ordered and bool(node.children))
    lines = [f"{'  ' * depth}{node.kind.capitalize()}: {node.name or node.uid}{marks}"]
    for child in node.children:
        lines += _lesson_lines(child, depth + 1)
    return lines


def relation_lines(graph: SceneGraph) -> list[str]:
    """One line per relation that the scene has."""
    return [
        f"{graph.name[row]}  {kind.replace('_', ' ')}  {_name_of(graph, target)}"
        for row, kind, target in graph.entries("relations", "kind", "target")
    ]


def _name_of(graph: SceneGraph, uid: str) -> str:
    row = graph.row_of_uid.get(uid)
    return f"(uid {uid}, not in the scene)" if row is None else graph.name[row]


def summary(graph: SceneGraph) -> dict[str, Any]:
    """Counts for people and for machines, JSON-ready."""
    kinds = np.bincount(graph.type, minlength=len(TYPES))
    categories = np.bincount(graph.category[graph.category >= 0], minlength=len(graph.vocabulary))
    return {
        "title": graph.title,
        "entities": len(graph),
        "roots": int((graph.parent < 0).sum()),
        "meshes": len(graph.meshes),
        "types": {TYPES[index]: int(kinds[index]) for index in np.flatnonzero(kinds)},
        "categories": {name: int(count) for name, count in zip(graph.vocabulary, categories, strict=True) if count},
        "components": {name: len(component.rows) for name, component in sorted(graph.components.items())},
    } | ({} if graph.frames is None else {"frames": asdict(graph.frames)})


def to_records(graph: SceneGraph) -> list[dict[str, Any]]:
    """One JSON-ready record per entity: identity, category, parent's uid, matrices (rows), actions, relations."""
    world = world_matrices(graph)
    return [
        {
            "name": graph.name[row],
            "uid": graph.uid[row],
            "type": TYPES[graph.type[row]],
            "category": graph.category_name(row),
            "parent": graph.uid[graph.parent[row]] if graph.parent[row] >= 0 else None,
            "mesh": graph.meshes[graph.mesh[row]].name if graph.mesh[row] >= 0 else None,
            "local": graph.local[row].tolist(),
            "world": world[row].tolist(),
            "actions": [action.type for _, action in graph.entries("actions", "data", row=row)],
            "relations": [
                {"kind": kind, "target": target}
                for _, kind, target in graph.entries("relations", "kind", "target", row=row)
            ],
        }
        for row in range(len(graph))
    ]
