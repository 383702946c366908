"""What the mouse points at in a viewport: the first face in the room that looks at the user."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy
import numpy as np

if TYPE_CHECKING:
    from ...unisg_blender.generate.pointing.placing_room import PlacingRoom

MOST, NEXT = 24, 1e-4
"""Faces that are looked through at most, such as ceilings and walls before the room, and how far behind one the next
is looked for, in scene units."""

LEVEL = 0.7
"""Upward part of the normal from which on a face is level."""


@dataclass(frozen=True)
class Pointed:
    """A point in metres, and whether the face there is level."""

    point: tuple[float, float, float]
    level: bool


def viewport_under(
    context: bpy.types.Context, event: bpy.types.Event
) -> tuple[bpy.types.Region, bpy.types.RegionView3D] | None:
    """The viewport of the window under the mouse, None over its sidebar, toolbar and header, and over anything else."""
    for area in context.window.screen.areas:
        if area.type == "VIEW_3D" and _is_in(area, event):
            if any(_is_in(region, event) for region in area.regions if region.type != "WINDOW"):
                return None
            for number, region in enumerate(item for item in area.regions if item.type == "WINDOW"):
                if _is_in(region, event):
                    quad = area.spaces.active.region_quadviews
                    return region, quad[number] if len(quad) else area.spaces.active.region_3d
    return None


def _is_in(place: bpy.types.Area | bpy.types.Region, event: bpy.types.Event) -> bool:
    """Is the mouse in an area or region? What is hidden has a width of 1."""
    if place.width <= 1 or place.height <= 1:
        return False
    across, up = event.mouse_x - place.x, event.mouse_y - place.y
    return bool(0 <= across < place.width and 0 <= up < place.height)


def pointed_at(
    context: bpy.types.Context, region: bpy.types.Region, view: bpy.types.RegionView3D, mouse: tuple[int, int],
    room: PlacingRoom | None, metres: float,
) -> Pointed | None:  # fmt: skip
    """What is under the mouse (pixels of the region) in a ``room``; of what nothing is known yet the first face.

    ``metres`` is how long a unit of the scene is. Where there is no face, it is the floor's plane.
    """
    from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d

    origin = region_2d_to_origin_3d(region, view, mouse)
    way = region_2d_to_vector_3d(region, view, mouse)
    depsgraph, start, behind = context.evaluated_depsgraph_get(), origin.copy(), None
    for _ in range(MOST):
        hit, point, normal, *_ = context.scene.ray_cast(depsgraph, start, way)
        if not hit:
            break
        found = Pointed(tuple(metres * value for value in point), abs(normal.z) > LEVEL)
        if room is None or room.inside(np.array(found.point)):
            if normal.dot(way) < 0:
                return found
            behind = behind or found
        start = point + way * NEXT
    if behind is not None:
        return behind
    floor = (room.floor if room is not None else 0.0) / metres
    far = (floor - origin.z) / way.z if abs(way.z) > 1e-6 else -1.0
    return Pointed(tuple(metres * value for value in origin + way * far), True) if far > 0 else None
