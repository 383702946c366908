"""Completion: an object is put back into a half-emptied room. How far from where it was does it come to stand?

Error of a draw: the horizontal distance of its middle from the place of that
removed object of its category which is nearest (they are interchangeable), in
centimetres, and the turn against that object, in degrees. Best of :data:`DRAWS`
draws; rows are compared by Wilcoxon's signed-rank test on the same holes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...generate import Generator
from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.placeable import Placeable
from ...generate.propose.proposer import Query
from ...geometry.arrays import Floats
from ...geometry.planar import wrapped
from ...metrics.requested_relations import is_beside, is_on, place_of
from ...scene import SceneGraph, world_matrices
from ...spatial.object_rows import object_rows
from ...spatial.objects import scene_objects
from .cases import Hole
from .furnishing import ByCopying, ByModel

DRAWS = 5
TEST_LEVEL = 0.05


@dataclass(frozen=True, eq=False)
class Completed:
    """What became of one hole; NaN where it does not apply.

    Attributes
    ----------
    centimetres, degrees
        Of the best of :data:`DRAWS` draws.
    same_support, same_kind
        Whether the support that the model ranks first (or, where it ranks none, names most often in the draws) is that
        of a removed object, or of its category, 0 or 1.
    on_top, beside
        Whether a request was satisfied, 0 or 1.
    nll
        Negative log-density of the true position and heading on the true support, nats (metres, radians).
    """

    centimetres: float
    degrees: float
    same_support: float
    same_kind: float
    on_top: float
    beside: float
    nll: float

    FIELDS = ("centimetres", "degrees", "same_support", "same_kind", "on_top", "beside", "nll")

    def values(self) -> list[float]:
        """All of them in the order of FIELDS."""
        return [float(getattr(self, name)) for name in self.FIELDS]


NOTHING = Completed(*[np.nan] * 7)


def complete(way: ByModel | ByCopying, hole: Hole, seed: int) -> Completed:
    """Measure one hole."""
    if isinstance(way, ByCopying):
        found = way.places(hole, DRAWS, seed)
        if not found:
            return NOTHING
        centimetres, degrees = pose_error([place for place, _ in found], hole.places)
        kind = most_common([kind for _, kind in found])
        kinds = {hole.real.category_name(hole.real.row_of_uid[uid]) for uid in hole.supports}
        return Completed(centimetres, degrees, np.nan, float(kind in kinds), np.nan, np.nan, np.nan)
    places, supports = [], []
    for draw in range(DRAWS):
        graph, row = way.fill(hole, DRAWS * seed + draw)
        if row >= 0:
            places.append(place_of(graph, row))
            supports.append(graph.uid[graph.parent[row]] if graph.parent[row] >= 0 else "")
    if not places:
        return NOTHING
    centimetres, degrees = pose_error(places, hole.places)
    seen = _seen(hole, way.generator.categories)
    named = _ranked_first(way, hole, *seen) or most_common(supports)
    kinds = {hole.real.category_name(hole.real.row_of_uid[uid]) for uid in hole.supports}
    kind = hole.real.category_name(hole.real.row_of_uid[named]) if named else ""
    on_top, beside = _requests(way, hole, seed)
    nll = -log_density(way.generator, hole, *seen)
    return Completed(centimetres, degrees, float(named in hole.supports), float(kind in kinds), on_top, beside, nll)


def pose_error(drawn: Sequence[Floats], true: Floats) -> tuple[float, float]:
    """Centimetres and degrees of the best of places (4,) each against places (K, 4): the smallest distance."""
    places = np.array(drawn)
    far = np.linalg.norm(places[:, None, :2] - true[:, :2], axis=-1)
    best, nearest = np.unravel_index(far.argmin(), far.shape)
    turn = wrapped(places[best, 3] - true[nearest, 3])
    return 100 * float(far.min()), float(np.degrees(abs(turn)))


def _ranked_first(way: ByModel, hole: Hole, scene: ObservedScene, uids: Sequence[str]) -> str:
    """uid of the support with the highest chance; "" for models that give none. See :func:`_seen` for the last two."""
    of = getattr(way.generator.proposer, "support_chances", None)
    if of is None:
        return ""
    generator = way.generator
    usual = {prior.support for prior in generator.contract.priors.supports[hole.category]}
    kinds = [hole.rest.category_name(hole.rest.row_of_uid[uid]) for uid in uids]
    allowed = np.array([kind in usual for kind in kinds], bool)
    if not allowed.any():
        return ""
    chances = of(scene, generator.categories.index(hole.category), Placeable(hole.asset).half, allowed)
    return uids[int(np.argmax(chances))]


def most_common(names: Sequence[str]) -> str:
    """The most frequent of some names; the first of several."""
    return max(names, key=list(names).count)


def _requests(way: ByModel, hole: Hole, seed: int) -> tuple[float, float]:
    """Whether the object comes to stand on its old support, and beside its old neighbour, when that is asked for."""
    there, found = set(_uids(hole.rest)), []
    for target, test in ((hole.support, is_on), (hole.neighbour, is_beside)):
        if target not in there:
            found.append(np.nan)
            continue
        request = {"on": target} if test is is_on else {"beside": target}
        graph, row = way.fill(hole, seed, **request)
        found.append(float(row >= 0 and test(graph, row, target)))
    return found[0], found[1]


def _uids(graph: SceneGraph) -> list[str]:
    """uids of the scene's objects."""
    rows = object_rows(graph)
    return [graph.uid[row] for row in np.unique(rows[rows >= 0])]


def _seen(hole: Hole, vocabulary: tuple[str, ...]) -> tuple[ObservedScene, list[str]]:
    """The half-emptied room as a proposer sees it, and the uids of its objects."""
    objects = scene_objects(hole.rest, vocabulary)
    return ObservedScene.of(objects, world_matrices(hole.rest)[objects.row]), [
        hole.rest.uid[row] for row in objects.row
    ]


def log_density(generator: Generator, hole: Hole, scene: ObservedScene, uids: Sequence[str]) -> float:
    """Log-density of where the object was, given what it stood on, nats; NaN for proposers without a density.

    ``scene`` and ``uids`` are the half-emptied room as the proposer sees it.
    """
    of = getattr(generator.proposer, "log_density", None)
    if of is None or hole.support not in uids:
        return np.nan
    support = uids.index(hole.support)
    allowed = np.arange(len(uids)) == support
    query = Query(scene, generator.categories.index(hole.category), Placeable(hole.asset), allowed, {})
    return float(of(query, support, hole.places[0]))
