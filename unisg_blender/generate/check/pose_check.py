"""What is wrong with a thing that is not in the scene yet, where it would stand: asked at each move of a mouse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Floats
from ...scene import SceneGraph
from ...scene.hierarchy import subtree
from ...spatial.structure.scan import world_triangles
from ..observe.placeable import Placeable
from .holding_scene import SPARE
from .mesh_check import CUTTING, FLOATING, OUTSIDE, pose_fault
from .scene_check import WOULD_BE_IN, WOULD_BLOCK, SceneShapes, measured
from .surroundings import PosedThing, Surroundings
from .ways_through import in_the_way

SHORT = {OUTSIDE: "is outside the building", FLOATING: "floats"}
BLOCKS_NOW = (WOULD_BLOCK, "blocks")


@dataclass(frozen=True, eq=False)
class PoseCheck:
    """A scene in which poses of new things are judged as :func:`~.scene_check.check_scene` judges what is there."""

    around: Surroundings
    shapes: SceneShapes

    @staticmethod
    def of(graph: SceneGraph) -> PoseCheck:
        """One for a scene, in whatever words."""
        return PoseCheck(Surroundings.of(graph, graph), SceneShapes.of(graph))

    def reason(self, thing: PosedThing) -> str:
        """What is wrong with a thing, in words without measures, "" if nothing is: takes milliseconds."""
        reason = pose_fault(self.around, thing)
        if reason in SHORT:
            return SHORT[reason]
        if reason.startswith(WOULD_BE_IN):
            return f"collides with {reason.removeprefix(WOULD_BE_IN)}"
        return reason.replace(*BLOCKS_NOW)

    def measured(self, thing: PosedThing, category: str) -> str:
        """The same with by how much, and whether it cuts the way; "" for what turns out to hang on the building."""
        reason = pose_fault(self.around, thing)
        if not reason:
            return CUTTING.replace(*BLOCKS_NOW) if self._cuts(thing) else ""
        nothing = np.zeros(len(self.shapes.triangles), bool)
        fault = measured(self.shapes, -1, category, thing.triangles, thing.matrix, nothing, reason)
        return "" if fault is None else fault.text

    def _cuts(self, thing: PosedThing) -> bool:
        """Does a thing cut a place in its room off, or narrow the way to it?"""
        structure, mine = self.around.room.structure, thing.triangles
        if structure is None or not len(mine):
            return False
        number = structure.room_at((mine.min(axis=(0, 1)) + mine.max(axis=(0, 1))) / 2)
        return number >= 0 and bool(in_the_way(structure.rooms[number], self.around.triangles, [mine], SPARE))


def posed_thing(
    check: PoseCheck, thing: Placeable, triangles: Floats, place: Floats, holder: str = "", inside: bool = False
) -> PosedThing:
    """A thing at a place (4,).

    Parameters
    ----------
    triangles
        (M, 3, 3): those of its asset where that is, metres; see :func:`own_triangles`.
    holder
        Uid of what it hangs from or is fixed to, "" for what stands; ``inside`` which it is, perhaps.
    """
    motion, graph = thing.motion(place), check.around.graph
    holders = subtree(graph, graph.row_of_uid[holder]) if holder else np.zeros(0, np.int64)
    mine = triangles @ motion[:3, :3].T + motion[:3, 3]
    return PosedThing(mine, thing.world(place), np.zeros(len(graph), bool), holders, bool(holder), inside)


def own_triangles(thing: Placeable) -> Floats:
    """The triangles (M, 3, 3) of a thing's asset where that is, metres."""
    return world_triangles(thing.asset.graph)[0]
