"""Choose what a dataset keeps of its scenes' geometry, while they go by on their way into it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...scene import Mesh, SceneGraph, world_matrices
from ...scene.categories import FLOOR, STRUCTURE
from ...spatial.floor_plan import mesh_outline
from ...spatial.object_rows import object_rows
from ...spatial.part_boxes import mesh_parts
from .asset import Asset, object_graph, shell_of
from .asset_file import Assets, pack_assets

PER_CATEGORY = 8
SHELLS = 48
MOST_FACES = 20_000
"""Faces of an object that is kept; where its category has none yet, up to :data:`LARGEST`."""

LARGEST = 250_000
REMEMBERED = 20_000
BUDGET = 4_000_000
"""Faces of all that is kept together, the first object of each category apart: some 300 MB at most."""


class AssetCollector:
    """Keeps the first few different objects of each category, the first rooms, and the boxes of every mesh's parts.

    What is kept depends on the scenes and their order only. ``source`` says where
    a scene comes from.
    """

    def __init__(self) -> None:
        self.objects: dict[str, dict[str, tuple[Asset, str]]] = {}
        self.shells: list[tuple[Asset, str]] = []
        self.parts: dict[str, NDArray[np.float32]] = {}
        self.outlines: dict[str, NDArray[np.float32]] = {}
        self._faces = 0

    def add(self, graph: SceneGraph, source: str = "") -> None:
        """Take in one scene."""
        for mesh in graph.meshes:
            if mesh.checksum not in self.parts:
                self.parts[mesh.checksum] = _boxes(mesh)
        self._add_outlines(graph)
        owner, world = object_rows(graph), world_matrices(graph)
        for row, key, faces in _scene_objects(graph, owner):
            make = partial(object_graph, graph, row, owner, world)
            self._offer(graph.category_name(row), key, faces, source, make)
        if len(self.shells) < SHELLS and (shell := shell_of(graph, owner)) is not None:
            self._offer_shell(shell.faces, source, lambda: shell)

    def merge(self, assets: Assets, source: str, meshes: Iterable[str]) -> None:
        """Take in what was collected of one source before; ``meshes`` are the checksums of the meshes of its scenes."""
        parts, outlines = assets.shapes("parts"), assets.shapes("outlines")
        for key in meshes:
            self.parts.setdefault(key, parts[key])
            if key in outlines:
                self.outlines.setdefault(key, outlines[key])
        for number, record in enumerate(assets.index["assets"]):
            if record["source"] != source:
                continue
            make = partial(assets.asset, number)
            if record["category"]:
                self._offer(record["category"], record["key"], record["faces"], source, make)
            else:
                self._offer_shell(record["faces"], source, make)

    def _offer(self, category: str, key: str, faces: int, source: str, make: Callable[[], Asset]) -> None:
        """Keep an object if there is room for it and none of that shape yet."""
        known = self.objects.get(category, {})
        if key in known or len(known) >= PER_CATEGORY or faces > (MOST_FACES if known else LARGEST):
            return
        if known and self._faces + faces > BUDGET:
            return
        self._faces += faces
        self.objects.setdefault(category, {})[key] = (make(), source)

    def _offer_shell(self, faces: int, source: str, make: Callable[[], Asset]) -> None:
        if len(self.shells) < SHELLS and 0 < faces <= LARGEST and self._faces + faces <= BUDGET:
            self._faces += faces
            self.shells.append((make(), source))

    def _add_outlines(self, graph: SceneGraph) -> None:
        if FLOOR not in graph.vocabulary:
            return
        for row in np.flatnonzero((graph.category == graph.vocabulary.index(FLOOR)) & (graph.mesh >= 0)):
            mesh = graph.meshes[graph.mesh[row]]
            if mesh.checksum not in self.outlines:
                with contextlib.suppress(UniSGError):  # what somebody calls a floor may have no area
                    self.outlines[mesh.checksum] = mesh_outline(mesh).astype(np.float32)

    def pack(self) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """What is kept, as arrays and an index for an assets file."""
        kept = [entry for _, group in sorted(self.objects.items()) for entry in group.values()] + self.shells
        return pack_assets([asset for asset, _ in kept], self.parts, self.outlines, [source for _, source in kept])

    def __bool__(self) -> bool:
        return bool(self.parts)


def _boxes(mesh: Mesh) -> NDArray[np.float32]:
    """Boxes of a mesh's parts; files that are read one after another often share meshes."""
    if mesh.checksum not in _boxes_of:
        if len(_boxes_of) >= REMEMBERED:
            _boxes_of.clear()
        _boxes_of[mesh.checksum] = mesh_parts(mesh).astype(np.float32)
    return _boxes_of[mesh.checksum]


_boxes_of: dict[str, NDArray[np.float32]] = {}


def _scene_objects(graph: SceneGraph, owner: NDArray[np.int64]) -> Iterator[tuple[int, str, int]]:
    """Row, key and number of faces of the objects with geometry that could be instanced."""
    rows = np.flatnonzero((owner >= 0) & (graph.category[owner] >= 0) & (graph.mesh >= 0))
    rows = rows[np.argsort(owner[rows], kind="stable")]
    faces = np.array([len(mesh.offsets) - 1 for mesh in graph.meshes], np.int64)
    for group in np.split(rows, np.flatnonzero(np.diff(owner[rows])) + 1) if len(rows) else ():
        row, meshes = int(owner[group[0]]), np.unique(graph.mesh[group])
        total = int(faces[meshes].sum())
        if total and graph.category_name(row) not in STRUCTURE:
            yield row, "".join(graph.meshes[index].checksum for index in meshes), total
