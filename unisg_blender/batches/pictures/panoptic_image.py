"""Numbers of objects as the colours of a PNG, as COCO's panoptic format has them; needs nothing but zlib."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...runtime.atomic_files import write_file

HEAD = b"\x89PNG\r\n\x1a\n"
TRUE_COLOUR = (8, 2, 0, 0, 0)
"""Bits of a channel, red-green-blue, and PNG's only compression, filter and order of lines."""


def write_panoptic(path: Path, instances: NDArray[np.int32]) -> None:
    """Write numbers (height, width), below 2**24, as a PNG with red + 256 green + 65536 blue."""
    height, width = instances.shape
    colors = np.stack([instances & 255, instances >> 8 & 255, instances >> 16 & 255], axis=-1).astype(np.uint8)
    lines = np.concatenate([np.zeros((height, 1), np.uint8), colors.reshape(height, -1)], axis=1)
    chunks = [
        (b"IHDR", struct.pack(">II5B", width, height, *TRUE_COLOUR)),
        (b"IDAT", zlib.compress(lines.tobytes(), 6)),
        (b"IEND", b""),
    ]
    write_file(path, HEAD + b"".join(_chunk(kind, data) for kind, data in chunks))


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
