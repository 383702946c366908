"""Plans of what was recognised: each storey from above. Needs matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import UniSGError
from ...geometry.arrays import Floats
from ...runtime.matplotlib_figure import new_figure
from .room_things import RoomName
from .structure import Room, Structure

ENDINGS = (".svg", ".png", ".pdf")
FLOORS = ("#cfe3f2", "#f6dcc2", "#d5ecd0", "#ead7ee", "#f6efc0", "#d9d9d9")
COLOURS = {"door": "#2e8b57", "window": "#3aa6d0", "passage": "#c0392b"}
WALL, SURFACE, THIN = "#4a4a4a", "#3455a4", 0.03


def check_plan(path: Path) -> None:
    """Refuse a picture that could not be drawn, before the work.

    Raises
    ------
    UniSGError
        Without matplotlib or the folder, or for another kind of file.
    """
    new_figure(1, 1)
    if path.suffix.lower() not in ENDINGS:
        raise UniSGError(f"cannot draw {path}: the known kinds are {', '.join(ENDINGS)}")
    if not path.parent.is_dir():
        raise UniSGError(f"there is no folder {path.parent} to write {path.name} to")


def draw_plan(structure: Structure, path: Path, names: Sequence[RoomName] | None = None) -> None:
    """Draw rooms, walls, openings and surfaces from above, a storey beside the other; see :func:`check_plan`.

    Rooms are labelled with what they are, if that is known.
    """
    storeys = max(structure.storeys, 1)
    figure = new_figure(7 * storeys, 7)
    for storey in range(storeys):
        axes = figure.add_subplot(1, storeys, storey + 1)
        for number, room in enumerate(structure.rooms):
            if room.storey == storey:
                _draw_room(axes, f"{number}: {names[number].label}" if names else f"{number}:", number, room)
        for surface in structure.surfaces:
            if structure.rooms[surface.room].storey == storey:
                axes.fill(*surface.outline.T, fill=False, edgecolor=SURFACE, linewidth=0.6)
        axes.set_aspect("equal")
        axes.set(title=f"storey {storey}", xlabel="x in m", ylabel="y in m")
    for number, note in enumerate(structure.notes):
        figure.text(0.01, 0.01 + 0.03 * number, note, fontsize=8)
    figure.savefig(path, dpi=100)


def _draw_room(axes: Any, label: str, number: int, room: Room) -> None:
    axes.fill(*room.outline.T, color=FLOORS[number % len(FLOORS)], hatch="" if room.indoors else "//")
    for hole in room.holes:
        axes.fill(*hole.T, color="white")
    for wall in room.walls:
        axes.fill(*_strip(wall.start, wall.stop, max(wall.thickness, THIN)).T, color=WALL)
    for opening in room.openings:
        axes.plot(*np.stack([opening.start, opening.stop]).T, color=COLOURS[opening.kind], linewidth=3)
    axes.text(*room.outline.mean(axis=0), f"{label.strip()} {room.area:.1f} m2", ha="center", fontsize=7)


def _strip(start: Floats, stop: Floats, thickness: float) -> Floats:
    """The corners (4, 2) of a wall whose face runs from ``start`` to ``stop``, its thickness to the right."""
    along = (stop - start) / np.linalg.norm(stop - start)
    out = np.array([along[1], -along[0]]) * thickness
    return np.stack([start, stop, stop + out, start + out])
