"""Which linear maps of multivectors commute with motions: all of them, found by linear algebra, not from a list.

A motion near the identity is 1 + h B with a bivector B, and its sandwich changes x by h (B x - x B). A map commutes
with all motions exactly if it commutes with this change for the generators B of the motions. That is a
homogeneous system of equations with whole coefficients, whose solutions are all such maps.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from ...errors import UniSGError, did_you_mean
from ...geometry.arrays import Floats
from ...poses.multivectors import PGA_BLADES
from .pga_products import GEOMETRIC, GRADES

TURNS, SHIFTS = ("e12", "e13", "e23"), ("e01", "e02", "e03")
SYMMETRIES: dict[str, tuple[str, ...]] = {
    "mirrors": (*TURNS, *SHIFTS, "e1"),
    "motions": (*TURNS, *SHIFTS),
    "rooms": ("e12", *SHIFTS),
}
"""Generators by name. ``motions``: all rigid ones. ``mirrors``: reflections too, as GATr has it. ``rooms``: turns about
the vertical and shifts, which is what a room may be moved by without its things falling over."""


def _blade(name: str) -> Floats:
    return np.eye(16)[PGA_BLADES.index(name)]


def change(generator: str) -> Floats:
    """The matrix (16, 16) that multiplies coefficients: B x - x B of a bivector, x mirrored less x of a vector."""
    table, blade = GEOMETRIC.numpy().astype(np.float64), _blade(generator)
    left, right = np.einsum("i,ijk->kj", blade, table), np.einsum("j,ijk->ki", blade, table)
    if len(generator) == 3:
        return left - right
    signs = np.diag([(-1.0) ** grade for grade in GRADES])  # the mirror at e1 is x -> e1 x' e1, odd grades negated
    return left @ right @ signs - np.eye(16)


def _symmetry(name: str) -> list[Floats]:
    if name not in SYMMETRIES:
        raise UniSGError(f"unknown symmetry {name!r}{did_you_mean(name, SYMMETRIES)}: choose {', '.join(SYMMETRIES)}")
    return [change(generator) for generator in SYMMETRIES[name]]


@cache
def commuting_maps(symmetry: str) -> Floats:
    """A basis (K, 16, 16) of the maps y = A x with A (M x ~M) = M (A x) ~M for all motions M of a symmetry.

    For ``mirrors`` these are GATr's nine, y = sum of w_k <x>_k + sum of v_k e0 <x>_k, the projections to each grade and
    e0 times four of them (Brehmer et al. 2023, arXiv 2305.18415, Proposition 1); without mirrors more commute.

    Raises
    ------
    UniSGError
        An unknown symmetry.
    """
    identity = np.eye(16)
    equations = [np.kron(identity, part.T) - np.kron(part, identity) for part in _symmetry(symmetry)]
    return _null_space(np.concatenate(equations)).reshape(-1, 16, 16)


@cache
def invariant_parts(symmetry: str) -> Floats:
    """A basis (K, 16) of the linear functions of a multivector that no motion of a symmetry changes."""
    return _null_space(np.concatenate([part.T for part in _symmetry(symmetry)]))


@cache
def invariant_elements(symmetry: str) -> Floats:
    """A basis (K, 16) of the multivectors that no motion of a symmetry changes."""
    return _null_space(np.concatenate(_symmetry(symmetry)))


def _null_space(equations: Floats) -> Floats:
    """A basis (K, N) of the solutions of equations (M, N) with small whole coefficients, by Gauss and Jordan."""
    rows = np.unique(equations[np.abs(equations).max(axis=1) > 0], axis=0)
    pivots: list[int] = []
    for column in range(rows.shape[1]):
        place = len(pivots)
        found = np.flatnonzero(np.abs(rows[place:, column]) > 0.5e-6)
        if not len(found):
            continue
        rows[[place, place + found[0]]] = rows[[place + found[0], place]]
        rows[place] /= rows[place, column]
        others = np.arange(len(rows)) != place
        rows[others] -= np.outer(rows[others, column], rows[place])
        pivots.append(column)
    return _solutions(rows, pivots)


def _solutions(rows: Floats, pivots: Sequence[int]) -> Floats:
    free = np.setdiff1d(np.arange(rows.shape[1]), pivots)
    basis = np.zeros((len(free), rows.shape[1]))
    basis[np.arange(len(free)), free] = 1
    basis[:, pivots] = -rows[: len(pivots), free].T
    return basis
