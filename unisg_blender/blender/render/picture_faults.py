"""Whether a picture shows anything."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

BLANK = 0.004
"""Share of a picture's range by which the pixels of a blank one differ."""

BLACK = "the picture is black"


def picture_fault(path: Path) -> str:
    """That a picture shows nothing: it is black, or blank; "" if it shows something."""
    image = bpy.data.images.load(str(path))
    try:
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
    finally:
        bpy.data.images.remove(image)
    seen = pixels.reshape(-1, 4)[:, :3]
    if float(seen.std(axis=0).max()) > BLANK:
        return ""
    return BLACK if float(seen.mean()) < 10 * BLANK else "the picture is blank: nothing is seen from there"
