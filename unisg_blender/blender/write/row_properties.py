"""The custom properties of new objects, from the components of their rows."""

from __future__ import annotations

import bpy

from ...runtime.read_report import ReadReport
from ...scene.graph import TYPES, SceneGraph
from ...scene.properties import encode_properties
from ..helper_objects import TYPE
from ..id_properties import set_custom_properties


def write_properties(graph: SceneGraph, row: int, item: bpy.types.Object, report: ReadReport) -> None:
    """Set the custom properties of the object that stands for a row."""
    kind = TYPES[graph.type[row]]
    if item.type == "MESH" and kind != "MESH":
        item[TYPE] = kind
    refused = set_custom_properties(item, encode_properties(graph, row))
    if refused:
        report.add(item.name, f"custom properties that Blender cannot hold: {', '.join(sorted(refused))}")
