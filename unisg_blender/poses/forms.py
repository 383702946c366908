"""The interchangeable representation forms of a pose: ``FORMS`` and ``convert``.

A form turns affine 4x4 matrices (column vectors, metres, Z up) into feature
vectors and back, for numpy arrays and torch tensors, batched over any leading
axes. Scale never enters a rotation: the 3x3 block is split into R S, a form
holds R and the translation, and S stands beside it in six stretch channels.
Equation (2) of the UniSG^GA paper lists the forms; the conventions are in
``docs/poses.md``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from ..errors import UniSGError
from . import encodings
from .arrays import Components, Formula, as_batch, map_rows
from .encodings import Block
from .multivectors import CGA_BLADES, CGA_EVEN, PGA_BLADES, PGA_EVEN
from .polar import pose_rotation
from .stretch import stretch_of, stretched

STRETCH_CHANNELS = ("stretch_xx", "stretch_yy", "stretch_zz", "stretch_xy", "stretch_xz", "stretch_yz")
"""The entries of the symmetric stretch that stand beside a form."""

STRETCH_WIDTH = len(STRETCH_CHANNELS)
"""Number of stretch channels."""


@dataclass(frozen=True)
class Form:
    """One way to write poses down as feature vectors.

    Attributes
    ----------
    name
        Key in ``FORMS``.
    channels
        Name of each feature, in order.
    _encode, _decode, _project
        A :class:`~.encodings.Block` to components, these to a block, and to the nearest valid
        ones; a component is an array or tensor with one entry per pose.
    holds_affine
        Whether the form holds the whole affine by itself: its stretch channels are
        written for uniformity and not needed by ``decode``.
    holds_uniform_scale
        Whether it holds at least scale that is the same along all axes.
    """

    name: str
    channels: tuple[str, ...]
    _encode: Callable[[Block], Components] = field(repr=False)
    _decode: Callable[[Components], Block] = field(repr=False)
    _project: Callable[[Components], Components] = field(repr=False)
    holds_affine: bool = False
    holds_uniform_scale: bool = False

    @property
    def width(self) -> int:
        """Number of features, without stretch."""
        return len(self.channels)

    @property
    def holds_scale(self) -> bool:
        """Whether it holds scale of any kind by itself; without, what goes without stretch channels drops it."""
        return self.holds_affine or self.holds_uniform_scale

    def encode(self, matrices: Any, stretch: bool = False) -> Any:
        """Features of poses.

        Parameters
        ----------
        matrices
            Shape (..., 4, 4): affine matrices, array or tensor.
        stretch
            Append the six stretch channels, from which the affine comes back. Without them scale
            is dropped, but by forms that hold it.

        Returns
        -------
        array or tensor
            Shape (..., width) or (..., width + 6). Arrays are float32 where
            ``matrices`` was, else float64.

        Raises
        ------
        PoseError
            Wrong shape, NaN, infinity, or a last row that is not 0 0 0 1.
        """

        def features(m: Components) -> Components:
            """Matrix entries to the form's components."""
            return self._features(encodings.split(m, rotation=stretch or not self.holds_affine), stretch)

        batch, out = as_batch(matrices, (4, 4), "matrices"), (self.width + STRETCH_WIDTH * stretch,)
        return map_rows(features, batch, (4, 4), out, "the matrix", "has a last row other than 0 0 0 1")

    def decode(self, features: Any, stretch: bool = False) -> Any:
        """Matrices of features; the inverse of ``encode``.

        Expects features that ``encode`` or ``project`` made; ``project`` first what a network
        gave. Motors may come times any number but zero, ``cga_similarity`` with either sign.

        Parameters
        ----------
        features
            Shape (..., width), or (..., width + 6) with ``stretch``.
        stretch
            Whether the last six channels are stretch.

        Returns
        -------
        array or tensor
            Shape (..., 4, 4).

        Raises
        ------
        PoseError
            Wrong shape, NaN, infinity, or a versor of norm zero.
        """

        return self._map(lambda x: encodings.join(self._block(x, stretch)), features, stretch, (4, 4))

    def project(self, features: Any, stretch: bool = False) -> Any:
        """Nearest valid features, in canonical sign; for what a network gave.

        Motors are taken times any number but zero. Stretch channels, if any, pass
        through: every value of theirs is valid.

        Parameters
        ----------
        features
            Shape (..., width), or (..., width + 6) with ``stretch``.
        stretch
            Whether the last six channels are stretch.

        Returns
        -------
        array or tensor
            The shape of ``features``.

        Raises
        ------
        PoseError
            Wrong shape, NaN, infinity, or features with no nearest pose (a norm of zero).
        """

        out = (self.width + STRETCH_WIDTH * stretch,)
        return self._map(lambda x: (*self._project(x[: self.width]), *x[self.width :]), features, stretch, out)

    def _features(self, block: Block, stretch: bool) -> Components:
        channels = self._encode(block)
        return (*channels, *stretch_of(block.rotation, block.linear)) if stretch else channels

    def _block(self, x: Components, stretch: bool) -> Block:
        block = self._decode(x[: self.width])
        if self.holds_affine or not stretch:
            return block
        return block._replace(linear=stretched(block.rotation, x[self.width :]))

    def _map(self, function: Formula, features: Any, stretch: bool, out: tuple[int, ...]) -> Any:
        batch = as_batch(features, (self.width + STRETCH_WIDTH * stretch,), f"{self.name} features")
        return map_rows(function, batch, batch.shape[-1:], out, f"the {self.name} feature")


def _form(name: str, channels: str | tuple[str, ...], codec: encodings.Codec, **holds: bool) -> Form:
    names = tuple(channels.split()) if isinstance(channels, str) else channels
    return Form(name, names, codec.encode, codec.decode, codec.project, **holds)


_MATRIX = tuple(f"m{i}{j}" for i in range(4) for j in range(4))
_CGA_EVEN_BLADES = tuple(CGA_BLADES[i] for i in CGA_EVEN)

_FORMS = {
    form.name: form
    for form in (
        _form("matrix", _MATRIX, encodings.MATRIX),
        _form("trs_matrix", _MATRIX, encodings.TRS_MATRIX, holds_affine=True),
        _form("axis_angle", "tx ty tz angle ax ay az", encodings.AXIS_ANGLE),
        _form("quaternion", "tx ty tz w x y z", encodings.QUATERNION),
        _form("sixd", "tx ty tz r00 r10 r20 r01 r11 r21", encodings.SIXD),
        _form("dual_quaternion", "w x y z dw dx dy dz", encodings.DUAL_QUATERNION),
        _form("pga", PGA_BLADES, encodings.PGA),
        _form("pga_even", tuple(PGA_BLADES[i] for i in PGA_EVEN), encodings.PGA_EVEN_ONLY),
        _form("cga", CGA_BLADES, encodings.CGA),
        _form("cga_even", _CGA_EVEN_BLADES, encodings.CGA_EVEN_ONLY),
        _form("cga_similarity", CGA_BLADES, encodings.CGA_SIMILARITY, holds_uniform_scale=True),
    )
}
_SHIPPED = frozenset(_FORMS)

FORMS: Mapping[str, Form] = MappingProxyType(_FORMS)
"""The forms by name: those that come with UniSG, and those of :func:`register_form`."""


def register_form(form: Form) -> None:
    """Make a form of your own known by its name, in this process and in place of an earlier one.

    ``FORMS``, ``convert``, datasets and the command line's ``--form`` have it from then on;
    docs/poses.md shows one.

    Raises
    ------
    UniSGError
        If a form that comes with UniSG has that name, or it is empty.
    """
    if form.name in _SHIPPED or not form.name:
        raise UniSGError(f"{form.name!r} cannot be the name of a form of your own: choose another")
    _FORMS[form.name] = form


def convert(features: Any, source: str, target: str, stretch: bool = False) -> Any:
    """Features of one form as features of another, without going through matrices in memory.

    What the target does not hold is dropped, as by ``Form.encode``: without ``stretch`` only ``trs_matrix``
    and ``cga_similarity`` give scale, and only these two take it.

    Parameters
    ----------
    features
        Shape (..., width of ``source``), or 6 wider with ``stretch``.
    source, target
        Names in ``FORMS``.
    stretch
        Whether features come and go with their stretch channels.

    Returns
    -------
    array or tensor
        Shape (..., width of ``target``), or 6 wider with ``stretch``.

    Raises
    ------
    PoseError
        As ``Form.decode``.
    KeyError
        An unknown form.
    """
    old, new = FORMS[source], FORMS[target]

    def converted(x: Components) -> Components:
        """Components of the old form to those of the new one."""
        block = old._block(x, stretch)
        if old.holds_affine:
            block = block._replace(rotation=pose_rotation(block.linear))
        return new._features(block, stretch)

    return old._map(converted, features, stretch, (new.width + STRETCH_WIDTH * stretch,))
