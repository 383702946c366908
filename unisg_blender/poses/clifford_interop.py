"""To and from the multivectors of the ``clifford`` package, imported only when asked for."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import MissingPackageError
from .arrays import PoseError, is_tensor
from .forms import FORMS, convert

_FULL = {"pga_even": "pga", "cga_even": "cga"}


def to_multivector(features: Any, form: str = "pga") -> Any:
    """``clifford`` multivectors of poses.

    Parameters
    ----------
    features
        Shape (..., width of ``form``).
    form
        Name in ``FORMS``. Forms that are no multivectors become PGA motors, without their scale.

    Returns
    -------
    clifford.MultiVector or clifford.MVArray
        One multivector, or an array of shape (...); layout ``clifford.pga`` or ``clifford.g3c``.

    Raises
    ------
    PoseError
        Features that hold no pose.
    MissingPackageError
        Without ``clifford``.
    """
    values = np.asarray(features.detach() if is_tensor(features) else features)
    full = _FULL.get(form, form if form in ("pga", "cga", "cga_similarity") else "pga")
    values = values if full == form else convert(values, form, full)
    layout = _layout("pga" if full == "pga" else "cga")
    if values.shape[-1:] != (layout.gaDims,):
        raise PoseError(f"{form} features must have the shape (..., {layout.gaDims}), not {values.shape}")
    if values.ndim == 1:
        return layout.MultiVector(values.astype(np.float64))
    result = np.empty(values.shape[:-1], dtype=object)
    for index in np.ndindex(result.shape):
        result[index] = layout.MultiVector(values[index].astype(np.float64))
    return _clifford().MVArray(result)


def from_multivector(multivectors: Any, form: str | None = None) -> np.ndarray:
    """Features of ``clifford`` multivectors.

    Parameters
    ----------
    multivectors
        A ``MultiVector``, or an array or nested list of them; layout ``clifford.pga`` or ``clifford.g3c``.
    form
        Name in ``FORMS``; when omitted the coefficients as they are.

    Returns
    -------
    ndarray
        Shape (..., width), float64.

    Raises
    ------
    PoseError
        Multivectors of another algebra, or with a rotor of norm zero. Blades that no motor has are ignored.
    """
    coefficients = _coefficients(multivectors)
    width = coefficients.shape[-1]
    if width not in (16, 32):
        raise PoseError("multivectors must be of clifford.pga (16 coefficients) or of clifford.g3c (32)")
    if form is None:
        return coefficients
    full = "pga" if width == 16 else "cga_similarity"
    return convert(FORMS[full].project(coefficients), full, form)


def _coefficients(multivectors: Any) -> np.ndarray:
    if hasattr(multivectors, "layout"):
        return np.asarray(multivectors.value, dtype=np.float64)
    rows = [_coefficients(item) for item in multivectors]
    if len({row.shape for row in rows}) != 1:
        raise PoseError("multivectors must come as an array of at least one, all of one algebra")
    return np.stack(rows)


def _clifford() -> Any:
    try:
        import clifford
    except ImportError:
        raise MissingPackageError("clifford", "ga") from None
    return clifford


def _layout(algebra: str) -> Any:
    _clifford()
    if algebra == "pga":
        from clifford.pga import layout
    else:
        from clifford.g3c import layout
    return layout
