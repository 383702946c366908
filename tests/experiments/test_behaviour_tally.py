"""What counts of behaviour that was made again: each measure where all is right, and where one thing is not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from unisg_blender.experiments.behaviour.behaviour_benchmark import behaviour_cases
from unisg_blender.experiments.behaviour.behaviour_tally import BehaviourCase, Tally
from unisg_blender.generate.behaviour.action_kinds import Kinds
from unisg_blender.generate.behaviour.action_statistics import learn_kinds
from unisg_blender.scene import ActionData, SceneGraph, Thresholds
from unisg_blender.worlds import operating_room

Edit = Callable[[ActionData], ActionData]


@cache
def cases() -> tuple[BehaviourCase, ...]:
    return tuple(behaviour_cases([operating_room(seed) for seed in range(12)], seed=1))


@cache
def kinds() -> Kinds:
    return learn_kinds([case.real for case in cases()])


def edited(case: BehaviourCase, edit: Edit) -> SceneGraph:
    """The real scene, the actions that had been taken out changed."""
    gone = {roled.action.uid for roled in case.gone}
    table = case.real.components["actions"]
    column = table.columns["action"].copy() if "action" in table.columns else None
    name = "action" if column is not None else next(iter(table.columns))
    column = table.columns[name].copy()
    for place, action in enumerate(column):
        if action.uid in gone:
            column[place] = edit(action)
    changed = replace(table, columns={**table.columns, name: column})
    return case.real.replace(components={**case.real.components, "actions": changed})


def tallied(edit: Edit = lambda action: action, some: tuple[BehaviourCase, ...] | None = None) -> Tally:
    found = Tally(kinds())
    for case in cases() if some is None else some:
        scene = edited(case, edit)
        moved = next(iter(set(case.real.uid) - set(case.bare.uid)), case.uid)
        found.add(case, scene, moved)
    return found


def wanted() -> int:
    return sum(len(case.gone) for case in cases())


def test_the_same_again_is_wholly_right() -> None:
    row = tallied().row("same", len(cases()), 7.0)
    assert row.actions == wanted() > 0
    for name in ("recall", "precision", "exact", "stage", "order", "answers", "usual_recall"):
        assert getattr(row, name) == 1, name
    assert (row.thresholds, row.pose_cm, row.pose_degrees, row.milliseconds) == (0, 0, pytest.approx(0, abs=0.01), 7.0)
    record = row.to_record()
    assert record["played"] is None
    assert record["sound"] is None
    assert record["name"] == "same"


def test_nothing_made_recalls_nothing_and_is_not_wrong() -> None:
    found = Tally(kinds())
    for case in cases():
        found.add(case, case.bare, case.uid)
    row = found.row("none", len(cases()), 0.0)
    assert (row.recall, row.precision, row.exact, row.entities) == (0, 1, 0, 0)
    assert found.counts["made"] == 0
    assert (row.stage, row.order, row.answers) == (1, 1, 1)  # of nothing


def test_another_kind_of_action_is_no_right_one() -> None:
    row = tallied(lambda action: replace(action, type="Use" if action.type != "Use" else "Insert")).row(
        "other", 12, 0.0
    )
    assert (row.recall, row.precision, row.exact) == (0, 0, 0)


def test_half_of_them_right_is_half() -> None:
    half = len(cases()) // 2
    found = tallied(some=cases()[:half])
    for case in cases()[half:]:
        found.add(case, case.bare, case.uid)
    row = found.row("half", len(cases()), 0.0)
    assert row.exact == half / len(cases())
    right = sum(len(case.gone) for case in cases()[:half])
    assert row.recall == pytest.approx(right / wanted())
    assert row.precision == 1


def test_limits_are_off_by_their_share() -> None:
    def half_as_far(action: ActionData) -> ActionData:
        limits = action.thresholds
        return replace(action, thresholds=replace(limits, distance=limits.distance and limits.distance * 1.5))

    asked = [
        (name, getattr(roled.action.thresholds, name))
        for case in cases() for roled in case.gone for name in Thresholds.__dataclass_fields__
    ]  # fmt: skip
    told = [name for name, value in asked if value]
    assert "distance" in told
    row = tallied(half_as_far).row("wide", 12, 0.0)
    assert row.thresholds == pytest.approx(0.5 * told.count("distance") / len(told))
    none = tallied(lambda action: replace(action, thresholds=Thresholds())).row("none", 12, 0.0)
    assert none.thresholds == 1


def test_poses_are_apart_in_centimetres_and_degrees() -> None:
    def elsewhere(action: ActionData) -> ActionData:
        matrix = action.reference_matrix
        if matrix is None:
            return action
        cos, sin = np.cos(0.5), np.sin(0.5)
        turned = matrix @ np.array([[cos, -sin, 0, 0], [sin, cos, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        turned[:3, 3] += 0.03, 0.04, 0
        return replace(action, reference=tuple(turned.ravel().tolist()))

    assert any(roled.action.reference for case in cases() for roled in case.gone)
    row = tallied(elsewhere).row("moved", 12, 0.0)
    assert row.pose_cm == pytest.approx(5, rel=1e-4)
    assert row.pose_degrees == pytest.approx(np.degrees(0.5), rel=1e-4)


def test_wrong_answers_count() -> None:
    def wrong(action: ActionData) -> ActionData:
        others = tuple(k for k in range(len(action.answers)) if k not in action.correct)
        return replace(action, correct=others[:1]) if action.answers else action

    questions = sum(roled.action.type == "Question" for case in cases() for roled in case.gone)
    assert questions
    found = tallied(wrong)
    assert found.row("wrong", 12, 0.0).answers == 0
    assert found.counts["asked"] == questions


def test_sound_and_played_are_means_of_what_was_looked_at() -> None:
    found = tallied()
    found.sound, found.played = [True, True, False, True], [False, True]
    row = found.row("some", 12, 0.0)
    assert (row.sound, row.played) == (0.75, 0.5)
    assert row.to_record()["played"] == 0.5
