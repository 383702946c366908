"""Measures some rooms of one row; what is found are plain arrays, which are kept and joined."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays import Floats
from ...metrics.layout_distances import layout_of
from ...metrics.layout_features import OBJECT, PAIR, Features, scene_features, scene_width
from ...metrics.scene_validity import CategoryPair, measure_scene
from .benchmark_rows import Data, RowSpec, case_number, hole_number, training_rooms, vocabulary_of, way_of
from .completion import NOTHING, complete
from .furnishing import Real

VERSION = 6
"""Of what is measured; kept results of another version are not used."""

COUNTS = ("objects", "colliding", "overlapping", "off_support", "outside", "asked", "refused")
Arrays = dict[str, Floats]


def measure_rooms(
    spec: RowSpec, data: Data, seed: int, numbers: Sequence[int], allowed: frozenset[CategoryPair]
) -> Arrays:
    """Furnish and measure the rooms with these numbers.

    Returns
    -------
    dict
        ``counts`` (S, len(COUNTS)) and ``milliseconds`` (S,) of processor time per object, NaN where nothing was made;
        ``completion`` (S, 7), see :class:`~.completion.Completed`; ``scene`` (S, W); ``objects``, ``pairs`` and
        ``layout``, ragged, with their scenes' numbers in the first column.
    """
    way, vocabulary = way_of(spec, data), vocabulary_of(data)
    counts, spent, completion, features, layouts = [], [], [], [], []
    for number in numbers:
        case = case_number(spec, data, number)
        if case is None:
            continue
        made = way.furnish(case, 1000 * seed + number)
        report = measure_scene(made.scene, allowed=allowed)
        found = [report.counted, report.colliding, report.overlapping, report.off_support, report.outside]
        asked = 0 if spec.kind == "given" else sum(case.wanted.values())  # nobody knows what others were asked for
        counts.append([*(int(column.sum()) for column in found), asked, made.refused])
        spent.append(made.milliseconds)
        features.append(scene_features(made.scene, vocabulary, np.random.default_rng((number, seed))))
        layouts.append(layout_of(made.scene, vocabulary))
        hole = hole_number(spec, data, number, seed) if spec.completes else None
        done = NOTHING if hole is None or isinstance(way, Real) else complete(way, hole, 1000 * seed + number)
        completion.append(done.values())
    return {
        "counts": np.array(counts, np.float64).reshape(-1, len(COUNTS)),
        "milliseconds": np.array(spent, np.float64),
        "completion": np.array(completion, np.float64).reshape(-1, len(NOTHING.FIELDS)),
        "scene": np.array([part.scene for part in features]).reshape(-1, scene_width(vocabulary)),
        "objects": _ragged([part.objects for part in features], len(OBJECT)),
        "pairs": _ragged([part.pairs for part in features], len(PAIR)),
        "layout": _ragged(layouts, 3),
    }


def _ragged(parts: Sequence[NDArray[np.floating]], width: int) -> Floats:
    """Rows of all parts under one another, the number of the part before each."""
    numbered = [np.column_stack([np.full(len(part), number), part]) for number, part in enumerate(parts)]
    return np.concatenate([np.zeros((0, width + 1)), *numbered]).astype(np.float64)


def joined(parts: Sequence[Arrays]) -> Arrays:
    """The results of several lots of rooms as one."""
    first = 0
    result: dict[str, list[Floats]] = {name: [] for name in parts[0]}
    for part in parts:
        for name, values in part.items():
            if name in ("objects", "pairs", "layout"):
                values = values + np.eye(1, values.shape[1]) * first
            result[name].append(values)
        first += len(part["counts"])
    return {name: np.concatenate(values) for name, values in result.items()}


def features_of(found: Arrays) -> list[Features]:
    """The features of each room."""
    count = len(found["counts"])
    objects, pairs = split_ragged(found["objects"], count), split_ragged(found["pairs"], count)
    return [Features(*parts) for parts in zip(objects, pairs, found["scene"], strict=True)]


def split_ragged(rows: Floats, count: int) -> list[Floats]:
    """The parts that :func:`measure_rooms` put under one another, without their numbers."""
    places = np.searchsorted(rows[:, 0], np.arange(count + 1))
    return [rows[start:stop, 1:] for start, stop in pairwise(places)]


def training_layouts(data: Data, numbers: Sequence[int]) -> Arrays:
    """Layouts of training rooms, for novelty."""
    vocabulary = vocabulary_of(data)
    rooms = training_rooms(data, max(numbers) + 1)
    layouts = [layout_of(rooms[number], vocabulary) for number in numbers if number < len(rooms)]
    return {"layout": _ragged(layouts, 3), "counts": np.zeros((len(layouts), len(COUNTS)))}
