"""The geometry that a generator needs: real objects to instance, and the rooms that objects stand in.

The shards of a dataset hold no geometry. Its assets file (see :mod:`.asset_file`)
holds for each category a few whole objects (an entity with its uncategorised
descendants) and for each of some scenes the room they stand in. A trained model
has a file of the same make beside it (``MODEL.assets.safetensors``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...geometry.planar import heading, turn
from ...scene import STRUCTURE, SceneGraph, take, world_matrices
from ...scene.categories import FLOOR, has_category
from ...scene.graph import TYPES
from ...scene.identity import derived_uid
from ...scene.merge import append
from ...spatial.object_rows import object_rows


@dataclass(frozen=True, eq=False)
class Asset:
    """An object that can be put into a scene.

    Attributes
    ----------
    category
        What it is; "" for a room shell.
    graph
        The object: entity 0 with its uncategorised descendants, at the origin and
        without turn about the vertical; for a shell all its entities where they stand.
    targets
        Category of each entity, by uid, that the object's actions refer to.
    source
        What shows it, for whoever made the asset of something that can be shown again; "" for nothing.
    """

    category: str
    graph: SceneGraph
    targets: Mapping[str, str] = field(default_factory=dict)
    source: str = ""

    @property
    def key(self) -> str:
        """Checksums of its meshes: objects with the same key have the same shape."""
        return "".join(mesh.checksum for mesh in self.graph.meshes)

    @property
    def faces(self) -> int:
        """How many faces its meshes have."""
        return sum(len(mesh.offsets) - 1 for mesh in self.graph.meshes)


def object_graph(
    graph: SceneGraph, row: int, owner: NDArray[np.int64] | None = None, world: NDArray[np.float64] | None = None
) -> Asset:
    """The object at ``row``, with the entities that belong to it, as an asset.

    ``owner`` and ``world`` are what :func:`object_rows` and :func:`world_matrices` say, for who has them already.
    """
    own = np.flatnonzero(object_rows(graph) == row if owner is None else owner == row)
    matrix = (world_matrices(graph) if world is None else world)[row]
    parent = graph.parent.copy()
    parent[row] = -1
    part = take(graph.replace(parent=parent), own)
    local = part.local.copy()
    local[0] = turn(-float(heading(matrix[:3, :3]))) @ matrix
    local[0, :3, 3] = 0
    kept = {name: value for name, value in part.components.items() if name not in _SCENE_WIDE}
    part = part.replace(local=local, components=kept)
    return Asset(graph.category_name(row), _lean(part), _action_targets(graph, part))


def whole_thing(graph: SceneGraph, name: str) -> SceneGraph:
    """All of a scenegraph as one object: an entity of that name above it, its parts without categories."""
    root = SceneGraph(
        name=(name,), uid=(derived_uid("whole", name),), type=np.array([TYPES.index("EMPTY")], np.int8),
        parent=np.full(1, -1, np.int32), category=np.full(1, -1, np.int32), vocabulary=(), local=np.eye(4)[None],
        mesh=np.full(1, -1, np.int32), meshes=(),
    )  # fmt: skip
    parts = graph.replace(category=np.full(len(graph), -1, np.int32), vocabulary=())
    return append(root, [parts], [root.uid[0]])


_SCENE_WIDE = ("world", "relations", "lsa", "animation", "recording", "channels", "parenting")


def shell_of(graph: SceneGraph, owner: NDArray[np.int64] | None = None) -> Asset | None:
    """The room that a scene stands in: its objects of the categories in :data:`STRUCTURE`; None without a floor."""
    if FLOOR not in graph.vocabulary:
        return None
    owner = object_rows(graph) if owner is None else owner
    part = take(graph, np.flatnonzero((owner >= 0) & has_category(graph, STRUCTURE)[owner]))
    return Asset("", _lean(part.replace(components={})))


def _lean(graph: SceneGraph) -> SceneGraph:
    """The same scenegraph with the meshes and materials that it uses only."""
    used, place = np.unique(np.append(graph.mesh, -1), return_inverse=True)
    meshes = tuple(graph.meshes[index] for index in used[1:])
    slots = {slot for mesh in meshes for slot in mesh.materials}
    materials = {name: value for name, value in graph.materials.items() if name in slots}
    return graph.replace(mesh=(place[:-1] - 1).astype(np.int32), meshes=meshes, materials=materials)


def _action_targets(graph: SceneGraph, part: SceneGraph) -> dict[str, str]:
    actions = [action for _, action in part.entries("actions", "data")]
    uids = {uid for action in actions for uid in (*action.targets, *action.tools, action.frame)}
    return {uid: graph.category_name(graph.row_of_uid[uid]) for uid in sorted(uids) if uid in graph.row_of_uid}
