"""Place objects that a scene has already anew, by the model, each seeing all others; the rest stays where it is."""

from __future__ import annotations

from collections import abc
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..dataset.assets.asset import object_graph
from ..geometry.arrays import Floats
from ..runtime.steps import at_once
from ..scene import SceneGraph, placed, take
from ..scene.categories import STRUCTURE
from ..scene.hierarchy import subtree
from ..spatial.object_rows import object_rows
from ..spatial.objects import SceneObjects, middle_of, scene_objects
from ..spatial.structure import recognise_structure
from ..words import understand
from .check.mesh_check import faults
from .generator import Generator
from .place.instanced_scene import with_instances
from .place.placement_record import Placement
from .place.settle_existing import held_by, kept_by_locks
from .propose.place_sampling import USUAL, Sampling

TRIES, NEW = 4, 0.1
"""Draws at most until an object stands elsewhere, and metres, or radians of turn, from which on it does."""


@dataclass(frozen=True, eq=False)
class Rerolled:
    """What became of one object: its row, its ``world`` matrix (4, 4) now, its ``carrier`` (name, "" for the ground),
    the rows of what moves ``along`` with it, and a ``note`` if it stays where it was."""

    row: int
    world: Floats
    carrier: str = ""
    along: tuple[int, ...] = ()
    note: str = ""


def reroll_steps(
    generator: Generator, graph: SceneGraph, rows: Iterable[int], seed: int, words: Mapping[str, str] | None = None,
    sampling: Sampling = USUAL,
) -> abc.Generator[Rerolled, None, list[Rerolled]]:  # fmt: skip
    """Each object a step; :func:`reroll_rows` is the same at once.

    New places for the objects at some rows, the largest first; what stands on them and is not among them moves along.
    What is building, locked or carries something locked, unknown to the model, or finds no place stays, with a note. An
    object of a house stays in its room.
    """
    shown, found = with_instances(graph), []
    owner = object_rows(shown)
    wanted = sorted({int(owner[shown.row_of_uid[graph.uid[row]]]) for row in rows} - {-1})
    objects = scene_objects(shown, ())
    number = {int(row): place for place, row in enumerate(objects.row)}
    kept = kept_by_locks(shown, objects, [number[row] for row in wanted if row in number])
    size = {row: float(objects.half[number[row]].prod()) if row in number else 0.0 for row in wanted}
    rng = np.random.default_rng(seed)
    for row in sorted(wanted, key=lambda each: -size[each]):
        note = kept.get(number.get(row, -1), "")
        along = _along(objects, number[row], wanted) if row in number else ()
        item = Rerolled(row, shown.world[row], note=note)
        if not note:
            item = _placed_anew(generator, shown, row, along, rng, words, sampling)
        if not item.note:
            shown = _moved(shown, item)
        item = _of_given(item, shown, graph)
        yield item
        found.append(item)
    return found


reroll_rows = at_once(reroll_steps)


def _along(objects: SceneObjects, obj: int, wanted: list[int]) -> tuple[int, ...]:
    """The rows of what stands on an object and moves along: not what is placed anew itself, nor what stands on that."""
    others = [other for other in range(len(objects)) if int(objects.row[other]) in wanted and other != obj]
    left = {each for other in others for each in (other, *held_by(objects, other))}
    return tuple(int(objects.row[other]) for other in held_by(objects, obj) if other not in left)


def _placed_anew(
    generator: Generator, graph: SceneGraph, row: int, along: tuple[int, ...], rng: np.random.Generator,
    words: Mapping[str, str] | None, sampling: Sampling,
) -> Rerolled:  # fmt: skip
    """One object at another place that holds, what moves along included; the last draw counts if none is far away."""
    read = understand(graph, generator.categories, words, generator.contract.priors.sizes).graph
    category = read.category_name(row)
    if category in STRUCTURE or category not in generator.categories:
        why = "it is building" if category in STRUCTURE else "the model does not know what it is"
        return Rerolled(row, graph.world[row], note=why)
    gone = {int(each) for top in (row, *along) for each in subtree(graph, top)}
    rest = take(graph, np.array([each for each in range(len(graph)) if each not in gone], np.int64))
    asset, room = object_graph(read, row), _room_of(generator, rest, graph, row)
    best = Rerolled(row, graph.world[row], note="no free place was found")
    for _ in range(TRIES):
        made = generator.add(
            rest, {category: 1}, int(rng.integers(2**31)), assets={category: [asset]}, behaviour=False,
            within=room, words=words, sampling=sampling,
        )  # fmt: skip
        new = _as_rerolled(row, along, made.objects[-1], graph)
        if new.note or (along and _spoils(graph, new)):
            continue
        best = new
        if _differs(graph.world[row], new.world):
            break
    return best


def _as_rerolled(row: int, along: tuple[int, ...], placement: Placement, graph: SceneGraph) -> Rerolled:
    if placement.world is None:
        return Rerolled(row, graph.world[row], note=placement.note)
    return Rerolled(row, placement.world, placement.support, along)


def _room_of(generator: Generator, rest: SceneGraph, graph: SceneGraph, row: int) -> str:
    """The number of the room that an object is in, "" where there is one only."""
    if generator.read(rest).rooms <= 1:
        return ""
    middle = middle_of(graph, graph.uid[row])
    number = -1 if middle is None else recognise_structure(rest).room_at(middle)
    return str(number) if number >= 0 else ""


def _of_given(item: Rerolled, shown: SceneGraph, graph: SceneGraph) -> Rerolled:
    """With the rows of the scene that was given, which has no row for what its instances show."""
    rows = [graph.row_of_uid.get(shown.uid[each], -1) for each in (item.row, *item.along)]
    return replace(item, row=rows[0], along=tuple(each for each in rows[1:] if each >= 0))


def _moved(graph: SceneGraph, item: Rerolled) -> SceneGraph:
    """The scene with an object at its new place, and what stands on it."""
    shift = item.world @ np.linalg.inv(graph.world[item.row])
    rows = [item.row, *item.along]
    return placed(graph, rows, np.array([item.world, *(shift @ graph.world[each] for each in item.along)]))


def _spoils(graph: SceneGraph, item: Rerolled) -> bool:
    """Whether what moves along would be in something, outside or in the way where it was not before."""
    uids = [graph.uid[each] for each in item.along]
    before = faults(graph, graph, uids)
    return any(uid not in before for uid in faults(_moved(graph, item), graph, uids))


def _differs(before: Floats, after: Floats) -> bool:
    """Whether an object stands elsewhere, or is turned."""
    apart = float(np.linalg.norm(after[:3, 3] - before[:3, 3]))
    axes = [matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0) for matrix in (before, after)]
    turned = float(np.arccos(np.clip((np.trace(axes[0].T @ axes[1]) - 1) / 2, -1, 1)))
    return apart >= NEW or turned >= NEW
