"""Variations of scenes: what is said varies, the rest stays, and rooms stay as sound as they were."""

from __future__ import annotations

from collections import Counter
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.worlds.digest import digest
from unisg_blender.behaviour import all_actions
from unisg_blender.errors import UniSGError
from unisg_blender.generate import Generator
from unisg_blender.generate.check.scene_check import check_scene
from unisg_blender.generate.variation.removed_things import without_things
from unisg_blender.generate.variation.room_plan import plan_room
from unisg_blender.generate.variation.things import Things
from unisg_blender.generate.variation.variation import Variation
from unisg_blender.generate.variation.variation_file import variation_from
from unisg_blender.generate.variation.varied_room import VariedRoom, known_variation, vary
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.worlds import living_room, operating_room


@cache
def generator() -> Generator:
    return Generator.load(find_generator("living_room"))


@cache
def scene() -> SceneGraph:
    return living_room(3)


@cache
def things() -> Things:
    return Things.of(generator().read(scene()))


def varied(record: dict[str, Any], seed: int = 1, graph: SceneGraph | None = None) -> VariedRoom:
    variation = known_variation(variation_from(record), generator(), {})
    return vary(generator(), graph or scene(), variation, seed, {})


def counts(graph: SceneGraph) -> Counter[str]:
    return Counter(graph.category_name(row) for row in range(len(graph)) if graph.category[row] >= 0)


def stayed(room: VariedRoom, before: SceneGraph) -> set[str]:
    """uids of what has not moved and has the mesh that it had."""
    after = room.scene
    return {
        uid
        for row, uid in enumerate(before.uid)
        if uid in after.row_of_uid
        and np.allclose(after.world[after.row_of_uid[uid]], before.world[row], atol=1e-9)
        and (before.mesh[row] < 0) == (after.mesh[after.row_of_uid[uid]] < 0)
        and (
            before.mesh[row] < 0
            or after.meshes[after.mesh[after.row_of_uid[uid]]].checksum == before.meshes[before.mesh[row]].checksum
        )
    }


def test_nothing_said_leaves_a_scene_as_it_is() -> None:
    assert digest(varied({}).scene) == digest(scene())


@pytest.mark.slow
def test_things_are_placed_anew_as_many_as_there_were() -> None:
    room = varied({"reroll": ["Book", "Cup"], "refused": 0.0})
    assert counts(room.scene) == counts(scene())
    mine = {scene().uid[row] for row in things().rows if things().category[row] in ("Book", "Cup")}
    assert mine
    assert mine & set(room.scene.uid) == set()
    assert stayed(room, scene()) == set(scene().uid) - set(room.gone)
    assert check_scene(room.scene).faults == check_scene(scene()).faults == ()


@pytest.mark.slow
def test_what_is_locked_stays_with_what_it_stands_on() -> None:
    table = next(row for row in things().rows if things().above.get(row) and things().category[row] != "Rug")
    load = scene().name[things().with_load(table)[1]]
    room = varied({"reroll": ["*"], "lock": [load], "refused": 1.0})
    assert {scene().uid[table], scene().uid[scene().name.index(load)]} <= stayed(room, scene())
    assert len(room.gone) > 10


@pytest.mark.slow
def test_things_move_a_little_with_what_stands_on_them() -> None:
    room = varied({"jitter": {"distance": 0.04, "angle": 4}})
    assert set(room.scene.uid) == set(scene().uid)
    assert len(room.moved) > 10
    assert set(scene().uid) - stayed(room, scene()) >= set(room.moved)
    assert check_scene(room.scene).faults == ()
    for row in things().rows:
        uid = scene().uid[row]
        shift = room.scene.world[room.scene.row_of_uid[uid]] @ np.linalg.inv(scene().world[row])
        assert abs(np.degrees(np.arctan2(shift[1, 0], shift[0, 0]))) <= 4.0 + 1e-6
        for other in things().with_load(row)[1:]:
            place = room.scene.row_of_uid[scene().uid[other]]
            moved = room.scene.world[place] @ np.linalg.inv(scene().world[other])
            np.testing.assert_allclose(moved, shift, atol=1e-6)


@pytest.mark.slow
def test_things_get_other_shapes_where_they_stand() -> None:
    room = varied({"swap": ["*"], "shapes": ["model"]})
    assert room.swapped
    for uid in room.swapped:
        old, new = scene().row_of_uid[uid], room.scene.row_of_uid[uid]
        assert room.scene.category_name(new) == scene().category_name(old)
        assert room.scene.name[new] == scene().name[old]
    assert set(scene().uid) - stayed(room, scene()) <= {
        scene().uid[row] for uid in room.swapped for row in [scene().row_of_uid[uid]]
    } | {uid for uid in scene().uid if uid not in room.scene.row_of_uid}
    assert check_scene(room.scene).faults == ()
    assert all_actions(room.scene) == all_actions(scene())


def test_no_lesson() -> None:
    room = varied({"lesson": False})
    assert all_actions(scene())
    assert not all_actions(room.scene)
    assert not room.scene.entries("lsa")


@pytest.mark.slow
def test_the_same_seed_is_the_same_room() -> None:
    record = {"reroll": {"Book": 0.5}, "swap": {"Chair": 0.5}, "counts": {"Cup": [2, 4]}, "jitter": {"distance": 0.02}}
    one, two, other = varied(record, 5), varied(record, 5), varied(record, 6)
    assert digest(one.scene) == digest(two.scene) != digest(other.scene)


@pytest.mark.slow
def test_rooms_from_nothing_are_as_in_training() -> None:
    nothing = SceneBuilder("Room").build()
    room = varied({"counts": {"Book": 0, "Cup": [1, 2]}, "refused": 1.0}, 2, nothing)
    found = counts(room.scene)
    assert found["Book"] == 0
    assert found["Floor"] == 1
    assert len(found) > 10


def test_a_room_that_is_refused_is_drawn_again_and_told() -> None:
    with pytest.raises(UniSGError, match=r"no place for \d+ x Sofa in 2 draws"):
        varied({"counts": {"Sofa": 40}, "tries": 2, "refused": 0.1})


def test_categories_that_the_model_does_not_know() -> None:
    with pytest.raises(UniSGError, match="did you mean 'Sofa'"):
        varied({"counts": {"Soffa": 1}})


@settings(max_examples=60, deadline=None)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_plans_keep_what_is_said(data: st.DataObject, seed: int) -> None:
    names = sorted(set(things().category.values()))
    some = st.lists(st.sampled_from(names), max_size=4, unique=True)
    least, more = data.draw(st.integers(0, 4)), data.draw(st.integers(0, 4))
    counted = data.draw(st.sampled_from(names))
    locked, out, again = data.draw(some), data.draw(some), data.draw(some)
    record = {"lock": locked, "remove": out, "reroll": again, "counts": {counted: [least, least + more]}}
    plan = plan_room(things(), variation_from(record), {}, True, np.random.default_rng(seed))
    gone = set(plan.gone)
    assert not gone & things().named(locked)
    for row in gone:  # with all that stands on it
        assert set(things().with_load(row)) <= gone
    kept = things().count(set(things().rows) - gone)
    before = things().count(things().rows)
    final = {name: kept[name] + plan.wanted.get(name, 0) for name in names}
    assert final[counted] >= least
    if counted not in locked and not any(
        things().named(locked) & set(things().with_load(row)) for row in things().named([counted])
    ):
        assert final[counted] <= least + more
    for name in set(names) - {counted, *out}:
        assert final[name] == before[name]


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 3), number=st.integers(0, 10**6))
def test_nothing_refers_to_what_is_gone(seed: int, number: int) -> None:
    graph = operating_room(seed)
    row = number % len(graph)
    left = without_things(graph, [row]).validate()
    uids, actions = set(left.uid), all_actions(left)
    for action in actions:
        assert {*action.targets, *action.tools, *filter(None, [action.frame])} <= uids
    known = {action.uid for action in actions}
    assert all(set(action.members) <= known for action in actions)
    for _, tree in left.entries("lsa", "data"):
        nodes = list(tree.walk())
        assert {node.action for node in nodes if node.kind == "action"} <= known
        assert {need for node in nodes for need in node.requires} <= {node.uid for node in nodes}
    assert all(target in uids for _, _, target in left.entries("relations", "kind", "target"))


def test_a_variation_is_a_plain_record() -> None:
    assert Variation() == variation_from({})


def test_names_that_mean_nothing_are_told() -> None:
    made = varied({"remove": ["Zebra", "Cup"], "lock": ["Sofa", "Yeti*"]})
    assert made.nothing == ("Zebra", "Yeti*")
    assert varied({"reroll": ["Chair"]}).nothing == ()
