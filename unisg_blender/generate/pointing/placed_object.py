"""What was pointed at becomes part of the scene: one object more, with actions if that is wished."""

from __future__ import annotations

import numpy as np

from ..generator import Generated
from ..place.instanced_scene import without_instances
from ..place.placement_record import Placement
from ..place.scene_extension import Addition, Names, extend, uid_maker
from ..placing_rounds import New
from .ghosts import Ghost
from .placing_room import PlacingRoom


def place_ghost(room: PlacingRoom, ghost: Ghost, seed: int | None = None, behaviour: bool = True) -> Generated:
    """The scene with the thing where its ghost is; what is wrong there is noted, and does not hinder.

    Parameters
    ----------
    seed
        Same seed, same identity and actions; None for others every time.
    behaviour
        Give it the actions that the lesson lacks, as far as a model of behaviour lies beside this one.
    """
    new = New(Names(room.graph.name), uid_maker(room.shown, seed), np.random.default_rng(seed))
    category, support = room.wanted.category, ghost.support
    name, holder = new.names.new(category), room.scene.labels[support] if support >= 0 else None
    relation = room.scene.support(room.target.category, support).prior.relation
    asset, uid = room.target.placeable.asset, new.make_uid(category)
    addition = Addition(asset, uid, name, holder.uid if holder else "", ghost.world, category, relation)
    result = without_instances(extend(room.shown, [addition], new.names, new.make_uid), room.graph, room.shown)
    note = "; ".join((*ghost.wrong, *filter(None, [ghost.note])))
    placement = Placement(
        category, name, uid, holder.name if holder else "", ghost.world, note=note, source=asset.source
    )
    return room.generator.finished(room.graph, result, [placement], new, behaviour=behaviour)
