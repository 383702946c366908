"""The simplest generator of rooms: training rooms with all that stands on the floor pushed about by some centimetres.

    python examples/copied_rooms.py rooms/living-room/training copied 300 10
    unisg evaluate copied --data rooms/living-room/test --training rooms/living-room/training --out results

The numbers are rooms and centimetres. docs/evaluating.md says what a folder of rooms must be like.
"""

import sys
from itertools import islice
from pathlib import Path

import numpy as np

from unisg_blender import SceneGraph, UniSGError, open_dataset, write_scene_file
from unisg_blender.dataset.scenes_with_shapes import scenes_with_shapes
from unisg_blender.scene import STRUCTURE


def pushed_about(room: SceneGraph, rng: np.random.Generator, centimetres: float) -> SceneGraph:
    """The room with other places, along x and y, for all things that hang under the building or under nothing."""
    local, building = room.local.copy(), ("", *STRUCTURE)
    for row, parent in enumerate(room.parent):
        above = room.category_name(int(parent)) if parent >= 0 else ""
        if room.category_name(row) not in building and above in building:
            local[row, :2, 3] += rng.normal(0, centimetres / 100, 2)
    return room.replace(local=local)


if len(sys.argv) != 5:
    sys.exit(__doc__)
training, out, count, centimetres = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
rng = np.random.default_rng(0)
try:
    for number, room in enumerate(islice(scenes_with_shapes(open_dataset(training)), count)):
        out.mkdir(parents=True, exist_ok=True)
        write_scene_file(pushed_about(room, rng, centimetres), out / f"room-{number:04d}.usdc")
except UniSGError as error:
    sys.exit(str(error))
