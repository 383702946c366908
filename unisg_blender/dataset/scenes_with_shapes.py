"""The scenes of a dataset as scenegraphs whose meshes have the right shape, as far as layout goes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..geometry.boxes import SIGNS
from ..scene import Mesh, SceneGraph, mesh_from_faces
from ..scene.mesh import BOX_FACES
from .format.columns import mesh_checksums
from .format.reader import Dataset
from .rebuild import to_scenegraph


def scenes_with_shapes(dataset: Dataset) -> Iterator[SceneGraph]:
    """The scenes of a dataset, with the boxes of each mesh's parts (and the floors' outlines) for meshes.

    Where the dataset has no assets file every mesh is one box.
    """
    yield from map(ShapedScenes(dataset).scene, range(len(dataset)))


class ShapedScenes:
    """Scenes of a dataset by their numbers, as :func:`scenes_with_shapes` gives them one after another."""

    def __init__(self, dataset: Dataset) -> None:
        self._dataset, file = dataset, dataset.assets()
        self._parts = None if file is None else file.shapes("parts")
        self._outlines = {} if file is None else file.shapes("outlines")
        self._known: dict[str, Mesh] = {}

    def scene(self, number: int) -> SceneGraph:
        """One scene."""
        scene = self._dataset[number]
        graph = to_scenegraph(scene)
        if self._parts is None:
            return graph
        sums = mesh_checksums(scene.columns)
        for key, box in zip(sums, graph.meshes, strict=True):
            if key not in self._known:
                self._known[key] = _shape_mesh(box, self._parts.get(key), self._outlines.get(key))
        return graph.replace(meshes=tuple(self._known[key] for key in sums))


def _shape_mesh(box: Mesh, parts: NDArray[np.float32] | None, outline: NDArray[np.float32] | None) -> Mesh:
    if outline is not None and len(outline) >= 3:
        low, high = box.bounds[:, 2]
        outline = _from_a_corner_that_sees_all(outline)
        count, steps = len(outline), np.arange(len(outline))
        points = np.concatenate([np.column_stack([outline, np.full(count, z)]) for z in (low, high)])
        sides = np.stack([steps, (steps + 1) % count, count + (steps + 1) % count, count + steps], axis=1)
        return mesh_from_faces(box.name, points, [steps[::-1].tolist(), (count + steps).tolist(), *sides.tolist()])
    if parts is None or not len(parts):
        return box
    points = parts[:, (SIGNS > 0).astype(int), np.arange(3)]
    faces = [[8 * place + corner for corner in face] for place in range(len(parts)) for face in BOX_FACES]
    return mesh_from_faces(box.name, points.reshape(-1, 3), faces)


def _from_a_corner_that_sees_all(outline: NDArray[np.float32]) -> NDArray[np.float32]:
    """The polygon begun at a corner from which a fan of triangles covers it (faces are cut into fans)."""
    for start in range(len(outline)):
        turned = np.roll(outline, -start, axis=0)
        first, second = turned[1:-1] - turned[0], turned[2:] - turned[0]
        if (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > -1e-9).all():
            return turned
    return outline
