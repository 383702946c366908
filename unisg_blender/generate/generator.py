"""The generator: asks a model where new objects could be, settles them and puts them into the scenegraph."""

from __future__ import annotations

import os
from collections import abc
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..behaviour import all_actions
from ..dataset.assets.asset import Asset
from ..errors import UniSGError
from ..geometry.arrays import Ints
from ..runtime.steps import at_once
from ..scene import SceneGraph
from ..scene.categories import FLOOR, STRUCTURE
from ..spatial.structure import recognise_structure
from .behaviour import ActionPolicy, Behaviour, add_behaviour, behaviour_path, load_behaviour
from .counts import MOST_OBJECTS
from .observe.contract import Contract
from .observe.placement_order import in_order
from .place.placement_record import Placement
from .place.placer import ObjectPlacer
from .place.room_shell import add_shell
from .place.scene_extension import Names, extend, uid_maker
from .place.shape_library import Library
from .propose.anchor_proposer import AnchorProposer
from .propose.cgvae_proposer import CgvaeProposer
from .propose.proposer import Proposer
from .propose.trained_model import TrainedModel, load_model
from .propose.trees_proposer import TreesProposer


@dataclass(frozen=True, eq=False)
class Generated:
    """The extended scene, the rows that are new in it, what became of each object asked for, and how many ``actions``
    are new."""

    scene: SceneGraph
    rows: Ints
    objects: tuple[Placement, ...]
    actions: int = 0

    @property
    def added(self) -> int:
        """How many objects were added."""
        return sum(not placement.refused for placement in self.objects)

    @property
    def refused(self) -> tuple[Placement, ...]:
        """The objects for which there was no room."""
        return tuple(placement for placement in self.objects if placement.refused)


class Generator:
    """Adds objects of chosen categories to scenes; see :meth:`load` and :meth:`add`."""

    def __init__(self, model: TrainedModel, proposer: Proposer | None = None) -> None:
        self.model = model
        self.contract = model.contract
        self.library = Library(model)
        self.proposer: Proposer = proposer or _proposer(model)

    @staticmethod
    def load(path: str | os.PathLike[str]) -> Generator:
        """A generator with the model of an ONNX file.

        Raises
        ------
        UniSGError
            If the file is missing, no ONNX model, or made for something else.
        """
        return Generator(load_model(path))

    @cached_property
    def behaviour(self) -> ActionPolicy | None:
        """What gives new objects their actions; None if there is no behaviour beside the model."""
        path = behaviour_path(self.model.path)
        return load_behaviour(path) if path.is_file() else None

    @property
    def categories(self) -> tuple[str, ...]:
        """What it can add."""
        return self.contract.vocabulary

    def sample_counts(self, rng: np.random.Generator, scene: SceneGraph | None = None) -> dict[str, int]:
        """How many objects of each category a room has: those of a training scene drawn at random.

        For a ``scene`` that has a floor already, nothing that is building.
        """
        rooms = self.contract.priors.rooms
        counts = rooms[rng.integers(len(rooms))]
        there = scene is not None and (FLOOR in scene.vocabulary or bool(recognise_structure(scene).rooms))
        left_out = STRUCTURE if there else ()
        known = zip(self.categories, counts, strict=True)
        return {name: int(count) for name, count in known if count and name not in left_out}

    def steps(
        self, scene: SceneGraph, counts: Mapping[str, int], seed: int | None = None, *, bulk: bool = False,
        settle: bool = True, assets: Mapping[str, Sequence[Asset]] | None = None, behaviour: bool = True,
        on: str = "", beside: str = "",
    ) -> abc.Generator[Placement, None, Generated]:  # fmt: skip
        """Add objects to a scene, each a step; what is there already stays as it is. :meth:`add` is the same at once.

        Parameters
        ----------
        scene
            Any scenegraph; it may be empty.
        counts
            How many objects of each category. Asked for a "Floor" in a scene in which no room can be
            recognised, the generator starts with a room shell.
        seed
            Same seed, same result; None for another result every time.
        bulk
            Propose places for all objects at once, none of them seeing the others; they are still settled
            one after another.
        settle
            False takes every first proposal as it is, collisions and all.
        assets
            Shapes to use, by category and in order, instead of drawing them from the scene or beside the model.
        behaviour
            Give the new objects actions, and these places in the lesson, as far as a model of behaviour
            lies beside this one.
        on, beside
            uid or name of an object of the scene on which, or beside which, all objects are wanted. What finds
            no room there is refused (on), or stands as near as there is room (beside).

        Raises
        ------
        UniSGError
            For a category that the model does not know, a number below 1, nothing to add or more than
            :data:`MOST_OBJECTS`, an object that is missing, or a model that gives no finite numbers.
        """
        _check_counts(counts, self.contract)
        names, make_uid = Names(scene.name), uid_maker(scene, seed)
        rng = np.random.default_rng(seed)
        before = set(scene.uid)
        wanted = in_order(counts, self.contract.priors)
        placements: list[Placement] = []
        if FLOOR in counts and FLOOR not in scene.vocabulary:
            scene, placements = add_shell(scene, counts, self.library, rng, names, make_uid)
            wanted = [name for name in wanted if name not in STRUCTURE]
            yield from placements
        shapes = {self.categories.index(name): given for name, given in (assets or {}).items() if name in counts}
        numbers = [self.categories.index(name) for name in wanted]
        work = ObjectPlacer(self.proposer, self.library, scene, rng, settle, numbers, shapes, on or beside)
        work.request(on, beside)
        for planned in work.order(bulk):
            placements.append(work.place(planned, names, make_uid))
            yield placements[-1]
        result = extend(scene, work.scene.additions, names, make_uid)
        if behaviour and self.behaviour is not None:
            made = add_behaviour(result, [item.uid for item in placements if item.uid], self.behaviour, make_uid, rng)
            result, placements = made.scene, [_with_behaviour(item, made) for item in placements]
        rows = np.array([row for row, uid in enumerate(result.uid) if uid not in before], np.int64)
        return Generated(result, rows, tuple(placements), len(all_actions(result)) - len(all_actions(scene)))

    add = at_once(steps)


def _proposer(model: TrainedModel) -> Proposer:
    kinds: dict[str, Callable[[TrainedModel], Proposer]] = {
        "anchors": AnchorProposer, "cgvae": CgvaeProposer, "trees": TreesProposer
    }  # fmt: skip
    return kinds[model.contract.kind](model)


def _with_behaviour(item: Placement, made: Behaviour) -> Placement:
    """A placement with the names of its new actions and with notes on those that could not be made."""
    notes = [note for note in (item.note, *made.notes.get(item.uid, ())) if note] if item.uid else [item.note]
    return replace(item, actions=tuple(made.actions.get(item.uid, ())), note="; ".join(notes))


def _check_counts(counts: Mapping[str, int], contract: Contract) -> None:
    if not counts:
        raise UniSGError("nothing to add: give categories and numbers, such as Scalpel=2")
    contract.check_categories(list(counts))
    for name, count in counts.items():
        if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
            raise UniSGError(f"the number of {name!r} must be a whole number from 1 on, not {count!r}")
    if (total := sum(map(int, counts.values()))) > MOST_OBJECTS:
        raise UniSGError(f"{total} objects are too many for one call: add at most {MOST_OBJECTS} at a time")
