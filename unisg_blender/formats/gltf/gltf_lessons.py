"""Lessons in a glTF file: their behaviour graphs, as KHR_interactivity has them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ...errors import UniSGError
from ...interactivity.graph_writer import EXTENSION, SELECTABILITY
from ...interactivity.lesson_compiler import lesson_graph
from ...runtime.read_report import ReadReport
from ...scene import SceneGraph

SELECTABLE = {SELECTABILITY: {"selectable": True}}
"""The extension of a node that can be selected."""


def add_lessons(graph: SceneGraph, document: dict[str, Any], report: ReadReport) -> None:
    """Add the graphs of a scene's lessons to its document; what cannot be played, or is told otherwise, is noted."""
    lessons = playable_lessons(graph, report)
    if lessons:
        document["extensionsUsed"] = [*document.get("extensionsUsed", []), *lessons]
        document["extensions"] = {**document.get("extensions", {}), **lessons}
    for number in selected_nodes(lessons):
        document["nodes"][number].setdefault("extensions", {}).update(SELECTABLE)
    if selected_nodes(lessons):
        document["extensionsUsed"] += SELECTABLE


def playable_lessons(graph: SceneGraph, report: ReadReport, node_of: Callable[[int], int] = int) -> dict[str, Any]:
    """The extensions that hold a scene's lessons, {} for none; ``node_of`` a row is its node in the file."""
    graphs = []
    for row, operation in graph.entries("lsa", "data"):
        try:
            compiled = lesson_graph(graph, operation, node_of)
        except UniSGError as error:
            report.add(graph.name[row], f"not playable in other programs: {error}")
            continue
        graphs.append({"name": operation.name or operation.uid, **compiled.graph})
        for name, text in compiled.lost:
            report.add(name, text)
    return {EXTENSION: {"graphs": graphs, "graph": 0}} if graphs else {}


def selected_nodes(lessons: dict[str, Any]) -> list[int]:
    """Nodes that the graphs of :func:`playable_lessons` let a learner select."""
    found = set()
    for graph in lessons.get(EXTENSION, {}).get("graphs", ()):
        ops = [each["op"] for each in graph["declarations"]]
        chosen = (node for node in graph["nodes"] if ops[node["declaration"]] == "event/onSelect")
        found |= {node["configuration"]["nodeIndex"]["value"][0] for node in chosen}
    return sorted(found)
