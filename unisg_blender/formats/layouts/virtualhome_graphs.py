"""Graphs of VirtualHome: nodes with axis-aligned boxes, edges ON and INSIDE between them.

Unity (left-handed, y up, metres). Rooms and characters are no things; edges with a wall or a ceiling at an end are left
out: there, "on" means "at". Puig et al., "VirtualHome: Simulating Household Activities via Programs", 2018.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...scene import SceneGraph
from ..axes import numbers
from ..layout_file import LayoutFile, has_lists
from ..room_builder import RoomBuilder, upright_box

NAME = "VirtualHome graph"
LICENCE = "MIT"
SHELL = ("ceiling", "wall", "walls")
NO_THINGS = ("Rooms", "Characters")
STRUCTURE = {
    "floor": "Floor",
    "wall": "Wall",
    "walls": "Wall",
    "ceiling": "Ceiling",
    "door": "Door",
    "window": "Window",
}
KINDS = {"ON": "on_top_of", "INSIDE": "inside"}


def recognises(data: Any) -> bool:
    """Whether it has nodes with a class and a box, and edges."""
    return has_lists(data, "nodes", "edges") and all("class_name" in node for node in data["nodes"][:3])


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The home."""
    builder = RoomBuilder(file.title)
    nodes = {node["id"]: node for node in file.data["nodes"] if node["category"] not in NO_THINGS}
    for node in nodes.values():
        bounds, name = node.get("bounding_box"), node["class_name"]
        if not bounds:
            file.report.add(f"{name} {node['id']}", "the file gives no box for it: it is left out")
            continue
        center, size = (numbers(bounds[key], 3)[[0, 2, 1]] for key in ("center", "size"))
        local, size = upright_box(center - size / 2, center + size / 2)
        builder.box(STRUCTURE.get(name, name), size, local, uid=str(node["id"]))
    file.report.add("", "boxes are axis-aligned: which way things face is not told")
    for edge in file.data["edges"]:
        ends = edge["from_id"], edge["to_id"]
        shell = any(end not in nodes or nodes[end]["class_name"] in SHELL for end in ends)
        if edge["relation_type"] in KINDS and not shell:
            builder.relate(str(ends[0]), KINDS[edge["relation_type"]], str(ends[1]))
    yield builder.build()
