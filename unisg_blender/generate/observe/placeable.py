"""An asset ready to be placed: its upright box and the boxes of its parts, at the origin."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...dataset.assets.asset import Asset
from ...geometry.arrays import Floats
from ...geometry.boxes import Boxes, corners
from ...geometry.planar import rotation, turn
from ...scene import SceneGraph, box_mesh
from ...spatial.part_boxes import part_boxes
from ...spatial.support_surfaces import support_surfaces


@dataclass(frozen=True, eq=False)
class Placeable:
    """An asset with its measures.

    A place is (x, y, z, yaw): the middle of the bottom of the upright box, metres,
    and the turn about the vertical, radians.
    """

    asset: Asset

    @cached_property
    def _own(self) -> Boxes:
        return part_boxes(self.asset.graph).boxes

    @cached_property
    def parts(self) -> Boxes:
        """Boxes of the parts, relative to the middle of the bottom."""
        boxes = self._own
        return Boxes(boxes.center - self.foot, boxes.axes, boxes.half, boxes.solid)

    @cached_property
    def _box(self) -> tuple[Floats, Floats]:
        points = corners(self._own).reshape(-1, 3) if len(self._own.center) else np.zeros((1, 3))
        return points.min(axis=0), points.max(axis=0)

    @cached_property
    def half(self) -> Floats:
        """Half extents (3,) in metres."""
        low, high = self._box
        return (high - low) / 2

    @cached_property
    def foot(self) -> Floats:
        """Middle of the bottom (3,) as seen from the asset's origin."""
        low, high = self._box
        return np.array([*((low + high) / 2)[:2], low[2]])

    @cached_property
    def surfaces(self) -> Floats:
        """What it can carry others on, see :func:`~...spatial.support_surfaces.support_surfaces`."""
        return support_surfaces(self.parts, 0.0)

    def motion(self, place: Floats) -> Floats:
        """The matrix (4, 4) that brings the asset as it is to a place (4,)."""
        matrix = turn(float(place[3]))
        matrix[:3, 3] = place[:3] - matrix[:3, :3] @ self.foot
        return matrix

    def world(self, place: Floats) -> Floats:
        """World matrix of the asset's entity at a place (4,)."""
        return self.motion(place) @ self.asset.graph.local[0]

    def boxes_at(self, places: Floats) -> Boxes:
        """World boxes of the parts at places (T, 4): T times P boxes, place by place."""
        turns = rotation(places[:, 3])[:, None]
        center = (turns @ self.parts.center[None, :, :, None])[..., 0] + places[:, None, :3]
        axes = turns @ self.parts.axes[None]
        half = np.broadcast_to(self.parts.half, center.shape)
        count = len(places) * len(self.parts.center)
        return Boxes(center.reshape(-1, 3), axes.reshape(-1, 3, 3), half.reshape(-1, 3), np.ones(count, bool))


def box_placeable(category: str, size: Floats) -> Placeable:
    """A plain box of a category's usual size, for where there is no mesh to show."""
    mesh = box_mesh(category, size)
    graph = SceneGraph(
        name=(category,),
        uid=("box",),
        type=np.zeros(1, np.int8),
        parent=np.full(1, -1, np.int32),
        category=np.zeros(1, np.int32),
        vocabulary=(category,),
        local=np.eye(4)[None],
        mesh=np.zeros(1, np.int32),
        meshes=(mesh,),
    )
    return Placeable(Asset(category, graph))
