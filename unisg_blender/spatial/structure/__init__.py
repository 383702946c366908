"""Structure from geometry: floors, rooms, walls, openings, and surfaces that can hold things."""

from __future__ import annotations

from .recognise import recognise_structure
from .structure import HoldingSurface, Opening, Room, Structure, WallPiece

__all__ = ["HoldingSurface", "Opening", "Room", "Structure", "WallPiece", "recognise_structure"]
