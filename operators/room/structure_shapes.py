"""What is drawn of the recognised structure: triangles, lines and labels, in the scene's units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from mathutils.geometry import tessellate_polygon
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ...unisg_blender.spatial.structure import Opening, Structure

Points: TypeAlias = NDArray[np.float32]
Colour: TypeAlias = tuple[float, float, float, float]

ROOM: Colour = (0.35, 0.65, 1.0, 0.14)
OPEN: Colour = (0.65, 0.65, 0.65, 0.10)
SURFACE: Colour = (1.0, 0.75, 0.2, 0.28)
OUTLINE: Colour = (0.35, 0.65, 1.0, 0.95)
RIM: Colour = (1.0, 0.75, 0.2, 0.8)
OPENINGS: dict[str, Colour] = {
    "door": (0.25, 0.85, 0.4, 1.0), "window": (0.3, 0.9, 0.95, 1.0), "passage": (0.9, 0.45, 0.9, 1.0)
}  # fmt: skip

LEGEND = "blue: rooms   green: doors   cyan: windows   purple: passages   yellow: surfaces for things"
"""What the colours mean, in a line."""

LIFTED, HIGH = 0.01, 0.3
"""Metres by which floors and surfaces are drawn above themselves, and labels above the floor."""


@dataclass(frozen=True, eq=False)
class StructureShapes:
    """Triangles (3 K, 3) and lines (2 K, 3) by colour, and labels with their places."""

    triangles: dict[Colour, Points]
    lines: dict[Colour, Points]
    labels: tuple[tuple[str, tuple[float, float, float]], ...]


def structure_shapes(structure: Structure, room_lines: Sequence[str], units: float) -> StructureShapes:
    """What is drawn of a structure, with a line for each room, in a scene of so many units a metre."""
    triangles: dict[Colour, list[Points]] = {}
    lines: dict[Colour, list[Points]] = {}
    labels = []
    for room, line in zip(structure.rooms, room_lines, strict=True):
        loops = [_raised(loop, room.floor) for loop in (room.outline, *room.holes)]
        triangles.setdefault(ROOM if room.indoors else OPEN, []).append(_filled(loops))
        lines.setdefault(OUTLINE, []).extend(map(_closed, loops))
        for opening in room.openings:
            lines.setdefault(OPENINGS[opening.kind], []).append(_frame(opening))
        x, y = room.inner_point.tolist()
        labels.append((line.split(": ", 1)[1], (x * units, y * units, (room.floor + HIGH) * units)))
    for surface in structure.surfaces:
        loop = _raised(surface.outline, surface.height)
        triangles.setdefault(SURFACE, []).append(_filled([loop]))
        lines.setdefault(RIM, []).append(_closed(loop))
    return StructureShapes(_joined(triangles, units), _joined(lines, units), tuple(labels))


def _raised(loop: NDArray[np.float64], height: float) -> Points:
    """A loop (K, 2) at a height, (K, 3)."""
    return np.column_stack([loop, np.full(len(loop), height + LIFTED)]).astype(np.float32)


def _closed(loop: Points) -> Points:
    """The edges of a loop as pairs of points."""
    return np.stack([loop, np.roll(loop, -1, axis=0)], axis=1).reshape(-1, 3)


def _filled(loops: Sequence[Points]) -> Points:
    """Triangles of a polygon with holes."""
    corners = np.concatenate(loops)
    found = tessellate_polygon([loop.tolist() for loop in loops])
    return corners[np.array(found, np.int64).reshape(-1)]


def _frame(opening: Opening) -> Points:
    """The rectangle of an opening, as pairs of points."""
    ends = opening.start, opening.stop, opening.stop, opening.start
    heights = opening.bottom, opening.bottom, opening.top, opening.top
    corners = [[*end, height] for end, height in zip(ends, heights, strict=True)]
    return _closed(np.array(corners, np.float32))


def _joined(parts: dict[Colour, list[Points]], units: float) -> dict[Colour, Points]:
    return {colour: (np.concatenate(some) * units).astype(np.float32) for colour, some in parts.items() if len(some)}
