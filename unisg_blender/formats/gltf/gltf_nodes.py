"""Entities as glTF nodes, in the order of their rows; cameras and lights hang below them, turned as glTF looks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...geometry.y_up import turned_matrices
from ...runtime.read_report import ReadReport
from ...scene import SceneGraph
from ...scene.components import CAMERA, LIGHT, VISIBILITY, WORLD
from ...scene.hierarchy import local_matrices
from ...scene.properties import encode_properties
from .gltf_axes import DOWN, placements
from .gltf_cameras_lights import camera_record, light_record
from .gltf_meshes import MeshWriter

LIGHTS = "KHR_lights_punctual"


class NodeWriter:
    """The nodes of a scene; node k is the entity in row k, what hangs below follows."""

    def __init__(self, graph: SceneGraph, meshes: MeshWriter, report: ReadReport) -> None:
        self.cameras: list[dict[str, Any]] = []
        self.lights: list[dict[str, Any]] = []
        self._graph, self._report = graph, report
        hidden = graph.entries(VISIBILITY, "hidden", "render")
        self._hidden = {row for row, eye, render in hidden if eye or render}
        self.nodes = [
            {"name": name, **place, "extras": _plain(encode_properties(graph, row))}
            for row, (name, place) in enumerate(zip(graph.name, self._placements(), strict=True))
        ]
        for row in range(len(graph)):
            self._add_mesh(row, meshes)
        for row, record in graph_records(graph, CAMERA):
            self._hang(row, "camera", {"camera": len(self.cameras)})
            self.cameras.append(camera_record(record))
        for row, record in graph_records(graph, LIGHT):
            self._hang(row, "light", {"extensions": {LIGHTS: {"light": len(self.lights)}}})
            self.lights.append(light_record(record))
        for row in range(len(graph) - 1, -1, -1):  # parents come first: what hangs below is there when it is asked for
            above = graph.parent[row]
            if above >= 0:
                self.nodes[above].setdefault("children", []).insert(0, row)

    def _placements(self) -> list[dict[str, Any]]:
        """Where nodes stand in their parents, as they are seen."""
        graph = self._graph
        local = local_matrices(graph, graph.world) if WORLD in graph.components else graph.local
        lost = ~np.isfinite(local).all(axis=(1, 2))
        for row in np.flatnonzero(lost).tolist():
            self._report.add(graph.name[row], "its place is no number: it is shown at its parent's")
        sound = np.where(lost[:, None, None], np.eye(4), local)
        return placements(turned_matrices(sound))

    def _add_mesh(self, row: int, meshes: MeshWriter) -> None:
        graph = self._graph
        if graph.mesh[row] < 0 or row in self._hidden:
            return
        mesh = graph.meshes[graph.mesh[row]]
        slots = list(mesh.materials)
        for _, slot, material in graph.entries("materials", "slot", "material", row=row):
            slots += [""] * (slot + 1 - len(slots))
            slots[slot] = material
        number = meshes.number(mesh, slots)
        if number is not None:
            self.nodes[row]["mesh"] = number

    def _hang(self, row: int, kind: str, content: dict[str, Any]) -> None:
        self.nodes[row].setdefault("children", []).append(len(self.nodes))
        self.nodes.append({"name": f"{self._graph.name[row]} ({kind})", "rotation": DOWN, **content})


def graph_records(graph: SceneGraph, component: str) -> list[tuple[int, dict[str, Any]]]:
    """Row and values by column of each entry of a component, one for a row."""
    found = graph.components.get(component)
    if found is None:
        return []
    return [(row, {name: values[0] for name, values in columns.items()}) for row, columns in found.groups()]


def _plain(value: Any) -> Any:
    """A custom property without what JSON has no numbers for."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
