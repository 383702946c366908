"""How each form writes a pose: encode, decode and project on components.

A pose between the forms is a ``Block``: the affine's 3x3 block A, the rotation
R in it, and the translation.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from .arrays import Components, namespace
from .motors import dual_part, extract_translation, nearest_motor
from .multivectors import (
    CGA_EVEN,
    PGA_EVEN,
    cga_even,
    from_cga_even,
    from_pga_even,
    from_similarity_even,
    gather,
    pga_even,
    similarity_even,
    spread,
)
from .polar import nearest_rotation, pose_rotation
from .rotations import (
    axis_angle_from_quaternion,
    cofactors,
    dot,
    quaternion_from_axis_angle,
    quaternion_from_rotation,
    rotation_from_columns,
    rotation_from_quaternion,
    scale,
    unit_quaternion,
)

LAST_ROW_TOLERANCE = 1e-6
SCALE_TOLERANCE = 1e-5


class Block(NamedTuple):
    """A pose on components: 3x3 block (9, row-major), its rotation (9), translation (3)."""

    linear: Components
    rotation: Components
    translation: Components


class Codec(NamedTuple):
    """The three functions of a form."""

    encode: Callable[[Block], Components]
    decode: Callable[[Components], Block]
    project: Callable[[Components], Components]


def split(m: Components, rotation: bool = True) -> Block:
    """Block of the 16 components of a 4x4 matrix, a last row other than 0 0 0 1 gives NaN."""
    linear = (*m[0:3], *m[4:7], *m[8:11])
    excess = abs(m[12]) + abs(m[13]) + abs(m[14]) + abs(m[15] - 1.0)
    tx = namespace(excess).where(excess > LAST_ROW_TOLERANCE, float("nan"), m[3])
    return Block(linear, pose_rotation(linear) if rotation else linear, (tx, m[7], m[11]))


def join(block: Block) -> Components:
    """The 16 components of a 4x4 matrix, row-major."""
    a, t = block.linear, block.translation
    return (*a[0:3], t[0], *a[3:6], t[1], *a[6:9], t[2], 0.0, 0.0, 0.0, 1.0)


def inverse_affine(m: Components) -> Components:
    """The 16 components of the inverse of an affine matrix."""
    linear, _, translation = split(m, rotation=False)
    cofactor, determinant = cofactors(linear)
    inverse = [scale(1.0 / determinant, cofactor[i::3]) for i in range(3)]
    moved = tuple(-dot(row, translation) for row in inverse)
    return join(_rigid([x for row in inverse for x in row], moved))


def rigid_motor(m: Components) -> Components:
    """The 8 components of the motor of a rigid matrix; scale or shear gives NaN."""
    block = split(m)
    off = [x - y for x, y in zip(block.linear, block.rotation, strict=True)]
    factor = namespace(off[0]).where(dot(off, off) > SCALE_TOLERANCE**2, float("nan"), 1.0)
    return scale(factor, _joined(_motor(block)))


def _rigid(rotation: Components, translation: Components) -> Block:
    return Block(rotation, rotation, translation)


def _decode_matrix(x: Components) -> Block:
    return _rigid((*x[0:3], *x[4:7], *x[8:11]), x[3:12:4])


def _project_matrix(x: Components) -> Components:
    return join(_rigid(nearest_rotation(_decode_matrix(x).linear), x[3:12:4]))


def _project_axis_angle(x: Components) -> Components:
    q = unit_quaternion(quaternion_from_axis_angle(x[3], x[4:7]))
    return (*x[:3], *axis_angle_from_quaternion(q))


def _project_sixd(x: Components) -> Components:
    r = rotation_from_columns(x[3:6], x[6:9])
    return (*x[:3], *r[0::3], *r[1::3])


def _motor(block: Block) -> tuple[Components, Components]:
    q = quaternion_from_rotation(block.rotation)
    return q, dual_part(q, block.translation)


def _joined(motor: tuple[Components, Components]) -> Components:
    return (*motor[0], *motor[1])


def _from_motor(r: Components, d: Components) -> Block:
    return _rigid(rotation_from_quaternion(r), extract_translation(r, d))


def uniform_scale(block: Block) -> Any:
    """The mean of the stretch without its sign, |tr(R^T A)| / 3: exact where A is uniform."""
    return namespace(block.translation[0]).abs(dot(block.rotation, block.linear)) / 3.0


def dilation_of(s: Any) -> Components:
    """(a, b, a + b) of D = a + b e45 = cosh g - sinh g e45 with g = ln(s) / 2.

    Scale 0 has no normalised versor; it gets the null one, 0.5 (1 + e45).
    """
    xp = namespace(s)
    root = xp.sqrt(xp.where(s == 0, 1.0, s))
    return (0.5 * (s + 1.0) / root, 0.5 * (1.0 - s) / root, 1.0 / root)


def nearest_similarity(m: Components) -> tuple[Components, Components, Any]:
    """Unit motor (r, d) and scale s >= 0 of the 16 even coefficients of a versor times any number."""
    r, d, a, b = from_similarity_even(m)
    return *nearest_motor(r, scale(1.0 / (a + b), d)), namespace(a).abs((a - b) / (a + b))


def _encode_similarity(block: Block) -> Components:
    return similarity_even(*_motor(block), dilation_of(uniform_scale(block)))


def _decode_similarity(m: Components) -> Block:
    """Of a normalised versor, where a^2 - b^2 = 1: a + b from b alone, by a sum without cancellation."""
    xp = namespace(m[0])
    r, d, a, b = from_similarity_even(m)
    larger = xp.sqrt(1.0 + b * b) + xp.where(b < 0, -b, b)
    total = xp.where(b < 0, 1.0 / larger, larger)
    null = a < 0.75  # a normalised versor has a >= 1, the null one of scale 0 has a = b = 0.5
    rigid = _from_motor(r, scale(xp.where(null, 1.0, 1.0 / total), d))
    return rigid._replace(linear=scale(xp.where(null, 0.0, 1.0 / (total * total)), rigid.rotation))


def _project_similarity(m: Components) -> Components:
    r, d, s = nearest_similarity(m)
    return similarity_even(r, d, dilation_of(s))


MATRIX = Codec(lambda block: join(block._replace(linear=block.rotation)), _decode_matrix, _project_matrix)
TRS_MATRIX = Codec(join, _decode_matrix, lambda x: join(_decode_matrix(x)))
QUATERNION = Codec(
    lambda block: (*block.translation, *quaternion_from_rotation(block.rotation)),
    lambda x: _rigid(rotation_from_quaternion(x[3:7]), x[:3]),
    lambda x: (*x[:3], *unit_quaternion(x[3:7])),
)
AXIS_ANGLE = Codec(
    lambda block: (*block.translation, *axis_angle_from_quaternion(quaternion_from_rotation(block.rotation))),
    lambda x: _rigid(rotation_from_quaternion(quaternion_from_axis_angle(x[3], x[4:7])), x[:3]),
    _project_axis_angle,
)
SIXD = Codec(
    lambda block: (*block.translation, *block.rotation[0::3], *block.rotation[1::3]),
    lambda x: _rigid(rotation_from_columns(x[3:6], x[6:9]), x[:3]),
    _project_sixd,
)
DUAL_QUATERNION = Codec(
    lambda block: _joined(_motor(block)),
    lambda x: _from_motor(x[:4], x[4:8]),
    lambda x: _joined(nearest_motor(x[:4], x[4:8])),
)
PGA_EVEN_ONLY = Codec(
    lambda block: pga_even(*_motor(block)),
    lambda m: _from_motor(*from_pga_even(m)),
    lambda m: pga_even(*nearest_motor(*from_pga_even(m))),
)
CGA_EVEN_ONLY = Codec(
    lambda block: cga_even(*_motor(block)),
    lambda m: _from_motor(*from_cga_even(m)),
    lambda m: cga_even(*nearest_motor(*from_cga_even(m))),
)


def _in_full(even: Codec, slots: tuple[int, ...], width: int) -> Codec:
    return Codec(
        lambda block: spread(even.encode(block), slots, width),
        lambda m: even.decode(gather(m, slots)),
        lambda m: spread(even.project(gather(m, slots)), slots, width),
    )


PGA = _in_full(PGA_EVEN_ONLY, PGA_EVEN, 16)
CGA = _in_full(CGA_EVEN_ONLY, CGA_EVEN, 32)
CGA_SIMILARITY = _in_full(Codec(_encode_similarity, _decode_similarity, _project_similarity), CGA_EVEN, 32)
