"""From measurements of rooms to the numbers of a line: means over seeds, their spread, and intervals by scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...geometry.arrays import Floats
from ...metrics.layout_distances import novelty_limit
from ...metrics.seed_statistics import paired_test
from ...metrics.two_sample_test import LEVELS, NOISES
from .completion import Completed
from .room_measures import COUNTS, Arrays

RESAMPLED = 500
INTERVAL = (0.025, 0.975)
SHARES = ("colliding", "overlapping", "off_support", "outside")
NAMES = {
    "centimetres": "completion_cm", "degrees": "completion_degrees", "same_support": "parent_same",
    "same_kind": "parent_kind", "on_top": "on_top_of", "beside": "beside", "nll": "nll",
}  # fmt: skip
"""Columns by field of :class:`~.completion.Completed`; errors are medians, the others means."""


@dataclass(frozen=True, eq=False)
class Measured:
    """One row and seed: arrays of :mod:`.room_measures`, the classifiers' right answers, distances between layouts.

    ``behaviour`` is the recall of actions, NaN for rows without.
    """

    found: Arrays
    judged: Mapping[str, Floats]
    nearest: Floats
    pairwise: float
    behaviour: float = np.nan


@dataclass(frozen=True)
class TableRow:
    """One line of the table.

    ``values`` are means over the seeds, ``spread`` the standard deviations between
    them (none with one seed), ``interval`` the 95 % intervals of a bootstrap over scenes.
    """

    name: str
    seeds: int
    scenes: int
    objects: int
    values: Mapping[str, float]
    spread: Mapping[str, float] = field(default_factory=dict)
    interval: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def to_record(self) -> dict[str, Any]:
        """JSON-ready; what does not apply is left out."""
        return {
            "name": self.name, "seeds": self.seeds, "scenes": self.scenes, "objects": self.objects,
            "values": {name: round(value, 5) for name, value in self.values.items() if np.isfinite(value)},
            "spread": {name: round(value, 5) for name, value in self.spread.items() if np.isfinite(value)},
            "interval": {
                name: [round(low, 5), round(high, 5)]
                for name, (low, high) in self.interval.items() if np.isfinite(low)
            },
        }  # fmt: skip


def row_of(name: str, seeds: Sequence[Measured], real: Measured, ours: Sequence[Measured]) -> TableRow:
    """The line of a row from its seeds; ``real`` are the test rooms, ``ours`` the model's, to compare errors with."""
    single = [_values(one, real) for one in seeds]
    values = {key: float(np.mean([one[key] for one in single])) for key in single[0]}
    spread = {key: float(np.std([one[key] for one in single], ddof=1)) for key in single[0]} if len(single) > 1 else {}
    met = ours if len(ours) == len(seeds) else ours[:1]  # a row without seeds meets the model's first one
    errors, our_errors = (_errors(group) for group in (seeds, met))
    if seeds is not ours and len(errors) == len(our_errors):  # else they know things in different rooms
        values["p_model_better"] = paired_test(our_errors, errors, "less")
    counts = np.concatenate([one.found["counts"] for one in seeds])
    objects = int(counts[:, COUNTS.index("objects")].sum())
    return TableRow(name, len(seeds), len(seeds[0].found["counts"]), objects, values, spread, _intervals(seeds))


def _errors(group: Sequence[Measured]) -> Floats:
    return np.concatenate([one.found["completion"][:, Completed.FIELDS.index("centimetres")] for one in group])


def _values(one: Measured, real: Measured) -> dict[str, float]:
    counts = dict(zip(COUNTS, one.found["counts"].sum(axis=0), strict=True))
    values = {name: counts[name] / max(counts["objects"], 1) for name in SHARES}
    values["refused"] = counts["refused"] / counts["asked"] if counts["asked"] else np.nan
    spent = one.found["milliseconds"]
    values["milliseconds"] = float(np.nanmedian(spent)) if np.isfinite(spent).any() else np.nan
    values |= {f"c2st_{key.replace(' ', '_')}": float(np.nanmean(right)) for key, right in one.judged.items()}
    if np.isfinite(real.nearest).all() and (one.nearest > 0).any():  # not of the training rooms themselves
        values["novelty"] = float((one.nearest > novelty_limit(real.nearest)).mean())
    values["diversity"] = one.pairwise / real.pairwise
    values["behaviour"] = one.behaviour
    for place, name in enumerate(Completed.FIELDS):
        column = one.found["completion"][:, place]
        middle = np.nanmedian if name in ("centimetres", "degrees") else np.nanmean
        values[NAMES[name]] = float(middle(column)) if np.isfinite(column).any() else np.nan
    return values


def _intervals(seeds: Sequence[Measured]) -> dict[str, tuple[float, float]]:
    """95 % intervals: scenes are drawn with replacement, with all seeds of each."""
    rng = np.random.default_rng(0)
    counts = np.sum([one.found["counts"] for one in seeds], axis=0)
    drawn = rng.integers(len(counts), size=(RESAMPLED, len(counts)))
    objects = counts[drawn, COUNTS.index("objects")].sum(axis=1)
    found = {name: _quantiles(counts[drawn, COUNTS.index(name)].sum(axis=1) / objects) for name in SHARES}
    errors = np.stack([one.found["completion"][:, 0] for one in seeds])
    if np.isfinite(errors).any():
        found["completion_cm"] = _quantiles(np.nanmedian(errors[:, drawn], axis=(0, 2)))
    for key in [f"{level} {noise}" for level in LEVELS for noise in NOISES] if seeds[0].judged else ():
        right = np.nanmean([one.judged[key] for one in seeds], axis=0)
        half = len(right) // 2
        pair = np.nanmean([right[:half], right[half : 2 * half]], axis=0)
        again = rng.integers(half, size=(RESAMPLED, half))
        found[f"c2st_{key.replace(' ', '_')}"] = _quantiles(np.nanmean(pair[again], axis=1))
    return found


def _quantiles(values: Floats) -> tuple[float, float]:
    low, high = np.nanquantile(values, INTERVAL)
    return float(low), float(high)
