"""What training scenes teach about behaviour: kinds of actions, who takes part in them, and the shape of lessons."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from ...errors import UniSGError
from ...runtime.json_records import from_record
from ...runtime.onnx_session import damaged, metadata_text
from .roled_actions import Key

VERSION = 1
TASK = "behaviour"
SUFFIX = ".behaviour.onnx"


def behaviour_path(model: Path) -> Path:
    """Where the behaviour of a generator is: ``room.onnx`` has ``room.behaviour.onnx``."""
    return model.with_suffix(SUFFIX)


@dataclass(frozen=True)
class Reference:
    """How the reference pose of a kind comes about, in the frame of its frame entity.

    Each coordinate is ``value`` metres plus what ``rule`` names: 0 ("frame"), the target's present
    coordinate ("own"), the lowest or highest coordinate of the frame's box ("low", "high"), or it is
    ``value`` times half the box's width from its middle ("share"). The rotation is the target's
    present one ("own"), or the nine numbers of ``rotation``, row by row.
    """

    rule: tuple[str, str, str]
    value: tuple[float, float, float]
    turn: str
    rotation: tuple[float, ...]


@dataclass(frozen=True)
class AnswerRule:
    """Which answer of a Question is correct, by a rule that held in all training scenes.

    ``rule`` "count": the number of objects ``of`` a category (or "category|relation"); "always": the answer
    ``of``; "side": the first of ``answers`` where the target's coordinate ``of`` ("x", "y", "z") in the frame
    of what holds it is positive, else the second.
    """

    rule: str
    of: str
    answers: tuple[str, ...] = ()


@dataclass(frozen=True)
class Kind:
    """A kind of action: all actions of training scenes of one type and name in one stage and group.

    Attributes
    ----------
    slots
        For target, tool and frame: how often each category had that role; empty where there is none.
    roles
        "slot|category": share of the objects of the category that have the role.
    chance
        Share of the scenes with objects for all its roles in which it occurs.
    most
        Most actions of the kind in one scene.
    thresholds
        Medians of the thresholds that at least half of its actions have.
    rank
        Mean place among the actions of its stage, from 0 to 1.
    answers, answer_rule
        Those of the first Question seen, and which of them is correct (None: no rule tells).
    """

    type: str
    name: str
    stage: str
    group: str
    slots: tuple[dict[str, int], dict[str, int], dict[str, int]]
    roles: dict[str, float]
    chance: float
    most: int
    rank: float
    thresholds: dict[str, float]
    optional: bool = False
    trigger: bool = False
    reference: Reference | None = None
    answers: tuple[str, ...] = ()
    answer_rule: AnswerRule | None = None

    @property
    def key(self) -> Key:
        """Type, name, stage and group."""
        return self.type, self.name, self.stage, self.group


@dataclass(frozen=True)
class StageKind:
    """A stage of the training lessons: its ``lessons`` from the top, its mean place among all stages (0 to 1), the
    names of what it usually requires, and whether its actions are usually in order."""

    name: str
    lessons: tuple[str, ...]
    rank: float
    requires: tuple[str, ...]
    ordered: bool


@dataclass(frozen=True)
class Kinds:
    """All that the metadata of a model of behaviour says.

    ``categories`` are those of the training scenes, sorted; ``groups`` says of each Parallel group's name
    whether "all" or "any" is usual; ``operation`` is the commonest name of an operation.
    """

    categories: tuple[str, ...]
    kinds: tuple[Kind, ...]
    stages: tuple[StageKind, ...]
    groups: dict[str, str]
    operation: str
    provenance: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def number_of(self) -> dict[Key, int]:
        """Position of each kind by its key."""
        return {kind.key: number for number, kind in enumerate(self.kinds)}

    @cached_property
    def stage_number(self) -> dict[str, int]:
        """Position of each stage by its name."""
        return {stage.name: number for number, stage in enumerate(self.stages)}

    def to_json(self) -> str:
        """The metadata entry."""
        record = asdict(self)
        record["kinds"] = [_renamed(kind, "answer_rule", "right") for kind in record["kinds"]]
        return metadata_text(TASK, VERSION, **record)

    @staticmethod
    def from_record(record: Mapping[str, Any], path: Path) -> Kinds:
        """The kinds of a file's metadata; UniSGError if they are damaged."""
        try:
            kinds = [_renamed(kind, "right", "answer_rule") for kind in record["kinds"]]
            return from_record(Kinds, {**record, "kinds": kinds}, str(path))
        except (KeyError, TypeError, AttributeError, UniSGError):
            raise damaged(path) from None


def _renamed(record: Mapping[str, Any], old: str, new: str) -> dict[str, Any]:
    return {name: value for name, value in record.items() if name != old} | {new: record[old]}
