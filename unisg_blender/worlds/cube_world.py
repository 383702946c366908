"""Cubes in stacks, on tables, beside each other: the ground for learning what stands on what."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import permutations, product

import numpy as np

from ..errors import UniSGError
from ..geometry.arrays import Floats
from ..scene.builder import SceneBuilder
from ..scene.graph import SceneGraph
from ..scene.identity import derived_uid
from ..scene.mesh import Mesh
from ..scene.relation import Relation
from .furniture.building import floor
from .furniture.kit import asset, block
from .furniture.palette import used_by
from .layout import matrix_of

ROTATIONS = ("yaw", "full", "free")
PAPER_PAIRS = 5000
_SITE = 1.5
_COLORS = ("red", "blue", "green", "yellow")


@dataclass(frozen=True, eq=False)
class Cube:
    """A cube of a site: edge length, pose (x, y, z of its bottom, yaw) and what it stands on (-1 floor, -2 table)."""

    edge: float
    pose: tuple[float, float, float, float]
    on: tuple[int, ...]


def cubes(seed: int, count: int = 40, rotation: str = "yaw", nested: bool = False) -> SceneGraph:
    """Cubes on a floor: stacks, bridges, on tables, side by side and nearly touching.

    The relation ``on_top_of`` is the truth that a topology predictor has to find; a
    cube on two others has two. The hierarchy does not tell it unless ``nested``.

    Parameters
    ----------
    seed
        Any integer that is not negative.
    count
        How many cubes.
    rotation
        "yaw": cubes stand upright, turned about the vertical. "full": each rests on
        any of its faces, so that rotations spread over the whole group. "free": every
        site is turned as a whole at random, as if there was no gravity; what carries
        what then holds in the site's own frame.
    nested
        True: the parent is what a cube stands on (the first of two); False: the floor.

    Raises
    ------
    UniSGError
        If the count is below 1 or the rotation is unknown.
    """
    rng = np.random.default_rng((seed, 3))
    kinds: list[Callable[[np.random.Generator], list[Cube]]] = [_stack, _bridge, _table, _beside, _near]
    sites: list[list[Cube]] = []
    missing = count
    while missing > 0:
        site = kinds[int(rng.choice(5, p=[0.3, 0.15, 0.2, 0.2, 0.15]))](rng)[:missing]
        missing -= len(site)
        sites.append(site)
    return _scene(f"Cubes {seed}", rng, sites, rotation, nested, count)


def cube_pairs(seed: int, pairs: int = PAPER_PAIRS, rotation: str = "yaw") -> SceneGraph:
    """A field of ``pairs`` times two cubes, one on top of the other: as many cubes as the paper's topology task has.

    The paper (UniSG^GA, arXiv 2306.10621) has a random scene of 10,000 cubes, a new one in each run, and does not say
    how they lie; piles of two are this project's. ``rotation`` as for :func:`cubes`.
    """
    rng = np.random.default_rng((seed, 4))
    return _scene(f"Cube Pairs {seed}", rng, [_pile(rng, 2) for _ in range(pairs)], rotation, False, 2 * pairs)


def _edge(rng: np.random.Generator) -> float:
    return round(float(rng.uniform(0.12, 0.36)), 3)


def _turn(rng: np.random.Generator) -> float:
    return float(rng.uniform(-np.pi, np.pi))


def _pile(rng: np.random.Generator, height: int) -> list[Cube]:
    """Cubes one on another, each with its middle over the one below."""
    x, y, z = (*rng.uniform(-0.1, 0.1, 2), 0.0)
    site = []
    for level in range(height):
        edge = _edge(rng)
        site.append(Cube(edge, (x, y, z, _turn(rng)), (level - 1,)))
        x, y = np.array([x, y]) + rng.uniform(-0.3, 0.3, 2) * edge
        z += edge
    return site


def _stack(rng: np.random.Generator) -> list[Cube]:
    return _pile(rng, int(rng.integers(1, 6)))


def _bridge(rng: np.random.Generator) -> list[Cube]:
    """A cube across the gap between two of one height."""
    edge, gap, turn = _edge(rng), rng.uniform(0.002, 0.05), _turn(rng)
    half = (edge + gap) / 2
    along = np.array([np.cos(turn), np.sin(turn)]) * half
    aside = rng.uniform(-0.3, 0.3, 2) * gap
    top = max(_edge(rng), round(float(gap + 0.1), 3))
    return [
        Cube(edge, (along[0], along[1], 0.0, turn), (-1,)),
        Cube(edge, (-along[0], -along[1], 0.0, turn), (-1,)),
        Cube(top, (aside[0], aside[1], edge, turn + rng.normal(0, 0.2)), (0, 1)),
    ]


def _table(rng: np.random.Generator) -> list[Cube]:
    """Up to four cubes in the quarters of a table top, some with another on them."""
    site: list[Cube] = []
    for x, y in rng.permutation([(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)])[: int(rng.integers(1, 5))]:
        edge = min(_edge(rng), 0.24)
        site.append(Cube(edge, (float(x), float(y), 0.45, _turn(rng)), (-2,)))
        if rng.random() < 0.3:
            site.append(Cube(round(edge * 0.7, 3), (float(x), float(y), 0.45 + edge, _turn(rng)), (len(site) - 1,)))
    return site


def _beside(rng: np.random.Generator) -> list[Cube]:
    """Two or three in a row, face to face, a millimetre or less apart: they touch, none stands on another."""
    return _row(rng, 0.0002, 0.001)


def _near(rng: np.random.Generator) -> list[Cube]:
    """Two or three in a row, some millimetres apart, at times with one on top of the first."""
    site = _row(rng, 0.003, 0.02)
    if rng.random() < 0.5:
        x, y, _, turn = site[0].pose
        site.append(Cube(round(site[0].edge * 0.8, 3), (x, y, site[0].edge, turn), (0,)))
    return site


def _row(rng: np.random.Generator, closest: float, widest: float) -> list[Cube]:
    turn, x, site = _turn(rng), -0.35, []
    for _ in range(int(rng.integers(2, 4))):
        edge = min(_edge(rng), 0.26)
        middle = x + edge / 2
        site.append(Cube(edge, (middle * np.cos(turn), middle * np.sin(turn), 0.0, turn), (-1,)))
        x += edge + rng.uniform(closest, widest)
    return site


def _scene(
    title: str, rng: np.random.Generator, sites: list[list[Cube]], rotation: str, nested: bool, count: int
) -> SceneGraph:
    if count < 1:
        raise UniSGError(f"a scene needs at least one cube, not {count}")
    if rotation not in ROTATIONS:
        raise UniSGError(f"rotation must be one of {', '.join(ROTATIONS)}, not {rotation!r}")
    columns = int(np.ceil(np.sqrt(len(sites))))
    half = columns * _SITE / 2
    edge = half + 0.5
    ground = floor(((-edge, -edge), (edge, -edge), (edge, edge), (-edge, edge)), "linoleum")
    builder = SceneBuilder(title, used_by([ground.mesh, _table_mesh(), *_cube_meshes()]))
    root = builder.add("Floor", uid=derived_uid(title, "Floor"), mesh=ground.mesh, category="Floor")
    tables, number = 0, 0
    for index, site in enumerate(sites):
        place = np.array([index % columns + 0.5, index // columns + 0.5]) * _SITE - half
        frame = _site_frame(rng, place, rotation)
        carriers = {-1: (root, derived_uid(title, "Floor"), np.eye(4))}
        if any(-2 in cube.on for cube in site):
            name = f"Table.{tables:05d}"
            uid = derived_uid(title, name)
            on_floor = (Relation("on_top_of", carriers[-1][1]),)
            row = builder.add(
                name, uid=uid, parent=root, local=frame, mesh=_table_mesh(), category="Table", relations=on_floor
            )
            carriers[-2] = (row, uid, frame)
            tables += 1
        for step, cube in enumerate(site):
            name = f"Cube.{number:05d}"
            uid = derived_uid(title, name)
            world = frame @ matrix_of(cube.pose) @ _standing(rng, cube.edge, rotation)
            on = [carriers[base] for base in cube.on]
            parent, _, above = on[0] if nested else carriers[-1]
            row = builder.add(
                name,
                uid=uid,
                parent=parent,
                local=np.linalg.solve(above, world),
                mesh=_cube_meshes()[int(rng.integers(len(_COLORS)))],
                category="Cube",
                relations=tuple(Relation("on_top_of", below) for _, below, _ in on),
            )
            carriers[step] = (row, uid, world)
            number += 1
    return builder.build()


def _site_frame(rng: np.random.Generator, place: Floats, rotation: str) -> Floats:
    """Where a site stands; for "free" turned any way around a point high enough to stay above the floor."""
    frame = matrix_of((*place, 0.0, _turn(rng)))
    if rotation == "free":
        from scipy.spatial.transform import Rotation

        frame[:3, :3] = Rotation.random(random_state=int(rng.integers(2**31))).as_matrix()
        frame[2, 3] = 2.0
        frame[:3, 3] -= frame[:3, 2] * 0.4  # about the middle of the site
    return frame


def _standing(rng: np.random.Generator, edge: float, rotation: str) -> Floats:
    """A unit cube (origin in its middle) as one of this edge on the ground, upright or on any face."""
    matrix = np.eye(4)
    matrix[:3, :3] = edge * (_FACES_DOWN[int(rng.integers(24))] if rotation != "yaw" else np.eye(3))
    matrix[2, 3] = edge / 2
    return matrix


def _quarter_turns() -> Floats:
    """The 24 rotations that map a cube to itself, float64 (24, 3, 3)."""
    signed = [
        np.eye(3)[list(order)] * np.array(signs)[:, None]
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
    ]
    return np.array([matrix for matrix in signed if np.linalg.det(matrix) > 0])


_FACES_DOWN = _quarter_turns()


@cache
def _cube_meshes() -> tuple[Mesh, ...]:
    """The unit cube, origin in its middle, in every colour."""
    return tuple(asset("Cube", [block(color, (1, 1, 1), (0, 0, -0.5))], origin="own").mesh for color in _COLORS)


@cache
def _table_mesh() -> Mesh:
    legs = [block("oak", (0.06, 0.06, 0.409), (x, y, 0)) for x in (-0.36, 0.36) for y in (-0.36, 0.36)]
    return asset("Table", [block("oak", (0.8, 0.8, 0.04), (0, 0, 0.41)), *legs]).mesh
