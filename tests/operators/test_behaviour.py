"""The operators and panels of actions and lessons, in real Blender, as a user's clicks would call them."""

from __future__ import annotations

import importlib
from types import SimpleNamespace

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

from unisg_blender.behaviour import check_scene, prepare, simulate  # noqa: E402
from unisg_blender.blender import read_scene  # noqa: E402
from unisg_blender.blender.authoring.stored_behaviour import actions_of, lesson_of, scene_moments  # noqa: E402
from unisg_blender.blender.viewport.action_lines import action_lines  # noqa: E402

pytestmark = pytest.mark.usefixtures("extension")


@pytest.fixture(autouse=True)
def room():
    """A knee and a scalpel."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    for name, x in (("Knee", 0.0), ("Scalpel", 2.0)):
        bpy.ops.mesh.primitive_cube_add(size=0.2, location=(x, 0, 0))
        bpy.context.object.name = name
    activate("Knee")
    bpy.context.window_manager.unisg_lesson_node = ""


def activate(name, *others):
    for item in bpy.context.scene.objects:
        item.select_set(item.name in (name, *others))
    bpy.context.view_layer.objects.active = bpy.data.objects[name]


def knee_action(place=-1):
    return actions_of(bpy.data.objects["Knee"])[place]


def uid(name):
    return bpy.data.objects[name]["unisg_uid"]


def test_an_insert_is_made_with_a_few_clicks():
    scalpel, knee = bpy.data.objects["Scalpel"], bpy.data.objects["Knee"]
    activate("Scalpel")
    assert bpy.ops.unisg.action_add(type="Insert") == {"FINISHED"}
    scalpel.unisg_action_name = "Put the scalpel on the knee"
    bpy.context.window_manager.unisg_pick_frame = knee
    scalpel.location = (0, 0, 0.2)
    bpy.context.view_layer.update()
    bpy.ops.unisg.action_reference()
    scalpel.unisg_action_ask_angle = False
    scalpel.unisg_action_distance = 0.05
    scalpel.unisg_action_ask_hold = True
    scalpel.unisg_action_hold = 0.5
    action = actions_of(scalpel)[0]
    assert action.name == "Put the scalpel on the knee"
    assert action.targets == (uid("Scalpel"),)
    assert action.frame == uid("Knee")
    assert action.names == {uid("Scalpel"): "Scalpel", uid("Knee"): "Knee"}
    assert np.allclose(action.reference_matrix[:3, 3], [0, 0, 0.2])
    limits = action.thresholds
    assert (limits.distance, limits.angle, limits.hold) == (pytest.approx(0.05), None, 0.5)
    knee.location = (0, 3, 0)
    bpy.context.view_layer.update()
    bpy.ops.unisg.action_go_to_reference()
    assert np.allclose(scalpel.location, (0, 3, 0.2))


def test_reference_poses_are_in_the_unit_of_the_scene_and_limits_in_metres():
    bpy.context.scene.unit_settings.scale_length = 0.01
    scalpel, knee = bpy.data.objects["Scalpel"], bpy.data.objects["Knee"]
    activate("Scalpel")
    bpy.ops.unisg.action_add(type="Insert")
    bpy.context.window_manager.unisg_pick_frame = knee
    knee.location, scalpel.location = (0, 100, 0), (0, 100, 20)
    bpy.context.view_layer.update()
    bpy.ops.unisg.action_reference()
    scalpel.unisg_action_distance = 5.0
    action = actions_of(scalpel)[0]
    micrometre = 1e-4  # centimetres: Blender's matrices are float32, and the scalpel lies 300 of them away
    assert np.allclose(action.reference_matrix[:3, 3], [0, 0, 20], atol=micrometre)
    assert np.allclose(read_scene()["Scalpel"].actions[0].reference_matrix[:3, 3], [0, 0, 0.2], atol=micrometre / 100)
    assert read_scene()["Scalpel"].actions[0].thresholds.distance == pytest.approx(0.05)
    assert scalpel.unisg_action_distance == pytest.approx(5.0)
    lines = [points for points, _ in action_lines(bpy.context.scene, action)]
    assert any(np.ptp(points, axis=0).max() == pytest.approx(10.0, rel=0.05) for points in lines)  # its sphere
    knee.location = (0, 300, 0)
    bpy.context.view_layer.update()
    bpy.ops.unisg.action_go_to_reference()
    assert np.allclose(scalpel.location, (0, 300, 20), atol=micrometre)


def test_changing_the_frame_leaves_the_reference_where_it_is():
    activate("Scalpel")
    bpy.ops.unisg.action_add(type="Insert")
    bpy.ops.unisg.action_reference()
    activate("Scalpel", "Knee")
    bpy.ops.unisg.action_link(slot="frame")
    activate("Scalpel")
    bpy.data.objects["Scalpel"].location = (9, 9, 9)
    bpy.ops.unisg.action_go_to_reference()
    assert np.allclose(bpy.data.objects["Scalpel"].location, (2, 0, 0))
    bpy.ops.unisg.action_unlink(slot="frame")
    assert actions_of(bpy.data.objects["Scalpel"])[0].frame == ""


def test_use_question_parallel_and_the_list():
    activate("Knee", "Scalpel")
    bpy.ops.unisg.action_add(type="Use")
    assert knee_action().tools == (uid("Scalpel"),)
    bpy.data.objects["Knee"].unisg_action_trigger = True
    bpy.ops.unisg.action_add(type="Question")
    knee = bpy.data.objects["Knee"]
    bpy.ops.unisg.action_answers(add=True)
    knee.unisg_action_answer_2 = "Three"
    knee.unisg_action_correct_2, knee.unisg_action_correct_0 = True, False
    assert knee_action().answers == ("Yes", "No", "Three")
    assert knee_action().correct == (2,)
    bpy.ops.unisg.action_answers(add=False)
    assert knee_action().correct == ()
    bpy.ops.unisg.action_add(type="Parallel")
    bpy.ops.unisg.action_member(member=knee_action(0).uid)
    knee.unisg_action_any = True
    assert knee_action().members == (knee_action(0).uid,)
    assert knee_action().mode == "any"
    bpy.ops.unisg.action_move(step=-1)
    assert [action.type for action in actions_of(knee)] == ["Use", "Parallel", "Question"]
    bpy.ops.unisg.action_duplicate()
    assert len({action.uid for action in actions_of(knee)}) == 4
    bpy.ops.unisg.action_remove()
    bpy.ops.unisg.action_select(place=0)
    bpy.ops.unisg.action_unlink(slot="tools", uid=uid("Scalpel"))
    assert knee_action(0).tools == ()
    knee.unisg_action_type = "Remove"
    assert knee_action(0).type == "Remove"


def test_grey_buttons_say_why():
    bpy.context.view_layer.objects.active = None
    assert not bpy.ops.unisg.action_add.poll()
    activate("Knee")
    assert bpy.ops.unisg.action_add.poll()
    assert not bpy.ops.unisg.action_remove.poll()
    assert not bpy.ops.unisg.play.poll()
    assert not bpy.ops.unisg.lesson_add.poll()
    bpy.ops.unisg.action_add(type="Insert")
    with pytest.raises(RuntimeError, match="no reference pose yet"):
        bpy.ops.unisg.action_go_to_reference()
    with pytest.raises(RuntimeError, match="select other objects"):
        bpy.ops.unisg.action_link(slot="tools")


def build_lesson():
    """A lesson: move the scalpel to the knee, then take it away."""
    activate("Scalpel")
    bpy.ops.unisg.action_add(type="Insert")
    scalpel = bpy.data.objects["Scalpel"]
    scalpel.unisg_action_name = "Place"
    bpy.data.objects["Scalpel"].location = (0, 0, 0.2)
    bpy.context.view_layer.update()
    bpy.ops.unisg.action_reference()
    bpy.ops.unisg.lesson_new(name="Surgery")
    activate("Scalpel")
    bpy.ops.unisg.lesson_add_action()
    bpy.ops.unisg.action_add(type="Remove")
    scalpel.unisg_action_name = "Take away"
    bpy.ops.unisg.lesson_add_action()
    scalpel.location = (2, 0, 0)
    bpy.context.view_layer.update()
    return bpy.data.objects["Surgery"]


def shape(item):
    def walk(node):
        return (node.name, *map(walk, node.children)) if node.children else node.name

    return walk(lesson_of(item))


def test_a_lesson_is_built_moved_and_checked():
    item = build_lesson()
    assert shape(item) == ("Surgery", ("Surgery", ("Stage", "Place", "Take away")))
    assert not bpy.ops.unisg.lesson_add_action.poll(), "it has that action already"
    bpy.ops.unisg.lesson_move(how="UP")
    assert shape(item) == ("Surgery", ("Surgery", ("Stage", "Take away", "Place")))
    bpy.ops.unisg.lesson_move(how="DOWN")
    bpy.ops.unisg.lesson_add(kind="stage")
    item.unisg_node_name = "End"
    item.unisg_node_ordered = False
    item.unisg_node_optional = True
    assert shape(item) == ("Surgery", ("Surgery", ("Stage", "Place", "Take away"), "End"))
    stages = lesson_of(item).children[0].children
    assert (stages[1].optional, stages[1].ordered) == (True, False)
    bpy.ops.unisg.lesson_require(node=stages[0].uid)
    assert lesson_of(item).children[0].children[1].requires == (stages[0].uid,)
    bpy.ops.unisg.lesson_unrequire(uid=stages[0].uid)
    bpy.ops.unisg.lesson_add(kind="lesson")
    bpy.ops.unisg.lesson_move(how="OUT")
    assert shape(item)[2] == "Lesson"
    bpy.ops.unisg.lesson_move(how="IN")
    bpy.ops.unisg.lesson_remove()
    bpy.ops.unisg.lesson_select(uid=stages[1].uid)
    bpy.ops.unisg.lesson_remove()
    assert shape(item) == ("Surgery", ("Surgery", ("Stage", "Place", "Take away")))
    assert check_scene(read_scene()) == []
    assert bpy.ops.unisg.lesson_check() == {"FINISHED"}
    bpy.ops.unisg.lesson_select(uid=stages[0].children[0].uid)
    assert bpy.context.window_manager.unisg_action == 0


def animate():
    scalpel = bpy.data.objects["Scalpel"]
    for frame, place in ((1, (2, 0, 0)), (25, (0, 0, 0.2)), (49, (0, 0, 1))):
        scalpel.location = place
        scalpel.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_end = 60


def test_an_animation_plays_the_lesson():
    build_lesson()
    animate()
    bpy.context.scene.frame_set(7)
    graph = read_scene()
    timeline = simulate(prepare(graph), scene_moments(bpy.context.scene, graph))
    assert [event.name for event in timeline.performed()] == ["Place", "Take away"]
    assert timeline.performed()[0].time == pytest.approx(1.0, abs=0.1)
    assert timeline.finished
    assert bpy.context.scene.frame_current == 7
    assert bpy.ops.unisg.play() == {"FINISHED"}


def test_markers_answer_and_animated_numbers_are_trigger_and_force():
    activate("Knee", "Scalpel")
    bpy.ops.unisg.action_add(type="Use")
    knee, scalpel = bpy.data.objects["Knee"], bpy.data.objects["Scalpel"]
    knee.unisg_action_trigger, knee.unisg_action_ask_hold, knee.unisg_action_ask_force = True, False, True
    bpy.ops.unisg.lesson_new(name="Surgery")
    activate("Knee")
    bpy.ops.unisg.lesson_add_action()
    bpy.ops.unisg.action_add(type="Question")
    knee.unisg_action_name = "Ready?"
    bpy.ops.unisg.lesson_add_action()
    scalpel.location = (0, 0, 0.1)
    for frame, pressed, force in ((1, 0, 0.0), (10, 1, 0.0), (20, 1, 6.0)):
        scalpel["unisg_trigger"], scalpel["unisg_force"] = pressed, force
        scalpel.keyframe_insert('["unisg_trigger"]', frame=frame)
        scalpel.keyframe_insert('["unisg_force"]', frame=frame)
    scene = bpy.context.scene
    scene.timeline_markers.new("Ready? = No", frame=30)
    scene.timeline_markers.new("Ready? = Yes", frame=40)
    scene.frame_end = 50
    graph = read_scene()
    timeline = simulate(prepare(graph), scene_moments(scene, graph))
    told = [(event.name, event.kind) for event in timeline.events if event.kind in ("done", "wrong_answer")]
    assert told[:3] == [("Use Knee", "done"), ("Ready?", "wrong_answer"), ("Ready?", "done")]
    used, _ = timeline.performed()
    assert used.time > 9 / 24
    assert used.time < 20 / 24


def test_play_steps_through_the_open_scene():
    from unisg_extension.unisg_blender.blender.viewport.lesson_session import open_session

    build_lesson()
    played = open_session(bpy.context.scene)
    scalpel = bpy.data.objects["Scalpel"]
    played.step(0.0)
    assert [(action.name, holds) for action, holds in played.open_actions()] == [("Place", False)]
    scalpel.location = (0, 0, 0.2)
    bpy.context.view_layer.update()
    played.step(0.1)
    assert played.message().name == "Place"
    bpy.data.objects["Scalpel"].name = "Bistoury"  # renamed while playing
    scalpel.location = (0, 0, 3)
    bpy.context.view_layer.update()
    played.step(0.2)
    assert played.state.finished
    assert played.status(played.lesson.outline.nodes[-1].uid) == "done"


def test_a_recording_of_a_lesson_is_kept_replayed_and_played_as_an_animation():
    """As the modal operator does it, without its clock: moves, a trigger, an answer; then from the scene itself."""
    recording = importlib.import_module("unisg_extension.operators.recording")
    play = importlib.import_module("unisg_extension.operators.play")
    from unisg_extension.unisg_blender.blender.motion.scene_recording import SceneRecorder, scene_recording
    from unisg_extension.unisg_blender.blender.viewport.lesson_session import open_session

    knee, scalpel, scene = bpy.data.objects["Knee"], bpy.data.objects["Scalpel"], bpy.context.scene
    activate("Knee", "Scalpel")
    bpy.ops.unisg.action_add(type="Use")
    knee.unisg_action_name, knee.unisg_action_trigger, knee.unisg_action_ask_hold = "Cut", True, False
    bpy.ops.unisg.lesson_new(name="Surgery")
    activate("Knee")
    bpy.ops.unisg.lesson_add_action()
    bpy.ops.unisg.action_add(type="Question")
    knee.unisg_action_name = "Ready?"
    bpy.ops.unisg.lesson_add_action()
    uid = scalpel["unisg_uid"]

    take = recording.RecordingTake(scene.name, 0.0, SceneRecorder())
    played = open_session(scene)
    played.started = 0.5
    play._sessions[:] = [played]
    for at, x, pressed in ((0.0, 2.0, False), (1.0, 0.1, False), (2.0, 0.1, True), (3.0, 0.1, True), (4.0, 1.0, False)):
        scalpel.location.x = x
        played.pressed = {uid} if pressed else set()
        if at == 3.0:
            played.chosen = {actions_of(knee)[1].uid: (0,)}
            played.answer(actions_of(knee)[1].uid)
        bpy.context.view_layer.update()
        played.step(at)
        take.lesson = play.session()
        take.recorder.sample(scene, at + 0.5)
    play._sessions.clear()
    assert played.state.finished
    assert recording.UNISG_OT_record._save(Reports(), scene, take.graph(0.5, 0.1)) == {"FINISHED"}
    found = scene_recording(scene)
    words = ["started", "performed", "started", "answered:0", "performed"]
    assert [word for _, word, _ in found["Knee"].events] == words
    assert [(time, word) for time, word, _ in found["Scalpel"].events][1:] == [(2.5, "pressed"), (4.5, "released")]

    assert bpy.ops.unisg.replay() == {"FINISHED"}
    assert sorted(marker.name for marker in scene.timeline_markers) == ["Ready? = Yes", "done: Cut", "done: Ready?"]
    scene.frame_set(30)
    assert not scalpel["unisg_trigger"]
    assert scalpel.location.x == pytest.approx(0.3, abs=0.3)
    scene.frame_set(70)
    assert scalpel["unisg_trigger"]
    graph = read_scene()
    timeline = simulate(prepare(graph), scene_moments(scene, graph))
    assert [event.name for event in timeline.performed()] == ["Cut", "Ready?"]
    assert bpy.ops.unisg.replay() == {"FINISHED"}  # again: nothing is there twice
    assert len(scene.timeline_markers) == 3
    assert bpy.ops.unisg.record() == {"FINISHED"}  # the playback, lesson and all
    assert [word for _, word, _ in scene_recording(scene)["Knee"].events].count("performed") == 2
    assert bpy.ops.unisg.record_clear() == {"FINISHED"}
    assert scene_recording(scene) == {}


class Reports:
    """Stands for an operator that saves into the scene alone."""

    filepath = ""

    def report(self, kind, text):
        assert kind == {"INFO"}, text


def test_types_of_a_users_own_are_in_the_menu(tmp_path):
    from unisg_extension.unisg_blender.behaviour import remove_type

    path = tmp_path / "types.py"
    path.write_text("CONDITIONS = {'Lift': lambda batch, moment: moment.world[batch.target, 2, 3] > batch.distance}")
    assert bpy.ops.unisg.load_types(filepath=str(path)) == {"FINISHED"}
    assert bpy.ops.unisg.action_add(type="Lift") == {"FINISHED"}
    assert knee_action().type == "Lift"
    assert knee_action().targets == (bpy.data.objects["Knee"]["unisg_uid"],)
    remove_type("Lift")
    with pytest.raises(RuntimeError, match="no file"):
        bpy.ops.unisg.load_types(filepath=str(tmp_path / "missing.py"))


def test_every_edit_is_one_undo_step():
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.unisg.action_add("EXEC_DEFAULT", True, type="Insert")
    assert len(actions_of(bpy.data.objects["Knee"])) == 1
    bpy.ops.unisg.action_reference("EXEC_DEFAULT", True)
    assert knee_action().reference is not None
    bpy.ops.ed.undo()
    assert knee_action().reference is None
    bpy.ops.ed.undo()
    assert not actions_of(bpy.data.objects["Knee"])
    bpy.ops.ed.redo()
    assert len(actions_of(bpy.data.objects["Knee"])) == 1


def test_nothing_is_stored_beside_the_documented_properties():
    build_lesson()
    for item in bpy.context.scene.objects:
        assert {key for key in dict(item) if not key.startswith("cycles")} <= {
            "unisg_actions",
            "unisg_uid",
            "unisg_lsa",
        }


def test_lines_of_the_overlay():
    from unisg_extension.unisg_blender.blender.viewport.action_lines import action_lines

    build_lesson()
    place, away = actions_of(bpy.data.objects["Scalpel"])
    lines = list(action_lines(bpy.context.scene, place))
    assert len(lines) == 4  # hologram, distance, angle, link
    hologram = lines[0][0]
    assert np.allclose(hologram.mean(axis=0), (0, 0, 0.2), atol=1e-6)
    assert np.ptp(hologram[:, 0]) == pytest.approx(0.2)
    assert all(points.shape[1] == 3 and len(points) % 2 == 0 for points, _ in lines)
    assert len(list(action_lines(bpy.context.scene, away))) == 1


def test_copies_are_told_apart_at_once():
    from unisg_extension.operators import copy_repair

    build_lesson()
    scene = bpy.context.scene
    copy_repair._after_update(scene, None)
    activate("Scalpel")
    bpy.ops.object.duplicate()
    bpy.context.view_layer.update()
    assert bpy.app.timers.is_registered(copy_repair._repair)
    copy_repair._repair()
    assert len({item.get("unisg_uid") for item in scene.objects if "unisg_uid" in item}) == 2 + 1
    copy = bpy.data.objects["Scalpel.001"]
    assert actions_of(copy)[0].targets == (copy["unisg_uid"],)


def test_copies_of_another_windows_scene_are_told_apart():
    from unisg_extension.operators import copy_repair

    shown, other = bpy.context.scene, bpy.data.scenes.new("Other")
    mug = bpy.data.objects.new("Mug", bpy.data.meshes.new("Mug"))
    mug["unisg_uid"] = "mug"
    other.collection.objects.link(mug)
    for scene in (other, shown):
        copy_repair._after_update(scene, None)
    copy = mug.copy()
    other.collection.objects.link(copy)
    copy_repair._after_update(other, None)
    copy_repair._repair()
    assert copy["unisg_uid"] != mug["unisg_uid"]


def test_a_stage_for_the_operation_goes_into_its_last_lesson():
    bpy.ops.unisg.lesson_new(name="Surgery")
    item = bpy.data.objects["Surgery"]
    bpy.context.window_manager.unisg_lesson_node = lesson_of(item).uid
    assert bpy.ops.unisg.lesson_add(kind="stage") == {"FINISHED"}
    assert [node.kind for node in lesson_of(item).children[-1].children] == ["stage", "stage"]


def test_a_click_in_the_tree_selects_that_object_only():
    item = build_lesson()
    bpy.data.objects["Knee"].select_set(True)
    root = lesson_of(item)
    action = root.children[0].children[0].children[0]
    bpy.ops.unisg.lesson_select(uid=action.uid)
    assert [each.name for each in bpy.context.selected_objects] == ["Scalpel"]
    assert bpy.context.active_object.name == "Scalpel"


def test_an_operation_with_one_lesson_is_shown_as_that_lesson(extension):
    shown_top = extension.operators.lesson_properties.shown_top
    root = lesson_of(build_lesson())
    assert shown_top(root) == root.children[0]
    bpy.context.window_manager.unisg_lesson_node = root.uid
    bpy.ops.unisg.lesson_add(kind="lesson")
    root = lesson_of(bpy.data.objects["Surgery"])
    assert len(root.children) == 2
    assert shown_top(root) == root


@pytest.mark.parametrize(("finished", "told"), [(True, "The lesson has ended"), (False, "Stopped before the end")])
def test_stop_says_whether_the_lesson_has_ended(extension, finished, told):
    """Stop lets the session go; the running operator hears of it at its next event."""
    play, said = extension.operators.play, []
    state = SimpleNamespace(finished=finished)
    current = SimpleNamespace(state=state, scene="Scene", face=lambda: 0, step=lambda _: [], started=0.0)
    operator = SimpleNamespace(
        _finished=False, _timer=None, report=lambda _, text: said.append(text),
        _end=lambda context: play.UNISG_OT_play._end(operator, context),
    )  # fmt: skip
    context = SimpleNamespace(window_manager=SimpleNamespace(event_timer_remove=lambda _: None, windows=()))
    play._sessions[:] = [current]
    bpy.data.scenes[0].name = "Scene"
    assert play.UNISG_OT_play.modal(operator, context, SimpleNamespace(type="TIMER")) == {"PASS_THROUGH"}
    bpy.ops.unisg.play_stop()
    assert play.UNISG_OT_play.modal(operator, context, SimpleNamespace(type="TIMER")) == {"FINISHED"}
    assert said == [told]
