"""Give things categories by a rule of one's own, and write the file again: what is flat and rests on a table is a Tray.

python examples/own_category.py room.blend labelled.blend
"""

import sys

import numpy as np

from unisg_blender import read_scene_file, relate, write_scene_file
from unisg_blender.scene import local_bounds

scene, _ = read_scene_file(sys.argv[1])
size = np.ptp(local_bounds(scene), axis=1)  # (N, 3), metres, in the things' own frames; 0 without a mesh
flat = (size[:, 2] < 0.05) & (size[:, :2].min(axis=1) > 0.15)
on_table = np.zeros(len(scene), bool)
for row, kind, target in relate(scene).entries("relations", "kind", "target"):
    on_table[row] |= kind == "on_top_of" and "Table" in scene.name[scene.row_of_uid[target]]
rows = np.flatnonzero(flat & on_table & (scene.category < 0))

names = [*scene.vocabulary, *({"Tray"} - set(scene.vocabulary))]
category = scene.category.copy()
category[rows] = names.index("Tray")
write_scene_file(scene.replace(vocabulary=tuple(names), category=category), sys.argv[2])
print(f"{len(rows)} trays: {', '.join(scene.name[row] for row in rows)}")
