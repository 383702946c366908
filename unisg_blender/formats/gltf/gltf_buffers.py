"""The bytes of a glTF file as they are collected: arrays become accessors, or plain views for our own reading."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

COMPONENTS = {np.dtype(np.float32): 5126, np.dtype(np.uint32): 5125}
SHAPES = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4"}
VERTICES, INDICES = 34962, 34963
"""What a view is bound to: attributes of vertices, or numbers of vertices."""


class Buffers:
    """One growing buffer with its views and accessors."""

    def __init__(self) -> None:
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self._parts: list[bytes] = []
        self._size = 0

    @property
    def data(self) -> bytes:
        """All bytes so far."""
        return b"".join(self._parts)

    def view(self, values: NDArray[Any], target: int | None = None) -> int:
        """The number of a new view with the bytes of an array, which is not empty."""
        content = np.ascontiguousarray(values).tobytes()
        record = {"buffer": 0, "byteOffset": self._size, "byteLength": len(content)}
        self.views.append(record if target is None else record | {"target": target})
        self._parts += [content, b"\0" * (-len(content) % 4)]
        self._size += len(content) + -len(content) % 4
        return len(self.views) - 1

    def accessor(self, values: NDArray[Any], target: int | None = None, bounds: bool = False) -> int:
        """The number of a new accessor to float32 or uint32 values (K,) or (K, n), K > 0."""
        record: dict[str, Any] = {
            "bufferView": self.view(values, target),
            "componentType": COMPONENTS[values.dtype],
            "count": len(values),
            "type": SHAPES[values.shape[1:]],
        }
        if bounds:
            low, high = values.min(axis=0), values.max(axis=0)
            record |= {"min": np.atleast_1d(low).tolist(), "max": np.atleast_1d(high).tolist()}
        self.accessors.append(record)
        return len(self.accessors) - 1
