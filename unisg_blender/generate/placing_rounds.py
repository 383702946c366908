"""Placing in rounds: what is placed is checked, and for what does not hold another place is looked for."""

from __future__ import annotations

from collections import abc
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..dataset.assets.asset import Asset
from ..geometry.arrays import Floats
from ..scene import SceneGraph
from ..spatial.objects import as_whole
from .check.holding_scene import only_what_holds
from .place.placement_record import Placement
from .place.placer import ObjectPlacer
from .place.scene_extension import Names, UidMaker, extend
from .place.shape_library import Library
from .propose.place_sampling import USUAL, Sampling
from .propose.proposer import Proposer

ROUNDS = 3
"""How often places are looked for, for what the last check takes out."""

Placing = abc.Generator[Placement, None, tuple[SceneGraph, list[Placement]]]
"""Placing object after object: what became of each, and at the end the scene and all of them."""


@dataclass(frozen=True, eq=False)
class How:
    """How objects are wanted, see :meth:`~.generator.Generator.steps`; ``within`` is a point (3,) in their room."""

    bulk: bool
    settle: bool
    assets: Mapping[str, Sequence[Asset]]
    on: str
    beside: str
    within: Floats | None = None
    ways: bool = True
    sampling: Sampling = USUAL
    shapes: Mapping[str, Sequence[Asset]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class New:
    """Where names, identities and chances of new objects come from."""

    names: Names
    make_uid: UidMaker
    rng: np.random.Generator


@dataclass(frozen=True, eq=False)
class PlacingRounds:
    """What places objects: proposals, shapes, ``read`` that says what the model sees of a scene, and the ``room``,
    the scene before anything is placed in it."""

    proposer: Proposer
    library: Library
    read: Callable[[SceneGraph], SceneGraph]
    how: How
    new: New
    room: SceneGraph

    def steps(self, scene: SceneGraph, wanted: Sequence[str]) -> Placing:
        """Place objects of the wanted categories in a scene; what was placed first is yielded, later rounds are not.

        Nothing is checked where nothing is settled. Chosen shapes are placed once: another would take their turn.
        """
        chosen = any(name in self.how.assets for name in wanted)
        rounds, done = 1 if chosen or not self.how.settle else ROUNDS, []
        for left in reversed(range(rounds)):
            if not wanted:
                break
            work, made = self._placer(scene, wanted), []
            for planned in work.order(self.how.bulk):
                made.append(work.place(planned, self.new.names, self.new.make_uid))
                if left == rounds - 1:
                    yield made[-1]
            scene, told = extend(scene, work.scene.additions, self.new.names, self.new.make_uid), made
            if self.how.settle:
                scene, told = only_what_holds(self.room, scene, made, self.how.ways)
            out = [new.refused and not old.refused for old, new in zip(made, told, strict=True)]
            done += [item for item, taken in zip(told, out, strict=True) if not (left and taken)]
            wanted = [item.category for item, taken in zip(told, out, strict=True) if taken]
        return scene, done

    def _placer(self, scene: SceneGraph, wanted: Sequence[str]) -> ObjectPlacer:
        vocabulary, how = self.library.model.contract.vocabulary, self.how
        numbers = [vocabulary.index(name) for name in wanted]
        shapes = {vocabulary.index(name): given for name, given in how.assets.items() if name in wanted}
        seen = as_whole(as_whole(self.read(scene), how.on), how.beside)
        return ObjectPlacer(
            self.proposer,
            self.library.preferring(how.shapes),
            seen,
            self.new.rng,
            how.settle,
            numbers,
            shapes,
            how.on,
            how.beside,
            how.within,
            how.ways,
            how.sampling,
        )
