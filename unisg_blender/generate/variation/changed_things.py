"""Things that stay, changed a little: another shape, another place close by; what would not hold stays as it was."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from ...dataset.assets.asset import Asset, object_graph
from ...geometry.arrays import Floats
from ...geometry.planar import turn
from ...scene import SceneGraph
from ...scene.components import MATERIALS
from ...scene.hierarchy import placed, take
from ...scene.identity import derived_uid
from ...scene.merge import append
from ...spatial.object_rows import object_rows
from ...spatial.objects import SceneObjects, scene_objects
from ..check.mesh_check import faults
from ..observe.placeable import Placeable
from .variation import Jitter

DRAWS = 3
"""Times that a change is drawn for a thing at most, before it stays as it was."""

Make = Callable[[SceneGraph, Sequence[str]], SceneGraph]
"""Changes some things, by uid, of a scene."""


def only_sound(before: SceneGraph, groups: Mapping[str, Sequence[str]], make: Make) -> tuple[SceneGraph, list[str]]:
    """A scene with those changes that leave it as sound as it was, and the uids of what was changed.

    Parameters
    ----------
    before
        The scene.
    groups
        By uid of a thing that may change the uids of all that changes with it.
    make
        Changes some of them.
    """
    everyone = [uid for group in groups.values() for uid in group]
    was = faults(before, before, everyone) if everyone else {}
    left = list(groups)
    while left:
        scene = make(before, left)
        said = faults(scene, before, [uid for one in left for uid in groups[one]])
        bad = {uid for uid, reason in said.items() if was.get(uid) != reason}
        if not bad:
            return scene, left
        left = [uid for uid in left if not bad & set(groups[uid])]
    return before, []


def jittered(
    scene: SceneGraph, groups: Mapping[str, Sequence[str]], jitter: Jitter, rng: np.random.Generator
) -> tuple[SceneGraph, list[str]]:
    """The scene with things moved and turned a little on the level, each with all that stands on it."""
    moved: list[str] = []
    for _ in range(DRAWS if jitter.distance or jitter.angle else 0):
        left = {uid: group for uid, group in groups.items() if uid not in moved}
        motions = {uid: _motion(scene.world[scene.row_of_uid[uid]], jitter, rng) for uid in left}
        scene, now = only_sound(scene, left, partial(_moved, motions, left))
        moved += now
    return scene, [each for uid in moved for each in groups[uid]]


def _moved(
    motions: Mapping[str, Floats], groups: Mapping[str, Sequence[str]], scene: SceneGraph, uids: Sequence[str]
) -> SceneGraph:
    """The scene with some things moved, each with its group."""
    rows = sorted((scene.row_of_uid[each], uid) for uid in uids for each in groups[uid])
    world = np.array([motions[uid] @ scene.world[row] for row, uid in rows])
    return placed(scene, [row for row, _ in rows], world)


def _motion(world: Floats, jitter: Jitter, rng: np.random.Generator) -> Floats:
    """A motion (4, 4) about where a thing stands: within a circle, metres, and a turn about the vertical."""
    far, way = jitter.distance * np.sqrt(rng.random()), rng.uniform(0, 2 * np.pi)
    spin = np.radians(rng.uniform(-jitter.angle, jitter.angle))
    there, back = np.eye(4), np.eye(4)
    there[:3, 3] = world[:3, 3] + (far * np.cos(way), far * np.sin(way), 0)
    back[:3, 3] = -world[:3, 3]
    return np.asarray(there @ turn(float(spin)) @ back)


def swapped(
    scene: SceneGraph, uids: Sequence[str], shapes: Callable[[str], Sequence[Asset]], rng: np.random.Generator
) -> tuple[SceneGraph, list[str]]:
    """The scene in which things have other shapes of their category, where they stand, and the uids of these."""
    done: list[str] = []
    for _ in range(DRAWS):
        chosen = {}
        for uid in uids:
            own = object_graph(scene, scene.row_of_uid[uid])
            others = [asset for asset in shapes(uid) if asset.key != own.key]
            if others and uid not in done:
                chosen[uid] = others[int(rng.integers(len(others)))]
        scene, now = only_sound(scene, {uid: [uid] for uid in chosen}, partial(_with_shapes, chosen))
        done += now
    return scene, done


def _with_shapes(chosen: Mapping[str, Asset], scene: SceneGraph, uids: Sequence[str]) -> SceneGraph:
    """The scene in which some things have the shapes that were chosen for them."""
    objects = scene_objects(scene, ())
    places = {uid: _place(objects, number) for number, row in enumerate(objects.row) if (uid := scene.uid[row]) in uids}
    for uid in uids:
        scene = _with_shape(scene, uid, chosen[uid], *places[uid])
    return scene


def _place(objects: SceneObjects, number: int) -> tuple[Floats, bool]:
    """Where a thing stands (4,), as a :class:`~..observe.placeable.Placeable` has it; with its top if it hangs."""
    hangs = objects.relation[number] == "hangs_from"
    height = objects.top[number] if hangs else objects.bottom[number]
    return np.array([*objects.center[number, :2], height, objects.yaw[number]]), hangs


def _with_shape(scene: SceneGraph, uid: str, asset: Asset, place: Floats, hangs: bool) -> SceneGraph:
    """The scene in which a thing has the shape of an asset; its name, its actions and what is said of it stay."""
    row = scene.row_of_uid[uid]
    own = np.flatnonzero(object_rows(scene) == row)
    entity = take(scene, np.array([row]))
    parent = int(scene.parent[row])
    shape = Placeable(asset)
    world = shape.world(place - [0, 0, 2 * shape.half[2] if hangs else 0, 0])
    local = world if parent < 0 else np.linalg.inv(scene.world[parent]) @ world
    graph = asset.graph
    kept = {name: table for name, table in entity.components.items() if name not in _OF_SHAPES}
    kept |= {name: table for name, table in graph.components.items() if name == MATERIALS}
    part = graph.replace(
        name=(scene.name[row], *graph.name[1:]),
        uid=(uid, *(derived_uid(uid, f"{number} {name}") for number, name in enumerate(graph.name[1:]))),
        local=np.concatenate([local[None], graph.local[1:]]),
        components=kept,
    )
    rest = take(scene, np.setdiff1d(np.arange(len(scene)), own))
    return append(rest, [part], [scene.uid[parent] if parent >= 0 else ""])


_OF_SHAPES = ("world", "channels", "animation", "bones", MATERIALS, "parenting")
"""What is said of an entity that another shape of it has not."""
