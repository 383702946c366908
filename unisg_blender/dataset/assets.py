"""The geometry beside a dataset: real things to instance, room shells, and the shape of every mesh as boxes.

A dataset holds no geometry. ``assets.safetensors`` beside its manifest holds what
a generator needs of it: for each category a few whole things (an entity with its
uncategorised descendants), for each of some scenes the room they stand in, and
for every mesh the boxes around its connected parts. A trained model has a file of
the same make beside it (``MODEL.assets.safetensors``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..scene import SceneGraph, subtree, take, world_matrices
from ..scene.outline import FLOOR, mesh_outline
from ..scene.overlap import mesh_parts

FILE = "assets.safetensors"
PER_CATEGORY = 8
SHELLS = 48
MOST_FACES = 20_000
STRUCTURE = ("Floor", "Wall", "Ceiling", "Door", "Window", "Column", "Stairs")
"""Categories that make the shell of a room; what else stands in it is furniture."""


@dataclass(frozen=True, eq=False)
class Asset:
    """A thing that can be put into a scene.

    Attributes
    ----------
    category
        What it is; "" for a room shell.
    graph
        The thing: entity 0 with its uncategorised descendants, at the origin and
        without turn about the vertical; for a shell all its entities where they stand.
    targets
        Category of each entity, by uid, that the thing's actions refer to.
    """

    category: str
    graph: SceneGraph
    targets: Mapping[str, str] = field(default_factory=dict)


def heading(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn about the vertical, radians (...,), of the linear parts (..., 3, 3) of world matrices.

    The twist of a swing-twist decomposition: what is left, R_z(-heading) R, turns
    about a horizontal axis only.
    """
    return np.arctan2(linear[..., 1, 0] - linear[..., 0, 1], linear[..., 0, 0] + linear[..., 1, 1])


def turn(angle: float) -> NDArray[np.float64]:
    """The 4x4 matrix of a turn about the vertical, radians."""
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return matrix


def thing_of(graph: SceneGraph, row: int) -> Asset:
    """The entity at ``row`` and its uncategorised descendants, as an asset."""
    own = [row]
    for below in subtree(graph, row):
        if below != row and graph.parent[below] in own and graph.category[below] < 0:
            own.append(int(below))
    part = take(graph, np.array(own))
    local = part.local.copy()
    world = world_matrices(graph)[row]
    local[0] = turn(-float(heading(world[:3, :3]))) @ world
    local[0, :3, 3] = 0
    kept = {name: value for name, value in part.components.items() if name not in _SCENE_WIDE}
    part = part.replace(local=local, components=kept)
    return Asset(graph.category_name(row), _lean(part), _action_targets(graph, part))


_SCENE_WIDE = ("world", "relations", "lsa", "animation", "recording", "channels", "parenting")


def shell_of(graph: SceneGraph) -> Asset | None:
    """The room that a scene stands in: its entities of the categories in :data:`STRUCTURE`; None without a floor."""
    names = np.array([graph.category_name(row) for row in range(len(graph))])
    if FLOOR not in names:
        return None
    part = take(graph, np.flatnonzero(np.isin(names, STRUCTURE)))
    return Asset("", _lean(part.replace(components={})))


def _lean(graph: SceneGraph) -> SceneGraph:
    """The same scenegraph with the meshes and materials that it uses only."""
    used, place = np.unique(np.append(graph.mesh, -1), return_inverse=True)
    meshes = tuple(graph.meshes[index] for index in used[1:])
    slots = {slot for mesh in meshes for slot in mesh.materials}
    materials = {name: value for name, value in graph.materials.items() if name in slots}
    return graph.replace(mesh=(place[:-1] - 1).astype(np.int32), meshes=meshes, materials=materials)


def _action_targets(graph: SceneGraph, part: SceneGraph) -> dict[str, str]:
    found = part.components.get("actions")
    actions = () if found is None else found.columns["data"]
    uids = {uid for action in actions for uid in (*action.targets, *action.tools, action.frame)}
    return {uid: graph.category_name(graph.row_of_uid[uid]) for uid in sorted(uids) if uid in graph.row_of_uid}


class AssetCollector:
    """Watches scenes go by on their way into a dataset and keeps what a generator needs of their geometry."""

    def __init__(self) -> None:
        self.things: dict[str, dict[str, Asset]] = {}
        self.shells: list[Asset] = []
        self.parts: dict[str, NDArray[np.float32]] = {}
        self.outlines: dict[str, NDArray[np.float32]] = {}

    def watch(self, graphs: Iterable[Any]) -> Iterator[Any]:
        """The same scenes (or samples with a ``graph``), seen while they pass."""
        for item in graphs:
            self.add(getattr(item, "graph", item))
            yield item

    def add(self, graph: SceneGraph) -> None:
        """Take in one scene."""
        for mesh in graph.meshes:
            if mesh.checksum not in self.parts:
                self.parts[mesh.checksum] = mesh_parts(mesh).astype(np.float32)
        for row in np.flatnonzero(graph.category >= 0):
            self._add_row(graph, int(row))
        if len(self.shells) < SHELLS and (shell := shell_of(graph)) is not None:
            self.shells.append(shell)

    def _add_row(self, graph: SceneGraph, row: int) -> None:
        name, mesh = graph.category_name(row), graph.mesh[row]
        known = self.things.setdefault(name, {})
        if name == FLOOR and mesh >= 0 and graph.meshes[mesh].checksum not in self.outlines:
            self.outlines[graph.meshes[mesh].checksum] = mesh_outline(graph.meshes[mesh]).astype(np.float32)
        if len(known) >= PER_CATEGORY or name in STRUCTURE or (mesh >= 0 and graph.meshes[mesh].checksum in known):
            return
        thing = thing_of(graph, row)
        faces = [len(mesh.offsets) - 1 for mesh in thing.graph.meshes]
        if faces and sum(faces) <= MOST_FACES:
            known.setdefault("".join(mesh.checksum for mesh in thing.graph.meshes), thing)

    def save(self, folder: Path) -> None:
        """Write ``assets.safetensors`` into a dataset's folder."""
        from .asset_file import save_assets

        things = [thing for group in self.things.values() for thing in group.values()]
        save_assets(folder / FILE, [*things, *self.shells], self.parts, self.outlines)
