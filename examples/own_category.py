"""Give things categories by a rule of one's own, from name, size and what they rest on, and write the file again.

unisg world living-room --seed 3 --out homes
python examples/own_category.py homes/living-room-00003.blend labelled.blend
"""

import sys
from collections import Counter

import numpy as np

from unisg_blender import UniSGError, read_scene_file, relate, write_scene_file
from unisg_blender.scene import local_bounds


def rule(name: str, category: str, size: np.ndarray, below: str) -> str:
    """The category of a thing: ``size`` (3,) is in metres, ``below`` the name of what it rests on, "" for nothing."""
    if category == "Book" and "Table" in below and size[2] < 0.05:
        return "Magazine"
    return category or (name.partition(".")[0] if size.any() else "")  # Blender's "Chair.001" is a Chair


if len(sys.argv) != 3:
    sys.exit(__doc__)
try:
    scene, _ = read_scene_file(sys.argv[1])
    size = np.ptp(local_bounds(scene), axis=1)  # (N, 3), in the things' own frames; 0 without a mesh
    on = {row: scene.name[scene.row_of_uid[target]] for row, kind, target in
          relate(scene).entries("relations", "kind", "target") if kind == "on_top_of"}  # fmt: skip
    rows = range(len(scene))
    old = [scene.category_name(row) for row in rows]
    new = [rule(scene.name[row], old[row], size[row], on.get(row, "")) for row in rows]
    vocabulary = (*scene.vocabulary, *sorted({*new} - {"", *scene.vocabulary}))
    category = np.array([vocabulary.index(name) if name else -1 for name in new], np.int32)
    write_scene_file(scene.replace(vocabulary=vocabulary, category=category), sys.argv[2])
except UniSGError as error:
    sys.exit(str(error))
changed = Counter(after for before, after in zip(old, new, strict=True) if before != after)
print("new categories:", ", ".join(f"{name} {count}" for name, count in changed.items()) or "none")
