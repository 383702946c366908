"""What a model knows of a scene: its things in the model's words, and how foreign it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...errors import UniSGError
from ...geometry.arrays import Floats
from ...runtime.wording import some_of
from ...scene import SceneGraph
from ...scene.categories import FLOOR, STRUCTURE
from ...spatial.object_rows import find_objects
from ...spatial.structure import Structure, recognise_structure
from ...spatial.structure.missing_floor import missing_floor
from ...spatial.structure.room_things import things_in_rooms
from ...words import SceneWords, VocabularyMatch, thing_table, understand
from ...words.room_kinds import room_kind
from ...words.vocabulary_match import BROAD, KIND
from .contract import Contract

USUAL = 0.5
"""Share of a model's rooms in which a thing is usual."""

FEW, ENOUGH = 1 / 3, 4
"""Share of known things below which a scene of at least so many things is foreign."""

SHOWN = 6

NO_STRUCTURE = Structure((), (), 0.0, ())


@dataclass(frozen=True, eq=False)
class SceneReading:
    """A scene as a model reads it.

    Attributes
    ----------
    words
        The scene with its categories in the model's vocabulary, and what was understood.
    things
        For each of its objects that is no building the thing that it is, "" where neither category nor name says.
    known
        How many of these the model knows.
    model_kind
        The kind of room that the model makes, "" where its categories do not say.
    rooms
        How many rooms the scene has, of which the things of one are told; 1 where that was not asked.
    present
        The model's category of each of the known things.
    """

    scene: SceneGraph
    words: SceneWords
    things: tuple[str, ...]
    known: int
    model_kind: str
    rooms: int = 1
    present: tuple[str, ...] = ()

    @staticmethod
    def of(
        scene: SceneGraph, contract: Contract, said: Mapping[str, str] | None = None, near: Floats | None = None
    ) -> SceneReading:
        """Read a scene; ``said`` is what the user says of words, see :func:`~...words.understand`.

        Of a house of several rooms the things are those of the room in which new ones would stand: that of the point
        ``near`` (3,), or the largest.
        """
        words = understand(scene, contract.vocabulary, said, contract.priors.sizes)
        graph = words.graph
        rows = find_objects(graph, empty=False).rows.tolist()
        rows = [row for row in rows if graph.category_name(row) not in STRUCTURE]
        nameless = any(not graph.category_name(row) for row in rows)
        built = recognise_structure(graph) if _may_have_rooms(graph, nameless) else NO_STRUCTURE
        rows = [row for row in rows if graph.category_name(row) or row not in built.parts]
        if len(built.rooms) > 1:
            rows = sorted(set(rows) & set(things_in_rooms(built, graph)[_room_used(built, near)]))
        thing_of = {item.row: item.match.thing for item in words.understood}
        known = tuple(name for row in rows if (name := graph.category_name(row)) in contract.vocabulary)
        things = tuple(thing_of.get(row) or graph.category_name(row) for row in rows)
        kind, count = room_kind(_usual(contract)), max(len(built.rooms), 1)
        return SceneReading(scene, words, things, len(known), kind, count, known)

    @property
    def graph(self) -> SceneGraph:
        """The scene in the model's words."""
        return self.words.graph

    @cached_property
    def has_room(self) -> bool:
        """Whether it has a floor, by its categories or by its geometry, or walls that make a room with one."""
        if FLOOR in self.graph.vocabulary or recognise_structure(self.graph).rooms:
            return True
        return self.missing_floor is not None

    @cached_property
    def missing_floor(self) -> Floats | None:
        """The lowest and highest corner (2, 3) of the floor that walls here lack, None where they lack none."""
        return None if FLOOR in self.graph.vocabulary else missing_floor(self.graph)

    @cached_property
    def kind(self) -> str:
        """The kind of room that it looks like, "" where its things do not say."""
        return room_kind(_thing(name) for name in self.things)

    @property
    def is_foreign(self) -> bool:
        """Whether it is of another kind than the model's rooms, or hardly any of its things are known."""
        another = bool(self.kind and self.model_kind and self.kind != self.model_kind)
        return another or (len(self.things) >= ENOUGH and self.known < FEW * len(self.things))

    def lines(self) -> list[str]:
        """How much is known, what was understood, and what was not; nothing where all is known by its own name."""
        count, told = len(self.things), self.words.lines()
        if not count or (self.known == count and not told):
            return self.doubts
        lines = [self.summary]
        if told:
            lines.append(f"understood: {some_of(told, SHOWN)}")
        return lines + ([f"not known: {some_of(self.unknown, SHOWN)}"] if self.unknown else []) + self.doubts

    def report_lines(self) -> list[str]:
        """The same in full, a line for each thing."""
        return [self.summary, *self.words.lines(), *(f"{name}: not known" for name in self.unknown)]

    @property
    def doubts(self) -> list[str]:
        """What is said of a scene that shows something, but no room: is its unit right, has it no floor?"""
        structure = recognise_structure(self.scene)
        indoors = any(room.indoors for room in structure.rooms)
        return [] if indoors or not (self.scene.mesh >= 0).any() else list(structure.notes)

    @property
    def summary(self) -> str:
        """How many things the model knows, and what kind of room it looks like."""
        looks = f"; it looks like {_a(self.kind)}" if self.kind else ""
        where = f"this one of {self.rooms} rooms" if self.rooms > 1 else "the scene"
        return f"{self.known} of {len(self.things)} things in {where} are known to the model{looks}"

    @property
    def unknown(self) -> list[str]:
        """The things that the model does not know, each once."""
        vocabulary = set(self.graph.vocabulary)
        known = {item.match.thing for item in self.words.understood if item.match.category}
        left = [name for name in self.things if name and name not in known]
        return sorted({name for name in left if name in vocabulary or name not in known})

    def to_record(self) -> dict[str, object]:
        """JSON-ready."""
        understood = [
            {"uid": self.scene.uid[item.row], "said": item.said, "category": item.match.category, "how": item.match.how}
            for item in self.words.understood
            if item.match.category
        ]
        return {"things": len(self.things), "known": self.known, "kind": self.kind or None, "understood": understood}


def understood_counts(
    counts: Mapping[str, int], contract: Contract, said: Mapping[str, str] | None = None
) -> dict[str, int]:
    """Counts by the model's categories: "couches" are Sofas; what it does not know has the name of the table of words.

    Raises
    ------
    UniSGError
        For a word that neither knows, or that may mean several of the model's categories.
    """
    words = VocabularyMatch(contract.vocabulary, said)
    found: dict[str, int] = {}
    for name, count in counts.items():
        match = words.match(name)
        placeable = not match.part and has_usual_place(match.thing)
        if match.how == BROAD or (match.how == KIND and not placeable):
            options = " or ".join(repr(option) for option in (match.category, *match.others))
            raise UniSGError(f"the model does not know {name!r}: did you mean {options}?")
        category = match.thing if placeable and match.how in (KIND, "") else match.category
        if not category:
            contract.check_categories([name])
        found[category or name] = found.get(category or name, 0) + count
    return found


def missing_counts(counts: Mapping[str, int], reading: SceneReading) -> dict[str, int]:
    """What a room that already has some things lacks of a whole one; nothing that is building where there is a room.

    Raises
    ------
    UniSGError
        If the scene is foreign to the model, or lacks nothing.
    """
    if not reading.has_room and not reading.things:
        return dict(counts)
    if reading.is_foreign:
        raise UniSGError(why_foreign(reading))
    graph = reading.graph
    there = {name: int((graph.category == number).sum()) for number, name in enumerate(graph.vocabulary)}
    left_out = STRUCTURE if reading.has_room else ()
    left = {name: count - there.get(name, 0) for name, count in counts.items() if name not in left_out}
    found = {name: count for name, count in left.items() if count > 0}
    if not found:
        raise UniSGError("the scene has everything that a whole room has: say what to add (--add)")
    return found


def why_foreign(reading: SceneReading) -> str:
    """What is said of a scene that is foreign to the model."""
    kind = f"looks like {_a(reading.kind)}" if reading.kind else "is foreign to the model"
    made = f"; the model makes {reading.model_kind}s" if reading.model_kind else ""
    where = "room" if reading.rooms > 1 else "scene"
    known = f"{reading.known} of its {len(reading.things)} things are known"
    return f"the {where} {kind}, {known}{made}: say what to add (--add), or take another model"


def _may_have_rooms(graph: SceneGraph, nameless: bool) -> bool:
    """Whether rooms are to be looked for: several floors have their category, or what has none may be the building."""
    floors = sum(graph.category_name(int(row)) == FLOOR for row in np.flatnonzero(graph.mesh >= 0))
    return floors > 1 or (nameless and not floors)


def _room_used(structure: Structure, near: Floats | None) -> int:
    """The number of the room in which new things would stand: that of a point, or the largest one indoors."""
    number = structure.room_at(near) if near is not None else -1
    sizes = [(room.indoors, room.area) for room in structure.rooms]
    return number if number >= 0 else sizes.index(max(sizes))


def _usual(contract: Contract) -> list[str]:
    """The things that most rooms of a model have."""
    rooms = np.array(contract.priors.rooms)
    if not len(rooms):
        return []
    usual: Sequence[bool] = ((rooms > 0).mean(axis=0) >= USUAL).tolist()
    return [_thing(name) for name, often in zip(contract.vocabulary, usual, strict=True) if often]


def has_usual_place(thing: str) -> bool:
    """Whether the table of words says how large a thing is and where it stands."""
    known = thing_table().things.get(thing)
    return known is not None and bool(known.size and known.place)


def _thing(name: str) -> str:
    return thing_table().read(name).thing or name


def _a(kind: str) -> str:
    return f"{'an' if kind[:1] in 'aeiou' else 'a'} {kind}"
