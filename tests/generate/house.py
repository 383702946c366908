"""A house of two rooms side by side, with a door between them, for tests."""

from __future__ import annotations

import numpy as np

from tests.spatial.built_rooms import SQUARE, Hole, box, grown, joined, mesh, slab, walls
from unisg_blender.scene import SceneBuilder, SceneGraph

LEFT, RIGHT = SQUARE, SQUARE + np.array([5.1, 0.0])

KITCHEN = {
    "Fridge.001": box((0.1, 3.2, 0), (0.8, 3.9, 1.9)), "SM_Stove_01": box((1, 3.3, 0), (1.6, 3.9, 0.9)),
    "Spüle": box((1.8, 3.3, 0), (2.6, 3.9, 0.9)),
}  # fmt: skip
BEDROOM = {
    "Doppelbett": box((6, 1.5, 0), (7.8, 3.5, 0.5)), "comodino": box((8, 3.5, 0), (8.4, 3.9, 0.5)),
    "wardrobe": box((9, 0.1, 0), (10, 0.7, 2.0)),
}  # fmt: skip
DOOR = Hole(1, 0.4, 1.3)


def house(floors: tuple[str, str] | None = None, things: dict | None = None, category: str = "") -> SceneGraph:
    """The kitchen is left, the bedroom right; walls in one mesh, and the floor, or two floors of these names.

    ``category`` is that of floors and walls.
    """
    builder = SceneBuilder("House")
    ground = np.array([[0, 0], [10.1, 0], [10.1, 4], [0, 4]], float)
    if floors is None:
        builder.add("ground", uid="ground", mesh=mesh(slab(grown(ground, 0.1), -0.1, 0.0)), category=category)
    for name, outline in zip(floors or (), (LEFT, RIGHT), strict=True) if floors else ():
        builder.add(name, uid=name, mesh=mesh(slab(grown(outline, 0.05), -0.1, 0.0)), category=category)
    inner = walls(LEFT, 0, 2.5, 0.1, (DOOR,))
    sides = joined([*inner, *walls(RIGHT, 0, 2.5, 0.1)[:3]])
    builder.add("sides", uid="sides", mesh=mesh(sides), category="Wall" if category else "")
    for name, part in (KITCHEN | BEDROOM if things is None else things).items():
        builder.add(name, uid=name, mesh=mesh(part))
    return builder.build()
