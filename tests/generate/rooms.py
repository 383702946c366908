"""Small furnished rooms for the tests of learning and generating."""

from __future__ import annotations

import numpy as np

from unisg_blender.geometry.planar import turn
from unisg_blender.scene import (
    ActionData,
    Material,
    Mesh,
    Relation,
    SceneBuilder,
    SceneGraph,
    Thresholds,
    mesh_from_faces,
)

FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def box(name: str, x: float, y: float, z: float, material: str = "") -> Mesh:
    """A box that stands on the origin."""
    corners = np.stack(np.meshgrid([-x / 2, x / 2], [-y / 2, y / 2], [0, z], indexing="ij"), axis=-1).reshape(-1, 3)
    mesh = mesh_from_faces(name, corners, FACES)
    slots = (material,) if material else ()
    index = np.zeros(6, np.int32) if material else None
    return Mesh(name, mesh.points, mesh.corners, mesh.offsets, material_index=index, materials=slots)


def at(x: float, y: float, z: float, yaw: float = 0.0) -> np.ndarray:
    """A pose: metres and radians."""
    matrix = turn(yaw)
    matrix[:3, 3] = x, y, z
    return matrix


def room(seed: int, cups: int = 2) -> SceneGraph:
    """A floor with four walls, a table with cups on it, a lamp on the wall; different by seed."""
    rng = np.random.default_rng(seed)
    width, depth = rng.uniform(4, 6, 2)
    builder = SceneBuilder(f"Room {seed}", materials={"wood": Material("wood", (0.4, 0.2, 0.1, 1.0))})
    number = iter(range(1000))

    def uid() -> str:
        return f"{seed:04d}-{next(number):04d}"

    on = "on_top_of"
    floor_uid = uid()
    floor = builder.add(
        "Floor", uid=floor_uid, local=at(0, 0, -0.1), mesh=box("Floor", width, depth, 0.1), category="Floor"
    )
    for side in range(4):
        reach, length = (depth, width) if side % 2 == 0 else (width, depth)
        local = turn(side * np.pi / 2) @ at(0, reach / 2 + 0.05, 0.1)
        wall_uid = uid()
        wall = builder.add(
            f"Wall.{side}", uid=wall_uid, parent=floor, local=local, mesh=box("Wall", length, 0.1, 2.5), category="Wall"
        )
        if side == 0:
            hung = at(rng.uniform(-1, 1), -0.05 - 0.05, 1.8)
            builder.add(
                "Lamp", uid=uid(), parent=wall, local=hung, mesh=box("Lamp", 0.2, 0.1, 0.2), category="Lamp",
                relations=(Relation("hangs_from", wall_uid),),
            )  # fmt: skip
    table_uid = uid()
    place = at(*rng.uniform(-1, 1, 2), 0.1, rng.uniform(-3, 3))
    table = builder.add(
        "Table", uid=table_uid, parent=floor, local=place, mesh=box("Table", 1.2, 0.7, 0.8, "wood"), category="Table",
        relations=(Relation(on, floor_uid),),
    )  # fmt: skip
    for cup in range(cups):
        own = uid()
        action = ActionData(f"take-{own}", "Remove", "Take the cup", targets=(own,), frame=table_uid,
                            thresholds=Thresholds(distance=0.3))  # fmt: skip
        candidate = at(-0.4 + 0.25 * cup + rng.uniform(-0.03, 0.03), rng.uniform(-0.2, 0.2), 0.8, rng.uniform(-3, 3))
        builder.add(
            f"Cup.{cup}", uid=own, parent=table, local=candidate, mesh=box("Cup", 0.08, 0.08, 0.1), category="Cup",
            actions=(action,), relations=(Relation(on, table_uid),),
        )  # fmt: skip
    return builder.build()
