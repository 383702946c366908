"""Action types of your own, by name: for everything that checks, plays and rehearses actions in this process."""

from __future__ import annotations

import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...errors import UniSGError
from ...scene.action_data import TYPES
from .action_batch import Batch
from .conditions import Condition

Gesture = Callable[[Any, Batch], None]
"""How a rehearsal performs an action: it moves objects with the hand; the batch holds that one action."""

OWN_CONDITIONS: dict[str, Condition] = {}
OWN_GESTURES: dict[str, Gesture] = {}


def add_type(name: str, condition: Condition, gesture: Gesture | None = None) -> None:
    """Make a type known, in place of an earlier one of that name.

    Parameters
    ----------
    condition
        Says of a batch of actions and a moment which of them hold: see :mod:`.conditions`.
    gesture
        How a rehearsal performs it; without one, it brings the target to its reference
        pose, or the tool to the target.

    Raises
    ------
    UniSGError
        If the name is that of a type that comes with UniSG.
    """
    if name in TYPES or not name:
        raise UniSGError(f"{name!r} cannot be the name of a type of your own: choose another")
    OWN_CONDITIONS[name] = condition
    OWN_GESTURES.pop(name, None)
    if gesture is not None:
        OWN_GESTURES[name] = gesture


def remove_type(name: str) -> None:
    """Forget a type; one that is not known is passed over."""
    OWN_CONDITIONS.pop(name, None)
    OWN_GESTURES.pop(name, None)


def load_types(path: str | Path) -> tuple[str, ...]:
    """Run a Python file and make known what it has in ``CONDITIONS`` and perhaps ``GESTURES``, both by name.

    Returns
    -------
    tuple of str
        The names of the types.

    Raises
    ------
    UniSGError
        If the file cannot be run, or has no types.
    """
    if not Path(path).is_file():
        raise UniSGError(f"cannot read {path}: it is no file")
    try:
        found = runpy.run_path(str(path))
    except Exception as error:  # whatever a user's own file raises
        raise UniSGError(f"{path} cannot be run: {type(error).__name__}: {error}") from error
    conditions, gestures = found.get("CONDITIONS"), found.get("GESTURES", {})
    if not isinstance(conditions, dict) or not conditions or not all(map(callable, conditions.values())):
        raise UniSGError(f"{path} has no types: it needs a dictionary CONDITIONS of functions by name")
    for name, condition in conditions.items():
        add_type(name, condition, gestures.get(name))
    return tuple(conditions)
