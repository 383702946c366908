"""A world of one's own: shelves with boxes, by seed, as a dataset to learn from.

python examples/own_world.py shelves 20
"""

import sys

import numpy as np

from unisg_blender import SceneBuilder, SceneGraph, write_dataset
from unisg_blender.dataset import Sample
from unisg_blender.scene import mesh_from_faces

CORNERS = np.stack(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def at(x: float, y: float, z: float) -> np.ndarray:
    """A matrix that only moves, metres."""
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def shelf(seed: int) -> SceneGraph:
    """A board with one to six boxes side by side; the same seed, the same scene."""
    rng = np.random.default_rng(seed)
    builder = SceneBuilder(f"Shelf {seed}")
    board = mesh_from_faces("Board", CORNERS * (2.0, 0.4, 0.03), FACES)
    parent = builder.add("Board", uid="board", category="Shelf", mesh=board, local=at(0, 0, 1.2))
    count = int(rng.integers(1, 7))
    for number in range(count):
        box = mesh_from_faces("Box", CORNERS * rng.uniform(0.1, 0.3, 3), FACES)
        place = at((number + 0.5) / count * 2.0 - 1.0, 0, 0.03)
        builder.add(f"Box {number}", uid=f"box{number}", category="Box", mesh=box, parent=parent, local=place)
    return builder.build()


folder, count = sys.argv[1], int(sys.argv[2])
write_dataset((Sample(shelf(seed), f"shelf-{seed}", "shelf") for seed in range(count)), folder, "quaternion")
print(f"{folder}: {count} scenes")
