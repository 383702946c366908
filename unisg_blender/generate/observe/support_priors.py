"""What training scenes say about categories: where they stand, how they rest, what may overlap what."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...geometry.box_overlap import nearby_pairs, penetration
from ...geometry.boxes import covers, part_tops
from ...geometry.planar import rotate, turned_reach
from ...spatial.objects import SceneObjects
from ...spatial.supports import CONTACT
from .reference_objects import find_reference_objects

RESTS, HANGS, AT_SIDE, INSIDE = "rests", "hangs", "beside", "inside"
"""How an object is held: on a surface, from the underside, at the side, or anywhere within its support."""

RARE = 0.01
"""Supports that hold less than this share of a category's objects are left out."""

OVERLAP_SCENES = 150
"""Scenes in which overlaps are measured: a tenth of a second each."""

SPANNING = 0.9
"""A category reaches from holder to holder if at least this share of its objects touches two of the same kind."""

FAR_END = (-0.05, 0.15)
"""Metres: gaps to the second holder with which an object still counts as reaching it."""

NEAR_EDGE = 0.05
"""Metres by which the middle of what rests on a part may be beside it."""

SHALLOW, FEWEST, USUAL_DEPTH = 0.002, 5, 0.9
"""Overlaps of categories count from so many metres and so many cases on; this quantile of them is allowed."""

Seen = tuple[str, float, str]


@dataclass(frozen=True)
class SupportPrior:
    """How objects of a category stand on one kind of support.

    ``support`` "" means that they have none; ``count`` how often that was seen;
    ``contact`` how they are held; ``gap`` the median of the clearance in metres
    where they are held at the side; ``relation`` how the scenes call it, "" if they do not say.
    """

    support: str
    count: int
    contact: str
    gap: float = 0.0
    relation: str = ""


@dataclass(frozen=True)
class CategoryPriors:
    """The priors of all categories.

    Attributes
    ----------
    supports
        By category: its priors, the commonest first.
    sizes
        By category: median width, depth and height in metres.
    overlaps
        By "A|B" (sorted): metres that boxes of these categories may reach into each other; by "A>B" the same for
        an A that is held by that B.
    rooms
        Counts of the categories (in vocabulary order) in some of the scenes.
    orders
        By "Support>Category": where along such a support the category was found, see :mod:`.placement_order`.
    references
        Categories that come first on the floor, see :mod:`.reference_objects`.
    spanning
        Categories that reach from one holder to another, see :mod:`..place.spanning_objects`.
    """

    supports: dict[str, list[SupportPrior]]
    sizes: dict[str, list[float]]
    overlaps: dict[str, float]
    rooms: list[list[int]]
    orders: dict[str, list[float]] = field(default_factory=dict)
    references: list[str] = field(default_factory=list)
    spanning: list[str] = field(default_factory=list)

    def prior(self, category: str, support: str) -> SupportPrior | None:
        """How a category stands on a kind of support; None if that was never seen."""
        return next((prior for prior in self.supports.get(category, ()) if prior.support == support), None)


def learn_priors(scenes: Iterable[SceneObjects], vocabulary: Sequence[str], rooms: int = 256) -> CategoryPriors:
    """Priors out of the objects of training scenes, whose categories are numbered as in ``vocabulary``."""
    names = (*vocabulary, "")
    contacts: dict[tuple[str, str], list[Seen]] = defaultdict(list)
    sizes: dict[str, list[Any]] = defaultdict(list)
    depths: dict[str, list[float]] = defaultdict(list)
    counts = []
    across: Counter[str] = Counter()
    scenes = list(scenes)
    for number, objects in enumerate(scenes):
        counts.append(np.bincount(objects.category[objects.category >= 0], minlength=len(vocabulary)).tolist())
        for obj in np.flatnonzero(objects.category >= 0):
            category, support = names[objects.category[obj]], int(objects.support[obj])
            below = names[objects.category[support]] if support >= 0 else ""
            contacts[category, below].append((*contact(objects, int(obj), support), objects.relation[obj]))
            sizes[category].append(2 * objects.half[obj])
            across[category] += contacts[category, below][-1][0] == AT_SIDE and _spans(objects, int(obj), support)
        for pair, depth in _overlaps(objects, names) if number < OVERLAP_SCENES else ():
            depths[pair].append(depth)
    return CategoryPriors(
        supports=_supports(contacts),
        sizes={name: np.median(sizes[name], axis=0).round(4).tolist() for name in vocabulary if name in sizes},
        overlaps={pair: round(limit, 4) for pair, values in depths.items() if (limit := _tolerance(values)) > SHALLOW},
        rooms=counts[:: max(1, len(counts) // rooms)][:rooms],
        references=find_reference_objects(scenes, vocabulary),
        spanning=[name for name in vocabulary if across[name] >= SPANNING * max(1, len(sizes[name]))],
    )


def contact(objects: SceneObjects, obj: int, support: int) -> tuple[str, float]:
    """How an object is held by its support, and the clearance at its side in metres."""
    if support < 0:
        return (RESTS if abs(objects.bottom[obj]) <= CONTACT else INSIDE), 0.0
    parts = objects.parts_of(support)
    level = np.abs(part_tops(parts) - objects.bottom[obj]) <= CONTACT
    if (level & covers(parts, objects.center[obj, :2], NEAR_EDGE)).any():
        return RESTS, 0.0
    if abs(objects.bottom[support] - objects.top[obj]) <= CONTACT:
        return HANGS, 0.0
    gap = side_gap(objects, obj, support)
    return (AT_SIDE, gap) if -CONTACT <= gap <= FAR_END[1] else (INSIDE, 0.0)


def side_gap(objects: SceneObjects, obj: int, support: int) -> float:
    """Horizontal clearance in metres between an object and its support's box, negative where they overlap."""
    reach = turned_reach(objects.half[obj], objects.yaw[obj] - objects.yaw[support])
    local = np.abs(rotate(objects.center[obj, :2] - objects.center[support, :2], -objects.yaw[support]))
    return float((local - reach - objects.half[support, :2]).max())


def _spans(objects: SceneObjects, obj: int, support: int) -> bool:
    """Whether an object that is held at the side touches a second holder of the same kind too."""
    alike = np.flatnonzero(objects.category == objects.category[support])
    return any(FAR_END[0] <= side_gap(objects, obj, int(other)) <= FAR_END[1] for other in alike if other != support)


def _supports(contacts: dict[tuple[str, str], list[Seen]]) -> dict[str, list[SupportPrior]]:
    found: dict[str, list[SupportPrior]] = defaultdict(list)
    for (category, support), seen in contacts.items():
        kind = Counter(kind for kind, _, _ in seen).most_common(1)[0][0]
        gap = float(np.median([gap for other, gap, _ in seen if other == kind]))
        relation = Counter(relation for _, _, relation in seen).most_common(1)[0][0]
        found[category].append(SupportPrior(support, len(seen), kind, round(gap, 4), relation))
    for priors in found.values():
        priors.sort(key=lambda prior: (-prior.count, prior.support))
        total = sum(prior.count for prior in priors)
        priors[:] = [prior for prior in priors if prior.count >= RARE * total] or priors[:1]
    return dict(sorted(found.items()))


def _overlaps(objects: SceneObjects, names: Sequence[str]) -> list[tuple[str, float]]:
    """Depth to which any two objects whose boxes come near each other overlap, by key of the pair."""
    pairs = nearby_pairs(objects.parts)
    pairs = pairs[objects.owner[pairs[:, 0]] != objects.owner[pairs[:, 1]]]
    depth = penetration(objects.parts.take(pairs[:, 0]), objects.parts.take(pairs[:, 1]))
    deepest: dict[tuple[int, int], float] = {}
    for first, second, value in zip(*objects.owner[pairs.T], depth, strict=True):
        key = (min(first, second), max(first, second))
        deepest[key] = max(deepest.get(key, 0.0), float(value))

    def key_of(a: int, b: int) -> str:
        """ "A|B" of the categories of two objects, or "A>B" if the second holds the first."""
        first, second = names[objects.category[a]], names[objects.category[b]]
        if objects.support[b] == a:
            return f"{second}>{first}"
        return f"{first}>{second}" if objects.support[a] == b else "|".join(sorted((first, second)))

    return [(key_of(*pair), deep) for pair, deep in deepest.items()]


def _tolerance(depths: list[float]) -> float:
    return float(np.quantile(depths, USUAL_DEPTH)) if len(depths) >= FEWEST else 0.0
