"""What counts as touching, beside, above, inside: lengths and shares."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class RelationTolerances:
    """What counts as what. Lengths in metres.

    Attributes
    ----------
    gap, overlap
        Largest distance, and largest depth, at which surfaces touch.
    beside
        Largest horizontal distance of objects that stand beside each other.
    above
        Largest height of one object over another that it hangs above.
    shared
        Least share of the smaller one's footprint (for above and below) or height
        (for beside and the directions) that both have in common.
    walls
        In how many of six directions an object that is inside another meets it at least;
        where nothing is over it, on all sides and below.
    hollow
        Least depth of something open at the top that objects can be inside of, as a
        share of its narrower inner width: objects lie in a bowl, but on a tray.
    vast, backdrop
        Times as long as another, and as all others together, by the longest side, something is at least that is no
        object on top of things, but ground or sky.
    heading
        Direction in which the viewer looks, radians counter-clockwise from +Y: it
        decides what is left, right, in front and behind.
    """

    gap: float = 0.01
    overlap: float = 0.02
    beside: float = 0.5
    above: float = 2.0
    shared: float = 0.25
    walls: int = 4
    hollow: float = 0.25
    vast: float = 20.0
    backdrop: float = 3.0
    heading: float = 0.0


DEFAULT = RelationTolerances()
