"""Reference poses: which rule gives them, learned from examples, and the pose that the rule gives in a new scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...behaviour.fulfilment.body_contact import body_bounds
from ...geometry.arrays import Floats
from ...scene import SceneGraph, world_matrices
from .action_kinds import Reference
from .roled_actions import RoledAction

RULES = ("own", "frame", "high", "low", "share")
TURNED = 0.01
"""Radians within which a turn counts as the target's own."""


@dataclass(frozen=True, eq=False)
class PoseSample:
    """A ``reference`` pose (4, 4), the target's ``own`` pose (4, 4) in the same frame, and the ``middle`` and
    ``half`` extents (3,) of the frame's box, metres."""

    reference: Floats
    own: Floats
    middle: Floats
    half: Floats


def sample_of(graph: SceneGraph, roled: RoledAction) -> PoseSample:
    """What there is to learn from an action with a reference pose."""
    target, tool, frame = roled.slots
    reference = roled.action.reference_matrix
    assert reference is not None
    own, middle, half = surroundings(graph, tool if roled.action.type == "Tool" else target, frame)
    return PoseSample(reference, own, middle, half)


def surroundings(graph: SceneGraph, target: int, frame: int) -> tuple[Floats, Floats, Floats]:
    """The target's pose (4, 4) in the frame (rows; -1: the world), and middle and half (3,) of the frame's box."""
    world = world_matrices(graph)
    pose = world[target] if target >= 0 else np.eye(4)
    if frame < 0:
        return pose, np.zeros(3), np.zeros(3)
    box = body_bounds(graph, np.array([frame]))[:, 0]
    return np.linalg.pinv(world[frame]) @ pose, box[:3], box[3:]


def learn_reference(samples: Sequence[PoseSample]) -> Reference | None:
    """The rule by which the reference poses vary least; None without examples."""
    if not samples:
        return None
    target = np.array([sample.reference[:3, 3] for sample in samples])
    own = np.array([sample.own[:3, 3] for sample in samples])
    middle, half = (np.array([getattr(sample, name) for sample in samples]) for name in ("middle", "half"))
    width = np.maximum(half, 1e-6)
    left = {
        "own": target - own, "frame": target, "high": target - middle - half, "low": target - middle + half,
        "share": (target - middle) / width,
    }  # fmt: skip
    spread = {name: np.abs(values - np.median(values, axis=0)).mean(axis=0) for name, values in left.items()}
    spread["share"] = spread["share"] * half.mean(axis=0) + 1e-6
    rule = [min(RULES, key=lambda name: round(float(spread[name][axis]), 6)) for axis in range(3)]
    value = [float(np.median(left[name][:, axis])) for axis, name in enumerate(rule)]
    turns = np.array([sample.reference[:3, :3] for sample in samples])
    owns = np.array([unit_axes(sample.own[:3, :3]) for sample in samples])
    as_own = float(np.median(angles(turns, owns))) < TURNED
    rotation = np.eye(3) if as_own else _middle_turn(turns)
    return Reference(
        rule=(rule[0], rule[1], rule[2]),
        value=(round(value[0], 6), round(value[1], 6), round(value[2], 6)),
        turn="own" if as_own else "fixed",
        rotation=tuple(np.round(rotation, 9).reshape(-1).tolist()),
    )


def reference_pose(rule: Reference, own: Floats, middle: Floats, half: Floats) -> Floats:
    """The reference pose (4, 4) for a target at ``own`` (4, 4) in a frame with the box ``middle``, ``half`` (3,)."""
    pose = np.eye(4)
    base = {"own": own[:3, 3], "frame": np.zeros(3), "high": middle + half, "low": middle - half, "share": middle}
    for axis, (name, value) in enumerate(zip(rule.rule, rule.value, strict=True)):
        pose[axis, 3] = base[name][axis] + value * (half[axis] if name == "share" else 1.0)
    pose[:3, :3] = unit_axes(own[:3, :3]) if rule.turn == "own" else np.array(rule.rotation).reshape(3, 3)
    return pose


def unit_axes(linear: Floats) -> Floats:
    """The rotation nearest to a linear part (3, 3)."""
    u, _, v = np.linalg.svd(linear)
    return u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v)) or 1.0]) @ v


def angles(one: Floats, two: Floats) -> Floats:
    """Angles in radians between rotations (..., 3, 3)."""
    trace = np.einsum("...ij,...ij->...", one, two)
    return np.asarray(np.arccos(np.clip((trace - 1) / 2, -1, 1)))


def _middle_turn(turns: Floats) -> Floats:
    """The rotation among up to 100 with the least mean angle to the others."""
    some = turns[:: max(1, len(turns) // 100)]
    return some[int(angles(some[:, None], some[None]).mean(axis=1).argmin())]
