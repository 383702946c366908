"""A world of one's own: shelves with boxes, by seed, as a dataset to learn from.

python examples/own_world.py shelves 20
"""

import sys

import numpy as np

from unisg_blender import SceneBuilder, SceneGraph, UniSGError, write_dataset
from unisg_blender.dataset import Sample
from unisg_blender.scene import box_mesh


def shelf(seed: int) -> SceneGraph:
    """A board with one to six boxes side by side; the same seed, the same scene."""
    rng = np.random.default_rng(seed)
    builder = SceneBuilder(f"Shelf {seed}")
    board = box_mesh("Board", (2.0, 0.4, 0.03))
    parent = builder.add("Board", uid="board", category="Shelf", mesh=board, local=(0, 0, 1.2))
    count = int(rng.integers(1, 7))
    for number in range(count):
        mesh, place = box_mesh("Box", rng.uniform(0.1, 0.3, 3)), ((number + 0.5) / count * 2.0 - 1.0, 0, 0.03)
        builder.add(f"Box {number}", uid=f"box{number}", category="Box", mesh=mesh, parent=parent, local=place)
    return builder.build()


if len(sys.argv) != 3 or not sys.argv[2].isdecimal():
    sys.exit(__doc__)
folder, count = sys.argv[1], int(sys.argv[2])
try:
    write_dataset((Sample(shelf(seed), f"shelf-{seed}", "shelf") for seed in range(count)), folder, "quaternion")
except UniSGError as error:
    sys.exit(str(error))
print(f"{folder}: {count} scenes")
