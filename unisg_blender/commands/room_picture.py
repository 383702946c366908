"""Which room a picture of what was generated looks into, and from which side."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..blender import RoomView
    from ..generate import Generated

STEEP = 0.75
"""How much a camera looks down for each metre that it looks along both axes."""


def room_view(result: Generated) -> RoomView | None:
    """The room that most new objects are in, seen from where most of these are seen; None where there is no room."""
    from ..blender import RoomView
    from ..spatial.structure import recognise_structure
    from ..spatial.structure.sight import best_seen

    scene = result.scene if result.reading is None else result.reading.scene
    structure = recognise_structure(scene)
    if not structure.rooms:
        scene = result.scene
        structure = recognise_structure(scene)
    placed = np.array([item.world[:3, 3] for item in result.objects if item.world is not None]).reshape(-1, 3)
    numbers = [structure.room_at(place) for place in placed]
    known = Counter(number for number in numbers if number >= 0)
    if not known:
        return None
    chosen = known.most_common(1)[0][0]
    room = structure.rooms[chosen]
    view = RoomView(room.outline, room.floor, room.ceiling, {scene.name[row] for row in structure.parts})
    ways = [np.array([x, y, -STEEP]) for x, y in ((-0.55, 0.75), (0.55, 0.75), (-0.55, -0.75), (0.55, -0.75))]
    points = placed[np.array(numbers) == chosen] + np.array([0, 0, 0.3])
    best = best_seen(scene, points, ways, lambda middles, way: view.hides(middles, way))
    return replace(view, toward=tuple(ways[best].tolist()))
