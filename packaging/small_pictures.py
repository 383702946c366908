"""Pictures of pages as files of few bytes."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

COLOURS = 256


def save_small(picture: Image.Image, path: Path) -> None:
    """Write a picture with few colours, those farthest apart: a median cut would lose what is small and bright."""
    few = picture.convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=2, dither=Image.Dither.NONE)
    few.save(path, optimize=True)
