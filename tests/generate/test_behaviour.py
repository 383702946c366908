"""Behaviour of new objects: existing lessons are extended and not changed, new ones play to their end."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.behaviour import all_actions, check_scene, operations
from unisg_blender.errors import UniSGError
from unisg_blender.experiments.behaviour.behaviour_benchmark import (
    behaviour_cases,
    by_policy,
    is_sound,
    measure_behaviour,
    plays_to_the_end,
)
from unisg_blender.experiments.behaviour.behaviour_removal import without_behaviour
from unisg_blender.generate.behaviour.action_kinds import TASK, VERSION, Kind, Kinds
from unisg_blender.generate.behaviour.action_policy import RoleMasks, Scores
from unisg_blender.generate.behaviour.action_statistics import learn_kinds
from unisg_blender.generate.behaviour.answer_rules import Asked, learn_answer_rule
from unisg_blender.generate.behaviour.behaviour_adder import Behaviour, add_behaviour
from unisg_blender.generate.behaviour.feasibility import unperformed
from unisg_blender.generate.behaviour.frequency_policy import FrequencyPolicy, LackingPolicy
from unisg_blender.generate.behaviour.observation import observe_behaviour
from unisg_blender.generate.behaviour.reference_poses import PoseSample, learn_reference, reference_pose
from unisg_blender.generate.behaviour.roled_actions import read_roled_actions
from unisg_blender.generate.place.scene_extension import uid_maker
from unisg_blender.runtime.onnx_session import read_metadata
from unisg_blender.scene import ActionData, LessonNode, SceneGraph, Thresholds
from unisg_blender.worlds import operating_room


@cache
def rooms() -> tuple[SceneGraph, ...]:
    """Some operating rooms."""
    return tuple(operating_room(seed) for seed in range(8))


@cache
def kinds() -> Kinds:
    """What they teach."""
    return learn_kinds(rooms())


def again(graph: SceneGraph, name: str) -> tuple[SceneGraph, SceneGraph, Behaviour]:
    """The scene without the behaviour of an object, and with it made anew by rules."""
    bare, uid = without_behaviour(graph, graph.row(name))
    return graph, bare, add_behaviour(bare, [uid], LackingPolicy(kinds()), uid_maker(bare, 0))


def without_new(node: LessonNode, old: set[str]) -> LessonNode:
    """A tree without nodes that were not there before."""
    kept = tuple(without_new(child, old) for child in node.children if child.uid in old)
    return LessonNode(node.kind, node.uid, node.name, node.action, kept, node.requires, node.optional, node.ordered)


@pytest.mark.slow
def test_kinds_tell_who_plays_what_where() -> None:
    found = {kind.name: kind for kind in kinds().kinds}
    incise = found["Incise the knee"]
    assert (incise.type, incise.stage, incise.slots[:2]) == ("Use", "Incise", ({"Knee": 8}, {"Scalpel": 8}))
    assert found["Take the mask off"].group == "Clear the table"
    assert found["Insert the implant"].thresholds == {"distance": 0.01, "angle": 0.174533, "hold": 1.0}
    assert found["How many swab packs are laid out?"].answer_rule is not None
    assert next(stage for stage in kinds().stages if stage.name == "Expose").requires == ("Incise",)
    record, _ = read_metadata(kinds().to_json(), Path("x"), TASK, (VERSION,), "cgvae")
    assert Kinds.from_record(record, Path("x")) == kinds()


@pytest.mark.parametrize("name", ["Scalpel", "Knee", "Swab", "Bag Mask", "Mayo Stand"])
def test_a_lesson_is_extended_and_not_changed(name: str) -> None:
    _, bare, made = again(rooms()[0], name)
    assert made.actions
    (before,), (after,) = operations(bare), operations(made.scene)
    assert without_new(after, {node.uid for node in before.walk()}) == before
    old = {action.uid: action for action in all_actions(bare)}
    assert {action.uid: action for action in all_actions(made.scene) if action.uid in old} == old
    assert is_sound(bare, made.scene)
    assert not check_scene(made.scene)
    for uid in set(bare.uid) - {next(iter(made.actions))}:
        row, place = bare.row_of_uid[uid], made.scene.row_of_uid[uid]
        assert bare[row].actions == made.scene[place].actions


@pytest.mark.slow
def test_a_thing_gets_back_what_it_had() -> None:
    real, bare, made = again(rooms()[0], "Scalpel")
    row = real.row("Scalpel")
    wanted = {roled.action.name: roled for roled in read_roled_actions(real) if row in roled.slots}
    got = {roled.action.name: roled for roled in read_roled_actions(made.scene) if roled.action.uid not in _uids(bare)}
    usual = set(wanted) - {"How many scalpels are there?"}
    assert usual <= set(got)
    back, true = got["Put the scalpel back"].action, wanted["Put the scalpel back"].action
    assert back.frame == true.frame
    np.testing.assert_allclose(back.reference, true.reference, atol=1e-6)
    assert back.thresholds.angle == true.thresholds.angle
    assert plays_to_the_end(made.scene)


def _uids(graph: SceneGraph) -> set[str]:
    return {action.uid for action in all_actions(graph)}


def test_same_seed_same_behaviour_another_seed_other_uids() -> None:
    bare, uid = without_behaviour(rooms()[1], rooms()[1].row("Scalpel"))
    one, two, other = (
        add_behaviour(bare, [uid], LackingPolicy(kinds()), uid_maker(bare, seed)).scene for seed in (0, 0, 1)
    )
    assert all_actions(one) == all_actions(two)
    assert _uids(one) != _uids(other)


@pytest.mark.slow
def test_a_scene_without_a_lesson_gets_a_whole_one_that_plays() -> None:
    graph = rooms()[2]
    bare = graph.replace(components={key: graph.components[key] for key in ("relations",)})
    made = add_behaviour(bare, bare.uid, LackingPolicy(kinds()), uid_maker(bare, 0))
    (tree,) = operations(made.scene)
    names = [node.name for node in tree.walk() if node.kind == "stage"]
    (true,) = operations(graph)
    assert names == [node.name for node in true.walk() if node.kind == "stage"]
    expose = next(node for node in tree.walk() if node.name == "Expose")
    assert expose.requires == (next(node.uid for node in tree.walk() if node.name == "Incise"),)
    assert any(action.type == "Parallel" and len(action.members) > 2 for action in all_actions(made.scene))
    assert not check_scene(made.scene)
    assert plays_to_the_end(made.scene)


def test_a_second_scalpel_gets_nothing_and_a_chair_neither() -> None:
    graph = next(room for room in rooms() if "Scalpel.001" in room.name)
    bare, uid = without_behaviour(graph, graph.row("Scalpel.001"))
    policy = LackingPolicy(kinds())
    made = add_behaviour(bare, [uid], policy, uid_maker(bare, 0))
    assert "Incise the knee" not in made.actions.get(uid, [])
    stool = graph.uid[graph.row("Stool")]
    assert add_behaviour(graph, [stool], policy, uid_maker(graph, 0)).scene is graph


class Wants:
    """Wants one kind of action, with a probability, with whoever may play in it."""

    def __init__(self, name: str, chance: float = 1.0) -> None:
        self.kinds, self.chance = kinds(), chance
        self.number = [kind.name for kind in self.kinds.kinds].index(name)

    def scores(self, play):
        objects = len(play.rows)
        wanted = np.zeros(len(self.kinds.kinds))
        wanted[self.number] = self.chance * float(not (play.kind == self.number).any())
        pairs = np.zeros((len(wanted), objects, objects))
        return Scores(wanted, np.zeros((len(wanted), objects)), pairs, pairs)

    def after(self, play, choice) -> int:
        return -1


def test_what_cannot_be_performed_is_not_made_and_a_note_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = rooms()[0]
    bare, uid = without_behaviour(graph, graph.row("Scalpel"))
    monkeypatch.setattr(
        "unisg_blender.generate.behaviour.behaviour_adder.unperformed",
        lambda scene, actions: {action.uid: "it could not be performed" for action in actions},
    )
    made = add_behaviour(bare, [uid], Wants("Incise the knee"), uid_maker(bare, 0))
    assert made.scene is bare
    assert made.notes[uid] == ["no 'Incise the knee': it could not be performed"]


@pytest.mark.slow
def test_what_is_done_now_and_then_is_drawn_and_what_is_usual_always_done() -> None:
    graph = rooms()[0]
    bare, uid = without_behaviour(graph, graph.row("Laryngoscope"))

    def made(chance: float, rng: np.random.Generator | None) -> bool:
        policy = Wants("Look with the laryngoscope", chance)
        return bool(add_behaviour(bare, [uid], policy, uid_maker(bare, 0), rng).actions)

    often = np.mean([made(0.4, np.random.default_rng(seed)) for seed in range(60)])
    assert 0.25 < often < 0.55
    assert all(made(0.6, np.random.default_rng(seed)) for seed in range(6))
    assert not any(made(0.05, np.random.default_rng(seed)) for seed in range(20))
    assert not made(0.4, None)


def test_nobody_carries_what_it_has_to_come_to() -> None:
    graph = rooms()[0]
    play = observe_behaviour(graph, kinds(), graph.uid)
    masks = RoleMasks(kinds())
    number = [kind.name for kind in kinds().kinds].index("Put on the mask")
    scores = Wants("Put on the mask").scores(play)
    for choice in masks.assignments(play, scores, number):
        target, _, frame = choice.slots
        assert not play.below[target, frame]


def test_actions_that_cannot_be_performed_are_found() -> None:
    graph = rooms()[0]
    knee, patient = graph.uid[graph.row("Knee")], graph.uid[graph.row("Patient")]
    pose = tuple(np.eye(4).reshape(-1).tolist())
    limits = Thresholds(distance=0.01)
    moved = tuple((np.eye(4) + np.eye(4, k=3) * 0.5).reshape(-1).tolist())
    away = ActionData("a", "Insert", targets=(patient,), frame=knee, reference=moved, thresholds=limits)
    fine = ActionData("b", "Insert", targets=(knee,), frame=patient, reference=pose, thresholds=limits)
    assert unperformed(graph, [fine]) == {}
    assert "a" in unperformed(graph, [fine, away])


def test_references_follow_the_rule_that_varies_least() -> None:
    rng = np.random.default_rng(0)
    samples = []
    for _ in range(20):
        own, reference = np.eye(4), np.eye(4)
        own[:3, 3] = rng.normal(size=3)
        middle, half = np.array([0, 0, 0.4]), np.array([0.3, 0.2, rng.uniform(0.2, 0.6)])
        reference[:3, 3] = own[0, 3] + 0.1, 0.25, middle[2] + half[2] + 0.02
        samples.append(PoseSample(reference, own, middle, half))
    rule = learn_reference(samples)
    assert rule is not None
    assert rule.rule == ("own", "frame", "high")
    np.testing.assert_allclose(rule.value, (0.1, 0.25, 0.02), atol=1e-6)
    one = samples[3]
    np.testing.assert_allclose(reference_pose(rule, one.own, one.middle, one.half), one.reference, atol=1e-6)


def test_right_answers_follow_rules_that_always_held() -> None:
    from collections import Counter

    counted = [Asked(("1", "2", "3"), str(n), Counter({"Cup": n, "Lamp": 2}), np.array([1.0, 0, 0])) for n in (1, 2, 3)]
    found = learn_answer_rule(counted)
    assert found is not None
    assert (found.rule, found.of) == ("count", "Cup")
    sides = [Asked(("Left", "Right"), "Left" if x > 0 else "Right", Counter(), np.array([x, 0, 0])) for x in (-1, 1, 2)]
    found = learn_answer_rule(sides)
    assert found is not None
    assert (found.rule, found.of, found.answers) == ("side", "x", ("Left", "Right"))
    tossed = [Asked(("a", "b"), answer, Counter(), np.zeros(3)) for answer in "abab"]
    assert learn_answer_rule(tossed) is None


@pytest.mark.slow
def test_the_measures_of_a_perfect_and_of_an_idle_policy() -> None:
    cases = behaviour_cases(rooms()[:3], seed=1)
    assert all(case.gone for case in cases)

    class Idle(LackingPolicy):
        def scores(self, play):
            return Scores(*([np.zeros(len(self.kinds.kinds))] * 4))

    idle = measure_behaviour("idle", cases, by_policy(Idle(kinds())), kinds(), play=1)
    assert (idle.recall, idle.exact, idle.sound) == (0.0, 0.0, 1.0)
    rule = measure_behaviour("rule", cases, by_policy(LackingPolicy(kinds())), kinds(), play=1)
    assert rule.recall > 0.6
    assert rule.sound == 1.0
    assert rule.played == 1.0
    assert rule.stage == 1.0
    assert (
        rule.recall
        >= measure_behaviour("frequency", cases, by_policy(FrequencyPolicy(kinds())), kinds(), play=0).recall
    )


def test_damaged_and_newer_metadata_are_told(tmp_path: Path) -> None:
    text = kinds().to_json()
    for bad in ("{", "[]", text.replace('"task": "behaviour"', '"task": "generate"'), '{"contract": 99, "task": "x"}'):
        with pytest.raises(UniSGError):
            read_metadata(bad, tmp_path / "x.onnx", TASK, (VERSION,), "cgvae")
    with pytest.raises(UniSGError, match="damaged"):
        Kinds.from_record({"kinds": [{"type": "Insert"}]}, tmp_path / "x.onnx")


def test_a_kind_has_its_key() -> None:
    assert isinstance(kinds().kinds[0], Kind)
    assert all(kinds().number_of[kind.key] == number for number, kind in enumerate(kinds().kinds))


def test_a_place_that_is_a_share_of_small_frames_is_learned_as_one() -> None:
    """Boxes of 5 to 15 cm that stand anywhere, and a place half-way up each: the share varies by millimetres."""
    rng = np.random.default_rng(0)
    samples = []
    for _ in range(40):
        middle, half = rng.uniform(-1, 1, 3), rng.uniform(0.05, 0.15, 3)
        reference, own = np.eye(4), np.eye(4)
        reference[:3, 3] = middle + rng.normal(0.5, 0.02, 3) * half
        own[:3, 3] = rng.uniform(-1, 1, 3)
        samples.append(PoseSample(reference, own, middle, half))
    learned = learn_reference(samples)
    assert learned is not None
    assert learned.rule == ("share", "share", "share")
    assert learned.value == pytest.approx((0.5, 0.5, 0.5), abs=0.02)
