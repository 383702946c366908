"""The actions of one type as columns, ready to be checked all at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.affine_rows import gather
from ...geometry.angle_test import least_trace
from ...scene.action_data import ActionData
from ...scene.graph import SceneGraph
from ...scene.hierarchy import world_matrices
from .body_contact import body_bounds


@dataclass(frozen=True, eq=False)
class Poses:
    """Entities whose pose is compared, P pairs of an action and one of its entities.

    ``action`` int64 (P,): place in the batch; ``row`` int64 (P,): the entity;
    ``reference`` float64 (12, P): components of the pose asked for, in the world
    where ``frame`` int64 (P,) is -1, otherwise in the frame of that entity.
    ``distance``, ``angle`` float64 (P,): the action's limits, see :class:`Batch`;
    ``turns`` bool (P,): there is one for the angle; ``trace`` float64 (P,): see
    :func:`...geometry.angle_test.least_trace`.
    """

    action: NDArray[np.int64]
    row: NDArray[np.int64]
    reference: NDArray[np.float64]
    frame: NDArray[np.int64]
    distance: NDArray[np.float64]
    angle: NDArray[np.float64]
    turns: NDArray[np.bool_]
    trace: NDArray[np.float64]

    def frames(self, world: NDArray[np.float64]) -> NDArray[np.float64]:
        """Components (12, P) of the frames' world matrices; of the identity where the frame is the world."""
        frames = gather(world, self.frame)
        still = np.flatnonzero(self.frame < 0)
        if len(still):
            frames[:, still] = np.eye(4)[:3].reshape(12, 1)
        return frames


@dataclass(frozen=True, eq=False)
class Contacts:
    """Pairs of a tool and a target, P in number.

    ``action`` int64 (P,): place in the batch; ``tool``, ``target`` int64 (P,): rows;
    ``tool_bounds``, ``target_bounds`` float64 (6, P): their boxes in their own frames;
    ``distance`` float64 (P,): how near they have to come in metres, 0 where the action does not say.
    """

    action: NDArray[np.int64]
    tool: NDArray[np.int64]
    target: NDArray[np.int64]
    tool_bounds: NDArray[np.float64]
    target_bounds: NDArray[np.float64]
    distance: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Batch:
    """K actions of one type, column by column.

    Attributes
    ----------
    actions, uid
        The actions as they are, and their uids as an array of strings (K,).
    index
        int64 (K,): their places among all actions that are checked.
    target, tool, frame
        int64 (K,): row of the first target and tool, and of the frame; -1 where there is none.
    distance, angle, hold, hits, force
        (K,): the thresholds in metres, radians, seconds, counts, newtons; what is not
        asked for is infinite (distance, angle), 0 (hold, force) or 1 (hits).
    trigger
        bool (K,).
    poses
        Entities whose pose is compared: the targets, or the tools of Tool actions.
    contacts
        Pairs of a tool and a target that may touch.
    """

    actions: tuple[ActionData, ...]
    uid: NDArray[np.str_]
    index: NDArray[np.int64]
    target: NDArray[np.int64]
    tool: NDArray[np.int64]
    frame: NDArray[np.int64]
    distance: NDArray[np.float64]
    angle: NDArray[np.float64]
    hold: NDArray[np.float64]
    hits: NDArray[np.float64]
    force: NDArray[np.float64]
    trigger: NDArray[np.bool_]
    poses: Poses
    contacts: Contacts

    def any_of(self, action: NDArray[np.int64], holds: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """bool (K,): some pair of the action holds; ``action`` and ``holds`` are (P,)."""
        result = np.zeros(len(self.actions), bool)
        result[action[holds]] = True
        return result


def make_batch(graph: SceneGraph, actions: Sequence[ActionData], index: Sequence[int]) -> Batch:
    """The columns of some actions, which should be of one type; entities that are missing are left out."""
    row_of = graph.row_of_uid

    def rows(uids: Sequence[str]) -> list[int]:
        """Rows of those uids that are there."""
        return [row_of[uid] for uid in uids if uid in row_of]

    def limit(name: str, default: float) -> NDArray[np.float64]:
        """A threshold of all actions, or its default."""
        values = [getattr(action.thresholds, name) for action in actions]
        return np.array([default if value is None else value for value in values], np.float64)

    distance, angle = limit("distance", np.inf), limit("angle", np.inf)
    return Batch(
        actions=tuple(actions),
        uid=np.array([action.uid for action in actions], np.str_),
        index=np.array(index, np.int64),
        target=np.array([(rows(action.targets) or [-1])[0] for action in actions], np.int64),
        tool=np.array([(rows(action.tools) or [-1])[0] for action in actions], np.int64),
        frame=np.array([row_of.get(action.frame, -1) for action in actions], np.int64),
        distance=distance,
        angle=angle,
        hold=limit("hold", 0.0),
        hits=limit("hits", 1.0),
        force=limit("force", 0.0),
        trigger=np.array([action.trigger for action in actions], bool),
        poses=_poses(graph, actions, row_of, distance, angle),
        contacts=_contacts(graph, [(rows(action.tools), rows(action.targets)) for action in actions], distance),
    )


def _poses(
    graph: SceneGraph,
    actions: Sequence[ActionData],
    row_of: Mapping[str, int],
    distance: NDArray[np.float64],
    angle: NDArray[np.float64],
) -> Poses:
    world = world_matrices(graph)
    found = [pair for place, action in enumerate(actions) for pair in _pose_pairs(place, action, row_of, world)]
    owner = np.array([pair[0] for pair in found], np.int64)
    return Poses(
        action=owner,
        row=np.array([pair[1] for pair in found], np.int64),
        reference=np.ascontiguousarray(np.array([pair[2] for pair in found]).reshape(-1, 16).T[:12]),
        frame=np.array([pair[3] for pair in found], np.int64),
        distance=distance[owner],
        angle=angle[owner],
        turns=np.isfinite(angle[owner]),
        trace=least_trace(angle[owner]),
    )


def _pose_pairs(
    place: int, action: ActionData, row_of: Mapping[str, int], world: NDArray[np.float64]
) -> Iterator[tuple[int, int, NDArray[np.float64], int]]:
    if action.frame and action.frame not in row_of:
        return
    frame = row_of.get(action.frame, -1)
    for uid in action.tools if action.type == "Tool" else action.targets:
        if uid not in row_of:
            continue
        row, reference = row_of[uid], action.reference_matrix
        if reference is None and action.type == "Remove":  # from where the scene has it
            reference = world[row] if frame < 0 else np.linalg.pinv(world[frame]) @ world[row]
        if reference is not None:
            yield place, row, reference, frame


def _contacts(
    graph: SceneGraph, ends: Sequence[tuple[list[int], list[int]]], distance: NDArray[np.float64]
) -> Contacts:
    pairs = [
        (place, tool, target)
        for place, (tools, targets) in enumerate(ends)
        for tool in tools
        for target in targets
        if tool != target
    ]
    columns = np.array(pairs, np.int64).reshape(-1, 3)
    rows, inverse = np.unique(columns[:, 1:], return_inverse=True)
    tool_bounds, target_bounds = (body_bounds(graph, rows).take(side, 1) for side in inverse.reshape(-1, 2).T)
    action, tool, target = columns.T.copy()
    near = np.where(np.isfinite(distance), distance, 0.0)[action]
    return Contacts(action, tool, target, tool_bounds, target_bounds, near)
