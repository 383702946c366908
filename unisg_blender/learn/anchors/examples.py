"""Training examples for the anchor model: a scene, one object in it as the target, and what of the rest is there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from torch import Tensor
from torch.utils.data import Dataset

from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.placement_order import along, middles
from ...generate.observe.prior_tables import PriorTables
from ...generate.observe.scene_tokens import chain, coming_vector, context_arrays, plan_vector, tokens_for
from ...generate.observe.support_candidates import Proximity, SupportCandidates, SupportOccupancy, support_arrays
from ..padding import padded_stack
from ..training_scenes import TrainingScene

RANDOM_SUBSETS = 0.25
"""Share of examples in which any other objects may be missing; in the rest the scene is built up in order."""

BALANCE = 0.75
"""How far all categories of a scene are targets equally often: 0 as often as they occur, 1 equally often."""

FLOOR = 1.5
"""How much more often what stands on the floor is a target: whatever goes on it depends on where it is."""

BUILDING = 0.25
"""How much less often walls, doors and windows are targets: they are seldom asked for one by one."""

BARE = 0.1
"""Share of examples in which parts of the building may be missing too; in the rest it is there before anything else."""

LESS = 0.2
"""Share of examples in which less is still to come than is missing: a user may ask for less than a whole room."""

JITTER, TURN_JITTER, DEQUANTISE, TURN_DEQUANTISE = 0.005, 0.02, 0.004, 0.0087
"""Metres and radians by which what is there and the target are moved, on supports of a metre and more.

The building is not turned: the far end of a wall would move by centimetres, and with it what stands along it.
"""


class RoomLayout:
    """A training scene with all that does not change from example to example."""

    def __init__(self, scene: TrainingScene, tables: PriorTables) -> None:
        self.scene = ObservedScene.of(scene.objects, scene.world)
        support, category = self.scene.support, self.scene.category
        count = len(support)
        self.targets = np.flatnonzero((category >= 0) & (self.scene.half.max(axis=1) > 0) & (support >= 0))
        _, kind, times = np.unique(category[self.targets], return_inverse=True, return_counts=True)
        self.building = tables.structural[category]
        self.floor = (support >= 0) & (support[support] < 0)
        chance = times[kind] ** -BALANCE * np.where(self.floor[self.targets], FLOOR, 1.0)
        chance *= np.where(self.building[self.targets], BUILDING, 1.0)
        self.chance = chance / chance.sum()
        self.above = np.zeros((count, count), bool)
        for obj in range(count):
            self.above[obj, chain(support, obj)] = True
        carriers = np.union1d(np.flatnonzero(tables.holding.any(axis=0)[category]), support[support >= 0])
        self.candidates = SupportCandidates.of(self.scene, carriers)
        self.nearness = Proximity.of(self.scene)
        self.truth = self.candidates.at(support, self.scene.surface)
        share = along(self.scene)
        middle = middles(self.scene, share)
        block = np.array([middle.get((s, c), 0.0) for s, c in zip(support, category, strict=True)])
        self.row = np.empty(count, np.int64)
        self.row[np.lexsort((share, category, block, ~tables.carriers[category]))] = np.arange(count)
        self.away = _away(self.scene, tables.leading[category])
        _ = self.scene.room  # found once, before the scene is copied with objects moved
        self.group, self.rank = tables.level[category], tables.rank[category]


def _away(scene: ObservedScene, reference: NDArray[np.bool_]) -> NDArray[np.float64]:
    """How far each object is from the nearest reference object, in 0..1 (K,); 0 in a scene without reference objects.

    Of alike objects the nearer one is placed first: one infusion pole belongs to the table, the other is spare.
    """
    if not reference.any():
        return np.zeros(len(reference))
    distance = np.linalg.norm(scene.center[:, None, :2] - scene.center[reference, :2], axis=2).min(axis=1)
    return distance / (1 + distance)


class AnchorExamples(Dataset[dict[str, Any]]):
    """Examples by number, drawn anew each time, the same for the same seed.

    Parameters
    ----------
    layouts
        Scenes to learn from.
    tables
        What the training scenes teach of the categories.
    count
        Examples in an epoch.
    fresh
        Other examples in every epoch; False for a fixed set to validate on.
    """

    def __init__(self, layouts: Sequence[RoomLayout], tables: PriorTables, count: int, seed: int, fresh: bool) -> None:
        self.layouts = [layout for layout in layouts if len(layout.targets)]
        self.tables, self.count, self.seed, self.asked = tables, count, seed, 0
        self.fixed = None if fresh else [self._draw(number) for number in range(count)]

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, index: int) -> dict[str, Any]:
        if self.fixed is not None:
            return self.fixed[index]
        self.asked += 1
        return self._draw(self.asked, index)

    def _draw(self, *number: int) -> dict[str, Any]:
        """The same for the same numbers; processes that share an epoch ask for different ones."""
        rng = np.random.default_rng((self.seed, *number))
        layout = self.layouts[int(rng.integers(len(self.layouts)))]
        return example(layout, int(rng.choice(layout.targets, p=layout.chance)), self.tables, rng)


def visible_with(
    layout: RoomLayout, target: int, rng: np.random.Generator
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], bool]:
    """What is there when the target's support is chosen, and when it is placed, each bool (K,); is that in order?"""
    count, in_order = len(layout.row), bool(rng.random() >= RANDOM_SUBSETS)
    if not in_order:
        chosen = placed = rng.random(count) < rng.random()
    else:
        before, group = layout.group < layout.group[target], layout.group == layout.group[target]
        tie, support = rng.random(count), layout.scene.support
        chosen = before | (group & (layout.rank + tie < layout.rank[target] + tie[target]))
        turn = rng.random(count)[support]
        within = np.where(layout.floor, layout.rank + layout.away + tie / 1000, layout.row)
        earlier = np.where(support == support[target], within < within[target], turn < turn[target])
        placed = before | (group & earlier)
    if rng.random() >= BARE and not layout.building[target]:
        chosen, placed = chosen | layout.building, placed | layout.building
    return _standing(layout, chosen, target), _standing(layout, placed, target), in_order


def _standing(layout: RoomLayout, seen: NDArray[np.bool_], target: int) -> NDArray[np.bool_]:
    """Those of the objects seen that something seen holds; what holds the target always, the target never."""
    seen = seen | layout.above[target]
    seen[target] = False
    missing = ~seen
    return seen & ~layout.above[:, missing].any(axis=1)


def example(layout: RoomLayout, target: int, tables: PriorTables, rng: np.random.Generator) -> dict[str, Any]:
    """One example: inputs of the model and the true candidate, height, position and heading."""
    scene, unknown = layout.scene, len(tables.rank) - 1
    category, parent, surface = int(scene.category[target]), int(scene.support[target]), int(scene.surface[target])
    chosen, placed, in_order = visible_with(layout, target, rng)
    fewer = rng.random() ** 2 if rng.random() < LESS else 1.0
    whole = in_order and fewer == 1.0
    kept = rng.random(len(placed)) < fewer
    half = scene.half[target]
    bottom = scene.center[target, 2] - half[2]
    scale = float(np.clip(scene.half[parent, :2].max(), 0.1, 1.0))
    here = kept & ~placed & (scene.support == parent) & (scene.category >= 0)
    here[target] = False
    area = float(4 * (scene.half[here, 0] * scene.half[here, 1]).sum())
    coming = Counter(scene.category[here].tolist())
    moved = shaken(scene, rng, scale, layout.building)
    tokens = tokens_for(moved, placed, parent, surface, bottom, half)
    position = scene.center[target, :2] + scale * rng.uniform(-DEQUANTISE, DEQUANTISE, 2)
    return {
        "target_category": category,
        "target_half": half.astype(np.float32),
        "target_bottom": np.float32(bottom - scene.room.ground),
        "plan": plan_vector(scene, placed, category, parent, surface, half, coming, area, whole),
        "row": coming_vector(coming, unknown),
        "whole": np.float32(whole),
        **context_arrays(moved, tokens, category, parent, surface, unknown),
        **_choice(layout, target, chosen, kept, tables, rng),
        "position": position.astype(np.float32),
        "heading": np.float32(scene.yaw[target] + rng.uniform(-TURN_DEQUANTISE, TURN_DEQUANTISE)),
    }


def _choice(
    layout: RoomLayout, target: int, seen: NDArray[np.bool_], kept: NDArray[np.bool_], tables: PriorTables,
    rng: np.random.Generator,
) -> dict[str, Any]:  # fmt: skip
    """The choice of the candidate among those of the objects that are there and of the usual kinds."""
    scene, unknown = layout.scene, len(tables.rank) - 1
    category, parent = int(scene.category[target]), int(scene.support[target])
    usual = seen & tables.holding[category][scene.category]
    usual[parent] = True
    among = np.flatnonzero(usual[layout.candidates.obj])
    near = layout.nearness.by_kind(scene, seen, unknown)
    arrays = support_arrays(
        scene, layout.candidates, SupportOccupancy.of(scene, seen), near, category, scene.half[target], unknown
    )
    later = kept & ~seen & (scene.category >= 0)
    later[target] = False
    height = scene.center[target, 2] - scene.half[target, 2] - (scene.center[parent, 2] - scene.half[parent, 2])
    return {
        **{name: array[among] for name, array in arrays.items()},
        "coming": coming_vector(Counter(scene.category[later].tolist()), unknown),
        "parent": int(np.searchsorted(among, layout.truth[target])),
        "kind": scene.category[layout.candidates.obj[among]],
        "height": np.float32(height + rng.uniform(-0.002, 0.002)),
    }


def shaken(scene: ObservedScene, rng: np.random.Generator, scale: float, building: NDArray[np.bool_]) -> ObservedScene:
    """The scene with each object a little moved, and turned unless it is part of the ``building``, bool (K,).

    ``scale``, metres, is the size of the support that is looked at: the smaller, the less they are moved.
    """
    shift = np.zeros_like(scene.center)
    shift[:, :2] = rng.uniform(-JITTER * scale, JITTER * scale, (len(shift), 2))
    yaw = scene.yaw + np.where(building, 0.0, rng.uniform(-TURN_JITTER, TURN_JITTER, len(scene.yaw)))
    return replace(scene, center=scene.center + shift, yaw=yaw)


CUTS = (14,)
"""A batch is cut into parts of up to so many tokens, since padding costs time."""


def collate(examples: Sequence[dict[str, Any]]) -> list[dict[str, Tensor]]:
    """A batch in parts of alike numbers of tokens, each padded, with ``mask`` and ``support_mask``."""
    part = np.digitize([len(item["category"]) for item in examples], CUTS, right=True)
    return [padded([examples[i] for i in np.flatnonzero(part == number)]) for number in np.unique(part)]


def padded(examples: Sequence[dict[str, Any]]) -> dict[str, Tensor]:
    """Examples as one padded batch."""
    batch = {name: padded_stack([item[name] for item in examples]) for name in examples[0]}
    for mask, name in (("mask", "category"), ("support_mask", "support_category")):
        batch[mask] = padded_stack([np.ones(len(item[name]), np.float32) for item in examples])
    return batch
