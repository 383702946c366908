from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.behaviour import begin, check_lesson, check_scene, moment, play, prepare
from unisg_blender.behaviour.lesson.lesson_progress import DONE, OPEN, SKIPPED, advance, blockers, first_status
from unisg_blender.behaviour.lesson.lesson_tree import outline
from unisg_blender.behaviour.playing.deadlock import circles, unreached
from unisg_blender.errors import UniSGError
from unisg_blender.scene import ActionData, LessonNode, SceneBuilder, Thresholds, world_matrices

TEN_DEGREES = math.radians(10)


def leaf(uid, **fields):
    return LessonNode("action", uid, uid.upper(), action=uid, **fields)


def stage(uid, *children, **fields):
    return LessonNode("stage", uid, uid.upper(), children=children, **fields)


def operation(*stages, **fields):
    return LessonNode("operation", "op", "Op", children=(LessonNode("lesson", "l", "L", children=stages, **fields),))


@st.composite
def any_operation(draw, least=0):
    """Random trees with random order, options and requirements; some cannot be played."""
    count = iter(range(1000))

    def node(kind, children):
        return LessonNode(
            kind, f"n{next(count)}", children=children, optional=draw(st.booleans()), ordered=draw(st.booleans())
        )

    def make_stage():
        leaves = [node("action", ()) for _ in range(draw(st.integers(least, 3)))]
        return node("stage", tuple(leaves))

    def make_lesson(depth):
        parts = []
        for _ in range(draw(st.integers(least, 3))):
            parts.append(make_lesson(depth - 1) if depth and draw(st.booleans()) else make_stage())
        return node("lesson", tuple(parts))

    root = node("operation", tuple(make_lesson(2) for _ in range(draw(st.integers(1, 2)))))
    uids = [each.uid for each in root.walk()]
    wanted = draw(st.lists(st.tuples(st.sampled_from(uids[1:] or uids), st.sampled_from(uids)), max_size=4))

    def with_requires(each):
        return LessonNode(
            each.kind, each.uid, children=tuple(map(with_requires, each.children)), optional=each.optional,
            ordered=each.ordered, requires=tuple(second for first, second in wanted if first == each.uid),
        )  # fmt: skip

    return with_requires(root)


@pytest.mark.slow
@given(any_operation(), st.randoms(use_true_random=False))
@settings(max_examples=250, deadline=None)
def test_random_lessons_never_deadlock_and_never_skip_a_prerequisite(root, random):
    plan = outline(root)
    if list(circles(plan)):
        return
    status, _ = advance(plan, first_status(plan), ())
    done: set[int] = set()
    for _ in range(len(plan.nodes) + 1):
        opened = [p for p in np.flatnonzero(status == OPEN) if plan.nodes[p].kind == "action"]
        if not opened:
            break
        chosen = random.sample(opened, random.randint(1, len(opened)))
        for place in chosen:
            for node in (place, *plan.above(place)):
                assert all(status[wanted] == DONE for wanted in plan.requires[node])
                before = [sibling for sibling in plan.earlier(node) if plan.mandatory[sibling]]
                assert all(status[sibling] == DONE for sibling in before)
        before = status
        status, changes = advance(plan, status, chosen)
        assert [change.place for change in changes if change.status == DONE and change.place in chosen]
        assert (status[before == DONE] == DONE).all()
        done.update(chosen)
    assert status[0] == DONE
    assert not (status == OPEN).any()
    for place, node in enumerate(plan.nodes):
        if plan.mandatory[place] and all(plan.mandatory[above] for above in plan.above(place)):
            assert status[place] == DONE, node.uid


@pytest.mark.slow
@given(any_operation(least=1))
@settings(max_examples=250, deadline=None)
def test_no_lesson_hides_an_action_that_no_order_reaches(root):
    """Where a search of all orders finds none that reaches every action, a circle or an unreached action is told."""
    plan = outline(root)
    if len(_leaves(plan)) > 5:
        return
    status, _ = advance(plan, first_status(plan), ())
    waiting = list(circles(plan))
    if _can_do_everything(plan, status):
        assert not waiting
    else:
        assert waiting or unreached(plan)
    if not waiting:
        assert not [each for each in unreached(plan) if all(plan.mandatory[at] for at in (each, *plan.above(each)))]


def test_an_optional_stage_that_requires_all_of_what_comes_later_is_told():
    early = stage("early", leaf("a"), optional=True, requires=("b", "c"))
    late = LessonNode("stage", "late", "Late", children=(leaf("b"), leaf("c")), ordered=False)
    graph = scene(operation(early, late), question("a"), question("b"), question("c"))
    problems = check_scene(graph)
    assert [(each.message, each.severe) for each in problems] == [
        ("Action 'A' is optional and may never be reached", False)
    ]


def _leaves(plan):
    return [place for place, node in enumerate(plan.nodes) if node.kind == "action"]


def _can_do_everything(plan, status):
    """Search all orders: is there one in which no leaf is skipped or never reached?"""
    leaves = _leaves(plan)
    if all(status[place] == DONE for place in leaves):
        return True
    opened = [place for place in leaves if status[place] == OPEN]
    if any(status[place] == SKIPPED for place in leaves):
        return False
    return any(_can_do_everything(plan, advance(plan, status, [place])[0]) for place in opened)


def play_through(root, order):
    plan = outline(root)
    place_of = {node.uid: place for place, node in enumerate(plan.nodes)}
    status, _ = advance(plan, first_status(plan), ())
    for uid in order:
        status, _ = advance(plan, status, [place_of[uid]])
    return {node.uid: "WODS"[status[place]] for place, node in enumerate(plan.nodes)}


def test_ordered_optional_any_order_and_requirements():
    root = operation(
        stage("s1", leaf("a"), leaf("b", optional=True), leaf("c")),
        stage("s2", leaf("d"), leaf("e"), leaf("f", requires=("e",)), ordered=False),
    )
    assert play_through(root, ["c"]) == dict(op="O", l="O", s1="O", a="O", b="W", c="W", s2="W", d="W", e="W", f="W")
    assert play_through(root, ["a"])["b"] == "O"
    assert play_through(root, ["a"])["c"] == "O"
    assert play_through(root, ["a", "c"]) == dict(
        op="O", l="O", s1="D", a="D", b="S", c="D", s2="O", d="O", e="O", f="W"
    )
    assert play_through(root, ["a", "b", "c", "e", "f"])["s2"] == "O"
    assert set(play_through(root, ["a", "b", "c", "e", "f", "d"]).values()) == {"D"}


def test_an_optional_end_can_be_done_until_something_later_is():
    root = operation(stage("s1", leaf("a"), leaf("b", optional=True)), stage("s2", leaf("c"), leaf("d", optional=True)))
    assert play_through(root, ["a"]) == dict(op="O", l="O", s1="D", a="D", b="O", s2="O", c="O", d="W")
    assert play_through(root, ["a", "c"]) == dict(op="D", l="D", s1="D", a="D", b="S", s2="D", c="D", d="O")
    assert set(play_through(root, ["a", "b", "c", "d"]).values()) == {"D"}


def test_what_is_required_is_no_longer_optional():
    root = operation(stage("s1", leaf("a", optional=True), leaf("b")), stage("s2", leaf("c", requires=("a",))))
    assert play_through(root, ["b"])["b"] == "W"
    assert set(play_through(root, ["a", "b", "c"]).values()) == {"D"}


def scene(root, *actions, **entities):
    builder = SceneBuilder()
    builder.add("Lesson", uid="lesson", lsa=root, actions=actions)
    for name, local in entities.items():
        builder.add(name.capitalize(), uid=name, local=local)
    return builder.build()


def insert(uid, target, reference, distance=0.02, angle=TEN_DEGREES, **fields):
    thresholds = Thresholds(distance, angle, fields.pop("hold", None))
    flat = tuple(reference.ravel())
    return ActionData(uid, "Insert", uid, (target,), reference=flat, thresholds=thresholds, **fields)


def shifted(x=0.0, y=0.0, z=0.0):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def question(uid, **fields):
    return ActionData(uid, "Question", uid, answers=("yes", "no"), correct=(0,), **fields)


@pytest.mark.parametrize(
    ("root", "actions", "message"),
    [
        (
            operation(stage("incision", leaf("a"))),
            [ActionData("a", "Use", targets=("knee",), tools=("x1",), names={"x1": "Scalpel"})],
            "Stage 'INCISION' needs 'Scalpel', which is not in the scene",
        ),
        (operation(stage("s", leaf("a"))), [], "Stage 'S' performs the action 'A', which is not in the scene"),
        (operation(stage("s", leaf("a"))), [question("a"), question("a")], "2 actions share one uid ('a' and 'a')"),
        (operation(stage("s", leaf("a"), leaf("a"))), [question("a")], "share one uid"),
        (operation(), [], "Operation 'Op' has no actions"),
        (operation(stage("s", leaf("a", requires=("zz",)))), [question("a")], "Action 'A' requires something"),
        (operation(stage("s", leaf("a", requires=("s",)))), [question("a")], "requires stage 'S', which is above it"),
        (
            operation(stage("s", leaf("a", requires=("b",)), leaf("b", requires=("a",)), ordered=False)),
            [question("a"), question("b")],
            "wait for each other",
        ),
        (
            operation(stage("s", leaf("a", requires=("b",), optional=True), leaf("b"))),
            [question("a"), question("b")],
            "wait for each other",
        ),
        (
            operation(stage("s", leaf("a", requires=("b",)), leaf("b")), stage("t", leaf("c"))),
            [question("a"), question("b"), question("c")],
            "Action 'C' can never be reached",
        ),
        (operation(stage("s", leaf("a"))), [ActionData("a", "Wipe", "Wipe it")], "of the unknown type"),
        (operation(stage("s", leaf("a"))), [ActionData("a", "Insert", "In")], "'In', which has no reference pose"),
        (operation(stage("s", leaf("a"))), [ActionData("a", "Use", "Cut")], "'Cut', which has no tool"),
        (operation(stage("s", leaf("a"))), [ActionData("a", "Question", "Q", answers=("x",))], "has no right answer"),
        (
            operation(stage("s", leaf("a"))),
            [ActionData("a", "Question", "Q", answers=("x",), correct=(1,))],
            "calls an answer right that it does not have",
        ),
        (
            operation(stage("s", leaf("a"))),
            [ActionData("a", "Parallel", "G", members=("b",)), ActionData("b", "Parallel", members=("a",))],
            "is a member of itself",
        ),
        (
            operation(stage("s", leaf("a"))),
            [ActionData("a", "Parallel", "G", members=("b",), names={"b": "Doff"})],
            "groups 'Doff', which is not in the scene",
        ),
    ],
)
def test_problems_name_the_object(root, actions, message):
    graph = scene(root, *actions, knee=np.eye(4))
    messages = [problem.message for problem in check_lesson(graph, root) if problem.severe]
    assert any(message in each for each in messages), messages
    assert not any(each[0].islower() for each in messages)
    with pytest.raises(UniSGError, match="the lesson cannot be played"):
        prepare(graph, root)


def test_a_sound_lesson_has_no_problems_and_an_unused_action_is_only_told():
    root = operation(stage("s", leaf("a")))
    graph = scene(root, question("a"), question("b"))
    assert check_lesson(graph, root) == []
    assert [(problem.uid, problem.severe) for problem in check_scene(graph)] == [("b", False)]


def run_lesson(graph, moments):
    lesson = prepare(graph)
    state, heard = begin(lesson), []
    for now in moments:
        state, events = play(lesson, state, now)
        heard += events
    return state, heard


def test_the_scalpel_is_placed_on_the_knee():
    """The paper's example: two Inserts under moving parents, in world space, once each, in order."""
    on_knee = shifted(0.1, 0.0, 0.05)
    builder = SceneBuilder()
    root = operation(
        stage("prepare", leaf("scalpel_on_knee"), leaf("mask_on_face"), ordered=False), stage("end", leaf("q"))
    )
    actions = (
        insert("scalpel_on_knee", "scalpel", on_knee, frame="knee"),
        insert("mask_on_face", "mask", shifted(0.0, 0.0, 0.1), frame="face"),
        question("q"),
    )
    body = builder.add("Patient", uid="patient", lsa=root, actions=actions)
    builder.add("Knee", uid="knee", parent=body, local=shifted(x=0.5))
    builder.add("Face", uid="face", parent=body, local=shifted(x=-0.5))
    tray = builder.add("Tray", uid="tray", local=shifted(y=2.0))
    builder.add("Scalpel", uid="scalpel", parent=tray)
    builder.add("Mask", uid="mask", parent=tray)
    graph = builder.build()
    turn = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    small = np.eye(4)
    small[:2, :2] = [[math.cos(0.1), -math.sin(0.1)], [math.sin(0.1), math.cos(0.1)]]

    def now(time, patient, scalpel, mask, answers=None):
        world = world_matrices(graph.replace(local=_moved(graph, patient))).copy()
        knee, face = world[graph.row("Knee")], world[graph.row("Face")]
        world[graph.row("Scalpel")], world[graph.row("Mask")] = knee @ scalpel, face @ mask
        return moment(graph, time, world, answers=answers)

    lying = shifted(1, 2, 0) @ turn
    off, off_face = shifted(x=0.3), shifted(x=0.3)
    place, on_face = on_knee @ small, shifted(0, 0.02, 0.1)
    state, events = run_lesson(
        graph,
        [
            now(0, np.eye(4), off, off_face),
            now(1, lying, on_knee @ turn, off_face),  # the place is right, the angle is not
            now(2, lying, on_knee @ shifted(0.021), off_face),  # the angle is right, the place is not
            now(3, lying @ turn, place, on_face),  # both, two actions in one moment
            now(4, lying, off, on_face),
            now(5, lying, place, on_face, {"q": (1,)}),
            now(6, lying, place, on_face, {"q": (0,)}),
        ],
    )
    told = [(event.time, event.kind, event.uid) for event in events if event.node == "action"]
    assert told == [
        (0, "opened", "scalpel_on_knee"),
        (0, "opened", "mask_on_face"),
        (3, "done", "scalpel_on_knee"),
        (3, "done", "mask_on_face"),
        (3, "opened", "q"),
        (5, "wrong_answer", "q"),
        (6, "done", "q"),
    ]
    assert state.finished
    why = next(event.why for event in events if event.uid == "scalpel_on_knee" and event.kind == "done")
    assert why == "'Scalpel' is 0 cm (at most 2 cm) and 5.73° (at most 10°) from its place"


def _moved(graph, patient):
    local = graph.local.copy()
    local[graph.row("Patient")] = patient
    return local


def two_inserts(**fields):
    root = operation(stage("s", leaf("first"), leaf("second")), **fields)
    first = insert("first", "a", shifted(1))
    second = insert("second", "b", shifted(2))
    return scene(root, first, second, a=np.eye(4), b=np.eye(4))


def places(graph, time, a, b):
    world = world_matrices(graph).copy()
    world[graph.row("A")], world[graph.row("B")] = shifted(a), shifted(b)
    return moment(graph, time, world)


def test_feedback_when_the_order_is_broken():
    graph = two_inserts()
    state, events = run_lesson(graph, [places(graph, t, *ab) for t, ab in enumerate([(0, 0), (0, 2), (1, 2), (1, 2)])])
    told = [(event.time, event.kind, event.uid) for event in events if event.node == "action"]
    assert told == [
        (0, "opened", "first"),
        (1, "out_of_order", "second"),
        (2, "done", "first"),
        (2, "opened", "second"),
        (3, "done", "second"),  # it is where it should be once its turn has come
    ]
    assert next(event.why for event in events if event.kind == "out_of_order") == (
        "'second' has to wait: first action 'FIRST'"
    )
    assert state.finished


def test_no_feedback_for_what_has_been_so_from_the_start_or_comes_with_the_action_of_the_moment():
    graph = two_inserts()
    _, events = run_lesson(graph, [places(graph, t, a, 2) for t, a in enumerate([0, 0, 1])])
    assert not [event for event in events if event.kind == "out_of_order"]
    root = operation(stage("s", leaf("first"), leaf("again")))
    both = (insert("first", "a", shifted(1)), insert("again", "a", shifted(1)))
    graph = scene(root, *both, a=np.eye(4), b=np.eye(4))
    state, events = run_lesson(graph, [places(graph, t, a, 0) for t, a in enumerate([0, 1, 1, 1])])
    assert [(event.time, event.kind) for event in events if event.uid == "again"] == [(1, "opened"), (2, "done")]
    assert state.finished


def test_taking_something_to_its_place_is_no_early_removal():
    away = ActionData("away", "Remove", "away", ("a",), thresholds=Thresholds(0.1))
    root = operation(stage("s", leaf("first"), leaf("away")))
    graph = scene(root, insert("first", "a", shifted(1)), away, a=np.eye(4), b=np.eye(4))
    _, events = run_lesson(graph, [places(graph, t, a, 0) for t, a in enumerate([0, 0.5, 1])])
    assert not [event for event in events if event.kind == "out_of_order"]


def test_an_action_that_two_leaves_perform_is_performed_twice():
    twice = LessonNode("action", "later", "Later", action="first")
    root = operation(stage("s", leaf("first"), leaf("second"), twice))
    graph = scene(root, insert("first", "a", shifted(1)), insert("second", "b", shifted(2)), a=np.eye(4), b=np.eye(4))
    state, events = run_lesson(graph, [places(graph, t, *ab) for t, ab in enumerate([(1, 0), (0, 2), (0, 2), (1, 2)])])
    assert [(event.time, event.uid) for event in events if event.kind == "done" and event.node == "action"] == [
        (0, "first"), (1, "second"), (3, "later"),
    ]  # fmt: skip
    assert state.finished


def test_a_parallel_group_is_a_leaf_and_early_members_are_told():
    group = ActionData("group", "Parallel", "Both", members=("in", "q"))
    root = operation(stage("s", leaf("start"), leaf("group")))
    actions = (question("start"), group, insert("in", "a", shifted(1)), question("q"))
    graph = scene(root, *actions, a=np.eye(4), b=np.eye(4))
    world = [places(graph, t, a, 0) for t, a in enumerate([0, 1, 0, 0, 1, 1])]
    given = [{}, {}, {"start": (0,)}, {"q": (0,)}, {}, {}]
    moments = [moment(graph, now.time, now.world, answers=answers) for now, answers in zip(world, given, strict=True)]
    state, events = run_lesson(graph, moments)
    told = [(event.time, event.kind, event.action) for event in events if event.node == "action"]
    assert told == [
        (0, "opened", "start"), (1, "out_of_order", "in"), (2, "done", "start"), (2, "opened", "group"),
        (4, "done", "group"),
    ]  # fmt: skip
    assert state.finished


def test_states_are_never_changed_in_place():
    graph = two_inserts()
    lesson = prepare(graph)
    first = begin(lesson)
    copy = first.status.copy()
    play(lesson, first, places(graph, 0, 1, 2))
    assert (first.status == copy).all()
    assert not first.actions.done.any()
    again, _ = play(lesson, first, places(graph, 0, 1, 2))
    assert again.actions.done.any()


def test_what_comes_before_and_is_required_is_waited_for_once():
    """And what the node above waits for, too, is named once."""
    first = stage("s1", leaf("a"))
    second = stage("s2", leaf("b"), leaf("c", requires=("b", "s1")), requires=("s1",))
    tree = outline(operation(first, second))
    place = next(place for place, node in enumerate(tree.nodes) if node.uid == "c")
    assert [tree.nodes[each].uid for each in blockers(tree, first_status(tree), place)] == ["b", "s1"]
