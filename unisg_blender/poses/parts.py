"""The parts of a motor as multivectors: rotor, translator, dilator, and how to take one apart.

PGA multivectors have 16 coefficients in the order of ``clifford.pga``, CGA
multivectors 32 in that of ``clifford.g3c``. A motor is M = T R, a versor with
scale M = T R D; R and D commute.
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from .arrays import Components, PoseError, as_batch, map_rows, namespace
from .encodings import dilation_of, nearest_similarity
from .motors import dual_part, extract_translation
from .multivectors import CGA_EVEN, PGA_EVEN, cga_even, from_pga_even, gather, pga_even, similarity_even, spread
from .rotations import unit_quaternion

Algebra = Literal["pga", "cga"]

ONE: Components = (1.0, 0.0, 0.0, 0.0)
ZERO: Components = (0.0, 0.0, 0.0, 0.0)


class MotorParts(NamedTuple):
    """Rotor, translator and (CGA only, else None) dilator: multivectors of unit norm, canonical sign."""

    rotor: Any
    translator: Any
    dilator: Any


def rotor(quaternions: Any, algebra: Algebra = "pga") -> Any:
    """R = w - z e12 + y e13 - x e23 of quaternions.

    Parameters
    ----------
    quaternions
        Shape (..., 4), scalar first, of any norm but zero.
    algebra
        ``"pga"`` or ``"cga"``.

    Returns
    -------
    array or tensor
        Shape (..., 16) or (..., 32), canonical sign.
    """
    width = _width(algebra)
    batch = as_batch(quaternions, (4,), "quaternions")
    return map_rows(lambda q: _full(unit_quaternion(q), ZERO, width), batch, (4,), (width,), "the quaternion")


def translator(translations: Any, algebra: Algebra = "pga") -> Any:
    """T = 1 - 0.5 e0 t (PGA) or 1 - 0.5 t einf (CGA) of translations (..., 3) in metres."""
    width = _width(algebra)
    batch = as_batch(translations, (3,), "translations")
    return map_rows(lambda t: _full(ONE, dual_part(ONE, t), width), batch, (3,), (width,), "the translation")


def dilator(scales: Any) -> Any:
    """D = cosh g - sinh g e45, g = ln(s) / 2, of uniform scales (...) > 0; CGA, shape (..., 32)."""
    batch = as_batch(scales, (), "scales")[..., None]

    def full(s: Components) -> Components:
        """A scale to its dilator, NaN where it is not positive."""
        positive = namespace(s[0]).where(s[0] > 0, s[0], float("nan"))
        return spread(similarity_even(ONE, ZERO, dilation_of(positive)), CGA_EVEN, 32)

    return map_rows(full, batch, (1,), (32,), "the scale", "is not positive: a dilator holds s > 0")


def split_motor(multivectors: Any) -> MotorParts:
    """Rotor, translator and dilator of versors M = T R D.

    Parameters
    ----------
    multivectors
        Shape (..., 16) for PGA or (..., 32) for CGA: motors, or CGA versors with scale,
        times any number but zero (so also sign-flipped).

    Returns
    -------
    MotorParts
        Each of the shape of ``multivectors``; M is their product up to a factor.

    Raises
    ------
    PoseError
        Wrong shape, NaN, infinity, or a rotor of norm zero.
    """
    batch = as_batch(multivectors, (), "multivectors")
    width = batch.shape[-1] if batch.ndim else 0
    if width not in (16, 32):
        raise PoseError(f"a multivector has 16 (PGA) or 32 (CGA) coefficients, not {width}")

    def part(formula: Any) -> Any:
        """The formula over all rows."""
        return map_rows(formula, batch, (width,), (width,), "the rotor of the multivector")

    def translation(m: Components) -> Components:
        """A motor to the translator in it."""
        return dual_part(ONE, extract_translation(*_motor(m)[:2]))

    turn = part(lambda m: _full(unit_quaternion(_motor(m)[0]), ZERO, width))
    slide = part(lambda m: _full(ONE, translation(m), width))
    grow = part(lambda m: spread(similarity_even(ONE, ZERO, _dilation(m)), CGA_EVEN, 32)) if width == 32 else None
    return MotorParts(turn, slide, grow)


def _motor(m: Components) -> tuple[Components, Components]:
    if len(m) == 16:
        return from_pga_even(gather(m, PGA_EVEN))
    return nearest_similarity(gather(m, CGA_EVEN))[:2]


def _dilation(m: Components) -> Components:
    return dilation_of(nearest_similarity(gather(m, CGA_EVEN))[2])


def _full(r: Components, d: Components, width: int) -> Components:
    if width == 16:
        return spread(pga_even(r, d), PGA_EVEN, 16)
    return spread(cga_even(r, d), CGA_EVEN, 32)


def _width(algebra: str) -> int:
    if algebra not in ("pga", "cga"):
        raise PoseError(f"unknown algebra {algebra!r}: choose pga or cga")
    return 16 if algebra == "pga" else 32
