"""Behaviour of new objects: which actions they get, what takes part in these, and where a lesson performs them."""

from __future__ import annotations

from .action_kinds import behaviour_path
from .action_policy import ActionPolicy
from .behaviour_adder import Behaviour, add_behaviour
from .network_policy import load_behaviour

__all__ = ["ActionPolicy", "Behaviour", "add_behaviour", "behaviour_path", "load_behaviour"]
