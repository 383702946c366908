"""The shell of a room: outline, floor, walls, doors and windows, and places along the walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import Floats
from .furniture import building
from .furniture.kit import Furniture
from .layout import Layout, Placed, facing

Opening = tuple[float, float, float, float]
"""Middle along the wall's x, sill, width and height, metres."""


@dataclass(frozen=True, eq=False)
class Side:
    """One wall seen from the room: its entity, length, and what keeps furniture away from it, as (from, to) in x."""

    wall: Placed
    length: float
    openings: list[tuple[float, float, float]]

    def blocked(self, x: float, half: float, height: float) -> bool:
        """Is there an opening behind an object at x, ``half`` as wide to each side, that is ``height`` high?"""
        return any(start < x + half and x - half < stop and height > sill for start, stop, sill in self.openings)


def rectangle(width: float, depth: float) -> Floats:
    """A rectangle around the origin, counter-clockwise (4, 2)."""
    return np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (width / 2, depth / 2)


def cut_corner(outline: Floats, corner: int, x: float, y: float, square: bool) -> Floats:
    """A rectangle without one corner: cut off at a slant, or ``square`` (an L-shaped room), x and y metres of it."""
    point = outline[corner]
    inward = -np.sign(point) * np.array([x, y])
    ends = [point + inward * np.array([1, 0]), point + inward * np.array([0, 1])]
    if corner % 2 == 0:  # counter-clockwise around the origin the corners 0 and 2 are reached along y
        ends.reverse()
    new = [ends[0], point + inward, ends[1]] if square else ends
    return np.round(np.concatenate([outline[:corner], new, outline[corner + 1 :]]), 6)


def build_shell(
    layout: Layout,
    height: float,
    floor_material: str,
    wall_material: str,
    openings: dict[int, tuple[Opening, Furniture]],
) -> tuple[Placed, list[Side]]:
    """Floor, walls and what fills their openings; returns the floor and the sides in the order of the outline.

    ``openings`` is by number of the outline's edge; a wall has at most one.
    """
    outline = layout.outline
    floor = layout.add(building.floor(tuple(map(tuple, outline.tolist())), floor_material), (0, 0, 0, 0), None)
    edges = np.roll(outline, -1, axis=0) - outline
    lengths = np.linalg.norm(edges, axis=1)
    headings = np.arctan2(edges[:, 1], edges[:, 0])
    bends = np.angle(np.exp(1j * (headings - np.roll(headings, 1))))  # at the start of each edge, positive to the left
    miters = np.round(building.WALL_THICKNESS * np.tan(bends / 2), 6)
    sides = []
    for edge, (length, heading) in enumerate(zip(lengths, headings, strict=True)):
        opening, filling = openings.get(edge, (None, None))
        # seen from the room a wall runs from the end of its edge to the start
        ends = float(miters[(edge + 1) % len(edges)]), float(miters[edge])
        shape = building.wall(round(float(length), 6), height, wall_material, *ends, opening)
        middle = outline[edge] + edges[edge] / 2
        outward = np.array([edges[edge][1], -edges[edge][0]]) / length
        at = middle + outward * building.WALL_THICKNESS / 2
        wall = layout.add(shape, (*at, 0.0, heading + np.pi), floor)
        gaps = []
        if opening is not None and filling is not None:
            x, sill, width, _ = opening
            layout.add(filling, wall.pose_at(x, 0.0, sill, 0.0), wall, "inside")
            gaps.append((x - width / 2, x + width / 2, sill))
        sides.append(Side(wall, float(length), gaps))
    return floor, sides


def against(layout: Layout, sides: list[Side], asset: Furniture, gap: tuple[float, float] = (0.005, 0.05)) -> Floats:
    """A pose with the back of the asset to some wall, a few centimetres off and a little askew; not before a door.

    Where none is found in a few tries the pose lies outside the room.
    """
    ends = np.cumsum([side.length for side in sides])
    for _ in range(6):
        side = sides[int(np.searchsorted(ends, layout.rng.uniform(0, ends[-1])))]
        half = asset.size[0] / 2
        room = side.length / 2 - half - 0.05
        if room <= 0:
            continue
        x = layout.rng.uniform(-room, room)
        if side.blocked(x, half, asset.size[2]):
            continue
        back = asset.mesh.bounds[1, 1]
        lean = layout.rng.normal(0, 0.01)
        y = -building.WALL_THICKNESS / 2 - layout.rng.uniform(*gap) - back - half * abs(lean)
        return side.wall.pose_at(x, y, 0.0, lean)
    return np.array([1e3, 1e3, 0, 0])


def mount(layout: Layout, sides: list[Side], asset: Furniture, height: float, tries: int = 12) -> Placed | None:
    """Fix an asset to some wall with its bottom at ``height``, clear of openings and of what stands there."""
    for index in layout.rng.permutation(len(sides)):
        side = sides[index]
        half = asset.size[0] / 2
        room = side.length / 2 - half - 0.1
        if room <= 0:
            continue
        y = -building.WALL_THICKNESS / 2 - asset.mesh.bounds[1, 1]
        xs = [
            x for x in layout.rng.uniform(-room, room, tries) if not side.blocked(x, half + 0.1, height + asset.size[2])
        ]
        poses = np.array([side.wall.pose_at(x, y, height, 0.0) for x in xs]).reshape(-1, 4)
        for pose in poses[layout.fits(asset, poses, side.wall, 0.03)]:
            return layout.add(asset, pose, side.wall, "hangs_from")
    return None


def keep_door_free(layout: Layout, sides: list[Side], depth: float = 0.9) -> None:
    """Keep the floor in front of every opening that reaches the floor free."""
    for side in sides:
        for start, stop, sill in side.openings:
            if sill == 0:
                y = -building.WALL_THICKNESS / 2 - depth / 2
                layout.keep_out((stop - start, depth, 2.0), side.wall.pose_at((start + stop) / 2, y, 0.0, 0.0))


def beside_wall(layout: Layout, sides: list[Side], asset: Furniture) -> Floats:
    """A pose near some wall, turned any way: where objects are pushed that are not needed."""
    reach = float(np.hypot(*asset.size[:2]) / 2)
    pose = against(layout, sides, asset, (reach, reach + 0.35))
    pose[3] = layout.rng.uniform(-np.pi, np.pi)
    return pose


def look_at(pose: Floats, target: Floats, spread: float, rng: np.random.Generator) -> Floats:
    """The pose turned so that its front looks at a point, give or take ``spread`` radians."""
    return np.array([pose[0], pose[1], pose[2], facing(pose, target) + rng.normal(0, spread)])
