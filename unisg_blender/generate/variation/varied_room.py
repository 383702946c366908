"""A variation of a scene, or a room from nothing, as a file of what varies says."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from ...dataset.assets.asset import Asset
from ...dataset.assets.asset_file import Assets
from ...dataset.format.reader import open_dataset
from ...errors import UniSGError
from ...runtime.wording import some_of
from ...scene import SceneGraph
from ...scene.hierarchy import subtree
from ..generator import Generated, Generator
from .changed_things import jittered, swapped
from .removed_things import without_lesson, without_things
from .room_plan import plan_room
from .things import Things
from .variation import Variation

MODEL, OWN = "model", "scene"
"""Where shapes come from, beside folders of datasets."""


@dataclass(frozen=True, eq=False)
class VariedRoom:
    """A variation: what was ``generated`` into it, uids of what was taken out of its scene, has another shape, or was
    moved, how often it was ``redrawn`` because too much found no place, and which names mean ``nothing`` there."""

    generated: Generated
    gone: tuple[str, ...] = ()
    swapped: tuple[str, ...] = ()
    moved: tuple[str, ...] = ()
    redrawn: int = 0
    nothing: tuple[str, ...] = ()

    @property
    def scene(self) -> SceneGraph:
        """The room."""
        return self.generated.scene


def known_variation(variation: Variation, generator: Generator, words: Mapping[str, str]) -> Variation:
    """The variation with counts by the model's categories; UniSGError for a category that the model does not know."""
    counts = {}
    for name, count in variation.counts.items():
        (known,) = generator.understood({name: 1}, words)
        counts[known] = count
    return replace(variation, counts=counts)


def vary(
    generator: Generator, scene: SceneGraph, variation: Variation, seed: int, how: Mapping[str, Any],
    add: Mapping[str, int] | None = None,
) -> VariedRoom:  # fmt: skip
    """A variation of a scene by its seed; what nothing is said of stays as it is.

    Parameters
    ----------
    variation
        What varies, see :func:`known_variation`.
    how
        Further arguments of :meth:`~..generator.Generator.add`.
    add
        What is added beside, by category.

    Raises
    ------
    UniSGError
        If in none of ``variation.tries`` draws enough of what was to be added found a place, or as
        :meth:`~..generator.Generator.add`.
    """
    reading = generator.read(scene, how.get("words"), within=how.get("within", ""))
    things = Things.of(reading)
    for tried in range(variation.tries):
        number = seed if tried == 0 else int(np.random.SeedSequence([seed, tried]).generate_state(1)[0])
        training = generator.sample_counts(np.random.default_rng(number))
        rng = np.random.default_rng([number, 1])
        plan = plan_room(things, variation, training, reading.has_room, rng)
        wanted = dict(Counter(plan.wanted) + Counter(add or {}))
        room = _changed(generator, scene, things, plan.gone, variation, rng)
        made = generator.add(room.scene, wanted, number, **how) if wanted else room.generated
        if len(made.refused) <= variation.refused * sum(wanted.values()):
            if not variation.lesson:
                made = replace(made, scene=without_lesson(made.scene), actions=0)
            names = dict.fromkeys((*variation.remove, *variation.reroll, *variation.swap, *variation.lock))
            nothing = tuple(name for name in names if not things.named((name,)))
            return replace(room, generated=made, redrawn=tried, nothing=nothing)
    found = Counter(item.category for item in made.refused)
    missing = some_of(f"{many} x {name}" for name, many in found.items())
    raise UniSGError(f"no place for {missing} in {variation.tries} draws: ask for fewer, or let 'refused' be more")


def _changed(
    generator: Generator, scene: SceneGraph, things: Things, gone: Sequence[int], variation: Variation,
    rng: np.random.Generator,
) -> VariedRoom:  # fmt: skip
    """The scene without what goes, and with what stays changed a little."""
    out = set(gone)
    lost = sorted({scene.uid[below] for row in gone for below in subtree(scene, row).tolist()})
    room = without_things(scene, gone)
    free = [row for row in things.rows if row not in out | things.named(variation.lock)]
    alone = [row for row in free if _is_alone(scene, things, row)]
    to_swap = [scene.uid[row] for row in things.chosen(variation.swap, rng) if row in alone]
    category = {scene.uid[row]: things.category[row] for row in things.rows}
    sources = variation.shapes
    room, other = swapped(room, to_swap, lambda uid: _shapes(generator, scene, category[uid], sources), rng)
    loads = {row: things.with_load(row) for row in free}
    carried = {each for load in loads.values() for each in load[1:]}
    movable = things.named(variation.jitter.things)
    groups = {
        scene.uid[row]: [scene.uid[each] for each in load]
        for row, load in loads.items()
        if row in movable - carried and set(load) <= set(free)
    }
    room, moved = jittered(room, groups, variation.jitter, rng)
    empty = Generated(room, np.zeros(0, np.int64), ())
    return VariedRoom(empty, tuple(lost), tuple(other), tuple(moved))


def _is_alone(scene: SceneGraph, things: Things, row: int) -> bool:
    """Whether nothing stands on a thing, and no other hangs under it in the hierarchy."""
    below = subtree(scene, row)
    return len(things.with_load(row)) == 1 and bool((scene.category[below[1:]] < 0).all())


def _shapes(generator: Generator, scene: SceneGraph, category: str, sources: Sequence[str]) -> list[Asset]:
    """The shapes that there are of a category."""
    found: list[Asset] = []
    for source in sources:
        if source == OWN:
            found += [shape.asset for shape in generator.library.of_scene(category, scene)]
        elif source == MODEL:
            found += [shape.asset for shape in generator.library.of_model(category)]
        elif (assets := _dataset_assets(source)) is not None:
            found += [assets.asset(number) for number in assets.numbers(category)]
    return found


@lru_cache(maxsize=8)
def _dataset_assets(path: str) -> Assets | None:
    return open_dataset(path).assets()
