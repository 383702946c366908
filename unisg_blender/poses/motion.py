"""Rigid motion: composition, screws (logarithm and exponential), interpolation and blending of poses.

Every function takes and gives poses in the form its ``form`` names, broadcast
over leading axes, as arrays or tensors; ``"dual_quaternion"`` (8 channels) costs no
conversion. Screw interpolation (ScLERP) turns and slides about one fixed axis at
constant speed: the path that exp(t log(a^-1 b)) describes (Kavan et al. 2006).

``compose`` and ``inverse`` take scale along, in the forms that hold it. Screws and
blends have no scale: there a pose with scale or shear is refused with a ``PoseError``.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from .arrays import Components, Formula, as_batch, is_tensor, map_rows, namespace
from .encodings import inverse_affine, rigid_motor
from .forms import FORMS, convert
from .motors import exponential, inverse_motor, logarithm, multiply_motors, unit_motor
from .rotations import canonical_sign, dot, scale

PIVOT = "dual_quaternion"


def motors_of(poses: Any, form: str) -> Any:
    """Unit dual quaternions of canonical sign, shape (..., 8); PoseError where the poses have scale or shear."""
    if form == PIVOT:
        return FORMS[PIVOT].project(poses)
    if not FORMS[form].holds_scale:
        return convert(poses, form, PIVOT)
    cause = "has scale or shear, which a screw does not carry"
    return map_rows(rigid_motor, FORMS[form].decode(poses), (4, 4), (8,), "the pose", cause)


def compose(a: Any, b: Any, form: str = PIVOT) -> Any:
    """The pose that applies ``b`` first, then ``a``, with their scale where the form holds it: shape (..., width)."""
    if FORMS[form].holds_scale:
        return FORMS[form].encode(FORMS[form].decode(a) @ FORMS[form].decode(b))
    product = _map(lambda x: unit_motor(multiply_motors(x[:8], x[8:])), motors_of(a, form), motors_of(b, form), out=8)
    return _back(product, form)


def inverse(a: Any, form: str = PIVOT) -> Any:
    """The pose that undoes ``a``, with its scale where the form holds it: shape (..., width); no scale may be 0."""
    if FORMS[form].holds_scale:
        cause = "has a scale of zero, which nothing undoes"
        return FORMS[form].encode(map_rows(inverse_affine, FORMS[form].decode(a), (4, 4), (4, 4), "the pose", cause))
    return _back(_map(lambda x: unit_motor(inverse_motor(x)), motors_of(a, form), out=8), form)


def log(motors: Any, form: str = PIVOT) -> Any:
    """Screws of poses.

    Parameters
    ----------
    motors
        Shape (..., width of ``form``).
    form
        Name in ``FORMS``.

    Returns
    -------
    array or tensor
        Shape (..., 6): the rotation vector (angle times axis, radians, angle in [0, pi]) and
        the translation vector (metres) of the twist whose exponential is the pose.
    """
    return _map(logarithm, motors_of(motors, form), out=6)


def exp(screws: Any, form: str = PIVOT) -> Any:
    """Poses (..., width) of screws (..., 6), any angle; the inverse of ``log``."""
    screws = as_batch(screws, (6,), "screws")
    return _back(_map(lambda x: unit_motor(exponential(x)), screws, out=8), form)


def sclerp(a: Any, b: Any, fraction: Any, form: str = PIVOT, shortest: bool = True) -> Any:
    """Screw interpolation between poses, for one or many bodies at once.

    Parameters
    ----------
    a, b
        Poses at fraction 0 and 1: shapes (..., width), broadcast against each other.
    fraction
        Numbers broadcast against the leading axes; outside [0, 1] the screw goes on.
    form
        Name in ``FORMS``.
    shortest
        Turn the short way, at most 180 degrees. Otherwise the signs of ``a`` and ``b`` as given
        decide, in forms that have a sign: opposite ones turn the long way.

    Returns
    -------
    array or tensor
        Poses, shape (..., width), canonical sign.
    """

    def interpolated(x: Components) -> Components:
        """Two motors and a time to the motor between, along a screw."""
        start = x[:8]
        step = multiply_motors(inverse_motor(start), x[8:16])
        if shortest:
            step = scale(canonical_sign(step[:4]), step)
        return unit_motor(multiply_motors(start, exponential(scale(x[16], logarithm(step)))))

    ends = _signed(a, form, shortest), _signed(b, form, shortest)
    return _back(_map(interpolated, *ends, _column(fraction, ends[0]), out=8), form)


def cubic_sclerp(a: Any, p: Any, q: Any, b: Any, fraction: Any, form: str = PIVOT) -> Any:
    """Path through four poses at fractions 0, 1/3, 2/3 and 1: a screw whose axis and speed change smoothly.

    exp of the cubic through the logarithms of the poses as seen from ``a``. Poses more than
    180 degrees from ``a`` are taken the short way.

    Parameters
    ----------
    a, p, q, b
        Shapes (..., width), broadcast against each other.
    fraction
        Numbers broadcast against the leading axes.
    form
        Name in ``FORMS``.

    Returns
    -------
    array or tensor
        Poses, shape (..., width), canonical sign.
    """

    def interpolated(x: Components) -> Components:
        """Four motors at thirds of a span and a time to the motor there."""
        back, s = inverse_motor(x[:8]), x[32]
        weights = (
            13.5 * s * (s - 2 / 3) * (s - 1.0),
            -13.5 * s * (s - 1 / 3) * (s - 1.0),
            4.5 * s * (s - 1 / 3) * (s - 2 / 3),
        )
        total: Components = (0.0,) * 6
        for weight, start in zip(weights, (8, 16, 24), strict=True):
            step = multiply_motors(back, x[start : start + 8])
            screw = logarithm(scale(canonical_sign(step[:4]), step))
            total = tuple(t + weight * c for t, c in zip(total, screw, strict=True))
        return unit_motor(multiply_motors(x[:8], exponential(total)))

    poses = [motors_of(pose, form) for pose in (a, p, q, b)]
    return _back(_map(interpolated, *poses, _column(fraction, poses[0]), out=8), form)


def linear_slerp(a: Any, b: Any, fraction: Any, form: str = PIVOT) -> Any:
    """The usual interpolation, for comparison: a straight line and, apart from it, slerp the short way.

    Arguments as in ``sclerp``. Unlike a screw, the path depends on where the body's origin lies.
    """
    x, y = (convert(motors_of(end, form), PIVOT, "quaternion") for end in (a, b))
    part = _column(fraction, x)
    line = (1.0 - part) * x[..., :3] + part * y[..., :3]
    turned = [namespace(x).concatenate([0.0 * end[..., :3], end[..., 3:]], -1) for end in (x, y)]
    turns = sclerp(turned[0], turned[1], fraction, "quaternion")[..., 3:]
    return convert(namespace(x).concatenate([line, turns], -1), "quaternion", form)


def blend(motors: Any, weights: Any, form: str = PIVOT) -> Any:
    """Normalised weighted sum of poses: much cheaper than screws, close to them for near poses.

    Each pose takes the sign nearest to the first one's (dual quaternion linear blending,
    Kavan et al. 2007). The path of two poses is that of the screw up to second order; only
    its speed differs.

    Parameters
    ----------
    motors
        Shape (..., K, width of ``form``): K poses to blend.
    weights
        Shape (..., K); their sum need not be 1, only not 0.
    form
        Name in ``FORMS``.

    Returns
    -------
    array or tensor
        Shape (..., width).
    """
    poses = motors_of(motors, form)
    count = poses.shape[-2]

    def blended(x: Components) -> Components:
        """Motors and weights to their normalised sum."""
        first, total = x[:4], [0.0] * 8
        for k in range(count):
            pose = x[8 * k : 8 * k + 8]
            sign = namespace(x[0]).where(dot(first, pose[:4]) < 0, -1.0, 1.0)
            total = [t + x[8 * count + k] * sign * c for t, c in zip(total, pose, strict=True)]
        return unit_motor(total)

    flat = poses.reshape((*poses.shape[:-2], 8 * count))
    return _back(_map(blended, flat, _like(weights, poses), out=8), form)


def _signed(poses: Any, form: str, shortest: bool) -> Any:
    """As ``_motors``; unless ``shortest``, with the sign the poses came with."""
    motors = motors_of(poses, form)
    if shortest or not {"w", "1"} & set(FORMS[form].channels):
        return motors
    batch = as_batch(poses, (FORMS[form].width,), f"{form} features")
    rotor = slice(3 if form == "quaternion" else 0, None)
    same = (batch * FORMS[form].project(batch))[..., rotor].sum(-1) >= 0
    return namespace(batch).where(same, 1.0, -1.0)[..., None] * motors


def _back(motors: Any, form: str) -> Any:
    return motors if form == PIVOT else convert(motors, PIVOT, form)


def _like(values: Any, reference: Any) -> Any:
    if is_tensor(reference):
        return sys.modules["torch"].as_tensor(values, dtype=reference.dtype, device=reference.device)
    return np.asarray(values, dtype=reference.dtype)


def _column(values: Any, reference: Any) -> Any:
    return _like(values, reference)[..., None]


def _map(formula: Formula, *arrays: Any, out: int) -> Any:
    """Apply a formula to arrays laid side by side, their leading axes broadcast."""
    batch, xp = arrays[0], namespace(arrays[0])
    if len(arrays) > 1:
        leading = xp.broadcast_shapes(*(a.shape[:-1] for a in arrays))
        batch = xp.concatenate([xp.broadcast_to(a, (*leading, a.shape[-1])) for a in arrays], -1)
    return map_rows(formula, batch, batch.shape[-1:], (out,), "the pose")
