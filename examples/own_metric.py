"""A metric of one's own over a folder of scenes: how far each chair is from the nearest table, metres.

python examples/own_metric.py rooms/
"""

import sys
from pathlib import Path

import numpy as np

from unisg_blender import SceneGraph, UniSGError, read_scene_file


def places(scene: SceneGraph, word: str) -> np.ndarray:
    """World places (K, 3) of the things whose category ends with a word, metres."""
    rows = [row for row in range(len(scene)) if scene.category_name(row).endswith(word)]
    return scene.world[rows, :3, 3]


def chair_distances(scene: SceneGraph) -> np.ndarray:
    """Of each chair (K,) the distance on the floor to the nearest table, metres; empty without tables."""
    chairs, tables = places(scene, "Chair"), places(scene, "Table")
    if not len(tables):
        return np.zeros(0)
    return np.linalg.norm(chairs[:, None, :2] - tables[None, :, :2], axis=-1).min(axis=1)


if len(sys.argv) != 2:
    sys.exit(__doc__)
paths = sorted(Path(sys.argv[1]).glob("*.blend")) or sys.exit(f"{sys.argv[1]}: no .blend files")
try:
    every = [chair_distances(read_scene_file(path)[0]) for path in paths]
except UniSGError as error:
    sys.exit(str(error))
found = np.concatenate(every)
if not len(found):
    sys.exit(f"{sys.argv[1]}: no chairs beside tables")
print(f"{len(found)} chairs in {len(every)} rooms: median {np.median(found):.2f} m, farthest {found.max():.2f} m")
