from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear
from scipy.spatial.transform import Rotation

from unisg_blender.behaviour import compile_actions, holds, moment, start, step
from unisg_blender.behaviour.fulfilment.body_contact import EPSILON, _touching_exactly, bodies_at, body_bounds, touching
from unisg_blender.behaviour.fulfilment.deviation import away_by, placed
from unisg_blender.geometry.affine_rows import gather, rotation_and_size, turn_between
from unisg_blender.geometry.box_distance import separation
from unisg_blender.geometry.box_overlap import penetration
from unisg_blender.geometry.boxes import Boxes
from unisg_blender.scene import (
    ActionData,
    SceneBuilder,
    Thresholds,
    mesh_from_faces,
    world_matrices,
)
from unisg_blender.spatial import oriented_boxes

CUBE = mesh_from_faces(
    "cube",
    np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]),
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
)
DEGREE = math.pi / 180
POSE = tuple(np.eye(4).ravel())


def at(x=0.0, y=0.0, z=0.0, turn=(0.0, 0.0, 0.0), scale=1.0):
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec(np.array(turn)).as_matrix() * scale
    matrix[:3, 3] = x, y, z
    return matrix


def flat(matrix):
    return tuple(matrix.ravel())


class Bench:
    """Two cubes, a frame and one action; plays poses one after another."""

    def __init__(self, action, **where):
        builder = SceneBuilder()
        builder.add("Frame", uid="frame", local=where.get("frame"))
        builder.add("Target", uid="target", local=where.get("target"), mesh=CUBE, actions=(action,))
        builder.add("Tool", uid="tool", local=where.get("tool", at(5)), mesh=CUBE)
        self.graph = builder.build()
        self.checks = compile_actions(self.graph)
        self.state = start(self.checks)

    def at(self, time, trigger=(), force=None, answers=None, **where):
        world = world_matrices(self.graph).copy()
        for name, matrix in where.items():
            world[self.graph.row(name.capitalize())] = matrix
        self.state = step(self.checks, self.state, moment(self.graph, time, world, trigger, force, answers))
        return bool(self.state.done[0])


def insert(**thresholds):
    return ActionData("a", "Insert", targets=("target",), reference=flat(at(1)), thresholds=Thresholds(**thresholds))


@pytest.mark.parametrize(
    ("limit", "pose", "expected"),
    [
        ({"distance": 0.1}, at(1.1), True),  # exactly at the limit
        ({"distance": 0.1}, at(1.1 + 1e-6), False),
        ({"distance": 0.0}, at(1), True),
        ({"distance": 0.0}, at(1 + 1e-6), False),
        ({"angle": 10 * DEGREE}, at(9, turn=(0, 0, 10 * DEGREE)), True),
        ({"angle": 10 * DEGREE}, at(1, turn=(0, 0, 10.0001 * DEGREE)), False),
        ({"angle": math.pi}, at(1, turn=(math.pi, 0, 0)), True),
        ({"distance": 0.1, "angle": 0.2}, at(1.1, turn=(0, 0.2, 0)), True),
        ({"distance": 0.1, "angle": 0.2}, at(1.1001, turn=(0, 0.2, 0)), False),
        ({"distance": 0.1, "angle": 0.2}, at(1.1, turn=(0, 0.2001, 0)), False),
        ({"distance": 0.1, "angle": 0.2}, at(1, scale=7.0), True),  # scale is no rotation
        ({"distance": 0.1, "angle": 0.2}, at(1, scale=np.array([[1, 1, -1]] * 3)), False),  # a mirror is one
    ],
)
def test_insert_at_the_threshold_and_remove_is_its_opposite(limit, pose, expected):
    action = insert(**limit)
    assert Bench(action).at(0, target=pose) is expected
    remove = ActionData("a", "Remove", targets=("target",), reference=action.reference, thresholds=action.thresholds)
    assert Bench(remove).at(0, target=pose) is not expected


def test_insert_is_judged_in_the_world_under_a_moving_frame():
    action = ActionData(
        "a", "Insert", targets=("target",), frame="frame", reference=flat(at(1)), thresholds=Thresholds(0.1, 0.1)
    )
    bench = Bench(action)
    turned = at(3, 2, 1, turn=(0, 0, 1.0), scale=2.0)
    assert not bench.at(0, frame=turned, target=at(1))  # where it would be if the frame had not moved
    assert not bench.at(1, frame=turned, target=turned @ at(1.06))  # 6 cm in the frame are 12 cm in the world
    assert bench.at(2, frame=turned, target=turned @ at(1.04))


def test_hold_has_to_last_without_a_break():
    bench = Bench(insert(distance=0.1, hold=1.0))
    assert not bench.at(0.0, target=at(1))
    assert not bench.at(0.9, target=at(1))
    assert not bench.at(1.0, target=at(2))
    assert not bench.at(1.1, target=at(1))
    assert not bench.at(2.0, target=at(1))
    assert bench.at(2.1, target=at(1))  # exactly one second
    assert bench.at(3.0, target=at(2))  # stays performed


def test_remove_without_a_reference_leaves_where_the_scene_has_it():
    action = ActionData("a", "Remove", targets=("target",), frame="frame", thresholds=Thresholds(0.5))
    bench = Bench(action, frame=at(1), target=at(2))
    assert not bench.at(0)
    assert not bench.at(1, frame=at(11), target=at(12))  # carried along with the frame
    assert not bench.at(2, frame=at(11), target=at(12.5))
    assert bench.at(3, frame=at(11), target=at(12.6))


def use(kind="Use", **fields):
    thresholds = Thresholds(**fields.pop("thresholds", {}))
    return ActionData("a", kind, targets=("target",), tools=("tool",), thresholds=thresholds, **fields)


@pytest.mark.parametrize(
    ("distance", "tool", "expected"),
    [
        (None, at(1), True),  # faces touch
        (None, at(1 + 1e-6), False),
        (0.25, at(1.25), True),
        (0.25, at(1.2500001), False),
        (0.5, at(1.3, 1.4), True),  # edge to edge: 3-4-5
        (0.5, at(1.3001, 1.4), False),
        (None, at(0.5 + math.sqrt(0.5), turn=(0, 0, math.pi / 4)), True),  # an edge touches a face
        (None, at(0.5001 + math.sqrt(0.5), turn=(0, 0, math.pi / 4)), False),
    ],
)
def test_use_needs_contact(distance, tool, expected):
    assert Bench(use(thresholds={"distance": distance})).at(0, tool=tool) is expected


def test_use_with_trigger_time_force_and_hits():
    bench = Bench(use(trigger=True, thresholds={"hold": 0.5, "hits": 2, "force": 3.0}))
    touch = {"tool": at(0.9), "trigger": ("tool",), "force": {"tool": 3.0}}
    bench.at(0.0, **touch)
    bench.at(0.5, **touch)
    assert bench.state.hits[0] == 1
    bench.at(5.0, **touch)
    assert bench.state.hits[0] == 1  # one contact counts once, however long
    bench.at(5.1, tool=at(2))
    for wrong in ({"trigger": ()}, {"force": {"tool": 2.9}}, {"tool": at(2)}):
        bench.at(6.0, **touch | wrong)
        bench.at(7.0, **touch | wrong)
        assert bench.state.hits[0] == 1
    bench.at(8.0, **touch)
    assert bench.at(8.5, **touch)


def test_a_tool_works_at_its_pose_with_its_trigger():
    bench = Bench(use("Tool", reference=flat(at(0, 0, 2)), thresholds={"distance": 0.1, "angle": 0.1, "hits": 2}))
    there = at(0, 0, 2.1)
    assert not bench.at(0, tool=there)
    assert not bench.at(1, tool=there, trigger=("tool",))
    assert not bench.at(2, tool=there, trigger=("target",))
    assert not bench.at(3, tool=at(0.9), trigger=("tool",))  # contact is not what it asks for
    assert bench.at(4, tool=there, trigger=("tool",))
    touching = Bench(use("Tool"))
    assert not touching.at(0, tool=at(1))
    assert not touching.at(1, tool=at(1.1), trigger=("tool",))
    assert touching.at(2, tool=at(1), trigger=("tool",))


def test_question():
    action = ActionData("a", "Question", answers=("two", "three", "four"), correct=(0, 2))
    for chosen, expected in [((0,), False), ((0, 1, 2), False), ((2, 0), True), ((), False)]:
        assert Bench(action).at(0, answers={"a": chosen}) is expected
    assert not Bench(action).at(0, answers={"other": (0, 2)})


@pytest.mark.parametrize(("mode", "expected"), [("any", [False, True, True]), ("all", [False, False, True])])
def test_parallel(mode, expected):
    group = ActionData("g", "Parallel", members=("a", "q"), mode=mode)
    question = ActionData("q", "Question", answers=("yes",), correct=(0,))
    builder = SceneBuilder()
    builder.add("Target", uid="target", mesh=CUBE, actions=(group, insert(distance=0.1), question))
    graph = builder.build()
    checks = compile_actions(graph)
    state, world = start(checks), world_matrices(graph).copy()
    done = []
    for chosen, pose in [({}, at(0)), ({"q": (0,)}, at(0)), ({}, at(1))]:
        world[0] = pose
        state = step(checks, state, moment(graph, len(done), world, answers=chosen))
        done.append(bool(state.done[0]))
    assert done == expected


def test_several_targets_mean_any_of_them_and_actions_have_states_of_their_own():
    builder = SceneBuilder()
    either = ActionData("either", "Insert", targets=("a", "b"), reference=flat(at(1)), thresholds=Thresholds(0.1))
    first = ActionData("first", "Insert", targets=("a",), reference=flat(at(1)), thresholds=Thresholds(0.1))
    builder.add("A", uid="a", actions=(either, first))
    builder.add("B", uid="b", local=at(1))
    graph = builder.build()
    checks = compile_actions(graph)
    state = step(checks, start(checks), moment(graph, 0, world_matrices(graph)))
    assert state.done.tolist() == [True, False]


def lift(batch, moment):
    """The target is at least ``distance`` metres up."""
    return moment.world[batch.target, 2, 3] >= batch.distance


def test_a_type_of_your_own_is_a_function():
    builder = SceneBuilder()
    action = ActionData("up", "Lift", targets=("cup",), thresholds=Thresholds(distance=0.3, hold=1.0))
    builder.add("Cup", uid="cup", actions=(action,))
    graph = builder.build()
    checks = compile_actions(graph, conditions={"Lift": lift})
    state, done = start(checks), []
    for time, height in [(0, 0.2), (1, 0.3), (1.5, 0.4), (2, 0.3)]:
        state = step(checks, state, moment(graph, time, at(z=height)[None]))
        done.append(bool(state.done[0]))
    assert done == [False, False, False, True]
    assert compile_actions(graph).unknown == (0,)


def test_what_is_missing_or_not_a_number_is_never_performed():
    gone = ActionData("g", "Insert", targets=("gone",), reference=flat(at()), thresholds=Thresholds(1.0))
    frameless = ActionData(
        "f", "Insert", targets=("t",), frame="gone", reference=flat(at()), thresholds=Thresholds(1.0)
    )
    here = ActionData("h", "Insert", targets=("t",), reference=flat(at()), thresholds=Thresholds(1.0, 1.0))
    away = ActionData("r", "Remove", targets=("t",), thresholds=Thresholds(1.0, 1.0))
    touch = ActionData("u", "Use", targets=("t",), tools=("t", "gone", "b"))
    builder = SceneBuilder()
    builder.add("T", uid="t", mesh=CUBE, actions=(gone, frameless, here, away, touch))
    builder.add("B", uid="b", mesh=CUBE)
    graph = builder.build()
    world = np.full((2, 4, 4), np.nan)
    assert not holds(compile_actions(graph), moment(graph, 0, world)).any()


MATRIX = st.lists(st.floats(-3, 3), min_size=9, max_size=9).map(lambda values: np.array(values).reshape(3, 3))


@given(MATRIX)
@settings(max_examples=150, deadline=None)
def test_rotations_are_those_of_the_polar_decomposition(linear):
    u, singular, v = np.linalg.svd(linear)
    if singular[-1] < 1e-3 or abs(singular[0] / singular[-1]) > 1e4:
        return
    expected = u @ v * (1 if np.linalg.det(linear) > 0 else -1)
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    found = rotation_and_size(gather(matrix[None], np.array([0])))[0].reshape(3, 3).T
    assert np.abs(found - expected).max() < 1e-7


@given(st.lists(st.floats(-6, 6), min_size=6, max_size=6))
@settings(max_examples=100, deadline=None)
def test_angles_agree_with_scipy(numbers):
    first, second = Rotation.from_rotvec(numbers[:3]), Rotation.from_rotvec(numbers[3:])
    columns = [turn.as_matrix().T.reshape(9, 1) for turn in (first, second)]
    assert turn_between(*columns)[0] == pytest.approx((first.inv() * second).magnitude(), abs=1e-7)


@given(st.lists(st.floats(-3, 3), min_size=6, max_size=6), st.lists(st.floats(0.05, 1), min_size=6, max_size=6))
@settings(max_examples=60, deadline=None)
def test_separation_is_the_distance(pose, half):
    turn = Rotation.from_rotvec(pose[:3]).as_matrix()
    first = Boxes(np.zeros((1, 3)), np.eye(3)[None], np.array([half[:3]]), np.ones(1, bool))
    second = Boxes(np.array([pose[3:]]), turn[None], np.array([half[3:]]), np.ones(1, bool))
    if penetration(first, second)[0] > -1e-3:
        return

    points = np.hstack([np.diag(half[:3]), -turn @ np.diag(half[3:])])  # of one box less those of the other, in -1..1
    nearest = lsq_linear(points, pose[3:], bounds=(-1, 1), method="bvls", tol=1e-14)
    assert separation(first, second)[0] == pytest.approx(math.sqrt(2 * nearest.cost), abs=1e-6)


def test_bodies_are_the_oriented_boxes_and_groups_have_one_too():
    builder = SceneBuilder()
    sheared = np.diag([1.0, 2.0, 0.5, 1.0]) @ at(turn=(0.3, 0.4, 0.5))
    group = builder.add("Group", uid="g", local=at(1, turn=(0, 0, 0.7)))
    builder.add("One", uid="1", parent=group, mesh=CUBE)
    builder.add("Two", uid="2", parent=group, local=at(2), mesh=CUBE)
    builder.add("Sheared", uid="s", local=sheared, mesh=CUBE)
    graph = builder.build()
    rows = np.arange(len(graph))
    bodies = bodies_at(gather(world_matrices(graph), rows), body_bounds(graph, rows))
    boxes = oriented_boxes(graph)
    solid = boxes.solid
    assert np.allclose(bodies.center[solid], boxes.center[solid])
    assert np.allclose(bodies.half[solid], boxes.half[solid])
    whole = bodies.half[graph.row("Group")]
    assert np.allclose(whole, [1.5, 0.5, 0.5])


def random_poses(random, count, single):
    """Poses (12, K) of all sorts: rigid, scaled, mirrored, sheared, flat, axis-aligned."""
    linear = Rotation.random(count, random_state=random).as_matrix()
    linear[::7] = np.eye(3)
    linear[1::7] *= random.uniform(0.2, 3, (len(linear[1::7]), 1, 3))
    linear[2::7] *= -1
    linear[3::7] += random.normal(0, 0.3, (len(linear[3::7]), 3, 3))
    linear[4::7, :, 0] *= random.choice([0.0, -1.0, 1e-9], (len(linear[4::7]), 1))
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, :3, :3], matrices[:, :3, 3] = linear, random.normal(0, 0.12, (count, 3)).round(2)
    return matrices.astype(np.float32).astype(np.float64) if single else matrices


@pytest.mark.parametrize("single", [False, True])
def test_quick_answers_about_contact_are_those_of_the_exact_test(single):
    random, count = np.random.default_rng(5), 4000
    poses = [gather(random_poses(random, count, single), np.arange(count)) for _ in range(2)]
    bounds = [
        np.concatenate([random.normal(0, 0.02, (3, count)), random.choice([0, 0.01, 0.05, 0.1, 0.2], (3, count))])
        for _ in range(2)
    ]
    distance = random.choice([0, 0, 0.01, 0.05], count)
    found = touching(poses[0], bounds[0], poses[1], bounds[1], distance)
    bodies = [bodies_at(pose, box) for pose, box in zip(poses, bounds, strict=True)]
    assert np.array_equal(found, _touching_exactly(*bodies, distance + EPSILON))
    assert 0.2 < found.mean() < 0.8


@pytest.mark.parametrize("single", [False, True])
def test_quick_answers_about_poses_are_those_of_the_angle(single):
    random, count = np.random.default_rng(6), 700
    world = random_poses(random, 3 * count, single)
    world[:count, :3, :3] = world[count : 2 * count, :3, :3] @ world[2 * count :, :3, :3]  # many at their places
    turn = Rotation.from_rotvec(random.choice([0, 1e-9, 1e-4, 0.1, 0.10001, 3.14], (count, 1)) * [0.6, 0, 0.8])
    world[:count, :3, :3] = world[:count, :3, :3] @ turn.as_matrix()
    builder = SceneBuilder()
    for row in range(2 * count):
        builder.add(f"Thing {row:04}", uid=str(row))
    for row, reference in enumerate(world[2 * count :]):
        limits = Thresholds(random.choice([0.1, 0.2, 1]), random.choice([0, 1e-9, 1e-4, 0.1, 3.14, math.pi, 7]))
        builder.add(
            f"Thing {2 * count + row:04}", uid=str(2 * count + row),
            actions=(ActionData(f"a{row}", "Insert", "", (str(row),), (), flat(reference), str(count + row), limits),),
        )  # fmt: skip
    graph = builder.build()
    batch = compile_actions(graph).batches[0][1]
    now = moment(graph, 0, world)
    distance, angle = away_by(batch, now)
    expected = (distance <= batch.poses.distance + EPSILON) & (angle <= batch.poses.angle + EPSILON)
    there, away = placed(batch, now)
    assert np.array_equal(there, expected)
    assert np.array_equal(away, ~expected)
    assert 0.2 < there.mean() < 0.8
