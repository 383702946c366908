"""What is around a camera: the room that is looked at, its things, and where in it a person could stand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...errors import UniSGError
from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.camera_view import CameraView
from ...geometry.corner_ends import corner_ends
from ...geometry.polygon import inside, to_edges
from ...scene import SceneGraph
from ...scene.categories import STRUCTURE
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

ALONG: Floats = np.linspace(0.05, 0.95, 10)
"""Where on the way from an eye to what it looks at no wall may be."""


@dataclass(frozen=True, eq=False)
class ChosenView:
    """A camera, and the rows (N,) of the scene that its picture leaves out."""

    view: CameraView
    hidden: Bools


@dataclass(frozen=True, eq=False)
class Surround:
    """The place that is looked at: its ``outline`` (K, 2), heights of floor and ceiling, a point (2,) well within it.

    ``parts`` says by row what is building, by its category or as was recognised; ``things`` which objects are none.
    """

    graph: SceneGraph
    outline: Floats
    floor: float
    ceiling: float
    inner: Floats
    objects: Objects
    parts: dict[int, tuple[str, ...]]
    things: Bools

    @staticmethod
    def of(graph: SceneGraph, source: SceneGraph) -> Surround:
        """The largest room of a scene, or the box around all that it shows; UniSGError if that is nothing.

        ``source`` is the same scene as it was read: what is building is recognised there.
        """
        objects = find_objects(graph, empty=False)
        if not len(objects):
            raise UniSGError("the scene shows nothing: there is no object with a mesh")
        structure = recognise_structure(source)
        named = {row: (name,) for row in range(len(graph)) if (name := graph.category_name(row)) in STRUCTURE}
        parts = structure.parts | named
        things = np.array([int(row) not in parts for row in objects.rows])
        if structure.rooms:
            room = max(structure.rooms, key=lambda room: (room.indoors, room.area))
            inner = room.inner_point
            return Surround(graph, room.outline, room.floor, room.ceiling, inner, objects, parts, things)
        low, high = objects.low.min(axis=0), objects.high.max(axis=0)
        corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
        inner = (low + high)[:2] / 2
        return Surround(graph, corners, float(low[2]), np.inf, inner, objects, parts, things)

    @cached_property
    def middles(self) -> Floats:
        """Middles (T, 3) of the things in the place; where there are none, a point within it."""
        middle = (self.objects.low + self.objects.high) / 2
        here = self.things & inside(self.outline, middle[:, :2]) & (middle[:, 2] > self.floor)
        here &= middle[:, 2] < self.ceiling
        return middle[here] if here.any() else np.array([[*self.inner, self.floor + 1.0]])

    @property
    def built(self) -> Bools:
        """Which rows (N,) are building, of any kind."""
        return np.array([row in self.parts for row in range(len(self.graph))])

    def are(self, kind: str) -> Bools:
        """Which rows (N,) are a kind of building, "Wall" or another, whatever else they are."""
        return np.array([kind in self.parts.get(row, ()) for row in range(len(self.graph))])

    def sees(self, places: Floats, targets: Floats) -> Bools:
        """From which places (P, 2) the way to which targets (T, 2) stays within the outline, (P, T)."""
        starts = places[:, None, None]
        ways = starts + (targets[None, :, None] - starts) * ALONG[:, None]
        within: Bools = inside(self.outline, ways.reshape(-1, 2))
        return np.asarray(within.reshape(ways.shape[:3]).all(axis=2))

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
        low, high = corner_ends(triangles)
        near = np.isin(owner, rows) & (high[:, 2] > self.floor) & (low[:, 2] < self.floor + 2 * EYE_HEIGHT)
        faces = triangle_boxes(triangles[near])
        kept = np.ones(len(places), bool)
        for number, place in enumerate(places):
            body = np.array([[*place, self.floor + height] for height in HEIGHTS])
            seen = np.einsum("hbi,bij->hbj", body[:, None] - faces.center, faces.axes)
            kept[number] = not (np.abs(seen) < faces.half + FROM_THING).all(axis=2).any()
        return places[kept]
