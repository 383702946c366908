"""What varies from room to room: how many of what, what is placed anew, what stays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

TRAINING, SCENE, NOTHING = "as in training", "as in this scene", "nothing"
"""What a count, or what is not named, may be: as in a room that the model was trained on, drawn at random; as in the
scene that varies; none."""


@dataclass(frozen=True)
class Count:
    """How many of a category a room has: from ``least`` to ``most``, each as likely, with a ``chance``, else none.

    ``like`` is :data:`TRAINING` or :data:`SCENE` where that says it.
    """

    least: int = 1
    most: int = 1
    chance: float = 1.0
    like: str = ""


@dataclass(frozen=True)
class Jitter:
    """How far, metres, and by which angle, degrees, the ``things`` may be moved that stay."""

    distance: float = 0.0
    angle: float = 0.0
    things: tuple[str, ...] = ("*",)


@dataclass(frozen=True)
class Variation:
    """What varies. Things are named by category, or by their own names; ``*`` and ``?`` stand for anything.

    Attributes
    ----------
    counts
        How many of a category a room has in the end; what is too many is taken out, what is missing is added.
    rest
        The same of all other categories; "" for as in training where a room is made from nothing, else as in its scene.
    remove, reroll, swap
        What is taken out, placed anew, or gets another shape of its category, with the chance for each thing.
    lock
        What stays as it is, whatever else is said.
    shapes
        Where other shapes come from: "model", "scene", and folders of datasets.
    jitter
        What else is moved a little.
    lesson
        Whether new things get actions and a place in the lesson; False takes away what there is.
    refused
        The share of what is to be added that may find no place; a room in which it is more is drawn again.
    tries
        How often a room is drawn at most.
    """

    counts: Mapping[str, Count] = field(default_factory=dict)
    rest: str = ""
    remove: Mapping[str, float] = field(default_factory=dict)
    reroll: Mapping[str, float] = field(default_factory=dict)
    swap: Mapping[str, float] = field(default_factory=dict)
    lock: tuple[str, ...] = ()
    shapes: tuple[str, ...] = ("model", "scene")
    jitter: Jitter = Jitter()
    lesson: bool = True
    refused: float = 0.2
    tries: int = 3
