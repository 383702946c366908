"""Which side of a thing is its front, told by its shape: where a backrest, handles, a screen or open shelves are."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..errors import UniSGError
from ..geometry.arrays import Floats, Ints
from ..geometry.surface_contact import Triangles
from ..pretrained import FOLDER

SIDES = ("-y", "+x", "+y", "-x")
"""The sides of an upright box, each a quarter turn after the one before; things made here look towards -y."""

OUTWARDS = np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])

CELLS = 20
"""Cells along each edge of the pictures of depth that are taken from the four sides."""

SAMPLES = 6000

ON_SIDE = 0.04
"""Share of the depth of a box within which something is on its side."""

SLAB = 0.15
"""Share of the depth in which corners of the mesh count as details of a side."""

FLAT = 1e-6
"""Metres of an extent below which a thing is a sheet: all its sides look alike."""

CLEAR = 0.9
"""Chance from which on a front counts as told."""

FEATURES = (
    "flat", "relief", "edges", "small_edges", "depth", "details", "slanted", "upper_depth", "upper_mass", "rows",
    "wide", "mirrored", "unlike",
)  # fmt: skip
WEIGHTS_FILE = FOLDER / "fronts.json"


@dataclass(frozen=True, eq=False)
class Front:
    """The front of a thing: the chance (4,) of each of :data:`SIDES`."""

    chances: Floats

    @property
    def side(self) -> int:
        """The likeliest side, as a place in :data:`SIDES`: so many quarter turns is the thing turned."""
        return int(self.chances.argmax())

    @property
    def told(self) -> bool:
        """Whether the shape says it clearly."""
        return bool(self.chances.max() >= CLEAR)


def front_of(triangles: Triangles) -> Front:
    """The front of a thing by its triangles (M, 3, 3) as it stands, z up; no side is told without any surface."""
    found = side_features(triangles)
    if found is None:
        return Front(np.full(4, 0.25))
    score = found @ _weights()
    chances = np.exp(score - score.max())
    return Front(chances / chances.sum())


def side_features(triangles: Triangles) -> Floats | None:
    """What each side looks like, (4, F) by :data:`FEATURES`: most of them less the same of the opposite side; None
    for what has no surface, or is flat."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(normal, axis=1)
    if not area.sum() > 0:
        return None
    low, size = triangles.min(axis=(0, 1)), np.ptp(triangles, axis=(0, 1))
    if size.min() < FLAT:
        return None
    which, points = _samples(triangles, area)
    places, corners = (points - low) / size, (triangles.reshape(-1, 3) - low) / size
    normals = normal[which] / np.maximum(area[which, None], 1e-300)
    depth = [_depth_seen(places, side) for side in range(4)]
    one = np.array([_of_side(places, corners, normals, depth[side], side) for side in range(4)])
    both = np.array([_of_axis(size, depth[side], depth[(side + 2) % 4], side) for side in range(4)])
    return np.hstack([one - one[[2, 3, 0, 1]], both - both[[1, 2, 3, 0]]])


def _samples(triangles: Triangles, area: Floats) -> tuple[Ints, Floats]:
    """Points (S, 3) spread over the surface, and which triangles they lie on."""
    total, rng = np.cumsum(area), np.random.default_rng(0)
    which = np.searchsorted(total, (np.arange(SAMPLES) + 0.5) / SAMPLES * total[-1]).clip(max=len(area) - 1)
    one, two = rng.random((2, SAMPLES, 1))
    outside = one + two > 1
    one, two = np.where(outside, 1 - one, one), np.where(outside, 1 - two, two)
    corner = triangles[which]
    return which, corner[:, 0] + one * (corner[:, 1] - corner[:, 0]) + two * (corner[:, 2] - corner[:, 0])


def _into(places: Floats, side: int) -> Floats:
    """How deep places (N, 3) in the unit box lie behind a side, 0 to 1."""
    axis = 1 if side % 2 == 0 else 0
    return places[:, axis] if side in (0, 3) else 1 - places[:, axis]


def _depth_seen(places: Floats, side: int) -> Floats:
    """A picture of depth (CELLS, CELLS) from a side, columns by height; 1 where one sees through."""
    across = places[:, 0 if side % 2 == 0 else 1]
    across = 1 - across if side >= 2 else across
    column, row = ((value * CELLS).astype(int).clip(max=CELLS - 1) for value in (across, places[:, 2]))
    seen = np.ones((CELLS, CELLS))
    np.minimum.at(seen, (column, row), _into(places, side))
    return seen


def _of_side(places: Floats, corners: Floats, normals: Floats, seen: Floats, side: int) -> list[float]:
    hit = seen < 1
    steps = [np.abs(np.diff(seen, axis=axis)) for axis in (0, 1)]
    depth, facing = _into(places, side), normals[:, :2] @ OUTWARDS[side]
    high = places[:, 2] > 1 - 1 / 4
    return [
        float((seen < ON_SIDE).sum() / hit.sum()),
        float(seen[hit].std()),
        float(sum(step.mean() for step in steps)),
        float(sum(np.minimum(step, 0.1).mean() for step in steps)),
        float(seen[hit].mean()),
        float((_into(corners, side) < SLAB).mean()),
        float(((facing > SLAB) & (normals[:, 2] > 0.1)).mean()),
        float(seen[:, CELLS // 2 :].mean() - seen[:, : CELLS // 2].mean()),
        float(depth[high].mean() - 0.5) if high.any() else 0.0,
        float(np.abs(np.diff(seen.mean(axis=0))).mean()),
    ]


def _of_axis(size: Floats, seen: Floats, opposite: Floats, side: int) -> list[float]:
    ratio = np.log(size[0] / size[1]) * (1 if side % 2 == 0 else -1)
    return [float(np.clip(ratio, -2, 2)), float(np.abs(seen - seen[::-1]).mean()),
            float(np.abs(seen - opposite[::-1]).mean())]  # fmt: skip


@cache
def _weights() -> Floats:
    """The weight of each feature, (F,), as ``benchmarks/fronts.py`` has fitted them."""
    try:
        found = json.loads(WEIGHTS_FILE.read_text(encoding="utf-8"))
        return np.array([found["weights"][name] for name in FEATURES], float)
    except (OSError, ValueError, KeyError, TypeError):
        raise UniSGError(f"{WEIGHTS_FILE}: the weights of fronts are missing or damaged: install again") from None
