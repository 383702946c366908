"""Read a format of one's own, a table of boxes, and write it as a Blender file with categories.

    python examples/own_reader.py boxes.csv room.blend

Columns: name, category; x, y, z (of the middle of the bottom), width, depth, height (centimetres); degrees.
"""

import csv
import sys

import numpy as np

from unisg_blender import SceneBuilder, write_scene_file
from unisg_blender.scene import mesh_from_faces

CORNERS = np.stack(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]

builder = SceneBuilder("Boxes")
with open(sys.argv[1], newline="", encoding="utf-8") as file:
    for line in csv.DictReader(file):
        place = np.array([line["x"], line["y"], line["z"]], float) / 100  # centimetres to metres
        size = np.array([line["width"], line["depth"], line["height"]], float) / 100
        turn = np.radians(float(line["degrees"]))
        local = np.eye(4)
        local[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        local[:3, 3] = place
        mesh = mesh_from_faces(line["name"], CORNERS * size, FACES)
        builder.add(line["name"], uid=line["name"], category=line["category"], mesh=mesh, local=local)
scene = builder.build()
write_scene_file(scene, sys.argv[2])
print(f"{len(scene)} entities: {', '.join(scene.vocabulary)}")
