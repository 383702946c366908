"""What the judges say of a scene, and of many in one row with intervals."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Floats
from ...scene.graph import SceneGraph
from ..scene_validity import counted_objects
from .navigability import navigability
from .opening_clearance import openings
from .stability import simulated

STABILITY, NAVIGABILITY, OPENINGS = "stability", "navigability", "openings"
JUDGES = (STABILITY, NAVIGABILITY, OPENINGS)

PARTED = 0.9
"""Share of the free floor that can be reached below which a room counts as parted."""

DRAWN, LEVELS = 2000, (0.025, 0.975)


@dataclass(frozen=True)
class JudgedScene:
    """One scene; None where a judge was not asked, or has nothing to judge.

    ``free`` things can fall, ``stable`` of them stay; ``falling`` are the names of the others. ``doors`` and
    ``windows`` are their sides that look into the room, of which some are ``clear``.
    """

    things: int
    free: int | None = None
    stable: int | None = None
    falling: tuple[str, ...] = ()
    navigability: float | None = None
    doors: int | None = None
    doors_clear: int | None = None
    windows: int | None = None
    windows_clear: int | None = None


def judge_scene(
    graph: SceneGraph, judges: Collection[str] = JUDGES, only: Collection[int] | None = None
) -> JudgedScene:
    """Ask some of :data:`JUDGES` about a scene.

    Of ``only`` some rows it is asked whether they stay where they are; all other things are then as firm as the
    building. MissingPackageError if MuJoCo is asked and not installed.
    """
    counted = counted_objects(graph)
    said: dict[str, object] = {}
    if STABILITY in judges:
        fixed = () if only is None else [row for row in np.flatnonzero(counted).tolist() if row not in set(only)]
        found = simulated(graph, fixed)
        said |= {"free": len(found.rows), "stable": int(found.stays.sum())}
        said["falling"] = tuple(graph.name[row] for row in found.rows[~found.stays])
    if NAVIGABILITY in judges:
        said["navigability"] = navigability(graph)
    if OPENINGS in judges:
        for kind, name in (("Door", "doors"), ("Window", "windows")):
            sides = [side for side in openings(graph) if side.kind == kind]
            said |= {name: len(sides), f"{name}_clear": sum(not side.before for side in sides)}
    return JudgedScene(int(counted.sum()), **said)  # type: ignore[arg-type]


def summary(scenes: Sequence[JudgedScene]) -> dict[str, float | int | list[float] | None]:
    """Many scenes in one row: shares over all their things, and 95 % intervals of a bootstrap over scenes."""
    walked = np.array([scene.navigability for scene in scenes if scene.navigability is not None])
    row: dict[str, float | int | list[float] | None] = {
        "scenes": len(scenes), "things": sum(scene.things for scene in scenes)
    }  # fmt: skip
    for name, part, whole in (
        ("stable", "stable", "free"), ("doors_clear", "doors_clear", "doors"),
        ("windows_clear", "windows_clear", "windows"),
    ):  # fmt: skip
        counts = np.array([(getattr(scene, part) or 0, getattr(scene, whole) or 0) for scene in scenes], float)
        row |= {whole: int(counts[:, 1].sum()), name: ratio(counts), f"{name}_interval": ratio_interval(counts)}
    mean = np.stack([walked, np.ones_like(walked)], axis=1)
    row |= {"navigability": ratio(mean), "navigability_interval": ratio_interval(mean)}
    row |= {"navigability_worst": float(walked.min()) if len(walked) else None}
    return row | {"parted": int((walked < PARTED).sum())}


def ratio(counts: Floats) -> float | None:
    """The sum of the first column of counts (N, 2) over that of the second; None where that is 0."""
    part, whole = counts.reshape(-1, 2).sum(axis=0)
    return float(part / whole) if whole else None


def ratio_interval(counts: Floats) -> list[float]:
    """95 % interval of :func:`ratio` by a bootstrap over the rows, that is over scenes; empty where it has no value."""
    counts = counts.reshape(-1, 2)
    if not counts[:, 1].sum():
        return []
    drawn = counts[np.random.default_rng(0).integers(len(counts), size=(DRAWN, len(counts)))].sum(axis=1)
    drawn = drawn[drawn[:, 1] > 0]
    return [float(value) for value in np.quantile(drawn[:, 0] / drawn[:, 1], LEVELS)]
