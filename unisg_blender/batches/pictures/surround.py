"""What is around a camera: the room that is looked at, its things, and where in it a person could stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import UniSGError
from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.polygon import inside, to_edges
from ...scene import SceneGraph
from ...scene.categories import STRUCTURE, has_category
from ...spatial.object_rows import Objects, find_objects
from ...spatial.structure import recognise_structure
from ...spatial.structure.scan import world_triangles
from ...spatial.structure.triangle_boxes import triangle_boxes

EYE_HEIGHT, BELOW_CEILING = 1.6, 0.25
"""Metres over the floor of eyes, and below the ceiling of any camera at least."""

FROM_WALL, FROM_THING = 0.35, 0.25
"""Metres that a person keeps from walls and things."""

HEIGHTS, AROUND = (0.4, 0.8, 1.2, 1.6), 0.5
"""Metres over the floor at which a person must be free of faces, and the share of the room that the box of a thing
covers which is around one: of a room that is a single mesh its faces are in the way."""

FAR = 200.0
"""Metres that a camera sees at least."""

TRIED = 60
"""Places that are looked at for eyes."""


@dataclass(frozen=True, eq=False)
class Surround:
    """The place that is looked at: its ``outline`` (K, 2), heights of floor and ceiling in metres, and its things."""

    graph: SceneGraph
    outline: Floats
    floor: float
    ceiling: float
    objects: Objects
    things: Bools

    @staticmethod
    def of(graph: SceneGraph) -> Surround:
        """The largest room of a scene, or the box around all that it shows; UniSGError if that is nothing."""
        objects = find_objects(graph, empty=False)
        if not len(objects):
            raise UniSGError("the scene shows nothing: there is no object with a mesh")
        rooms = recognise_structure(graph).rooms
        things = ~has_category(graph, STRUCTURE)[objects.rows]
        if rooms:
            room = max(rooms, key=lambda room: (room.indoors, room.area))
            return Surround(graph, room.outline, room.floor, room.ceiling, objects, things)
        low, high = objects.low.min(axis=0), objects.high.max(axis=0)
        corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
        return Surround(graph, corners, float(low[2]), np.inf, objects, things)

    @property
    def middles(self) -> Floats:
        """Middles (T, 3) of the things; of all that is shown where there are none."""
        chosen = self.things if self.things.any() else np.ones(len(self.objects), bool)
        return np.asarray((self.objects.low[chosen] + self.objects.high[chosen]) / 2)

    def clip(self, back: float = 0.0) -> tuple[float, float]:
        """Between which metres a camera sees all of it that is ``back`` metres from its middle, or within it."""
        whole = self.objects.high.max(axis=0) - self.objects.low.min(axis=0)
        return 0.05, max(FAR, back + float(np.linalg.norm(whole)))

    def height(self, wanted: float) -> float:
        """A height so far over the floor, or under the ceiling."""
        return max(min(self.floor + wanted, self.ceiling - BELOW_CEILING), self.floor + 0.3)

    def standing_places(self, rng: np.random.Generator) -> Floats:
        """Places (P, 2) where a person could stand."""
        low, high = self.outline.min(axis=0), self.outline.max(axis=0)
        places = rng.uniform(low, high, (TRIED, 2))
        places = places[inside(self.outline, places)]
        places = places[np.linalg.norm(to_edges(self.outline, places), axis=2).min(axis=1, initial=np.inf) > FROM_WALL]
        least, most = self.objects.low[self.things], self.objects.high[self.things]
        tall = (most[:, 2] > self.floor + 0.15) & (least[:, 2] < self.floor + 1.8)
        covered = (np.minimum(most[:, :2], high) - np.maximum(least[:, :2], low)).clip(0).prod(axis=1)
        large = tall & (covered > AROUND * (high - low).prod())
        least, most = least[tall & ~large, :2] - FROM_THING, most[tall & ~large, :2] + FROM_THING
        places = places[~((places[:, None] > least) & (places[:, None] < most)).all(axis=2).any(axis=1)]
        return self._free_of_faces(places, self.objects.rows[self.things][large]) if large.any() else places

    def _free_of_faces(self, places: Floats, rows: Ints) -> Floats:
        """The places (P, 2) where a person is in no face of the objects of some rows."""
        triangles, row = world_triangles(self.graph)
        owner = self.objects.rows[self.objects.of_row[row]]
        low, high = triangles.min(axis=1), triangles.max(axis=1)
        near = np.isin(owner, rows) & (high[:, 2] > self.floor) & (low[:, 2] < self.floor + 2 * EYE_HEIGHT)
        faces = triangle_boxes(triangles[near])
        kept = np.ones(len(places), bool)
        for number, place in enumerate(places):
            body = np.array([[*place, self.floor + height] for height in HEIGHTS])
            seen = np.einsum("hbi,bij->hbj", body[:, None] - faces.center, faces.axes)
            kept[number] = not (np.abs(seen) < faces.half + FROM_THING).all(axis=2).any()
        return places[kept]
