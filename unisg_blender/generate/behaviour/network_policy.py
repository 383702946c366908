"""Actions by the network: arrays of a scene in, scores out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.onnx_session import OnnxModel, open_model
from .action_kinds import TASK, VERSION, Kinds
from .action_policy import ActionChoice, Scores
from .observation import BehaviourObservation

INPUTS = ("category", "new", "relation", "holds", "place", "mask", "kind", "stage", "order", "plays", "act_mask")
OUTPUTS = ("wanted", "target", "tool", "frame", "after")


def observation_arrays(observed: BehaviourObservation, kinds: Kinds) -> dict[str, NDArray[Any]]:
    """Inputs of the network for one scene, without the dimension of the batch; names as in the network's forward."""
    objects, actions = len(observed.rows), len(observed.kind)
    holds = np.zeros((objects, objects), np.float32)
    held = np.flatnonzero(observed.support >= 0)
    holds[held, observed.support[held]] = 1
    roles = np.zeros((actions, 3, objects), np.float32)
    action, slot = np.nonzero(observed.slots >= 0)
    roles[action, slot, observed.slots[action, slot]] = 1
    return {
        "category": np.where(observed.category < 0, len(kinds.categories), observed.category).astype(np.int64),
        "new": observed.new.astype(np.float32),
        "relation": observed.relation.astype(np.int64),
        "holds": holds,
        "place": observed.position.astype(np.float32),
        "mask": np.ones(objects, np.float32),
        "kind": np.where(observed.kind < 0, len(kinds.kinds), observed.kind).astype(np.int64),
        "stage": np.where(observed.leaf_stage < 0, len(kinds.stages), observed.leaf_stage).astype(np.int64),
        "order": observed.leaf_order.astype(np.float32),
        "plays": roles,
        "act_mask": np.ones(actions, np.float32),
    }


def load_behaviour(path: Path, threads: int = 1) -> NetworkPolicy:
    """The behaviour of a file that ``unisg train cgvae`` wrote beside a generator.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX file, or no model of behaviour that this software knows.
    """
    network = open_model(path, TASK, (VERSION,), "cgvae", threads)
    kinds = Kinds.from_record(network.metadata, path)
    network.expect("wanted", len(kinds.kinds))
    network.expect("after", len(kinds.kinds), None)
    return NetworkPolicy(kinds, network)


class NetworkPolicy:
    """Asks a network, with a batch of one."""

    def __init__(self, kinds: Kinds, network: OnnxModel) -> None:
        self.kinds, self.network = kinds, network
        self._asked: tuple[BehaviourObservation | None, NDArray[np.float32]] = (None, np.zeros(0, np.float32))

    def scores(self, observed: BehaviourObservation) -> Scores:
        """The network's scores for the next action."""
        arrays = observation_arrays(observed, self.kinds)
        if not len(observed.kind):  # one blank action: the network is not asked about none
            blank = observation_arrays(observed.with_action(-1, (-1, -1, -1), -1, None), self.kinds)
            arrays = blank | {"act_mask": np.zeros(1, np.float32)}
        wanted, target, tool, frame, after = self.network.run(
            OUTPUTS, **{name: value[None] for name, value in arrays.items()}
        )
        self._asked = observed, after[0]
        return Scores(1 / (1 + np.exp(-wanted[0].astype(np.float64))), target[0], tool[0], frame[0])

    def after(self, observed: BehaviourObservation, choice: ActionChoice) -> int:
        """The leaf of the kind's stage that the network points to."""
        asked, scores = self._asked
        assert asked is observed, "ask for scores first"
        stage = self.kinds.stage_number.get(self.kinds.kinds[choice.kind].stage, -1)
        leaves = np.flatnonzero((observed.leaf_stage == stage) & (observed.leaf_order >= 0))
        if stage < 0 or not len(leaves):
            return -1
        options = np.append(scores[choice.kind, leaves], scores[choice.kind, max(len(observed.kind), 1) + stage])
        best = int(options.argmax())
        return int(leaves[best]) if best < len(leaves) else -1
