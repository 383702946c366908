"""Read a format of one's own, a table of boxes, and write it as a Blender file with categories.

    python examples/own_reader.py boxes.csv room.blend

Columns: name, category; x, y, z (of the middle of the bottom), width, depth, height (centimetres); degrees.
"""

import csv
import sys

import numpy as np

from unisg_blender import SceneBuilder, UniSGError, write_scene_file
from unisg_blender.scene import box_mesh

if len(sys.argv) != 3:
    sys.exit(__doc__)
builder = SceneBuilder("Boxes")
try:
    with open(sys.argv[1], newline="", encoding="utf-8") as file:
        for line in csv.DictReader(file):
            place = np.array([line["x"], line["y"], line["z"]], float) / 100  # centimetres to metres
            size = np.array([line["width"], line["depth"], line["height"]], float) / 100
            turn = np.radians(float(line["degrees"]))
            local = np.eye(4)
            local[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
            local[:3, 3] = place
            mesh = box_mesh(line["name"], size)
            builder.add(line["name"], uid=line["name"], category=line["category"], mesh=mesh, local=local)
    scene = builder.build()
    write_scene_file(scene, sys.argv[2])
except (OSError, KeyError, ValueError, UniSGError) as error:
    sys.exit(f"{sys.argv[1]}: {error}")
print(f"{len(scene)} entities: {', '.join(scene.vocabulary)}")
