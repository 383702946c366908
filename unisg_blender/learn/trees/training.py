"""Train trees on a dataset and write them as a model for the generator."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from sklearn.ensemble import ExtraTreesClassifier

from ...dataset.format.reader import Dataset
from ...generate.observe.contract import Contract
from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.prior_tables import PriorTables
from ...generate.observe.seen_places import SeenPlaces
from ...generate.observe.support_priors import CategoryPriors
from ...generate.propose.place_features import CategoryKinds
from ...generate.propose.trained_model import load_model
from ...generate.propose.trees_proposer import TreesProposer
from ...runtime.progress import Progress
from ...scene.categories import STRUCTURE
from ..hyperparameters import Settings
from ..provenance import facts, save_model_assets
from ..training_scenes import scenes_and_priors
from .completion_pictures import completion_of, completion_svg
from .examples import examples
from .fitting import fit_trees, write_trees
from .held_out import Choice, HeldOut, choices, groups_of, measured
from .training_report import report_lines, write_report

MOST_EXAMPLES, MOST_ROUNDS = 5000, 2
"""True places that are learned from, about, and how often at most the same one with other things left out."""

MOST_PICTURES = 10
"""Held-out rooms that the page shows."""

FOLDS = 3
"""Times that other rooms are held out, to measure what the trees are worth."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """Trees, and the contract that goes with them."""

    trees: ExtraTreesClassifier
    contract: Contract

    def write(self, out: Path) -> None:
        """Write the model."""
        write_trees(self.trees, self.contract.to_json(), out)


def fit_on(scenes: Sequence[ObservedScene], vocabulary: tuple[str, ...], priors: CategoryPriors, seed: int) -> Fitted:
    """Trees fitted on some scenes."""
    tables, rng = PriorTables.of(priors, vocabulary), np.random.default_rng(seed)
    places, kinds = SeenPlaces.of(scenes, tables), CategoryKinds.of(tables, priors.sizes, vocabulary)
    total = sum(len(rows) for rows in places.places.values())
    rounds = int(np.clip(MOST_EXAMPLES // max(total, 1), 1, MOST_ROUNDS))
    trees = fit_trees(*examples(scenes, places, tables, kinds, rounds, rng), seed)
    contract = Contract("trees", vocabulary, priors, places=places.to_record(vocabulary))
    return Fitted(trees, contract)


def train_trees(datasets: Sequence[Dataset], out: Path, settings: Settings) -> dict[str, Any]:
    """Train and export; returns the provenance that the model carries.

    Trees are fitted :data:`FOLDS` times without some of the rooms, on which they are measured against plain places: for
    each group of categories the better of the two is drawn later. Those that are written have seen all rooms.

    Raises
    ------
    UniSGError
        For too few scenes or categories.
    """
    vocabulary, scenes, priors = scenes_and_priors(datasets[0], settings.quiet)
    observed = [ObservedScene.of(scene.objects, scene.world) for scene in scenes]
    fold, found = np.random.default_rng(settings.seed).permutation(len(scenes)) % FOLDS, list[HeldOut]()
    tables = PriorTables.of(priors, vocabulary)
    bar = Progress(FOLDS + 1, "fits", settings.quiet)
    for number in range(FOLDS):
        bar.say(f"measuring on {(fold == number).sum()} rooms that are held out")
        rest = [scene for scene, its in zip(observed, fold, strict=True) if its != number]
        unseen = [scene for scene, its in zip(observed, fold, strict=True) if its == number]
        proposer = _proposer(fit_on(rest, vocabulary, priors, settings.seed + number))
        rng = np.random.default_rng((settings.seed + number, 9))
        found += measured(proposer, unseen, tables, rng)
        bar.update(number + 1)
    fitted = fit_on(observed, vocabulary, priors, settings.seed)
    bar.update(FOLDS + 1)
    bar.close()
    chosen = choices(found)
    record = facts(datasets[0], settings, (len(scenes), 0)) | {
        "losses": {}, "parameters": len(fitted.trees.estimators_), "folds": FOLDS,
        "held_out": [choice.to_record() for choice in chosen.values()],
        "categories": category_records(found, vocabulary, observed, chosen),
    }  # fmt: skip
    record["notes"] += [note for choice in chosen.values() if (note := choice.note())]
    groups = groups_of(observed, tables)
    power = {vocabulary[category]: chosen[group].power for category, group in groups.items()}
    contract = replace(
        fitted.contract, provenance=record, plain={name: 1.0 for name, best in power.items() if best is None},
        sharpness={name: best for name, best in power.items() if best is not None},
    )  # fmt: skip
    replace(fitted, contract=contract).write(out)
    save_model_assets(datasets[0], out)
    pictures = [completion_svg(completion_of(proposer, scene, tables, chosen, rng)) for scene in unseen[:MOST_PICTURES]]
    page = write_report(record, STRUCTURE, out, pictures)
    return record | {"report": [*report_lines(record, STRUCTURE), f"all of it: {page}"]}


def _proposer(fitted: Fitted) -> TreesProposer:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fold.onnx"
        fitted.write(path)
        return TreesProposer(load_model(path))


def category_records(
    found: Sequence[HeldOut], vocabulary: Sequence[str], scenes: Sequence[ObservedScene], chosen: Mapping[str, Choice]
) -> list[dict[str, Any]]:
    """How often each category was seen, in how many rooms, and how it fared where it was held out."""
    result = []
    for category, name in enumerate(vocabulary):
        counts = [int((scene.category == category).sum()) for scene in scenes]
        mine = [one for one in found if one.category == category]
        record: dict[str, Any] = {"category": name, "objects": sum(counts), "rooms": sum(map(bool, counts))}
        if mine:
            plain = float(np.mean([one.plain for one in mine]))
            taken = float(np.mean([one.taken(chosen[one.group].power) for one in mine]))
            record |= {"held_out": len(mine), "plain": round(plain, 3), "taken": round(taken, 3)}
        result.append(record)
    return result
