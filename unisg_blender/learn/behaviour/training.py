"""Trains the network of behaviour on the scenes of a dataset and writes it beside the generator's model."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from ...dataset.format.reader import Dataset
from ...dataset.scenes_with_shapes import scenes_with_shapes
from ...errors import UniSGError
from ...generate.behaviour.action_kinds import Kinds, behaviour_path
from ...generate.behaviour.action_policy import RoleMasks
from ...generate.behaviour.action_statistics import learn_kinds
from ...generate.behaviour.network_policy import INPUTS, OUTPUTS, observation_arrays
from ...generate.behaviour.observation import BehaviourObservation, observe_behaviour
from ..hyperparameters import Settings
from ..onnx_export import export_onnx
from ..trainer import Schedule, loader
from ..training_job import Prepared, train_model
from ..training_scenes import split_rows
from .examples import BehaviourExamples, collate
from .network import BehaviourNet, BehaviourSizes

EPOCHS, FORM = 20, None
PER_EPOCH = 480
BATCH = 16
MOST_SCENES = 600
"""Scenes learned from, at most."""

FEWEST = 10
"""Scenes with actions, without which none are learned."""

WANTED_WEIGHT, LEAF_WEIGHT = 5.0, 0.5


class TooFewError(UniSGError):
    """Too few scenes have actions."""


def train_beside(datasets: Sequence[Dataset], model: Path, settings: Settings) -> dict[str, Any]:
    """Learn behaviour and write it beside the generator's file ``model``; returns the provenance that it carries.

    With fewer than :data:`FEWEST` scenes that have actions nothing is written, an older file
    is removed, and the returned ``notes`` say so.
    """
    out = behaviour_path(model)
    short = replace(settings, epochs=min(settings.epochs or EPOCHS, EPOCHS), logs=None, devices=1, nodes=1)
    try:
        return train_model(sys.modules[__name__], datasets, out, short)
    except TooFewError as error:
        out.unlink(missing_ok=True)
        return {"notes": [f"new objects get no behaviour: {error}"]}


def prepare(datasets: Sequence[Dataset], settings: Settings) -> Prepared:
    """Scenes with actions as observations; TooFewError if there are fewer than :data:`FEWEST`."""
    acting = (graph for graph in scenes_with_shapes(datasets[0]) if "actions" in graph.components)
    graphs = list(islice(acting, MOST_SCENES))
    if len(graphs) < FEWEST:
        raise TooFewError(f"{len(graphs)} scenes have actions, {FEWEST} are needed at least")
    kinds = learn_kinds(graphs)
    plays = [observe_behaviour(graph, kinds) for graph in graphs]
    seen, watched = ([plays[place] for place in rows] for rows in split_rows(len(plays), settings.seed))
    torch.manual_seed(settings.seed)
    network, gather = make_network(kinds), partial(collate, kinds=len(kinds.kinds))
    train = BehaviourExamples(seen, kinds, min(PER_EPOCH, 8 * len(seen)), settings.seed, fresh=True)
    val = BehaviourExamples(watched, kinds, min(120, 8 * len(watched)), settings.seed + 1, fresh=False)
    loaders = [loader(items, BATCH, settings, False, gather) for items in (train, val)]
    return Prepared(network, loaders, (len(seen), len(watched)), kinds, schedule=Schedule(rate=3e-3))


def export(prepared: Prepared, source: dict[str, Any], out: Path) -> None:
    """Write the model."""
    write_behaviour(prepared.network, replace(prepared.contract, provenance=source), out)


def make_network(kinds: Kinds) -> BehaviourNet:
    """An untrained network for these kinds."""
    sizes = BehaviourSizes(len(kinds.categories), len(kinds.kinds), len(kinds.stages))
    return BehaviourNet(sizes, torch.from_numpy(RoleMasks(kinds).allowed))


def terms(network: nn.Module, batch: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Cross entropy of kinds; of casts, any of the missing actions of a kind being right; and of the leaf before."""
    assert isinstance(network, BehaviourNet)
    seen = network.encode(batch)
    each = nn.functional.binary_cross_entropy_with_logits(seen.wanted, batch["wanted"], reduction="none")
    wanted = (each * batch["able"]).sum() / batch["able"].sum().clamp(min=1)
    scene, kind, target, *others, follows = batch["made"].T
    if not len(scene):
        return {"loss": WANTED_WEIGHT * wanted, "wanted": wanted}
    chance = network.targets(seen)[scene, kind, target]
    for slot, part in enumerate(others, 1):
        has = torch.nonzero(part >= 0).squeeze(1)
        if len(has):
            rows = torch.stack([scene[has], kind[has], target[has]], 1)
            found = network.partners(seen, batch["place"], batch["holds"], rows, slot)
            chance = chance.index_add(0, has, found.gather(1, part[has, None]).squeeze(1))
    cast = -_log_sum_by(scene * seen.wanted.shape[1] + kind, chance).mean()
    leaf = _leaf_loss(network, seen.roled, batch, scene, kind, follows)
    loss = WANTED_WEIGHT * wanted + cast + LEAF_WEIGHT * leaf
    return {"loss": loss, "wanted": wanted, "cast": cast, "leaf": leaf}


def _log_sum_by(group: Tensor, values: Tensor) -> Tensor:
    """Logarithms of the sums of exponentials of the values (M,) by group (M,)."""
    groups, place = group.unique(return_inverse=True)
    largest = values.new_full((len(groups),), -1e9).scatter_reduce(0, place, values.detach(), "amax")
    total = values.new_zeros(len(groups)).index_add(0, place, (values - largest[place]).exp())
    return largest + total.log()


def _leaf_loss(
    network: BehaviourNet, roled: Tensor, batch: Mapping[str, Tensor], scene: Tensor, kind: Tensor, follows: Tensor
) -> Tensor:
    asked = follows >= 0
    if not asked.any():
        return roled.sum() * 0
    scene, kind = scene[asked], kind[asked]
    scores = network.followed(roled)[scene, kind]
    leaves = (batch["act_mask"] * (batch["order"] >= 0))[scene]
    able = torch.cat([leaves, leaves.new_ones(len(leaves), network.sizes.stages)], 1)
    return nn.functional.cross_entropy(scores + (able - 1) * 1e4, follows[asked])


def write_behaviour(network: nn.Module, kinds: Kinds, out: Path) -> None:
    """Write the network as an ONNX file with what its scenes teach."""
    inputs = example_inputs(kinds)
    obj, roled_action = {1: "things"}, {1: "acts"}
    dynamic: dict[str, dict[int, str]] = {name: dict(obj) for name in INPUTS[:6]}
    dynamic |= {name: dict(roled_action) for name in ("kind", "stage", "order", "act_mask")}
    dynamic["holds"] = {1: "things", 2: "things"}
    dynamic["plays"] = {1: "acts", 3: "things"}
    export_onnx(network, inputs, OUTPUTS, dynamic, kinds.to_json(), out)


def example_inputs(kinds: Kinds, objects: int = 7, roled: int = 5) -> dict[str, Tensor]:
    """Inputs of the right kinds, one scene."""
    rng = np.random.default_rng(0)
    slots = np.stack([rng.permutation(objects)[:3] for _ in range(roled)])
    play = BehaviourObservation(
        rows=np.arange(objects), category=np.arange(objects) % len(kinds.categories), new=np.arange(objects) == 0,
        support=np.arange(objects) - 1, relation=np.zeros(objects, np.int64), position=rng.random((objects, 3)),
        below=np.eye(objects, dtype=bool), kind=np.arange(roled) % len(kinds.kinds), slots=slots,
        leaf_stage=np.zeros(roled, np.int64), leaf_order=np.arange(roled),
    )  # fmt: skip
    return {name: torch.from_numpy(array[None]) for name, array in observation_arrays(play, kinds).items()}
