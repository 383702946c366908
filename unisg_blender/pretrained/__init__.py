"""The models that come with the software; ``docs/models`` has their cards."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).resolve().parent


def default_generator() -> Path:
    """The generator for operating rooms."""
    return FOLDER / "operating_room.onnx"
