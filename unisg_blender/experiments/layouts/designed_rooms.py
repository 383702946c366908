"""Rooms that others designed, with what they say stands on what.

Three public sources: iTHOR's objects with their receptacles, VirtualHome's graphs, ThreeDWorld's layouts, which say
nothing of supports. How each is read: :mod:`...formats.layouts`.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from ...errors import UniSGError
from ...formats.layout_scenes import asset_folder, layout_scenes
from ...formats.layouts import ithor_plans, virtualhome_graphs
from ...scene import SceneGraph

FILES = ("ithor/objects.json", "virtualhome/*_graph.json", "tdw/floorplan_layouts.json")


@dataclass(frozen=True, eq=False)
class DesignedRoom:
    """A room: ``supports`` are pairs (row, row of what it stands on), None where the source says nothing; ``unclear``
    pairs are told in another way (a book inside a bookshelf) and count neither for nor against a prediction."""

    name: str
    graph: SceneGraph
    supports: frozenset[tuple[int, int]] | None
    unclear: frozenset[tuple[int, int]] = frozenset()


def read_layouts(folder: Path) -> list[DesignedRoom]:
    """All rooms of a folder with the sub-folders ``ithor``, ``virtualhome`` and ``tdw``, as far as they are there.

    Raises
    ------
    UniSGError
        If a file cannot be read, or there is none.
    """
    rooms = []
    for path in [path for pattern in FILES for path in sorted(folder.glob(pattern))]:
        for found in layout_scenes(path, asset_folder(path)):
            graph = found.graph
            if found.reader is ithor_plans:
                rooms.append(DesignedRoom(graph.title, graph, _pairs(graph, ("on_top_of", "inside"))))
            elif found.reader is virtualhome_graphs:
                on = _pairs(graph, ("on_top_of",))
                name = f"VirtualHome {graph.title.removesuffix('_graph')}"
                rooms.append(DesignedRoom(name, graph, on, _pairs(graph, ("inside",)) - on))
            else:
                rooms.append(DesignedRoom(graph.title, graph, None))
    if not rooms:
        raise UniSGError(f"{folder} has no layouts: give a folder with ithor/, virtualhome/ or tdw/ in it")
    return rooms


def _pairs(graph: SceneGraph, kinds: Collection[str]) -> frozenset[tuple[int, int]]:
    said = graph.entries("relations", "kind", "target")
    return frozenset((row, graph.row_of_uid[uid]) for row, kind, uid in said if kind in kinds)
