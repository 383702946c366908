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


def observation_arrays(play: BehaviourObservation, kinds: Kinds) -> dict[str, NDArray[Any]]:
    """Inputs of the network for one scene, without the dimension of the batch; names as in the network's forward."""
    objects, roled = len(play.rows), len(play.kind)
    holds = np.zeros((objects, objects), np.float32)
    held = np.flatnonzero(play.support >= 0)
    holds[held, play.support[held]] = 1
    plays = np.zeros((roled, 3, objects), np.float32)
    roled_action, slot = np.nonzero(play.slots >= 0)
    plays[roled_action, slot, play.slots[roled_action, slot]] = 1
    return {
        "category": np.where(play.category < 0, len(kinds.categories), play.category).astype(np.int64),
        "new": play.new.astype(np.float32),
        "relation": play.relation.astype(np.int64),
        "holds": holds,
        "place": play.place.astype(np.float32),
        "mask": np.ones(objects, np.float32),
        "kind": np.where(play.kind < 0, len(kinds.kinds), play.kind).astype(np.int64),
        "stage": np.where(play.leaf_stage < 0, len(kinds.stages), play.leaf_stage).astype(np.int64),
        "order": play.leaf_order.astype(np.float32),
        "plays": plays,
        "act_mask": np.ones(roled, np.float32),
    }


def load_behaviour(path: Path, threads: int = 1) -> NetworkPolicy:
    """The behaviour of a file that ``unisg train cgvae`` wrote beside a generator.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX file, or no model of behaviour that this software knows.
    """
    network = open_model(path, TASK, (VERSION,), "cgvae", threads)
    return NetworkPolicy(Kinds.from_record(network.metadata, path), network)


class NetworkPolicy:
    """Asks a network, with a batch of one."""

    def __init__(self, kinds: Kinds, network: OnnxModel) -> None:
        self.kinds, self.network = kinds, network
        self._asked: tuple[BehaviourObservation | None, NDArray[np.float32]] = (None, np.zeros(0, np.float32))

    def scores(self, play: BehaviourObservation) -> Scores:
        """The network's scores for the next action."""
        arrays = observation_arrays(play, self.kinds)
        if not len(play.kind):  # one blank action: the network is not asked about none
            blank = observation_arrays(play.with_act(-1, (-1, -1, -1), -1, None), self.kinds)
            arrays = blank | {"act_mask": np.zeros(1, np.float32)}
        wanted, target, tool, frame, after = self.network.run(
            OUTPUTS, **{name: value[None] for name, value in arrays.items()}
        )
        self._asked = play, after[0]
        return Scores(1 / (1 + np.exp(-wanted[0].astype(np.float64))), target[0], tool[0], frame[0])

    def after(self, play: BehaviourObservation, choice: ActionChoice) -> int:
        """The leaf of the kind's stage that the network points to."""
        asked, scores = self._asked
        assert asked is play, "ask for scores first"
        stage = self.kinds.stage_number.get(self.kinds.kinds[choice.kind].stage, -1)
        leaves = np.flatnonzero((play.leaf_stage == stage) & (play.leaf_order >= 0))
        if stage < 0 or not len(leaves):
            return -1
        roled = max(len(play.kind), 1)
        options = np.append(scores[choice.kind, leaves], scores[choice.kind, roled + stage])
        best = int(options.argmax())
        return int(leaves[best]) if best < len(leaves) else -1
