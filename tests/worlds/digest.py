"""A digest of everything in a scenegraph: two scenes with one digest are the same, bit for bit."""

from __future__ import annotations

import hashlib
import sys

from unisg_blender.scene import SceneGraph
from unisg_blender.scene.action_data import actions_to_json
from unisg_blender.scene.lesson_node import lesson_to_json
from unisg_blender.worlds import WORLDS


def digest(graph: SceneGraph) -> str:
    found = hashlib.blake2b(digest_size=16)
    for array in (graph.type, graph.parent, graph.category, graph.local, graph.mesh):
        found.update(array.tobytes())
    words = [graph.title, *graph.name, *graph.uid, *graph.vocabulary, *map(repr, graph.materials.values())]
    words += [mesh.checksum + repr(mesh.materials) for mesh in graph.meshes]
    words += [repr(mesh.material_index.tolist()) for mesh in graph.meshes]
    for name, table in graph.components.items():
        words += [name, repr(table.rows.tolist())]
        if name == "relations":
            words += [*table.columns["kind"], *table.columns["target"]]
        else:
            write = {"actions": lambda action: actions_to_json([action]), "lsa": lesson_to_json}[name]
            words += [write(value) for value in table.columns["data"]]
    found.update("\0".join(words).encode())
    return found.hexdigest()


if __name__ == "__main__":
    for world in sys.argv[2:]:
        print(world, digest(WORLDS[world](int(sys.argv[1]))))
