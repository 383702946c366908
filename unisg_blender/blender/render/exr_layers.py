"""Layers of an OpenEXR file as Blender writes it without compression: exact numbers, without another library."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError

MAGIC, NO_COMPRESSION = b"v/1\x01", 0
DTYPES: dict[int, np.dtype[Any]] = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


def read_layers(path: Path) -> dict[str, NDArray[np.float32]]:
    """Channels (height, width) by name, such as "ViewLayer.Depth.Z", the upper row first.

    Raises
    ------
    UniSGError
        If the file is none with lines of pixels without compression.
    """
    data = path.read_bytes()
    try:
        header, start = _header(data)
        if data[:4] != MAGIC or header["compression"][0] != NO_COMPRESSION:
            raise ValueError("it is compressed")
        return _channels(data, header, start)
    except (KeyError, ValueError, struct.error) as error:
        raise UniSGError(f"cannot read the passes in {path}: {error}") from None


def _header(data: bytes) -> tuple[dict[str, bytes], int]:
    """The attributes by name, and where the table of lines begins."""
    found: dict[str, bytes] = {}
    place = 8
    while data[place]:
        name, place = _text(data, place)
        _, place = _text(data, place)
        (size,) = struct.unpack_from("<i", data, place)
        found[name] = data[place + 4 : place + 4 + size]
        place += 4 + size
    return found, place + 1


def _text(data: bytes, place: int) -> tuple[str, int]:
    end = data.index(b"\0", place)
    return data[place:end].decode("utf-8", "replace"), end + 1


def _channels(data: bytes, header: dict[str, bytes], start: int) -> dict[str, NDArray[np.float32]]:
    names: list[tuple[str, np.dtype[Any]]] = []
    listed, place = header["channels"], 0
    while listed[place]:
        name, place = _text(listed, place)
        (kind,) = struct.unpack_from("<i", listed, place)
        names.append((name, DTYPES[kind]))
        place += 16
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    fields = [("head", "<i4", 2), *((f"{number}", dtype, width) for number, (_, dtype) in enumerate(names))]
    line = np.dtype(fields)
    lines = np.frombuffer(data, line, height, start + 8 * height)
    order = lines["head"][:, 0] - top
    return {name: lines[f"{number}"][np.argsort(order)].astype(np.float32) for number, (name, _) in enumerate(names)}
