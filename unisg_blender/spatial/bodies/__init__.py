"""What a scene is for a simulator: which things move as one, what stays, their convex pieces and their mass."""

from __future__ import annotations

from .hull_pieces import convex_pieces
from .made_bodies import simulated_scene
from .moving_bodies import RigidBody, rigid_bodies

__all__ = ["RigidBody", "convex_pieces", "rigid_bodies", "simulated_scene"]
