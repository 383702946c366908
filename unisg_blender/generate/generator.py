"""The generator: asks a model where new objects could be, settles them and puts them into the scenegraph."""

from __future__ import annotations

import os
from collections import Counter, abc
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from ..behaviour import all_actions
from ..dataset.assets.asset import Asset
from ..errors import UniSGError
from ..geometry.arrays import Floats, Ints
from ..runtime.steps import at_once
from ..scene import SceneGraph
from ..scene.categories import FLOOR, STRUCTURE
from ..spatial.objects import middle_of
from ..words import understand
from .behaviour import ActionPolicy, Behaviour, add_behaviour, behaviour_path, load_behaviour
from .counts import MOST_OBJECTS
from .observe.named_rooms import point_in_room
from .observe.placement_order import in_order
from .observe.scene_reading import SceneReading, missing_counts, understood_counts
from .place.instanced_scene import with_instances, without_instances
from .place.placed_by_rules import by_rules, contract_with, rules_for
from .place.placement_record import Placement
from .place.room_shell import add_floor, add_shell
from .place.scene_extension import Names, uid_maker
from .place.shape_library import Library
from .placing_rounds import How, New, Placing, PlacingRounds
from .propose.anchor_proposer import AnchorProposer
from .propose.cgvae_proposer import CgvaeProposer
from .propose.place_sampling import USUAL, Sampling
from .propose.proposer import Proposer
from .propose.trained_model import TrainedModel, load_model
from .propose.trees_proposer import TreesProposer

SHELL = (FLOOR, "Wall", "Ceiling")
"""What is never brought into a room that has it."""


@dataclass(frozen=True, eq=False)
class Generated:
    """The extended scene, the rows that are new in it, what became of each object asked for, how many ``actions``
    are new, and how the model read the scene that was there."""

    scene: SceneGraph
    rows: Ints
    objects: tuple[Placement, ...]
    actions: int = 0
    reading: SceneReading | None = None

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

    def read(
        self, scene: SceneGraph, words: Mapping[str, str] | None = None, *, near: str = "", within: str = ""
    ) -> SceneReading:
        """A scene in the model's words, and how foreign it is; ``words`` is what the user says of words. Of a house
        that is the room of an object, ``near``, or the one that ``within`` names, or the largest."""
        shown = with_instances(scene)
        return SceneReading.of(shown, self.contract, words, _point(shown, within, near))

    def understood(self, counts: Mapping[str, int], words: Mapping[str, str] | None = None) -> dict[str, int]:
        """Counts by the model's own categories, see :func:`~.observe.scene_reading.understood_counts`."""
        return understood_counts(counts, self.contract, words)

    def sample_counts(
        self, rng: np.random.Generator, scene: SceneGraph | None = None, words: Mapping[str, str] | None = None
    ) -> dict[str, int]:
        """How many objects of each category a room has: those of a training scene drawn at random.

        For a ``scene`` what it lacks of that: nothing that is building where it has a floor already.

        Raises
        ------
        UniSGError
            If the scene is of another kind than the model's rooms, or has everything.
        """
        rooms = self.contract.priors.rooms
        drawn = zip(self.categories, rooms[rng.integers(len(rooms))], strict=True)
        counts = {name: int(count) for name, count in drawn if count}
        return counts if scene is None else missing_counts(counts, self.read(scene, words))

    def steps(
        self, scene: SceneGraph, counts: Mapping[str, int], seed: int | None = None, *, bulk: bool = False,
        settle: bool = True, assets: Mapping[str, Sequence[Asset]] | None = None, behaviour: bool = True,
        on: str = "", beside: str = "", within: str = "", words: Mapping[str, str] | None = None, ways: bool = True,
        sampling: Sampling = USUAL, shapes: Mapping[str, Sequence[Asset]] | None = None,
    ) -> abc.Generator[Placement, None, Generated]:  # fmt: skip
        """Add objects to a scene, each a step; what is there already stays as it is. :meth:`add` is the same at once.

        Parameters
        ----------
        scene
            Any scenegraph; it may be empty.
        counts
            How many objects of each category, in any words. Asked for a "Floor" in a scene in which no room can be
            recognised, the generator starts with a room shell. What only the table of words knows, is placed by rules.
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
            Give the new objects actions and places in the lesson, if a model of behaviour lies beside this one.
        on, beside
            uid or name of an object of the scene on which, or beside which, all objects are wanted. What finds
            no room there is refused (on), or stands as near as there is room (beside). A group is meant as a whole.
        within
            The room in which all are wanted: "kitchen", or a number, see :func:`~.observe.named_rooms.find_room`.
        words
            What the user says of words for things: word to category, before the table of words.
        ways
            Nothing may cut the floor into parts between which nobody can walk, see :mod:`~.place.ways_kept`.
        sampling, shapes
            How places are drawn; shapes by category to draw from, before those of the scene and beside the model.

        Raises
        ------
        UniSGError
            For a category that is not known in any words, a number below 1, nothing to add or more than
            :data:`MOST_OBJECTS`, an object or a room that is missing, or a model that gives no finite numbers.
        """
        counts = self.understood(_checked(counts), words)
        given, scene = scene, with_instances(scene)
        near = _within(scene, within, on or beside)
        how = How(bulk, settle, assets or {}, on, beside, near, ways, sampling, shapes or {})
        reading = self.read(scene, words, near=on or beside, within=within)
        new = New(Names(scene.name), uid_maker(scene, seed), np.random.default_rng(seed))
        room, placements, wanted = self._with_room(scene, counts, reading, new)
        yield from placements
        rounds = PlacingRounds(self.proposer, self.library, partial(self.seen, words=words), how, new, room)
        result, made = yield from rounds.steps(room, wanted)
        placements += made
        if others := [name for name, count in counts.items() if name not in self.categories for _ in range(count)]:
            result, made = yield from self._by_rules(result, others, rounds, words)
            placements += made
        return self.finished(given, without_instances(result, given, scene), placements, new, reading, behaviour)

    add = at_once(steps)

    def _with_room(
        self, scene: SceneGraph, counts: Mapping[str, int], reading: SceneReading, new: New
    ) -> tuple[SceneGraph, list[Placement], list[str]]:
        """The scene with a room, if one is asked for and none is there, what became of its parts, and what is left of
        what the model knows."""
        placements: list[Placement] = []
        built: Sequence[str] = SHELL if reading.has_room else STRUCTURE if FLOOR in counts else ()
        if reading.has_room:
            refused = Counter({name: counts[name] for name in SHELL if name in counts})
            if reading.missing_floor is not None:
                scene, placements = add_floor(scene, reading.missing_floor, new.names, new.make_uid)
                refused -= Counter([FLOOR])
            placements += [Placement(name, note="there is a room already") for name in refused.elements()]
        elif FLOOR in counts:
            scene, placements = add_shell(scene, counts, self.library, new.rng, new.names, new.make_uid)
        known = {name: count for name, count in counts.items() if name in self.categories}
        return scene, placements, [name for name in in_order(known, self.contract.priors) if name not in built]

    def knowing(self, things: Sequence[str]) -> Generator:
        """One that places by rules what this one does not know, of the table of words; this one where it knows all."""
        kinds = tuple(name for name in dict.fromkeys(things) if name not in self.categories)
        if not kinds:
            return self
        contract = contract_with(self.contract, kinds)
        return Generator(replace(self.model, contract=contract), rules_for(contract, kinds))

    def seen(self, scene: SceneGraph, words: Mapping[str, str] | None = None) -> SceneGraph:
        """A scene in the model's words."""
        return understand(scene, self.contract.vocabulary, words, self.contract.priors.sizes).graph

    def _by_rules(
        self, scene: SceneGraph, things: Sequence[str], rounds: PlacingRounds, words: Mapping[str, str] | None
    ) -> Placing:
        """The scene with things that the model does not know, placed by rules."""
        known = self.knowing(things)
        read = partial(known.seen, words=words)
        placing = replace(rounds, proposer=known.proposer, library=known.library, read=read).steps(scene, things)
        while True:
            try:
                yield by_rules(next(placing))
            except StopIteration as stop:
                result, made = stop.value
                return result, [by_rules(item) for item in made]

    def finished(
        self, before: SceneGraph, result: SceneGraph, placements: list[Placement], new: New,
        reading: SceneReading | None = None, behaviour: bool = True,
    ) -> Generated:  # fmt: skip
        """What came of placing in a scene; with ``behaviour`` what was placed gets its actions."""
        if behaviour:
            result, placements = self._with_actions(result, placements, new)
        known = set(before.uid)
        rows = np.array([row for row, uid in enumerate(result.uid) if uid not in known], np.int64)
        actions = len(all_actions(result)) - len(all_actions(before))
        return Generated(result, rows, tuple(placements), actions, reading)

    def _with_actions(
        self, scene: SceneGraph, placements: list[Placement], new: New
    ) -> tuple[SceneGraph, list[Placement]]:
        """The scene with actions for what was placed, as far as there is a model of behaviour."""
        if self.behaviour is None:
            return scene, placements
        uids = [item.uid for item in placements if item.uid]
        made = add_behaviour(scene, uids, self.behaviour, new.make_uid, new.rng)
        return made.scene, [_with_behaviour(item, made) for item in placements]


def _within(scene: SceneGraph, within: str, thing: str) -> Floats | None:
    """A point in the room that is named, None where none is."""
    return _point(scene, within, thing) if within else None


def _point(scene: SceneGraph, within: str, thing: str) -> Floats | None:
    """A point (3,) in the room in which objects are wanted: a room by its name, or that of a thing; None for any."""
    if within and thing:
        raise UniSGError("give either a room, or an object on or beside which it is wanted")
    return point_in_room(scene, within) if within else middle_of(scene, thing) if thing else None


def _proposer(model: TrainedModel) -> Proposer:
    kinds: dict[str, Callable[[TrainedModel], Proposer]] = {
        "anchors": AnchorProposer, "cgvae": CgvaeProposer, "trees": TreesProposer
    }  # fmt: skip
    return kinds[model.contract.kind](model)


def _with_behaviour(item: Placement, made: Behaviour) -> Placement:
    """A placement with the names of its new actions and with notes on those that could not be made."""
    notes = [note for note in (item.note, *made.notes.get(item.uid, ())) if note] if item.uid else [item.note]
    return replace(item, actions=tuple(made.actions.get(item.uid, ())), note="; ".join(notes))


def _checked(counts: Mapping[str, int]) -> Mapping[str, int]:
    if not counts:
        raise UniSGError("nothing to add: give categories and numbers, such as Scalpel=2")
    for name, count in counts.items():
        if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
            raise UniSGError(f"the number of {name!r} must be a whole number from 1 on, not {count!r}")
    if (total := sum(map(int, counts.values()))) > MOST_OBJECTS:
        raise UniSGError(f"{total} objects are too many for one call: add at most {MOST_OBJECTS} at a time")
    return counts
