"""Meshes from USD geometry, each once however many prims show it."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom, UsdShade

from ...scene.mesh import Material, Mesh, shown_slots
from .. import schema
from ..names import true_name
from .gprims import shape_arrays
from .mesh_topology import Topology, read_topology
from .preview_surfaces import read_material
from .unsupported_prims import material_losses

SHOWN = ("MESH", "CURVE", "POINTCLOUD")
MOST_SLOTS = 2**15  # as in Blender


class MeshPrims:
    """The meshes and materials of one stage; geometry is turned into metres and Z up by ``frame``."""

    def __init__(self, frame: NDArray[np.float64]) -> None:
        self.meshes: list[Mesh] = []
        self.materials: dict[str, Material] = {}
        self._frame = frame
        self._place: dict[Any, int] = {}
        self._material_names: dict[Any, str] = {}

    def column(self, shapes: Sequence[Any], kinds: Sequence[str]) -> NDArray[np.int32]:
        """Positions in ``meshes`` of the geometry of some prims (None for no shape), -1 for none."""
        rows = [row for row, kind in enumerate(kinds) if kind in SHOWN and shapes[row] is not None]
        column = np.full(len(shapes), -1, np.int32)
        bound = UsdShade.MaterialBindingAPI.ComputeBoundMaterials([shapes[row] for row in rows])[0] if rows else []
        for row, material in zip(rows, bound, strict=True):
            prim = shapes[row]
            key = (*_geometry_key(prim), self._material_name(material) if material else None)
            if key not in self._place:
                self._place[key] = len(self.meshes)
                self.meshes.append(self._read(prim, material))
            column[row] = self._place[key]
        return column

    def keep_materials(self, scope: Any) -> None:
        """Add the materials of a scope, used or not."""
        for prim in scope.GetChildren() if scope else ():
            if prim.IsA(UsdShade.Material):
                self._material_name(UsdShade.Material(prim))

    def _read(self, prim: Any, material: Any) -> Mesh:
        name = true_name(prim)
        topology = read_topology(prim) if prim.IsA(UsdGeom.Mesh) else shape_arrays(prim)
        slots, material_index = self._slots(prim, material, len(topology.offsets) - 1)
        points, normals = self._turned(topology)
        if not np.isfinite(points).all():
            warnings.warn(f"{prim.GetPath()}: some points are not finite numbers", stacklevel=2)
        return Mesh(
            name=name,
            points=points,
            corners=topology.corners,
            offsets=topology.offsets,
            edges=topology.edges,
            normals=normals,
            uvs=topology.uvs,
            material_index=material_index,
            materials=slots,
        )

    def _turned(self, topology: Topology) -> tuple[NDArray[np.float32], NDArray[np.float32] | None]:
        if (self._frame == np.eye(4)).all():
            return topology.points, topology.normals
        linear = self._frame[:3, :3]
        points = (topology.points.astype(np.float64) @ linear.T).astype(np.float32)
        if topology.normals is None:
            return points, None
        turn = linear / np.cbrt(np.linalg.det(linear))
        return points, (topology.normals.astype(np.float64) @ turn.T).astype(np.float32)

    def _slots(self, prim: Any, material: Any, faces: int) -> tuple[tuple[str, ...], NDArray[np.int32] | None]:
        """Names in the material slots, and the slot of each face (None if all have the first)."""
        stored = prim.GetAttribute(schema.MATERIALS).Get()
        names = [self._material_name(material)] if material else []
        if hasattr(stored, "__iter__"):  # else there is none, or one of a type that USD does not know
            names = [str(name) for name in stored]
        subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets() if prim.GetChildren() else []
        if not subsets:
            return tuple(names), None
        index = np.zeros(faces, np.int32)
        for subset in subsets:
            own = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0]
            slot = subset.GetPrim().GetAttribute(schema.SLOT).Get()
            if not isinstance(slot, int) or not 0 <= slot < MOST_SLOTS:
                name = self._material_name(own) if own else subset.GetPrim().GetName()
                slot = names.index(name) if name in names else len(names)
                names += [name] if slot == len(names) else []
            members = np.array(subset.GetIndicesAttr().Get(Usd.TimeCode.EarliestTime()) or (), np.int64)
            members = members[(members >= 0) & (members < faces)]
            index[members] = slot
        index = shown_slots(index, len(names))
        return tuple(names), index if index.any() else None

    def _material_name(self, material: Any) -> str:
        """The name under which the material is kept; made unique where two different ones share one.

        Materials inside what is referenced or instanced come once for each copy, and are one.
        """
        prim = _shown_once(material.GetPrim())
        path = prim.GetPath()
        if path not in self._material_names:
            base = name = true_name(prim)
            number, found = 1, read_material(base, material)
            while name in self.materials and replace(self.materials[name], name=base) != found:
                name, number = f"{base}.{number:03d}", number + 1
            self._material_names[path] = name
            self.materials[name] = replace(found, name=name)
            for text in material_losses(material):
                warnings.warn(f"{path}: {text}", stacklevel=2)
        return self._material_names[path]


NO_GEOMETRY = ("physics:", "semantics:")
"""Properties that one of several prims with the same mesh may have, and still have that mesh."""


def _shown_once(prim: Any) -> Any:
    """The prim itself, or the one that all native instances share with it."""
    return prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim


def _geometry_key(prim: Any) -> tuple[Any, ...]:
    """The same for prims whose geometry comes from the same places: references and instances of one mesh."""
    prim = _shown_once(prim)
    specs = [
        (spec.layer.identifier, spec.path)
        for spec in prim.GetPrimStack() if any(not each.name.startswith(NO_GEOMETRY) for each in spec.properties)
    ]  # fmt: skip
    return tuple(specs) or (prim.GetPath(),)
