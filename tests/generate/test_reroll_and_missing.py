"""Objects get other places by the model while the rest stays; what a room lacks is told; what is locked stays."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.generate import Generator
from unisg_blender.generate.check.mesh_check import faults
from unisg_blender.generate.check.settled_scene import settle_rows
from unisg_blender.generate.observe.missing_things import suggestions
from unisg_blender.generate.rerolled_scene import Rerolled, reroll_rows
from unisg_blender.pretrained import shipped_generators
from unisg_blender.scene import SceneGraph, placed, take
from unisg_blender.scene.hierarchy import subtree
from unisg_blender.scene.structure_marks import LOCK, with_marks
from unisg_blender.worlds import living_room


@cache
def generator() -> Generator:
    return Generator.load(next(path for path in shipped_generators() if path.stem == "living_room"))


@cache
def room() -> SceneGraph:
    return living_room(3)


def row_of(category: str, graph: SceneGraph | None = None) -> int:
    graph = graph or room()
    return next(row for row in range(len(graph)) if graph.category_name(row) == category)


def anew(rows: list[int], graph: SceneGraph | None = None, seed: int = 1) -> list[Rerolled]:
    return reroll_rows(generator(), graph or room(), rows, seed)


def moved(graph: SceneGraph, found: list[Rerolled]) -> SceneGraph:
    for item in found:
        shift = item.world @ np.linalg.inv(graph.world[item.row])
        worlds = [item.world, *(shift @ graph.world[row] for row in item.along)]
        graph = placed(graph, [item.row, *item.along], np.array(worlds))
    return graph


def test_a_thing_gets_another_place_that_holds() -> None:
    row = row_of("Chair")
    (item,) = anew([row])
    assert (item.row, item.note) == (row, "")
    assert np.linalg.norm(item.world[:3, 3] - room().world[row][:3, 3]) > 0.1
    assert faults(moved(room(), [item]), room(), [room().uid[row]]) == {}
    assert np.linalg.det(item.world[:3, :3]) == pytest.approx(np.linalg.det(room().world[row][:3, :3]))


def test_the_same_seed_gives_the_same_places() -> None:
    first, second = (anew([row_of("Chair")], seed=5)[0].world for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_what_stands_on_it_moves_along() -> None:
    row = row_of("Coffee Table")
    (item,) = anew([row])
    assert item.note == ""
    assert item.along
    after, uids = moved(room(), [item]), [room().uid[each] for each in item.along]
    assert set(faults(after, room(), uids)) <= set(faults(room(), room(), uids))


def test_what_is_building_or_unknown_or_locked_stays_with_a_note() -> None:
    floor, chair, table = row_of("Floor"), row_of("Chair"), row_of("Coffee Table")
    assert [item.note for item in anew([floor])] == ["it is building"]
    locked = with_marks(room(), LOCK, {chair: "yes"})
    (item,) = anew([chair], locked)
    assert item.note == "it is locked"
    np.testing.assert_array_equal(item.world, room().world[chair])
    (along, *_) = anew([table])[0].along
    (item,) = anew([table], with_marks(room(), LOCK, {along: "yes"}))
    assert item.note == f"{room().name[along]} on it is locked"


def test_what_is_locked_is_not_settled_and_in_nobodys_way() -> None:
    chair = row_of("Chair")
    up = room().world[chair].copy()
    up[2, 3] += 0.7
    high = placed(room(), [chair], up[None])
    assert [item.note for item in settle_rows(high, [chair])] == [""]
    (item,) = settle_rows(with_marks(high, LOCK, {chair: "yes"}), [chair])
    assert item.note == "it is locked"
    np.testing.assert_allclose(item.world, up)
    for open_word in ("no", "0", "False"):
        assert [item.note for item in settle_rows(with_marks(high, LOCK, {chair: open_word}), [chair])] == [""]


def without(category: str) -> SceneGraph:
    gone = {
        int(row) for top in range(len(room())) if room().category_name(top) == category for row in subtree(room(), top)
    }
    return take(room(), np.array([row for row in range(len(room())) if row not in gone]))


def test_what_is_missing_is_told_likeliest_first() -> None:
    found = suggestions(generator().read(without("Sofa")), generator().contract)
    assert found[0].category == "Sofa"
    assert found[0].count == 0
    shares = [item.share for item in found]
    assert shares == sorted(shares, reverse=True)
    assert all(0 < share <= 1 for share in shares)
    assert not {"Floor", "Wall", "Door"} & {item.category for item in found}
    complete = {item.category: item.share for item in suggestions(generator().read(room()), generator().contract)}
    assert complete.get("Sofa", 0) < found[0].share


def test_a_room_of_another_kind_is_told_as_such() -> None:
    foreign = SimpleNamespace(is_foreign=True, known=1, things=("Drill",) * 9, kind="workshop", model_kind="", rooms=1)
    with pytest.raises(UniSGError, match="looks like a workshop, 1 of its 9 things are known"):
        suggestions(foreign, generator().contract)
