"""Shapes of bodies as MJCF has them: meshes that are seen, and convex pieces that collide."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from scipy.spatial.transform import Rotation

from ...geometry.arrays import Floats
from ...geometry.boxes import orthonormal_axes
from ...runtime.read_report import ReadReport
from ...scene import SceneGraph
from ...scene.components import RIGID_BODIES
from ...scene.hierarchy import subtree
from ...scene.mesh import Mesh, mesh_from_faces
from ...spatial.bodies.body_mass import density_of, mass_of
from ...spatial.bodies.hull_pieces import convex_pieces, firm_pieces

SEEN = {"contype": "0", "conaffinity": "0", "group": "2", "mass": "0"}
COLLIDES = {"group": "3"}
GREY = (0.8, 0.8, 0.8, 1.0)
FLAT = 1e-4
"""Metres of a half extent of a box at least."""


@dataclass(frozen=True, eq=False)
class Frame:
    """World matrices (N, 4, 4) as rigid ``placed`` (N, 4, 4) and what stretches there, ``linear`` (N, 3, 3)."""

    placed: Floats
    linear: Floats

    @staticmethod
    def of(world: Floats) -> Frame:
        """Those of some matrices."""
        placed = np.tile(np.eye(4), (len(world), 1, 1))
        placed[:, :3, :3] = orthonormal_axes(world[:, :3, :3])
        placed[:, :3, 3] = world[:, :3, 3]
        return Frame(placed, np.swapaxes(placed[:, :3, :3], 1, 2) @ world[:, :3, :3])

    def relative(self, row: int, above: int) -> Floats:
        """Where a row is as seen from another, -1 for the world, (4, 4)."""
        return self.placed[row] if above < 0 else np.linalg.inv(self.placed[above]) @ self.placed[row]


def pose_attributes(matrix: Floats) -> dict[str, str]:
    """Place and turn of a rigid matrix, as attributes of a body or a geom; nothing where it is at its parent's."""
    found = {}
    if np.abs(matrix[:3, 3]).max() > 1e-12:
        found["pos"] = _text(matrix[:3, 3])
    if np.abs(matrix[:3, :3] - np.eye(3)).max() > 1e-12:
        found["quat"] = _text(Rotation.from_matrix(matrix[:3, :3]).as_quat(canonical=True)[[3, 0, 1, 2]])
    return found


@dataclass
class BodyGeoms:
    """Adds geoms to bodies, and to ``asset`` what they are of; ``files`` are the meshes that are seen, by name."""

    scene: SceneGraph
    asset: Element
    report: ReadReport
    files: dict[str, str] = field(default_factory=dict)
    _known: dict[Any, str] = field(default_factory=dict)
    _heaviness: dict[int, float] = field(default_factory=dict)
    _pieces: dict[Any, list[str]] = field(default_factory=dict)

    def add(self, body: Element, row: int, frames: Frame, above: int, moves: bool) -> None:
        """The shapes of a row as seen from the body's own row ``above``; -1 for the world."""
        mesh = self.scene.meshes[self.scene.mesh[row]]
        if not len(mesh.triangles) or not np.isfinite(mesh.points).all():
            self.report.add(self.scene.name[row], "it has no faces: it is left out")
            return
        pose = pose_attributes(frames.relative(row, above))
        key = (int(self.scene.mesh[row]), frames.linear[row].round(9).tobytes())
        stretched = _stretched(mesh, frames.linear[row])
        seen = {"type": "mesh", "mesh": self._seen(key, stretched), "rgba": _text(self._colour(mesh))}
        SubElement(body, "geom", seen | SEEN | pose)
        shape = self._said.get(row, ("hull" if moves else "mesh", 0.0))[0]
        density = _text([density_of(self.scene, row) * self._heavier(row)])
        if shape == "box":
            low, high = stretched.bounds
            middle = frames.relative(row, above) @ np.append((low + high) / 2, 1)
            size = _text(np.maximum((high - low) / 2, FLAT))
            at = {"pos": _text(middle[:3])} | {name: value for name, value in pose.items() if name == "quat"}
            SubElement(body, "geom", {"type": "box", "size": size, "density": density} | COLLIDES | at)
            return
        for piece in self._collision(key, stretched, moves):
            SubElement(body, "geom", {"type": "mesh", "mesh": piece, "density": density} | COLLIDES | pose)

    @cached_property
    def _said(self) -> dict[int, tuple[str, float]]:
        """Shape and mass by row, for what hangs under a body those of the body."""
        own = {row: (str(shape), float(mass)) for row, shape, mass in self.scene.entries(RIGID_BODIES, "shape", "mass")}
        for row, parent in enumerate(self.scene.parent.tolist()):  # parents come first
            if row not in own and parent in own:
                own[row] = own[parent]
        return own

    def _heavier(self, row: int) -> float:
        """By how much the body that a row is of is heavier than by its category: what is said of its mass."""
        bodies = self.scene.components[RIGID_BODIES].rows
        while row >= 0 and row not in bodies:
            row = int(self.scene.parent[row])
        if row not in self._heaviness:
            said = self._said[row][1] if row >= 0 else 0.0
            rows = [each for each in subtree(self.scene, row) if self.scene.mesh[each] >= 0] if said > 0 else []
            self._heaviness[row] = said / mass_of(self.scene, rows) if said > 0 else 1.0
        return self._heaviness[row]

    def _seen(self, key: Any, mesh: Mesh) -> str:
        if key not in self._known:
            name = self._known[key] = f"mesh {len(self._known)}"
            file = f"{len(self._known):04d}.obj"
            corners = "".join(f"v {_text(point)}\n" for point in mesh.points.astype(np.float64))
            self.files[file] = corners + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in mesh.triangles.tolist())
            SubElement(self.asset, "mesh", name=name, file=file, inertia="shell")
        return self._known[key]

    def _collision(self, key: Any, mesh: Mesh, moves: bool) -> list[str]:
        if (key, moves) not in self._pieces:
            pieces = convex_pieces(mesh) if moves else firm_pieces(mesh)
            names = [f"{self._known[key]} {'piece' if moves else 'face'} {number}" for number in range(len(pieces))]
            for name, points in zip(names, pieces, strict=True):
                SubElement(self.asset, "mesh", name=name, vertex=_text(points.reshape(-1)))
            self._pieces[key, moves] = names
        return self._pieces[key, moves]

    def _colour(self, mesh: Mesh) -> tuple[float, ...]:
        material = self.scene.materials.get(mesh.materials[0]) if mesh.materials else None
        return GREY if material is None else material.base_color


def _stretched(mesh: Mesh, linear: Floats) -> Mesh:
    """A mesh of triangles with its points moved by a matrix (3, 3)."""
    faces = mesh.triangles if np.linalg.det(linear) >= 0 else mesh.triangles[:, ::-1]
    return mesh_from_faces(mesh.name, mesh.points.astype(np.float64) @ linear.T, faces)


def _text(values: Any) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)
