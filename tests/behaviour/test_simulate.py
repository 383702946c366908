from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from unisg_blender.behaviour import (
    Input,
    Motion,
    Track,
    moments,
    motion_from_json,
    motion_to_json,
    prepare,
    recorded_motion,
    rehearse,
    simulate,
    timeline_record,
)
from unisg_blender.errors import UniSGError
from unisg_blender.scene import ActionData, LessonNode, SceneBuilder, Thresholds, mesh_from_faces, table, world_matrices

CUBE = mesh_from_faces(
    "cube",
    np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.05, 0.05)]),
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
)


def at(x=0.0, y=0.0, z=0.0, turn=(0.0, 0.0, 0.0)):
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    matrix[:3, 3] = x, y, z
    return matrix


def flat(matrix):
    return tuple(matrix.ravel())


ACTIONS = (
    ActionData("take", "Remove", "Take the scalpel", ("scalpel",), thresholds=Thresholds(0.1)),
    ActionData("cut", "Use", "Cut", ("knee",), ("scalpel",), thresholds=Thresholds(hold=0.5, force=2.0), trigger=True),
    ActionData("knock", "Use", "Knock", ("knee",), ("mallet",), thresholds=Thresholds(0.01, hits=3)),
    ActionData(
        "implant", "Insert", "Insert the implant", ("implant",), reference=flat(at(0, 0, 0.1, (0, 0, 1))), frame="knee",
        thresholds=Thresholds(0.01, math.radians(10), hold=0.4),
    ),
    ActionData(
        "sew", "Tool", "Close", ("knee",), ("needle",), flat(at(0.5, 0, 1.2)), thresholds=Thresholds(0.02, 0.2, hits=4)
    ),
    ActionData("turn", "Remove", "Turn the lamp", ("lamp",), thresholds=Thresholds(angle=0.5)),
    ActionData("count", "Question", "How many swabs?", answers=("two", "three"), correct=(1,)),
    ActionData("doff", "Parallel", "Doff", members=("mask", "gown")),
    ActionData("mask", "Remove", "Mask off", ("mask",), thresholds=Thresholds(0.2)),
    ActionData("gown", "Remove", "Gown off", ("gown",), thresholds=Thresholds(0.2)),
)  # fmt: skip


def leaf(uid, **fields):
    return LessonNode("action", f"leaf_{uid}", action=uid, **fields)


def surgery():
    """A lesson of all types, tools on a scaled and turned tray, the knee under a patient."""
    prepare_stage = LessonNode("stage", "s1", "Prepare", children=(leaf("turn", optional=True), leaf("count")))
    operate = LessonNode("stage", "s2", "Operate", children=(leaf("take"), leaf("cut"), leaf("knock"), leaf("implant")))
    end = LessonNode("stage", "s3", "End", children=(leaf("sew"), leaf("doff")), ordered=False, requires=("s2",))
    lesson = LessonNode("lesson", "l", "Lesson", children=(prepare_stage, operate, end))
    builder = SceneBuilder()
    builder.add("Lesson", uid="lesson", lsa=LessonNode("operation", "op", "Knee", children=(lesson,)), actions=ACTIONS)
    patient = builder.add("Patient", uid="patient", local=at(0.5, 0.2, 0.9, (0, 0, 0.3)))
    builder.add("Knee", uid="knee", parent=patient, local=at(0.2, 0, 0), mesh=CUBE)
    tray = builder.add("Tray", uid="tray", local=at(2, 1, 1, (0.1, 0, 0.4)) @ np.diag([2, 2, 1, 1.0]))
    for place, name in enumerate(("Scalpel", "Mallet", "Implant", "Needle")):
        builder.add(name, uid=name.lower(), parent=tray, local=at(0, 0.2 * place, 0.05), mesh=CUBE)
    for place, name in enumerate(("Lamp", "Mask", "Gown")):
        builder.add(name, uid=name.lower(), local=at(-1, place, 2), mesh=CUBE)
    return builder.build()


def test_a_rehearsal_performs_every_action_in_order_and_plays_to_the_end():
    graph = surgery()
    lesson = prepare(graph)
    motion = rehearse(lesson)
    timeline = simulate(lesson, moments(graph, motion))
    assert timeline.finished
    assert [event.action for event in timeline.performed()] == [
        "turn", "count", "take", "cut", "knock", "implant", "sew", "doff",
    ]  # fmt: skip
    assert not [event for event in timeline.events if event.kind in ("wrong_answer", "skipped")]
    record = timeline_record(timeline)
    assert json.loads(json.dumps(record))["finished"]
    nodes = {node["uid"]: node for node in record["nodes"]}
    assert nodes["leaf_turn"]["optional"]
    assert nodes["s2"]["status"] == "done"
    assert nodes["leaf_cut"]["why"] == "'Scalpel' touches 'Knee', with the trigger, with 2 N, for 0.5 s"
    assert nodes["leaf_take"]["opened"] <= nodes["leaf_take"]["done"]


def test_a_rehearsal_goes_through_json():
    graph = surgery()
    lesson = prepare(graph)
    motion = motion_from_json(graph, motion_to_json(graph, rehearse(lesson)))
    assert simulate(lesson, moments(graph, motion)).finished


def test_nothing_happens_by_itself_and_without_force_nothing_is_cut():
    graph = surgery()
    lesson = prepare(graph)
    assert not simulate(lesson, moments(graph, Motion())).performed()
    motion = rehearse(lesson)
    weak = [Input(each.time, each.uid, each.trigger, each.force and 1.9, each.answer) for each in motion.inputs]
    timeline = simulate(lesson, moments(graph, Motion(motion.tracks, tuple(weak), motion.rate)))
    assert [event.action for event in timeline.performed()] == ["turn", "count", "take"]


def test_an_action_that_moving_cannot_perform_is_named():
    own = ActionData("wipe", "Wipe", "Wipe")
    lesson = LessonNode("lesson", "l", children=(LessonNode("stage", "s", children=(leaf("wipe"),)),))
    builder = SceneBuilder()
    builder.add("Lesson", uid="lesson", lsa=LessonNode("operation", "op", children=(lesson,)), actions=(own,))
    ready = prepare(builder.build(), conditions={"Wipe": lambda batch, moment: np.zeros(1, bool)})
    with pytest.raises(UniSGError, match=r"action 'leaf_wipe' \(Wipe\) is not performed"):
        rehearse(ready)


def test_scripted_motion_by_name_in_the_world_in_a_frame_and_below_the_parent():
    graph = surgery()
    text = {
        "rate": 10,
        "tracks": [
            {"entity": "Scalpel", "keys": [{"time": 0, "position": [0, 0, 0]}, {"time": 2, "position": [0, 0, 1]}]},
            {
                "entity": "mallet",
                "frame": "Knee",
                "keys": [{"time": 0, "position": [0, 0, 0.5], "rotation": [1, 0, 0, 0]}],
            },
            {"entity": "Knee", "frame": "parent", "keys": [{"time": 0, "matrix": np.eye(4).ravel().tolist()}]},
        ],
        "inputs": [
            {"time": 0.5, "entity": "Scalpel", "trigger": True, "force": 3},
            {"time": 1, "action": "How many swabs?", "answer": ["three"]},
        ],
    }
    played = list(moments(graph, motion_from_json(graph, json.dumps(text)), rest=0))
    assert [round(now.time, 6) for now in played] == [round(0.1 * frame, 6) for frame in range(21)]
    halfway = played[10]
    scalpel, knee = graph.row("Scalpel"), graph.row("Knee")
    assert np.allclose(halfway.world[scalpel, :3, 3], [0, 0, 0.5])
    assert np.allclose(halfway.world[scalpel, :3, :3], world_matrices(graph)[scalpel, :3, :3])  # as the scene has it
    assert np.allclose(halfway.world[knee], halfway.world[graph.row("Patient")])
    expected = halfway.world[knee][:3, 3] + [0, 0, 0.5]
    assert np.allclose(halfway.world[graph.row("Mallet"), :3, 3], expected)
    assert halfway.answers == {"count": (1,)}
    assert not played[4].trigger[scalpel]
    assert played[5].trigger[scalpel]
    assert played[20].force[scalpel] == 3
    assert not played[11].answers


def test_recorded_motion_comes_before_animation():
    graph = surgery()
    row = graph.row("Scalpel")

    def clip(height):
        return table([row], times=[np.array([0.0, 1.0])], matrices=[np.stack([at(), at(z=height)])])

    graph = graph.with_component("animation", clip(1.0))
    assert recorded_motion(graph).tracks[0].matrices[1, 2, 3] == 1.0
    graph = graph.with_component("recording", clip(2.0))
    assert recorded_motion(graph).tracks[0].matrices[1, 2, 3] == 2.0


def test_tracks_keep_scale_and_hold_outside():
    stretched = at(1) @ np.diag([2, 1, -1, 1.0])
    track = Track("x", np.array([0.0, 1.0]), np.stack([stretched, at(2) @ stretched]))
    poses = track.at(np.array([-1.0, 0.0, 0.5, 1.0, 9.0]))
    assert np.allclose(poses[[0, 1]], stretched)
    assert np.allclose(poses[[3, 4]], at(2) @ stretched)
    assert np.allclose(poses[2], at(1) @ stretched)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not valid JSON"),
        ("[]", "must be a JSON object"),
        ('{"a": 1}', "this has neither"),
        ('{"version": 2}', "update it"),
        ('{"tracks": [{"entity": "Nobody", "keys": []}]}', "names 'Nobody', which is not in the scene"),
        ('{"tracks": [{"entity": "Knee", "keys": []}]}', "has no keys"),
        ('{"tracks": [{"entity": "Knee", "keys": [{"time": 0}]}]}', "not of the form"),
        ('{"tracks": [{"entity": "Knee", "keys": [{"time": 0, "position": [0, 0, NaN]}]}]}', "not finite"),
        ('{"tracks": [{"entity": "Knee", "keys": [{"time": 0, "position": [0, 0]}]}]}', "not of the form"),
        ('{"rate": 0}', "positive number"),
        ('{"inputs": [{"time": 0, "action": "zz", "answer": [0]}]}', "no action of the scene"),
        ('{"inputs": [{"time": 0, "action": "count", "answer": ["nine"]}]}', "not of the form"),
    ],
)
def test_bad_motion_is_refused(text, message):
    with pytest.raises(UniSGError, match=message):
        motion_from_json(surgery(), text)


def test_frames_that_move_in_a_circle_are_refused():
    graph = surgery()
    tracks = [
        {"entity": one, "frame": other, "keys": [{"time": 0, "position": [0, 0, 0]}]}
        for one, other in (("Knee", "Mask"), ("Mask", "Knee"))
    ]
    with pytest.raises(UniSGError, match="cycle"):
        list(moments(graph, motion_from_json(graph, json.dumps({"tracks": tracks}))))
