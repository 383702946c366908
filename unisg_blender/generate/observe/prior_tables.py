"""The priors of a model by category number, looked up while objects are placed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...scene.categories import FLOOR, STRUCTURE
from .placement_order import groups, holders, ranks
from .support_priors import CategoryPriors, SupportPrior


@dataclass(frozen=True, eq=False)
class PriorTables:
    """Priors of C categories. The last of C + 1 entries stands for categories that the model does not know.

    Attributes
    ----------
    usual
        bool (C, C + 1): which categories (columns) hold a category (row); the last column: it may stand on the ground.
    overlaps, held_overlaps
        (C + 1, C + 1): metres that two categories may reach into each other, apart and where the second holds the
        first.
    spanning, structural, leading
        bool (C + 1,): what reaches from holder to holder, what is part of the building, and the reference objects
        (:mod:`~.reference_objects`).
    level, rank
        int64 (C + 1,), see :func:`~.placement_order.groups` and :func:`~.placement_order.ranks`.
    carriers
        bool (C + 1,): the categories that are there first, see :func:`~.placement_order.holders`.
    floor
        Number of the floor, -2 where there is none.
    supports
        By number: priors, the commonest first, each with the number of its support (-1: the ground).
    orders
        By numbers of support and category: where along such a support the category was found.
    """

    usual: Bools
    overlaps: Floats
    held_overlaps: Floats
    spanning: Bools
    structural: Bools
    leading: Bools
    level: Ints
    rank: Ints
    carriers: Bools
    floor: int
    supports: Mapping[int, Mapping[int, SupportPrior]]
    orders: Mapping[tuple[int, ...], Sequence[float]]

    @staticmethod
    def of(priors: CategoryPriors, vocabulary: Sequence[str]) -> PriorTables:
        """The tables for the categories of a vocabulary."""
        number = {name: position for position, name in enumerate(vocabulary)} | {"": -1}
        supports = {
            number[name]: {number[prior.support]: prior for prior in found if prior.support in number}
            for name, found in priors.supports.items()
            if name in number
        }
        usual = np.zeros((len(vocabulary), len(vocabulary) + 1), bool)
        for category, found in supports.items():
            usual[category, list(found)] = True
        overlaps, held = np.zeros((2, len(number), len(number)))
        for pair, depth in priors.overlaps.items():
            first, second = (number.get(name, -1) for name in pair.replace(">", "|").split("|"))
            if ">" in pair:
                held[first, second] = depth
            else:
                overlaps[first, second] = overlaps[second, first] = depth
        known = priors.spanning, STRUCTURE, priors.references, holders(priors) - {""}
        spanning, structural, leading, carriers = (np.array([name in names for name in number]) for names in known)
        orders = {
            tuple(number.get(name, -2) for name in key.split(">", 1)): seen for key, seen in priors.orders.items()
        }
        level, rank = groups(vocabulary, priors), ranks(vocabulary, priors)
        floor = number.get(FLOOR, -2)
        return PriorTables(
            usual, overlaps, held, spanning, structural, leading, level, rank, carriers, floor, supports, orders
        )

    @cached_property
    def holding(self) -> Bools:
        """(C + 1, C + 1): objects of which categories (columns) hold a category (row), the ground left out."""
        return np.pad(self.usual[:, :-1], (0, 1))
