"""Motors as multivectors of PGA (16 coefficients) and CGA (32), on components.

Coefficients stand in the order of ``clifford.pga`` (e0 first, e0^2 = 0) and of
``clifford.g3c`` (e4^2 = +1, e5^2 = -1, einf = e4 + e5). Only the slots listed
here are ever non-zero in a motor.
"""

from __future__ import annotations

from typing import Any

from .arrays import Components, namespace
from .rotations import dot, scale

PGA_BLADES = (
    *("1", "e0", "e1", "e2", "e3", "e01", "e02", "e03", "e12", "e13", "e23"),
    *("e012", "e013", "e023", "e123", "e0123"),
)
CGA_BLADES = (
    *("1", "e1", "e2", "e3", "e4", "e5", "e12", "e13", "e14", "e15", "e23", "e24", "e25", "e34", "e35", "e45"),
    *("e123", "e124", "e125", "e134", "e135", "e145", "e234", "e235", "e245", "e345"),
    *("e1234", "e1235", "e1245", "e1345", "e2345", "e12345"),
)
PGA_EVEN = (0, 5, 6, 7, 8, 9, 10, 15)
CGA_EVEN = (0, *range(6, 16), *range(26, 31))


def pga_even(r: Components, d: Components) -> Components:
    """The 8 even coefficients of w - z e12 + y e13 - x e23 - dx e01 - dy e02 - dz e03 - dw e0123."""
    w, x, y, z = r
    dw, dx, dy, dz = d
    return (w, 0.0 - dx, 0.0 - dy, 0.0 - dz, 0.0 - z, y, 0.0 - x, 0.0 - dw)


def from_pga_even(m: Components) -> tuple[Components, Components]:
    """(r, d) of the 8 even coefficients."""
    return (m[0], -m[6], m[5], -m[4]), (-m[7], -m[1], -m[2], -m[3])


def cga_even(r: Components, d: Components) -> Components:
    """The 16 even coefficients of a rigid motor: each dual one stands twice, beside e4 and beside e5."""
    w, x, y, z = r
    dw, dx, dy, dz = (0.0 - c for c in d)
    return (w, 0.0 - z, y, dx, dx, 0.0 - x, dy, dy, dz, dz, 0.0, dw, dw, 0.0, 0.0, 0.0)


def from_cga_even(m: Components) -> tuple[Components, Components]:
    """(r, d) of the 16 even coefficients of a rigid motor; doubled slots are averaged."""
    r = (m[0], -m[5], m[2], -m[1])
    return r, tuple(-0.5 * (m[i] + m[j]) for i, j in ((11, 12), (3, 4), (6, 7), (8, 9)))


def similarity_even(r: Components, d: Components, dilation: Components) -> Components:
    """The 16 even coefficients of T R D, with D = a + b e45 and ``dilation`` = (a, b, a + b).

    R D spreads r over the slots with and without e45; einf D = (a + b) einf scales the
    dual part. The sum is given, because it cancels where the scale is large.
    """
    a, b, total = dilation
    plain = cga_even(scale(a, r), scale(total, d))
    w, x, y, z = scale(b, r)
    return (*plain[:10], w, *plain[11:13], 0.0 - z, y, 0.0 - x)


def from_similarity_even(m: Components) -> tuple[Components, Components, Any, Any]:
    """(r, (a + b) d, a, b) of the 16 even coefficients of a versor T R D times any number; a is not negative.

    The unit quaternion r stands in them twice, as p = a r and as q = b r. It is taken from both,
    weighted a : b, so that noise counts least, nothing cancels and no choice between them jumps.
    """
    p, d = from_cga_even(m)
    q = (m[10], -m[15], m[14], -m[13])
    pp, pq, qq = dot(p, p), dot(p, q), dot(q, q)
    k = pq / pp
    a, b = pp + k * pq, pq + k * qq
    factor = 1.0 / namespace(k).sqrt(a + k * b)
    r = tuple(factor * (x + k * y) for x, y in zip(p, q, strict=True))
    return r, d, factor * a, factor * b


def spread(even: Components, slots: tuple[int, ...], width: int) -> Components:
    """All coefficients of a multivector from its even ones."""
    full: list = [0.0] * width
    for slot, values in zip(slots, even, strict=True):
        full[slot] = values
    return full


def gather(full: Components, slots: tuple[int, ...]) -> Components:
    """The even coefficients of a multivector."""
    return tuple(full[slot] for slot in slots)
