"""The mesh column: which entity has which mesh, each mesh read once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...runtime.read_report import ReadReport
from ...scene.mesh import Mesh
from ..depsgraph import is_evaluated
from .mesh_arrays import read_mesh

CURVE_LIKE = ("CURVE", "SURFACE", "FONT", "META")


@dataclass
class MeshShelf:
    """The meshes read so far; objects that share their data share the mesh.

    ``evaluated``: modifiers and shape keys applied, curves and texts as meshes;
    else the meshes as they are edited.
    """

    depsgraph: bpy.types.Depsgraph
    evaluated: bool
    report: ReadReport
    meshes: list[Mesh] = field(default_factory=list)
    places: dict[Any, int] = field(default_factory=dict)

    def column(self, items: Sequence[bpy.types.Object]) -> NDArray[np.int32]:
        """int32 (N,): the place of every object's mesh in ``meshes``, -1 for none."""
        return np.array([self.place(item) for item in items], np.int32).reshape(len(items))

    def place(self, item: bpy.types.Object) -> int:
        """The place of one object's mesh, reading it if it is new; -1 for objects without a mesh."""
        kind = item.type
        if kind == "MESH":
            own = self.evaluated and (_is_changed(item) and is_evaluated(item, self.depsgraph))
        elif kind in CURVE_LIKE and self.evaluated and is_evaluated(item, self.depsgraph):
            own = bool(item.modifiers)
        elif kind == "POINTCLOUD":
            own = False
        else:
            return -1
        key = (item.data, item) if own else item.data
        if key not in self.places:
            self.places[key] = self._store(item, own)
        return self.places[key]

    def drawn_mesh(self, drawn: bpy.types.Object, made: bool) -> Mesh | None:
        """The mesh of an evaluated object that is drawn as an instance; None without one.

        ``made``: geometry nodes made it, it is no object of its own.
        """
        if made and drawn.type == "POINTCLOUD":
            return read_points(drawn.data)
        if made:
            return read_mesh(drawn.data) if drawn.type == "MESH" else None
        place = self.place(drawn.original)
        return self.meshes[place] if place >= 0 else None

    def _store(self, item: bpy.types.Object, own: bool) -> int:
        mesh = self._read(item, own)
        if mesh is None:
            return -1
        if not np.isfinite(mesh.points).all():
            self.report.add(item.name, "some of its points are not finite numbers")
        if own and item.data.users > 1:  # the same modifiers on the same data give the same mesh
            alike = (item.data, mesh.checksum, mesh.materials)
            if alike in self.places:
                return self.places[alike]
            self.places[alike] = len(self.meshes)
        self.meshes.append(mesh)
        return len(self.meshes) - 1

    def _read(self, item: bpy.types.Object, own: bool) -> Mesh | None:
        if item.type == "POINTCLOUD":
            return read_points(item.data)
        found = item.evaluated_get(self.depsgraph) if own or item.type != "MESH" else item
        if item.type == "MESH" and item.mode != "EDIT":  # in edit mode the data is a shell without arrays
            return read_mesh(found.data, item.data.name)
        try:
            mesh = found.to_mesh()
            return None if mesh is None else read_mesh(mesh, item.data.name)
        except RuntimeError as error:
            self.report.add(item.name, f"has no geometry that can be read: {error}".strip())
            return None
        finally:
            found.to_mesh_clear()


def _is_changed(item: bpy.types.Object) -> bool:
    return len(item.modifiers) > 0 or item.data.shape_keys is not None or item.mode != "OBJECT"


def read_points(cloud: bpy.types.PointCloud) -> Mesh:
    """A point cloud as a mesh without faces."""
    points = np.zeros((len(cloud.points), 3), np.float32)
    if len(points):
        cloud.attributes["position"].data.foreach_get("vector", points.ravel())
    return Mesh(cloud.name, points, np.zeros(0, np.int32), np.zeros(1, np.int32))
