"""The lines of the generator's table, and the data that each of them is measured on, loaded once per process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import islice
from pathlib import Path

from ...dataset.format.reader import open_dataset
from ...dataset.scenes_with_shapes import scenes_with_shapes
from ...generate import Generator
from ...generate.observe.contract import Contract
from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.support_priors import CategoryPriors, learn_priors
from ...generate.propose.trained_model import TrainedModel
from ...scene import SceneGraph, world_matrices
from ...scene.categories import STRUCTURE
from ...spatial.objects import scene_objects
from .atiss_proposer import load_generator
from .baselines import GaussianProposer, WorldGaussianProposer
from .cases import Case, Hole, case_of, hole_of
from .furnishing import ByCopying, ByModel, Real, Way

LEARNED = 300
"""Training rooms that the Gaussians and the copies learn from, at most."""

JITTER = 0.1
KINDS = ("real", "training", "given", "model", "mean", "gaussian", "world", "copy", "jitter")
"""real: the test rooms; training: as many training rooms; given: rooms furnished elsewhere; the others furnish the
test rooms."""
AS_THEY_ARE = ("real", "training", "given")


@dataclass(frozen=True)
class RowSpec:
    """One line: its name, one of :data:`KINDS`, whether what it makes is settled, and its model's file or its rooms."""

    name: str
    kind: str
    model: str = ""
    settle: bool = True

    @property
    def completes(self) -> bool:
        """Whether it is asked to complete rooms."""
        return self.settle and self.kind not in AS_THEY_ARE


@dataclass(frozen=True)
class Data:
    """Test rooms and training rooms ("" for none) and how many of the former."""

    tests: str
    training: str
    scenes: int


def benchmark_rows(model: Path, others: Sequence[Path], training: bool) -> list[RowSpec]:
    """All lines of the table: real rooms, the model, other models, and with training rooms the simple baselines.

    Each model is a generator's file, or a dataset of rooms that it furnished.
    """
    rows = [RowSpec("real rooms", "real")]
    if training:
        rows.append(RowSpec("other real rooms (training)", "training"))
    for name, path in (("model", model), *((other.stem, other) for other in others)):
        if path.is_dir():
            rows.append(RowSpec("given rooms" if path == model else f"given rooms, {name}", "given", str(path)))
            continue
        rows += [RowSpec(f"{name}, raw", "model", str(path), False), RowSpec(f"{name}, settled", "model", str(path))]
    if training:
        for name, kind in (("category Gaussian, world", "world"), ("category Gaussian, on its support", "gaussian")):
            rows += [RowSpec(f"{name}, raw", kind, settle=False), RowSpec(f"{name}, settled", kind)]
        rows.append(RowSpec("category mean, raw", "mean", settle=False))
        rows.append(RowSpec("nearest training room copied", "copy"))
        rows.append(RowSpec("... with 10 cm jitter", "jitter"))
    return rows


@cache
def generator_of(path: str) -> Generator:
    """The model of a file, opened once."""
    return load_generator(path)


@cache
def test_rooms(data: Data) -> tuple[SceneGraph, ...]:
    """The test rooms."""
    return _rooms(data.tests, data.scenes)


@cache
def training_rooms(data: Data, most: int = LEARNED) -> tuple[SceneGraph, ...]:
    """The first training rooms; none without a training set."""
    return _rooms(data.training, most) if data.training else ()


@cache
def vocabulary_of(data: Data) -> tuple[str, ...]:
    """The categories that features are numbered by: all of the training rooms, or else of the test rooms."""
    return tuple(sorted(open_dataset(data.training or data.tests).category_counts))


@cache
def _rooms(path: str, most: int) -> tuple[SceneGraph, ...]:
    return tuple(islice(scenes_with_shapes(open_dataset(path)), most))


@cache
def _baseline(kind: str, data: Data) -> Generator:
    """A generator without a network: what is usual for the categories, and the Gaussians, from the training rooms."""
    vocabulary = vocabulary_of(data)
    objects = [scene_objects(graph, vocabulary) for graph in training_rooms(data)]
    contract = Contract("anchors", vocabulary, _priors(data))
    scenes = [
        ObservedScene.of(found, world_matrices(graph)[found.row])
        for found, graph in zip(objects, training_rooms(data), strict=True)
    ]
    proposer = GaussianProposer(scenes, 0.0 if kind == "mean" else 1.0) if kind != "world" else None
    return Generator(TrainedModel(Path("baseline.onnx"), contract), proposer or WorldGaussianProposer(scenes))


@cache
def _priors(data: Data) -> CategoryPriors:
    vocabulary = vocabulary_of(data)
    return learn_priors((scene_objects(graph, vocabulary) for graph in training_rooms(data)), vocabulary)


@cache
def way_of(spec: RowSpec, data: Data) -> Way:
    """How a row furnishes rooms."""
    if spec.kind in AS_THEY_ARE:
        return Real()
    if spec.kind in ("copy", "jitter"):
        known = [name for name in vocabulary_of(data) if name not in STRUCTURE]
        return ByCopying(training_rooms(data), known, JITTER if spec.kind == "jitter" else 0.0)
    return ByModel(generator_of(spec.model) if spec.kind == "model" else _baseline(spec.kind, data), spec.settle)


def _known(spec: RowSpec, data: Data) -> tuple[str, ...]:
    return generator_of(spec.model).categories if spec.kind == "model" else vocabulary_of(data)


def case_number(spec: RowSpec, data: Data, number: int) -> Case | None:
    """The room that a row is asked to furnish; None past the end, or if there is nothing in it."""
    given = {"training": lambda: training_rooms(data, data.scenes), "given": lambda: _rooms(spec.model, data.scenes)}
    rooms = given.get(spec.kind, lambda: test_rooms(data))()
    return case_of(rooms[number], _known(spec, data)) if number < len(rooms) else None


def hole_number(spec: RowSpec, data: Data, number: int, seed: int) -> Hole | None:
    """The half-emptied room that a row is asked to complete; it differs from seed to seed, not from row to row."""
    return hole_of(test_rooms(data)[number], _known(spec, data), 1000 * seed + number)
