"""COLLADA (.dae): its geometry, and where its nodes put it; materials, animation and skinning are not read.

Read here and not by pycollada: that finds no triangles in some shelves of a simulated bookstore, and the zip would have
to carry it.

Khronos Group, "COLLADA - Digital Asset Schema Release 1.5.0", 2008; versions 1.4 and 1.5 are the same in what is read.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..scene import Mesh
from .axes import Y_UP, Array, axis_turn, numbers, point_rows, pose, quaternion_turn

UP = {"Z_UP": np.eye(4), "Y_UP": Y_UP, "X_UP": pose((0, 0, 0), axis_turn("y", -np.pi / 2))}
"""From the frame with that axis up to ours."""

DEEPEST = 60
"""Nodes within nodes."""

MOST_PARTS = 100_000
Part = tuple[str, Array, Mesh]
"""Name of a node, its matrix (4, 4), and a mesh."""


def collada_parts(root: Element, path: Path, upright: bool = True) -> list[Part]:
    """What the scene of a document shows, in metres.

    Parameters
    ----------
    root
        The element COLLADA.
    path
        For messages.
    upright
        Whether its up axis becomes z; simulators of robots do not ask for it.
    """
    file = _Document(root, path)
    found: list[Part] = []
    for node in file.scene():
        for part in file.parts(node, file.frame(upright), 0):
            found.append(part)
            if len(found) > MOST_PARTS:
                raise UniSGError(f"cannot read {path}: it shows more than {MOST_PARTS:,} parts")
    return found


class _Document:
    def __init__(self, root: Element, path: Path) -> None:
        self.root, self.path = root, path
        self.ids = {
            (each.tag, each.get("id")): each for each in root.iter() if each.get("id")
        }  # a node's may be a mesh's
        self._meshes: dict[str, list[Mesh]] = {}
        self._arrays: dict[str, Array] = {}

    def frame(self, upright: bool) -> Array:
        """From its unit and axes to ours."""
        unit = self.root.find("asset/unit")
        metre = float("1" if unit is None else unit.get("meter", "1"))
        if not 0 < metre < 1e6:
            raise UniSGError(f"cannot read {self.path}: its unit is {metre:g} metres")
        up = (self.root.findtext("asset/up_axis") or "Y_UP").strip()
        return np.asarray((UP.get(up, Y_UP) if upright else np.eye(4)) @ np.diag([metre, metre, metre, 1.0]))

    def scene(self) -> list[Element]:
        """The nodes of the scene that is shown, or of the first one."""
        shown = self.root.find("scene/instance_visual_scene")
        scene = None if shown is None else self._named(shown, "url", "visual_scene")
        scene = self.root.find("library_visual_scenes/visual_scene") if scene is None else scene
        return [] if scene is None else scene.findall("node")

    def _named(self, element: Element, key: str, *tags: str) -> Element | None:
        name = element.get(key, "").removeprefix("#")
        return next((self.ids[tag, name] for tag in tags if (tag, name) in self.ids), None)

    def parts(self, node: Element, above: Array, depth: int) -> Iterator[Part]:
        """What a node shows, and the nodes in it; UniSGError if they are within each other."""
        if depth > DEEPEST:
            raise UniSGError(f"cannot read {self.path}: its nodes are more than {DEEPEST} deep")
        local = above @ _node_matrix(node)
        name = node.get("name") or node.get("id") or ""
        for child in node:
            if child.tag == "node":
                yield from self.parts(child, local, depth + 1)
            elif child.tag == "instance_node" and (other := self._named(child, "url", "node")) is not None:
                yield from self.parts(other, local, depth + 1)
            elif child.tag in ("instance_geometry", "instance_controller"):
                geometry, bound = self._geometry(child)
                yield from ((name, local @ bound, mesh) for mesh in self._meshes_of(geometry))

    def _geometry(self, instance: Element) -> tuple[Element | None, Array]:
        """The geometry of an instance, and the matrix in which a skin takes it; unposed."""
        found, bound = self._named(instance, "url", "geometry", "controller"), np.eye(4)
        for _ in range(DEEPEST):
            if found is None or found.tag != "controller":
                break
            inner = found.find("skin") if found.find("skin") is not None else found.find("morph")
            text = None if inner is None else inner.findtext("bind_shape_matrix")
            bound = bound if not text else bound @ numbers(text.split(), 16).reshape(4, 4)
            found = None if inner is None else self._named(inner, "source", "geometry", "controller")
        return found, bound

    def _meshes_of(self, geometry: Element | None) -> list[Mesh]:
        """The mesh of a geometry, if it has faces; the same object each time."""
        if geometry is None or geometry.tag != "geometry":
            return []
        key = geometry.get("id", "")
        if key not in self._meshes:
            self._meshes[key] = list(self._built(geometry))
        return self._meshes[key]

    def _built(self, geometry: Element) -> Iterator[Mesh]:
        mesh, sources = geometry.find("mesh"), list[tuple[Array, int]]()
        sizes, corners, start = list[NDArray[np.int64]](), list[NDArray[np.int64]](), 0
        for group in () if mesh is None else mesh:
            if group.tag not in _SIZES:
                continue
            points, numbers_of, counts = self._faces(group)
            if len(numbers_of) and (numbers_of.min() < 0 or numbers_of.max() >= len(points)):
                raise UniSGError(f"cannot read {self.path}: {geometry.get('id')!r} has faces of points that it has not")
            known = next((at for other, at in sources if other is points), None)
            if known is None:
                sources.append((points, known := start))
                start += len(points)
            corners.append(numbers_of + known)
            sizes.append(counts)
        if sizes:
            offsets = np.concatenate([[0], np.cumsum(np.concatenate(sizes))]).astype(np.int32)
            every = np.concatenate([points for points, _ in sources]).astype(np.float32)
            yield Mesh(
                geometry.get("name") or geometry.get("id") or "",
                every,
                np.concatenate(corners).astype(np.int32),
                offsets,
            )

    def _faces(self, group: Element) -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
        """Points, numbers of points by corner, and corners by face of a group of primitives."""
        inputs = group.findall("input")
        stride = 1 + max((int(each.get("offset", "0")) for each in inputs), default=0)
        vertex = next((each for each in inputs if each.get("semantic") == "VERTEX"), None)
        if vertex is None or not 0 < stride < 64:
            return np.zeros((0, 3)), np.zeros(0, np.int64), np.zeros(0, np.int64)
        column = int(vertex.get("offset", "0"))
        runs = [_whole(each.text).reshape(-1, stride)[:, column] for each in group.findall("p")]
        runs += [_whole(each.text).reshape(-1, stride)[:, column] for each in group.findall("ph/p")]
        corners, sizes = _SIZES[group.tag](runs, group)
        return self._points(vertex), corners, sizes

    def _points(self, vertex: Element) -> Array:
        vertices = self._named(vertex, "source", "vertices")
        place = None if vertices is None else vertices.find("input[@semantic='POSITION']")
        source = None if place is None else self._named(place, "source", "source")
        if source is None:
            return np.zeros((0, 3))
        if source.get("id") not in self._arrays:
            text, accessor = source.findtext("float_array"), source.find("technique_common/accessor")
            values = np.array((text or "").split(), np.float64)
            stride = 3 if accessor is None else int(accessor.get("stride", "3"))
            start = 0 if accessor is None else int(accessor.get("offset", "0"))
            if not 3 <= stride < 64:
                raise ValueError("points of fewer than three numbers")
            used = values[start : start + (len(values) - start) // stride * stride]
            self._arrays[source.get("id", "")] = point_rows(used.reshape(-1, stride)[:, :3])
        return self._arrays[source.get("id", "")]


def _whole(text: str | None) -> NDArray[np.int64]:
    return np.array((text or "").split(), np.int64)


def _node_matrix(node: Element) -> Array:
    """The transforms of a node, in the order in which they stand."""
    matrix = np.eye(4)
    for step in node:
        values = (step.text or "").split() if step.tag in _STEPS else []
        if step.tag in _STEPS:
            matrix = matrix @ _STEPS[step.tag](values)
    return matrix


def _rotation(values: list[str]) -> Array:
    x, y, z, degrees = numbers(values, 4)
    half = np.radians(degrees) / 2
    axis = np.array([x, y, z]) / (np.linalg.norm([x, y, z]) or 1.0)
    return pose((0, 0, 0), quaternion_turn(np.cos(half), *(np.sin(half) * axis)))


_STEPS = {
    "matrix": lambda values: numbers(values, 16).reshape(4, 4),
    "translate": lambda values: pose(numbers(values, 3)),
    "scale": lambda values: pose((0, 0, 0), np.eye(3), numbers(values, 3)),
    "rotate": _rotation,
}

Runs = list[NDArray[np.int64]]
Faces = tuple[NDArray[np.int64], NDArray[np.int64]]


def _none() -> NDArray[np.int64]:
    return np.zeros(0, np.int64)


def _triangles(runs: Runs, group: Element) -> Faces:
    corners = np.concatenate([*runs, _none()])
    corners = corners[: len(corners) // 3 * 3]
    return corners, np.full(len(corners) // 3, 3)


def _polylist(runs: Runs, group: Element) -> Faces:
    corners, sizes = np.concatenate([*runs, _none()]), _whole(group.findtext("vcount"))
    if (sizes < 0).any() or sizes.sum() != len(corners):
        raise ValueError("a polylist has other corners than it counts")
    return corners, sizes


def _polygons(runs: Runs, group: Element) -> Faces:
    return np.concatenate([*runs, _none()]), np.array([len(run) for run in runs], np.int64)


def _fans(runs: Runs, group: Element) -> Faces:
    return _triangles(
        [np.stack([np.full(len(r) - 2, r[0]), r[1:-1], r[2:]], 1).ravel() for r in runs if len(r) > 2], group
    )


def _strips(runs: Runs, group: Element) -> Faces:
    found = []
    for run in runs:
        steps = np.arange(max(len(run) - 2, 0))
        odd = steps % 2
        found.append(np.stack([run[steps + odd], run[steps + 1 - odd], run[steps + 2]], axis=1).ravel())
    return _triangles(found, group)


_SIZES = {
    "triangles": _triangles, "polylist": _polylist, "polygons": _polygons, "trifans": _fans, "tristrips": _strips,
}  # fmt: skip
