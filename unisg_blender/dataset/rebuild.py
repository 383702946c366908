"""From a scene of a dataset back to a scenegraph: the layout, with boxes for the meshes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..scene import Mesh, SceneGraph, mesh_from_faces, table
from ..scene.action_data import actions_from_json
from ..scene.component_table import Table
from ..scene.lesson_node import lesson_from_json
from ..scene.mesh import BOX_FACES
from .format.reader import Scene


def to_scenegraph(scene: Scene) -> SceneGraph:
    """The scenegraph of a scene: names, hierarchy, poses, categories, relations and behaviour as they were.

    A dataset holds no geometry: every mesh is the box around the one it stands
    for. Relations, links and lessons keep what they say about entities of the scene.
    """
    count = len(scene)
    uids = scene.strings("entity.uid")
    moved = np.tile(np.eye(4), (len(scene["world.entity"]), 1, 1))
    moved[:, :3] = scene["world.matrix"]
    tables = {
        "world": Table(scene["world.entity"], {"matrix": moved}),
        "relations": table(
            scene["relation.subject"],
            kind=[scene.vocabulary["relations"][kind] for kind in scene["relation.kind"]],
            target=[uids[row] for row in scene["relation.target"]],
        ),
        "actions": _actions(scene),
        "lsa": _operations(scene),
    }
    vocabulary = tuple(sorted(set(scene.categories) - {""}))
    place = {name: number for number, name in enumerate(vocabulary)}
    return SceneGraph(
        name=scene.strings("entity.name"),
        uid=uids,
        type=scene["entity.type"].copy(),
        parent=scene.parent.copy(),
        category=np.array([place.get(name, -1) for name in scene.categories], np.int32).reshape(count),
        vocabulary=vocabulary,
        local=scene.local(),
        mesh=scene["entity.mesh"].copy(),
        meshes=tuple(map(_box, scene.strings("mesh.name"), scene["mesh.bounds"])),
        components={name: value for name, value in tables.items() if len(value.rows)},
        title=scene.title,
    ).validate()


def _box(name: str, bounds: NDArray[np.float32]) -> Mesh:
    corners = np.stack(np.meshgrid(*bounds.T, indexing="ij"), axis=-1).reshape(-1, 3)
    return mesh_from_faces(name, corners, BOX_FACES)


def _actions(scene: Scene) -> Table:
    actions = [actions_from_json(text)[0] for text in scene.strings("action.record")]
    return table(scene["action.entity"], data=actions)


def _operations(scene: Scene) -> Table:
    return table(scene["operation.entity"], data=[*map(lesson_from_json, scene.strings("operation.record"))])
