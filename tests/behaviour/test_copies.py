"""After Shift-D, append, rename and undo every action still means the objects its author meant; exports keep it."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.behaviour import all_actions, moments, operations, prepare, rehearse, simulate
from unisg_blender.errors import UniSGError
from unisg_blender.scene import ActionData, LessonNode, SceneBuilder, Thresholds
from unisg_blender.usd import read_usd, write_usd

bpy = pytest.importorskip("bpy")

from unisg_blender.blender import read_scene, write_scene  # noqa: E402
from unisg_blender.blender.authoring.identities import ensure_uid, repair_copies, repair_identities  # noqa: E402
from unisg_blender.blender.authoring.stored_behaviour import actions_of, store_actions  # noqa: E402


@pytest.fixture(autouse=True)
def station():
    """A table with a scalpel and a knee on it, actions at the table and at the knee, a lesson."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.context.scene.frame_end = 1
    actions = (
        ActionData("both", "Parallel", "Both", members=("place", "count")),
        ActionData("count", "Question", "How many?", answers=("one", "two"), correct=(1,), extra={"note": 7}),
    )
    place = ActionData(
        "place", "Insert", "Place", ("scalpel",), frame="knee", reference=tuple(np.eye(4).ravel()),
        thresholds=Thresholds(0.02, 0.2),
    )  # fmt: skip
    leaves = tuple(LessonNode("action", f"leaf_{uid}", action=uid) for uid in ("both", "count"))
    stage = LessonNode("stage", "s", "Stage", children=(leaves[0], leaves[1]), requires=())
    lesson = LessonNode("operation", "op", "Op", children=(LessonNode("lesson", "l", children=(stage,)),))
    builder = SceneBuilder()
    table = builder.add("Table", uid="table", actions=actions, lsa=lesson)
    shift = np.eye(4)
    shift[0, 3] = 1
    builder.add("Knee", uid="knee", parent=table, actions=(place,))
    builder.add("Scalpel", uid="scalpel", parent=table, local=shift)
    write_scene(builder.build(), bpy.context.scene)
    for item in bpy.context.scene.objects:
        ensure_uid(item)


def duplicate(*names, move=(0, 0, 0)):
    for item in bpy.context.scene.objects:
        item.select_set(item.name in names)
    bpy.ops.object.duplicate()
    copied = list(bpy.context.selected_objects)
    for item in copied:
        if item.parent not in copied:
            item.location = [a + b for a, b in zip(item.location, move, strict=True)]
    bpy.context.view_layer.update()
    return copied


def meaning(graph):
    """For every Insert: the names of its owner, its target and its frame."""
    table = graph.components["actions"]
    name = {uid: graph.name[row] for uid, row in graph.row_of_uid.items()}
    return sorted(
        (graph.name[row], name.get(action.targets[0]), name.get(action.frame))
        for row, action in zip(table.rows, table.columns["data"], strict=True)
        if action.type == "Insert"
    )


def check_lessons(graph, count):
    """Every lesson performs actions of its own, and plays to its end."""
    assert len(operations(graph)) == count
    assert len({action.uid for action in all_actions(graph)}) == 3 * count
    used = [node.action for operation in operations(graph) for node in operation.walk() if node.kind == "action"]
    assert len(set(used)) == 2 * count
    for operation in operations(graph):
        lesson = prepare(graph, operation)
        assert simulate(lesson, moments(graph, rehearse(lesson))).finished


def test_a_copied_station_has_its_own_behaviour():
    duplicate("Table", "Knee", "Scalpel", move=(5, 0, 0))
    duplicate("Table", "Knee", "Scalpel", move=(9, 0, 0))
    graph = read_scene()
    assert meaning(graph) == [
        ("Knee", "Scalpel", "Knee"), ("Knee.001", "Scalpel.001", "Knee.001"), ("Knee.002", "Scalpel.002", "Knee.002"),
    ]  # fmt: skip
    check_lessons(graph, 3)


def test_what_was_not_copied_stays_the_original():
    duplicate("Knee", move=(0, 3, 0))
    assert meaning(read_scene()) == [("Knee", "Scalpel", "Knee"), ("Knee.001", "Scalpel", "Knee.001")]


def test_partly_copied_groups_belong_with_what_stands_beside_them():
    duplicate("Knee", move=(0, 3, 0))
    duplicate("Knee", "Scalpel", move=(0, 7, 0))
    expected = [
        ("Knee", "Scalpel", "Knee"),
        ("Knee.001", "Scalpel", "Knee.001"),
        ("Knee.002", "Scalpel.001", "Knee.002"),
    ]
    assert meaning(read_scene()) == expected


def test_repaired_at_once_nothing_can_go_wrong_later():
    duplicate("Knee")
    assert repair_copies(bpy.context.scene) == 1
    duplicate("Knee", "Scalpel")
    assert repair_copies(bpy.context.scene) == 2
    assert repair_copies(bpy.context.scene) == 0
    before = [(owner, target) for owner, target, _ in meaning(read_scene())]
    assert before == [("Knee", "Scalpel"), ("Knee.001", "Scalpel"), ("Knee.002", "Scalpel.001")]
    new = {"Knee": "Ω", "Knee.001": "A", "Knee.002": "B", "Scalpel": "Z", "Scalpel.001": "C"}
    for old, name in new.items():
        bpy.data.objects[old].name = name
        bpy.data.objects[name].location.x += 4
    bpy.context.view_layer.update()
    after = [(owner, target) for owner, target, _ in meaning(read_scene())]
    assert after == sorted((new[owner], new[target]) for owner, target in before)


def test_reading_and_repairing_agree():
    duplicate("Table", "Knee", "Scalpel", move=(5, 0, 0))
    before = read_scene()
    assert repair_identities(bpy.context.scene) == 3
    after = read_scene()
    assert before.uid == after.uid
    assert all_actions(before) == all_actions(after)
    assert operations(before) == operations(after)


def test_rename_undo_and_redo():
    bpy.ops.ed.undo_push(message="before")
    uids = read_scene().uid
    bpy.data.objects["Scalpel"].name = "Bistoury"
    assert meaning(read_scene()) == [("Knee", "Bistoury", "Knee")]
    bpy.ops.ed.undo_push(message="renamed")
    store_actions(bpy.data.objects["Knee"], ())
    bpy.ops.ed.undo_push(message="emptied")
    assert not actions_of(bpy.data.objects["Knee"])
    bpy.ops.ed.undo()
    assert meaning(read_scene()) == [("Knee", "Bistoury", "Knee")]
    bpy.ops.ed.undo()
    assert read_scene().uid == uids
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert not actions_of(bpy.data.objects["Knee"])


def behaviour(graph):
    return set(map(repr, all_actions(graph))), operations(graph), set(graph.uid)


def test_save_reload_and_append(tmp_path):
    expected = behaviour(read_scene())
    path = str(tmp_path / "station.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert behaviour(read_scene()) == expected
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    for _ in range(2):
        with bpy.data.libraries.load(path) as (source, target):
            target.objects = source.objects
        for item in target.objects:
            bpy.context.scene.collection.objects.link(item)
    bpy.context.view_layer.update()
    graph = read_scene()
    assert len(graph) == 6
    assert [(owner, target) for owner, target, _ in meaning(graph)] == [
        ("Knee", "Scalpel"),
        ("Knee.001", "Scalpel.001"),
    ]
    check_lessons(graph, 2)


def test_linked_objects_keep_their_behaviour_and_say_why_they_cannot_be_changed(tmp_path):
    expected = behaviour(read_scene())
    path = str(tmp_path / "station.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(path, link=True) as (source, target):
        target.objects = source.objects
    for item in target.objects:
        bpy.context.scene.collection.objects.link(item)
    bpy.context.view_layer.update()
    assert behaviour(read_scene()) == expected
    with pytest.raises(UniSGError, match="'Knee' is linked from another file: make a library override"):
        store_actions(bpy.data.objects["Knee"], ())
    override = bpy.data.objects["Knee"].override_create(remap_local_usages=True)
    with pytest.raises(UniSGError, match=r"'Knee' may not be overridden: open .*station\.blend and edit"):
        store_actions(override, ())


def test_library_overrides_of_what_was_written_with_the_panels_keep_their_own_behaviour(tmp_path):
    knee = bpy.data.objects["Knee"]
    store_actions(knee, actions_of(knee))
    path, other = str(tmp_path / "station.blend"), str(tmp_path / "other.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(path, link=True) as (_, target):
        target.objects = ["Knee"]
    bpy.context.scene.collection.objects.link(target.objects[0])
    override = bpy.data.objects["Knee"].override_create(remap_local_usages=True)
    store_actions(override, (*actions_of(override), ActionData("more", "Question")))
    bpy.ops.wm.save_as_mainfile(filepath=other)
    bpy.ops.wm.open_mainfile(filepath=other)
    assert [action.uid for action in actions_of(bpy.context.scene.objects["Knee"])] == ["place", "more"]


def test_gltf_keeps_the_behaviour(tmp_path):
    import addon_utils

    expected = behaviour(read_scene())
    path = str(tmp_path / "station.glb")
    before = addon_utils.check("io_scene_gltf2")[1]
    addon_utils.enable("io_scene_gltf2", default_set=False)
    try:
        bpy.ops.export_scene.gltf(filepath=path, export_extras=True, export_format="GLB")
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        bpy.ops.import_scene.gltf(filepath=path)
        assert behaviour(read_scene()) == expected
    finally:
        if not before:
            addon_utils.disable("io_scene_gltf2", default_set=False)


def test_usd_keeps_the_behaviour_ours_and_blenders(tmp_path):
    graph = read_scene()
    expected = behaviour(graph)
    ours, blenders = tmp_path / "ours.usda", tmp_path / "blenders.usdc"
    write_usd(graph, ours)
    assert behaviour(read_usd(ours)) == expected
    bpy.ops.wm.usd_export(filepath=str(blenders), export_custom_properties=True, root_prim_path="")
    assert behaviour(read_usd(blenders)) == expected
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.usd_import(filepath=str(blenders))
    found = behaviour(read_scene())
    assert found[:2] == expected[:2]
    assert found[2] >= expected[2]
