"""What a generative model's file says about itself, and how it is checked before anything is run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from ...errors import UniSGError, did_you_mean
from ...poses import FORMS, STRETCH_WIDTH
from ...runtime.json_records import from_record
from ...runtime.onnx_session import damaged, metadata_text
from ..counts import MOST_OBJECTS
from .prior_tables import PriorTables
from .seen_places import WIDTH
from .support_priors import CategoryPriors

VERSION = 5
SINCE = {"anchors": 5}
"""The first version of a kind that this software runs, where that is not 1."""

WIDEST, FARTHEST = 4096, 1e4
"""Largest latent, and largest length in metres, that a model may speak of."""

SHARPEST = 8.0
"""Largest power of odds."""

TASK = "generate"
KINDS = ("cgvae", "anchors", "trees")

PRIOR_KEYS = {"leaders": "references", "spans": "spanning"}
"""How files call some of the priors, which stand there under "habits"."""


@dataclass(frozen=True)
class Contract:
    """The metadata of a generative model.

    Attributes
    ----------
    kind
        One of :data:`KINDS`: which inputs and outputs the network has.
    vocabulary
        The categories it knows, in the order of its numbers.
    form
        Form of the poses it decodes; "" where it gives positions and headings.
    mean, scale
        Of all feature channels (form, then stretch): feature = mean + scale * standardised.
    kept
        Channels that the network has; the others are constant.
    latent
        Width of the noise input; 0 for none.
    priors
        What the training scenes say about the categories.
    provenance
        Dataset, counts, software, command and seed that the model comes from.
    places, plain, sharpness
        Of trees, by category: the places seen in training (:mod:`.seen_places`), how often one of these is taken
        without asking the trees, and the power of the trees' odds by which places are drawn; nothing for other kinds.
    """

    kind: str
    vocabulary: tuple[str, ...]
    priors: CategoryPriors
    form: str = ""
    mean: tuple[float, ...] = ()
    scale: tuple[float, ...] = ()
    kept: tuple[int, ...] = ()
    latent: int = 0
    provenance: dict[str, Any] = field(default_factory=dict)
    places: dict[str, list[list[float]]] = field(default_factory=dict)
    plain: dict[str, float] = field(default_factory=dict)
    sharpness: dict[str, float] = field(default_factory=dict)

    @cached_property
    def tables(self) -> PriorTables:
        """The priors by category number."""
        return PriorTables.of(self.priors, self.vocabulary)

    def to_json(self) -> str:
        """The metadata entry."""
        record = asdict(self)
        priors = record.pop("priors")
        record = {
            name: value for name, value in record.items() if value or name not in ("places", "plain", "sharpness")
        }
        habits = {old: priors.pop(new) for old, new in PRIOR_KEYS.items()} | priors
        return metadata_text(TASK, VERSION, habits=habits, **record)

    @staticmethod
    def from_record(record: Mapping[str, Any], path: Path) -> Contract:
        """The contract of a file's metadata; UniSGError if it is damaged."""
        try:
            habits = dict(record["habits"])
            priors = {new: habits.pop(old) for old, new in PRIOR_KEYS.items() if old in habits} | habits
            rest = {name: value for name, value in record.items() if name != "habits"}
            contract = from_record(Contract, rest | {"priors": priors}, str(path))
            contract.check()
            return contract
        except (KeyError, TypeError, ValueError, UniSGError):
            raise damaged(path) from None

    def check(self) -> None:
        """ValueError if numbers do not fit each other, or no training gives them."""
        names, priors, channels = len(self.vocabulary), self.priors, len(self.mean)
        width = FORMS[self.form].width + STRETCH_WIDTH if self.form else channels
        found = [prior for one in priors.supports.values() for prior in one]
        fits = {
            "vocabulary": 0 < names == len(set(self.vocabulary)),
            "channels": channels == len(self.scale) == width and set(self.kept) <= set(range(channels)),
            "latent": 0 <= self.latent <= WIDEST,
            "sizes": all(len(size) == 3 and 0 <= min(size) <= max(size) <= FARTHEST for size in priors.sizes.values()),
            "rooms": all(len(room) == names and min(room) >= 0 and sum(room) <= MOST_OBJECTS for room in priors.rooms),
            "gaps": all(abs(prior.gap) <= FARTHEST and prior.count > 0 for prior in found),
            "places": all(
                len(row) == WIDTH and max(map(abs, row)) <= FARTHEST for rows in self.places.values() for row in rows
            ),
            "plain": set(self.plain) <= set(self.places) and all(0 <= share <= 1 for share in self.plain.values()),
            "sharpness": all(0 <= power <= SHARPEST for power in self.sharpness.values()),
            "overlaps": all(0 <= depth <= FARTHEST for depth in priors.overlaps.values()),
        }
        if not all(fits.values()):
            raise ValueError(next(name for name, right in fits.items() if not right))

    def check_categories(self, names: Sequence[str]) -> None:
        """UniSGError naming the known categories if one of ``names`` is unknown."""
        for name in names:
            if name not in self.vocabulary:
                hint = did_you_mean(name, self.vocabulary)
                raise UniSGError(f"the model does not know {name!r}{hint}; it knows: {', '.join(self.vocabulary)}")
