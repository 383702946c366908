"""The unit of a Blender scene: metres inside, the scene's own unit wherever Blender holds a length.

Only lengths change: translations and points are multiplied, linear parts stay as they are, so an object of scale 1
keeps scale 1. Reference poses and recordings in custom properties are in the scene's unit too, so that they go with the
objects when somebody gives the scene another unit; thresholds are in metres in every scene. A new file is in metres.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..runtime.read_report import ReadReport
from ..scene import components
from ..scene.action_data import ActionData
from ..scene.component_table import Table
from ..scene.graph import SceneGraph
from ..scene.mesh import Mesh

UNITS = (1e-6, 1e6)
"""The smallest and the largest unit of a scene in metres."""

MATRICES = {
    components.WORLD: ("matrix",), components.PARENTING: ("frame",), components.CHANNELS: ("inverse",),
    components.BONES: ("rest", "pose"), components.INSTANCES: ("matrix",),
}  # fmt: skip
LENGTHS = {
    components.CHANNELS: ("location", "delta_location"), components.BONES: ("length",), components.EMPTY: ("size",),
    components.CAMERA: ("ortho_scale", "clip_start", "clip_end", "focus_distance"),
    components.LIGHT: ("radius", "size", "size_y"),
}  # fmt: skip
"""Columns of matrices and of lengths, by component; further columns are in :meth:`_Scaling.component`."""


def metres_per_unit(scene: bpy.types.Scene) -> float:
    """Metres in one unit of a scene: 1 without a unit system, where Blender scales nothing, and for what cannot be."""
    settings = scene.unit_settings
    unit = _said(settings)
    return 1.0 if settings.system == "NONE" or not UNITS[0] <= unit <= UNITS[1] else unit


def report_unit(scene: bpy.types.Scene, report: ReadReport) -> None:
    """Tell what is made of a unit that is not the metre."""
    said, unit = _said(scene.unit_settings), metres_per_unit(scene)
    if unit != 1.0:
        report.add("", f"its unit of {unit:g} m: all lengths are read in metres")
    elif said != 1.0:
        why = "there is no unit system" if UNITS[0] <= said <= UNITS[1] else "it cannot be"
        report.add("", f"the unit scale {said:g} is not applied, {why}: one Blender unit is read as one metre")


def scale_translations(matrices: NDArray[np.float64], factor: float) -> NDArray[np.float64]:
    """Affine matrices (..., 4, 4) with their translations multiplied; the same array for the factor 1."""
    if factor == 1.0:
        return matrices
    scaled = matrices.copy()
    scaled[..., :3, 3] *= factor
    return scaled


def scaled_mesh(mesh: Mesh, factor: float) -> Mesh:
    """A mesh with its points multiplied; the same mesh for the factor 1."""
    if factor == 1.0:
        return mesh
    return replace(mesh, points=(mesh.points.astype(np.float64) * factor).astype(np.float32))


def in_metres(graph: SceneGraph, scene: bpy.types.Scene) -> SceneGraph:
    """A scenegraph whose lengths are in the unit of ``scene``, in metres."""
    return _scaled(graph, metres_per_unit(scene))


def in_scene_units(graph: SceneGraph, scene: bpy.types.Scene) -> SceneGraph:
    """A scenegraph in metres, its lengths in the unit of ``scene``."""
    return _scaled(graph, 1.0 / metres_per_unit(scene))


def _scaled(graph: SceneGraph, factor: float) -> SceneGraph:
    return graph if factor == 1.0 else _Scaling(factor).graph(graph)


def _said(settings: bpy.types.UnitSettings) -> float:
    """The scale as it was typed, 0.01, not the float32 next to it."""
    return float(str(np.float32(settings.scale_length)))


@dataclass
class _Scaling:
    """One scenegraph and the prototypes of its instances with other lengths; what is shared stays shared."""

    factor: float
    meshes: dict[int, Mesh] = field(default_factory=dict)
    prototypes: dict[int, SceneGraph] = field(default_factory=dict)

    def graph(self, graph: SceneGraph) -> SceneGraph:
        """Matrices, meshes and components."""
        return graph.replace(
            local=scale_translations(graph.local, self.factor),
            meshes=tuple(map(self.mesh, graph.meshes)),
            components={name: self.component(name, found) for name, found in graph.components.items()},
        )

    def mesh(self, mesh: Mesh) -> Mesh:
        """A mesh, made once."""
        if id(mesh) not in self.meshes:
            self.meshes[id(mesh)] = scaled_mesh(mesh, self.factor)
        return self.meshes[id(mesh)]

    def component(self, name: str, found: Table) -> Table:
        """A component; one that holds no lengths stays as it is."""
        columns = found.columns
        matrices, lengths = ([key for key in each.get(name, ()) if key in columns] for each in (MATRICES, LENGTHS))
        changes: dict[str, NDArray[Any]] = {key: scale_translations(columns[key], self.factor) for key in matrices}
        changes |= {key: columns[key] * self.factor for key in lengths}
        if name == components.INSTANCES:
            changes["prototype"] = _each(found, "prototype", self.prototype)
        if name in (components.ANIMATION, components.RECORDING):
            changes["matrices"] = _each(found, "matrices", lambda motion: scale_translations(motion, self.factor))
        if name == components.ACTIONS:
            changes["data"] = _each(found, "data", self.action)
        if name == components.LIGHT:
            changes["energy"] = columns["energy"] * np.where(_spreads(columns), self.factor**2, 1.0)
        return Table(found.rows, {**columns, **changes}) if changes else found

    def action(self, action: ActionData) -> ActionData:
        """An action with its reference pose; thresholds are in metres in every scene."""
        if action.reference_matrix is None:
            return action
        reference = scale_translations(action.reference_matrix, self.factor)
        return replace(action, reference=tuple(reference.ravel().tolist()))

    def prototype(self, graph: SceneGraph) -> SceneGraph:
        """An instanced scenegraph, made once."""
        if id(graph) not in self.prototypes:
            self.prototypes[id(graph)] = self.graph(graph)
        return self.prototypes[id(graph)]


def _spreads(lights: Mapping[str, NDArray[Any]]) -> NDArray[np.bool_]:
    """bool (K,): lights whose watts thin out with the square of the distance, in whatever unit Blender measures it."""
    return (lights["kind"] != "SUN") & lights.get("normalize", np.ones(len(lights["kind"]), bool))


def _each(found: Table, name: str, change: Callable[[Any], Any]) -> NDArray[Any]:
    column = np.empty(len(found.rows), object)
    for place, value in enumerate(found.columns[name]):
        column[place] = change(value)
    return column
