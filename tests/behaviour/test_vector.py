from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.behaviour import CHANNELS, WIDTH, action_places, action_vector, behaviour_links, decode_action
from unisg_blender.errors import UniSGError
from unisg_blender.scene import ActionData, LessonNode, SceneBuilder, Thresholds
from unisg_blender.scene.action_data import MODES, TYPES, actions_from_json, actions_to_json

LIMIT = st.none() | st.floats(0, 1e6)
NUMBER = st.floats(-1e6, 1e6)


@st.composite
def any_action(draw):
    answers = tuple(draw(st.lists(st.text(max_size=5), max_size=8)))
    correct = tuple(sorted(draw(st.sets(st.integers(0, max(len(answers) - 1, 0)), max_size=len(answers)))))
    reference = draw(st.none() | st.tuples(*[NUMBER] * 12))
    return ActionData(
        uid=draw(st.text(min_size=1, max_size=8)),
        type=draw(st.sampled_from((*TYPES, "Wipe"))),
        name=draw(st.text(max_size=8)),
        targets=tuple(draw(st.lists(st.text(max_size=4), max_size=3))),
        tools=tuple(draw(st.lists(st.text(max_size=4), max_size=3))),
        reference=None if reference is None else (*reference, 0.0, 0.0, 0.0, 1.0),
        frame=draw(st.sampled_from(("", "bed"))),
        thresholds=Thresholds(draw(LIMIT), draw(LIMIT), draw(LIMIT), draw(st.none() | st.integers(0, 50)), draw(LIMIT)),
        trigger=draw(st.booleans()),
        answers=answers,
        correct=correct,
        members=tuple(draw(st.lists(st.text(max_size=4), max_size=3))),
        mode=draw(st.sampled_from(MODES)),
        names=draw(st.dictionaries(st.text(max_size=4), st.text(max_size=4), max_size=2)),
        extra=draw(
            st.dictionaries(st.sampled_from(("haptics", "note")), st.integers() | st.text(max_size=4), max_size=2)
        ),
    )


@pytest.mark.slow
@given(st.lists(any_action(), max_size=4))
@settings(max_examples=60, deadline=None)
def test_actions_pass_json_and_the_vector_unharmed(actions):
    assert actions_from_json(actions_to_json(actions)) == tuple(actions)
    builder = SceneBuilder()
    builder.add("Owner", uid="owner", actions=tuple(actions))
    vectors = action_vector(builder.build())
    assert vectors.values.shape == vectors.mask.shape == (len(actions), WIDTH)
    assert (vectors.values[~vectors.mask] == 0).all()
    assert (vectors.owner == 0).all()
    for row, action in enumerate(vectors.actions):
        bare = ActionData(
            action.uid, action.type, action.name, action.targets, action.tools, frame=action.frame,
            answers=action.answers, members=action.members, names=action.names, extra=action.extra,
        )  # fmt: skip
        assert decode_action(vectors.values[row], vectors.mask[row], bare) == action


def lesson():
    leaves = [LessonNode("action", f"leaf{n}", action=f"a{n}") for n in range(5)]
    first = LessonNode("stage", "s0", children=(leaves[0], leaves[1]))
    second = LessonNode("stage", "s1", children=(leaves[2], leaves[3]), ordered=False, requires=("s0",))
    inner = LessonNode("lesson", "l1", children=(second,))
    third = LessonNode("stage", "s2", children=(LessonNode("action", "leaf4", action="a4", optional=True),))
    outer = LessonNode("lesson", "l0", children=(first, inner))
    return LessonNode("operation", "op", children=(outer, LessonNode("lesson", "l2", children=(third,))))


def scene():
    builder = SceneBuilder()
    actions = [ActionData(f"a{n}", "Insert", targets=("thing",), frame="owner") for n in range(4)]
    actions += [ActionData("a4", "Parallel", members=("m",)), ActionData("m", "Use", tools=("tool", "gone"))]
    builder.add("Owner", uid="owner", actions=tuple(actions), lsa=lesson())
    builder.add("Thing", uid="thing")
    builder.add("Tool", uid="tool")
    return builder.build()


def test_the_place_in_the_lesson_is_filled_in():
    places = action_places(scene())
    assert [(p.lesson, p.stage, p.order, p.leaf, p.depth) for p in map(places.get, ("a0", "a1", "a2", "a3", "a4"))] == [
        (0, 0, 0, 0, 1), (0, 0, 1, 1, 1), (1, 1, 0, 2, 2), (1, 1, 1, 3, 2), (2, 2, 0, 4, 1),
    ]  # fmt: skip
    assert not places["a2"].ordered
    assert places["a4"].optional
    assert places["m"].member
    assert places["m"].leaf == 4
    vectors = action_vector(scene())
    column = {name: vectors.values[:, index] for index, name in enumerate(CHANNELS)}
    assert column["place.leaf"].tolist() == [0, 1, 2, 3, 4, 4]
    assert vectors.mask[:, CHANNELS.index("place.leaf")].all()


def test_links_join_actions_stages_lessons_and_entities():
    graph = scene()
    links = behaviour_links(graph)
    edges = {name: found.T.tolist() for (_, name, _), found in links.edges.items() if name not in ("contains", "has")}
    assert edges["targets"] == [[n, graph.row("Thing")] for n in range(4)]
    assert edges["uses"] == [[5, graph.row("Tool")]]
    assert edges["in_frame_of"] == [[n, 0] for n in range(4)]
    assert edges["groups"] == [[4, 5]]
    assert edges["precedes"] == [[0, 1], [1, 2], [1, 3], [2, 4], [3, 4]]
    assert links.edges["entity", "has", "action"].tolist() == [[0] * 6, [0, 1, 2, 3, 4, 5]]
    assert [node.uid for node in links.lessons] == ["l0", "l1", "l2"]
    assert [node.uid for node in links.stages] == ["s0", "s1", "s2"]
    assert links.edges["stage", "contains", "action"].T.tolist() == [[0, 0], [0, 1], [1, 2], [1, 3], [2, 4]]
    assert links.edges["lesson", "contains", "lesson"].T.tolist() == [[0, 1]]
    assert links.edges["lesson", "contains", "stage"].T.tolist() == [[0, 0], [1, 1], [2, 2]]
    assert links.stage_features[1].tolist() == [2, 0, 2, 1, 0, 0]


def test_a_networks_output_becomes_a_valid_action():
    values = np.full(WIDTH, -0.3)
    values[CHANNELS.index("type.Use")] = 0.9
    values[CHANNELS.index("threshold.hits")] = 2.6
    mask = np.zeros(WIDTH, bool)
    mask[[CHANNELS.index("threshold.hits"), CHANNELS.index("threshold.distance")]] = True
    action = decode_action(values, mask, ActionData("u", ""))
    assert action == ActionData("u", "Use", thresholds=Thresholds(distance=0.0, hits=3))
    assert actions_from_json(actions_to_json([action])) == (action,)


@pytest.mark.parametrize(
    "change",
    [
        {"reference": [1.0] * 16},
        {"reference": [math.nan] * 16},
        {"mode": "some"},
        {"correct": [True]},
        {"names": ["x"]},
        {"thresholds": {"distance": -1}},
        {"version": 2},
    ],
)
def test_bad_values_are_refused_with_the_actions_uid(change):
    with pytest.raises(UniSGError, match="u1"):
        actions_from_json(json.dumps([{"uid": "u1", "type": "Insert"} | change]))
