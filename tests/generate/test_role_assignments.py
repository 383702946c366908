"""Which objects take which roles: the best by the sum of their scores, of those that can be performed."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from unisg_blender.generate.behaviour.action_kinds import Kind, Kinds
from unisg_blender.generate.behaviour.action_policy import MOST_ASSIGNMENTS, ActionChoice, RoleMasks, Scores
from unisg_blender.generate.behaviour.observation import BehaviourObservation

CATEGORIES = ("Patient", "Scalpel", "Tray")
PATIENT, SCALPEL, TRAY = range(3)


def kind(name: str, action: str, *slots: tuple[str, ...]) -> Kind:
    roles = [dict.fromkeys(names, 1) for names in (*slots, *[()] * (3 - len(slots)))]
    return Kind(action, name, "", "", (roles[0], roles[1], roles[2]), {}, 1.0, 1, 0.0, {})


KINDS = Kinds(
    CATEGORIES,
    (
        kind("cut", "Tool", ("Patient",), ("Scalpel",)),
        kind("take", "Remove", ("Scalpel",), (), ("Tray",)),
        kind("use", "Use", ("Patient", "Tray"), ("Scalpel", "Tray"), ("Patient", "Unknown")),
        kind("none", "Use", ("Unknown",)),
    ),
    (), {}, "",
)  # fmt: skip


def observed(seed: int = 0) -> BehaviourObservation:
    """A patient, three scalpels of which one is on the tray, a tray on another tray, and something else; two new."""
    category = np.array([PATIENT, SCALPEL, SCALPEL, SCALPEL, TRAY, TRAY, -1])
    count = len(category)
    below = np.eye(count, dtype=bool)
    below[4, 1] = below[5, 4] = below[5, 1] = True
    rng = np.random.default_rng(seed)
    return BehaviourObservation(
        np.arange(count), category, np.isin(np.arange(count), (1, 3, 4)), np.full(count, -1), np.zeros(count, np.int64),
        rng.normal(size=(count, 3)), below, np.array([0, 1, -1]), np.array([[0, 2, -1], [1, -1, 4], [0, 1, -1]]),
        np.full(3, -1), np.full(3, -1),
    )  # fmt: skip


def drawn_scores(seed: int, count: int = 7) -> Scores:
    rng = np.random.default_rng(seed)
    k = len(KINDS.kinds)
    return Scores(
        rng.random(k),
        rng.normal(size=(k, count)),
        rng.normal(size=(k, count, count)),
        rng.normal(size=(k, count, count)),
    )


def expected(seen: BehaviourObservation, scores: Scores, number: int) -> list[tuple[int, int, int]]:
    """All assignments, each looked at by itself."""
    roles = KINDS.kinds[number].slots
    names = [CATEGORIES[c] if c >= 0 else "" for c in seen.category]
    choices = [[e for e in range(7) if names[e] and names[e] in role] if role else [-1] for role in roles]
    found = []
    for target, tool, frame in product(*choices):
        moved = KINDS.kinds[number].type in ("Insert", "Remove") and frame >= 0 and seen.below[target, frame]
        carried = tool >= 0 and (target == tool or seen.below[tool, target])
        if moved or carried or not any(e >= 0 and seen.new[e] for e in (target, tool, frame)):
            continue
        if any(
            k == number and tuple(s) == (target, tool, frame)
            for k, s in zip(seen.kind, seen.slots.tolist(), strict=True)
        ):
            continue
        total = scores.target[number, target]
        total += scores.tool[number, target, tool] if tool >= 0 else 0
        total += scores.frame[number, target, frame] if frame >= 0 else 0
        apart = sum(np.linalg.norm(seen.position[target] - seen.position[e]) for e in (tool, frame) if e >= 0)
        found.append((-total, apart, (target, tool, frame)))
    return [slots for *_, slots in sorted(found)][:MOST_ASSIGNMENTS]


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("number", range(len(KINDS.kinds)))
def test_the_best_that_can_be_performed_come_first(seed: int, number: int) -> None:
    seen, scores = observed(seed), drawn_scores(seed)
    found = RoleMasks(KINDS).assignments(seen, scores, number)
    assert [choice.slots for choice in found] == expected(seen, scores, number)
    assert all(choice == ActionChoice(number, choice.slots, float(scores.wanted[number])) for choice in found)


@pytest.mark.parametrize("seed", range(4))
def test_of_equals_the_nearest_are_taken(seed: int) -> None:
    seen, scores = observed(seed), drawn_scores(seed)
    equal = replace(scores, target=scores.target * 0, tool=scores.tool * 0, frame=scores.frame * 0)
    for number in range(3):
        assert [choice.slots for choice in RoleMasks(KINDS).assignments(seen, equal, number)] == expected(
            seen, equal, number
        )


def test_the_most_wanted_kind_that_has_any_is_chosen() -> None:
    seen, masks = observed(), RoleMasks(KINDS)
    wanted = replace(drawn_scores(1), wanted=np.array([0.6, 0.8, 0.7, 0.9]))
    half = np.full(4, 0.5)
    assert {choice.kind for choice in masks.choices(seen, wanted, half)} == {1}  # nothing can take the role of the last
    assert {choice.kind for choice in masks.choices(seen, wanted, np.array([0.5, 0.81, 0.7, 0.9]))} == {2}
    assert masks.choices(seen, wanted, np.full(4, 0.95)) == []


def test_likely_actions_are_made_always_and_others_now_and_then() -> None:
    masks = RoleMasks(KINDS)
    np.testing.assert_array_equal(masks.limits(None), np.full(4, 0.5))
    drawn = np.concatenate([masks.limits(np.random.default_rng(seed)) for seed in range(100)])
    assert (drawn.min(), drawn.max()) == (0.1, 0.5)
    assert 0.3 < np.mean(drawn == 0.5) < 0.7


def test_whether_anything_new_may_take_a_role() -> None:
    masks, seen = RoleMasks(KINDS), observed()
    assert masks.any_new(seen)
    assert not masks.any_new(replace(seen, new=np.arange(7) == 6))
    assert not masks.any_new(replace(seen, new=np.zeros(7, bool)))
    assert masks.candidates(seen, 0, 0).tolist() == [0]
    assert masks.candidates(seen, 0, 1).tolist() == [1, 2, 3]
    assert masks.candidates(seen, 0, 2).tolist() == [-1]
    assert masks.candidates(seen, 3, 0).tolist() == []
