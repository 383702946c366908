"""Uids: unique, stable, and right for copies that carry their original's."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from unisg_blender.scene import ActionData, SceneBuilder
from unisg_blender.scene.identity import derived_uid, new_uid, resolve_uids

SCENES = st.lists(st.tuples(st.sampled_from(["", "", "u", "v"]), st.text("ab1", max_size=3)), max_size=12)


@given(SCENES)
def test_resolved_uids_are_unique_and_keep_the_owners(scene: list[tuple[str, str]]) -> None:
    stored, names = [uid for uid, _ in scene], [name for _, name in scene]
    uids = resolve_uids(stored, names)
    assert len(set(uids)) == len(uids)
    assert {uid for uid in stored if uid} <= set(uids)
    assert resolve_uids(uids, names) == uids


@given(st.lists(st.text("abc", max_size=3), unique=True, max_size=8), st.randoms())
def test_uids_do_not_depend_on_the_order_of_rows(names: list[str], random) -> None:
    stored = [random.choice(["", "u"]) for _ in names]
    rows = list(range(len(names)))
    random.shuffle(rows)
    uids = resolve_uids(stored, names)
    shuffled = resolve_uids([stored[row] for row in rows], [names[row] for row in rows])
    assert shuffled == [uids[row] for row in rows]


def test_the_first_name_keeps_the_uid() -> None:
    uids = resolve_uids(["u", "u", "u"], ["Cube.010", "Cube.002", "Cube.001"])
    assert uids == [derived_uid("u", "Cube.010"), derived_uid("u", "Cube.002"), "u"]


def test_copied_actions_point_to_the_copied_targets() -> None:
    cut = ActionData("cut", "Use", targets=("knee", "lamp"), tools=("knife",), frame="knee")
    builder = SceneBuilder()
    for name, uid in (("Knife", "knife"), ("Knee", "knee"), ("Knife.001", "knife"), ("Knee.001", "knee")):
        builder.add(name, uid=uid, actions=(cut,) if uid == "knife" else ())
    builder.add("Lamp", uid="lamp")
    graph = builder.build()
    assert graph["Knife"].actions == (cut,)
    copy = graph["Knife.001"].actions[0]
    assert copy.targets == (graph["Knee.001"].uid, "lamp")
    assert (copy.tools, copy.frame) == ((graph["Knife.001"].uid,), graph["Knee.001"].uid)
    assert copy.uid == derived_uid("cut", graph["Knife.001"].uid)


def test_new_uids_differ() -> None:
    assert len({new_uid() for _ in range(100)}) == 100
