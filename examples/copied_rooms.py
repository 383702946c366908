"""The simplest generator of rooms: training rooms with all that stands on the floor pushed about by some centimetres.

    python examples/copied_rooms.py --training rooms/living-room/training --out copied --count 300
    unisg evaluate copied --data rooms/living-room/test --training rooms/living-room/training --out results

docs/evaluating.md says what such a folder must be like.
"""

from __future__ import annotations

import argparse
from itertools import islice
from pathlib import Path

import numpy as np

from unisg_blender import SceneGraph, open_dataset, write_scene_file
from unisg_blender.dataset.scenes_with_shapes import scenes_with_shapes
from unisg_blender.scene.categories import STRUCTURE


def pushed_about(room: SceneGraph, rng: np.random.Generator, centimetres: float) -> SceneGraph:
    """The room with other places, along x and y, for all things that hang under the building or under nothing."""
    local = room.local.copy()
    for row, parent in enumerate(room.parent):
        above = room.category_name(int(parent)) if parent >= 0 else ""
        if room.category_name(row) not in ("", *STRUCTURE) and above in ("", *STRUCTURE):
            local[row, :2, 3] += rng.normal(0, centimetres / 100, 2)
    return room.replace(local=local)


def main() -> None:
    """Write the rooms, one file each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--training", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--centimetres", type=float, default=10.0)
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(0)
    for number, room in enumerate(islice(scenes_with_shapes(open_dataset(args.training)), args.count)):
        write_scene_file(pushed_about(room, rng, args.centimetres), args.out / f"room-{number:04d}.usdc")


if __name__ == "__main__":
    main()
