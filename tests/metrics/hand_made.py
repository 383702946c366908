"""Small scenes whose faults are known by construction."""

from __future__ import annotations

import numpy as np

from unisg_blender.scene import Mesh, Relation, SceneBuilder, mesh_from_faces

FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def box_mesh(*size_at: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Mesh:
    """Boxes as one mesh: pairs of size and centre of the bottom."""
    points, faces = [], []
    for (x, y, z), at in size_at:
        square = np.array([[-x, -y], [x, -y], [x, y], [-x, y]]) / 2
        faces += [[len(points) * 8 + corner for corner in face] for face in FACES]
        points.append(np.concatenate([np.column_stack([square, np.full(4, level)]) for level in (0.0, z)]) + at)
    return mesh_from_faces("boxes", np.concatenate(points), faces)


def floor_mesh(width: float = 6, depth: float = 4) -> Mesh:
    return box_mesh(((width, depth, 0.1), (0, 0, -0.1)))


def table_mesh() -> Mesh:
    """1.2 x 0.8 x 0.75 with a 5 cm top on four legs."""
    legs = [((0.06, 0.06, 0.69), (x, y, 0)) for x in (-0.5, 0.5) for y in (-0.3, 0.3)]
    return box_mesh(((1.2, 0.8, 0.05), (0, 0, 0.7)), *legs)


def at(x: float, y: float, z: float, yaw: float = 0.0) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    matrix[:3, 3] = x, y, z
    return matrix


class Scene:
    """A floor to put boxes on; the uid of an object is its name."""

    def __init__(self, floor: Mesh | None = None) -> None:
        self.builder = SceneBuilder()
        self.floor = self.builder.add("floor", uid="floor", mesh=floor or floor_mesh(), category="Floor")

    def box(self, name, size, place, parent=None, category="Box", relation=None, mesh=None):
        return self.builder.add(
            name,
            uid=name,
            parent=self.floor if parent is None else parent,
            local=at(*place),
            mesh=mesh or box_mesh((size, (0, 0, 0))),
            category=category,
            relations=() if relation is None else (Relation(*relation),),
        )

    def build(self):
        return self.builder.build()
