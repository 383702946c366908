"""Lessons in a glTF file: their behaviour graphs, as KHR_interactivity has them."""

from __future__ import annotations

from typing import Any

from ...errors import UniSGError
from ...interactivity.graph_writer import EXTENSION
from ...interactivity.lesson_compiler import lesson_graph
from ...runtime.read_report import ReadReport
from ...scene import SceneGraph


def add_lessons(graph: SceneGraph, document: dict[str, Any], report: ReadReport) -> None:
    """Add the graphs of a scene's lessons to its document; what cannot be played, or is told otherwise, is noted."""
    graphs = []
    for row, operation in graph.entries("lsa", "data"):
        try:
            compiled = lesson_graph(graph, operation)
        except UniSGError as error:
            report.add(graph.name[row], f"not playable in other programs: {error}")
            continue
        graphs.append({"name": operation.name or operation.uid, **compiled.graph})
        for name, text in compiled.lost:
            report.add(name, text)
    if graphs:
        document["extensionsUsed"] = [*document.get("extensionsUsed", []), EXTENSION]
        document["extensions"] = {**document.get("extensions", {}), EXTENSION: {"graphs": graphs, "graph": 0}}
