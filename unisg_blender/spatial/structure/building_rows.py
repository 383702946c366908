"""Which entities are building and nothing else, told by geometry."""

from __future__ import annotations

from ...scene.graph import SceneGraph
from .recognise import recognise_structure

LONG_WALL = 2.0
"""Metres of a wall at least: shorter pieces may be furniture."""


def building_rows(graph: SceneGraph) -> dict[int, str]:
    """By row what is floor, ceiling or, where it is long enough, wall of a room, and nothing else."""
    structure = recognise_structure(graph)
    length: dict[int, float] = {}
    for room in structure.rooms:
        for wall in room.walls:
            length[wall.row] = length.get(wall.row, 0.0) + wall.length
    alone = {row: kinds[0] for row, kinds in structure.parts.items() if len(kinds) == 1}
    return {row: kind for row, kind in alone.items() if kind != "Wall" or length[row] >= LONG_WALL}
