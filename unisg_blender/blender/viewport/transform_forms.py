"""An object's local transform in every representation form, as rows to show and text to copy."""

from __future__ import annotations

import json
from functools import lru_cache

import bpy
import numpy as np

from ...poses import FORMS, STRETCH_CHANNELS

Rows = tuple[tuple[str, float], ...]
STRETCH = "stretch"


def local_matrix(item: bpy.types.Object) -> np.ndarray:
    """Child to parent, (4, 4) float64: parent inverse times basis, which holds under a zero scale too."""
    basis = np.array(item.matrix_basis, dtype=np.float64)
    return basis if item.parent is None else np.array(item.matrix_parent_inverse, dtype=np.float64) @ basis


def transform_forms(item: bpy.types.Object) -> dict[str, Rows]:
    """(channel, value) of every form in the order of ``FORMS``, then of the stretch beside them.

    Raises
    ------
    PoseError
        A transform that holds NaN or infinity.
    """
    return _forms(local_matrix(item).tobytes())


def transform_text(item: bpy.types.Object, name: str) -> str:
    """One form (or ``"stretch"``) as JSON: form, channels and values, to paste elsewhere."""
    rows = transform_forms(item)[name]
    return json.dumps({"form": name, "channels": [c for c, _ in rows], "values": [v for _, v in rows]})


@lru_cache(maxsize=8)
def _forms(data: bytes) -> dict[str, Rows]:
    matrix = np.frombuffer(data).reshape(4, 4)
    rows = {name: _rows(form.channels, form.encode(matrix)) for name, form in FORMS.items()}
    rows[STRETCH] = _rows(STRETCH_CHANNELS, FORMS["matrix"].encode(matrix, stretch=True)[-len(STRETCH_CHANNELS) :])
    return rows


def _rows(channels: tuple[str, ...], values: np.ndarray) -> Rows:
    return tuple(zip(channels, values.tolist(), strict=True))
