"""Behaviour of new things: which actions they get, who plays in these, and where a lesson performs them."""

from __future__ import annotations

from .add import Behaviour, add_behaviour
from .choice import Chooser
from .kinds import behaviour_path
from .model import load_behaviour
from .placements import with_behaviour

__all__ = ["Behaviour", "Chooser", "add_behaviour", "behaviour_path", "load_behaviour", "with_behaviour"]
