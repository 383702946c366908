"""The plan of a storey that was marked by eye: where a person gets, and where there is room for a thing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.ndimage import distance_transform_edt, label
from scipy.signal import fftconvolve
from triangle_soup import Soup, sampled

CELL, PERSON, LOW, HIGH, POCKET = 0.05, 0.25, 0.15, 1.8, 1.5
"""Metres: cells of the plan, half the width of a person, heights between which a person is; and the square metres of a
place that a thing may not cut off."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Cells of a storey: ``inside`` is marked as such, ``taken`` what is in the way of a person, ``low`` the corner."""

    inside: Any
    taken: Any
    low: Any
    floor: float

    @staticmethod
    def of(soup: Soup, storey: dict[str, Any]) -> Plan:
        """The plan of a marked storey."""
        polygons = [np.array(shape) for shape in storey["outline"]]
        corners = np.concatenate(polygons)
        low = corners.min(axis=0) - 2 * CELL
        shape = tuple(((corners.max(axis=0) - low) / CELL).astype(int) + 3)
        x, y = (low[k] + (np.arange(shape[k]) + 0.5) * CELL for k in (0, 1))
        inside = np.zeros(shape, bool)
        for polygon in polygons:
            inside |= polygon_cells(polygon, x, y)
        empty = Plan(inside, np.zeros(shape, bool), low, storey["floor"])
        return Plan(inside, empty.cells(soup), low, storey["floor"])

    def cells(self, soup: Soup, bottom: float = LOW, top: float = HIGH) -> Any:
        """Which cells triangles are in, between two heights over the floor."""
        high = self.low + np.array(self.inside.shape) * CELL
        near = soup.near(np.array([*self.low, self.floor + bottom]), np.array([*high, self.floor + top]))
        found = np.zeros(self.inside.shape, bool)
        for points in sampled(near.triangles, CELL / 2):
            level = (points[:, 2] >= self.floor + bottom) & (points[:, 2] <= self.floor + top)
            cell = ((points[level, :2] - self.low) / CELL).astype(int)
            good = ((cell >= 0) & (cell < self.inside.shape)).all(axis=1)
            found[tuple(cell[good].T)] = True
        return found

    def walkable(self, taken: Any) -> Any:
        """Where a person can stand."""
        return distance_transform_edt(self.inside & ~taken) * CELL > PERSON

    def cut_by(self, soups: Sequence[Soup]) -> bool:
        """Is a place cut off by more things than were there?"""
        free = self.walkable(self.taken)
        more = self.taken.copy()
        for soup in soups:
            more |= self.cells(soup)
        before, count = label(free)
        after, _ = label(self.walkable(more))
        for number in range(1, count + 1):
            sizes = np.bincount(after[before == number])[1:] * CELL**2
            if (sizes >= POCKET).sum() > 1:
                return True
        return False

    def room_for(self, half: Any, height: float, taken: Any) -> bool:
        """Is there a rectangle of half sizes (2,) free somewhere, in any of eight directions?"""
        free = self.inside & ~taken
        if (distance_transform_edt(free) * CELL > np.hypot(*half) + CELL).any():
            return True
        for angle in np.arange(8) * np.pi / 8:
            way = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            reach = int(np.ceil(np.hypot(*half) / CELL)) + 1
            grid = np.stack(np.mgrid[-reach : reach + 1, -reach : reach + 1], axis=-1) * CELL
            kernel = (np.abs(grid @ way) <= half).all(axis=-1)
            if (fftconvolve(~free, kernel, mode="valid") < 0.5).any():
                return True
        return False


def polygon_cells(polygon: Any, x: Any, y: Any) -> Any:
    found = np.zeros((len(x), len(y)), bool)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if a[1] != b[1]:
            over = (y >= min(a[1], b[1])) & (y < max(a[1], b[1]))
            found[:, over] ^= x[:, None] < (a[0] + (y[over] - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))[None]
    return found


def within(polygon: Any, point: Any) -> bool:
    return bool(polygon_cells(polygon, point[:1], point[1:2])[0, 0])
