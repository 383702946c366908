"""The small model behind category proposals: known shapes and sizes, words, and what often stands together."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..geometry.arrays import Floats
from ..meshes.atlasnet_sessions import FEATURE_WIDTH
from ..meshes.normalise import size_channels
from ..pretrained import FOLDER
from ..runtime.atomic_files import write_file
from ..runtime.json_records import from_record, parse_json
from ..words import VocabularyMatch
from .name_evidence import NameEvidence, name_evidence

LABELS_FILE = "labels.safetensors"
ARRAYS = ("vectors", "sizes", "classes", "together")
SIZE_WEIGHT = 0.5
"""How much a factor of e in size counts, in units of the mean distance of shapes from their mean."""
VERSION = "1"
TRUST = 3
"""Numbers of a model's trust."""


@dataclass(frozen=True, eq=False)
class LabelModel:
    """What is known of K categories.

    Attributes
    ----------
    vocabulary
        Their names.
    vectors, sizes
        float16 (M, 1024) and float32 (M, 3): mesh features and :func:`~...meshes.normalise.size_channels`
        of the known meshes, sorted by class.
    classes
        int32 (M,): their categories' places in the vocabulary, each of which occurs.
    spread
        Mean distance of the features from their mean: the unit of distances.
    temperature
        Distance that counts as one nat.
    lexicon
        For each category its words with their weights.
    together
        (K, K): log of how much oftener than by chance a category of the row
        stands beside one of the column; 0 where nothing is known.
    name_weight, beside_weight
        How much a full match of the name and the neighbours count, in nats.
    provenance
        Where the model comes from.
    settings
        By kind of room the categories that were seen in rooms of this kind only.
    trust
        How often it is right, see :func:`~.calibration.calibrated`; empty where that is not known.
    """

    vocabulary: tuple[str, ...]
    vectors: NDArray[np.float16]
    sizes: NDArray[np.float32]
    classes: NDArray[np.int32]
    spread: float
    temperature: float
    lexicon: tuple[dict[str, float], ...]
    together: NDArray[np.float32]
    name_weight: float
    beside_weight: float
    provenance: dict
    settings: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    trust: tuple[float, ...] = ()

    def shape_scores(self, vectors: NDArray[np.floating], sizes: NDArray[np.floating]) -> Floats:
        """Log-likelihoods (N, K), up to a constant, of mesh features (N, 1024) and sizes (N, 3) in metres."""
        apart = distances(vectors, size_channels(sizes), self.vectors, self.sizes, self.spread)
        return -nearest_of_class(apart, self.classes) / self.temperature

    def name_scores(self, names: tuple[str, ...]) -> Floats:
        """Evidence (K,) of an object's names, in nats: that of the first name that has a known word."""
        return self.read_names(names).scores

    def read_names(self, names: tuple[str, ...], words: VocabularyMatch | None = None) -> NameEvidence:
        """What an object's names say, see :func:`~.name_evidence.name_evidence`; scores in nats.

        ``words`` are the model's own :attr:`words` with what the user says of some of them.
        """
        found = name_evidence(names, words or self.words, self.lexicon)
        return NameEvidence(self.name_weight * found.scores, found.thing)

    @cached_property
    def words(self) -> VocabularyMatch:
        """Words of all languages in the model's vocabulary."""
        return VocabularyMatch(self.vocabulary)

    def save(self, path: str | Path) -> None:
        """Write the model as one safetensors file, whole or not at all."""
        from safetensors.numpy import save

        arrays = {name: np.ascontiguousarray(getattr(self, name)) for name in ARRAYS}
        record = {item.name: getattr(self, item.name) for item in fields(self) if item.name not in ARRAYS}
        write_file(Path(path), save(arrays, {"unisg_labels": VERSION, "record": json.dumps(record)}))

    @staticmethod
    def load(path: str | Path | None = None) -> LabelModel:
        """Read a model; the shipped one when no path is given.

        Raises
        ------
        UniSGError
            If the file is missing, damaged or of another version.
        """
        from safetensors import SafetensorError, safe_open

        path = FOLDER / LABELS_FILE if path is None else Path(path)
        if not path.is_file():
            raise UniSGError(f"{path}: no such model of categories; 'unisg train meshes' makes one")
        try:
            with safe_open(path, "np") as file:
                metadata = file.metadata() or {}
                arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        except SafetensorError as error:
            raise UniSGError(f"{path}: the model of categories is damaged: {error}") from error
        if metadata.get("unisg_labels") != VERSION:
            raise UniSGError(f"{path}: is no model of categories of version {VERSION}: train it again")
        what = f"{path}: the model of categories"
        record = from_record(LabelRecord, parse_json(metadata.get("record", ""), what), what)
        _check_arrays(arrays, len(record.vocabulary), what)
        if (
            len(record.trust) not in (0, TRUST)
            or len(record.lexicon) != len(record.vocabulary)
            or min(record.spread, record.temperature) <= 0
        ):
            raise UniSGError(f"{what} is damaged: train it again")
        return LabelModel(**arrays, **vars(record))


@dataclass(frozen=True)
class LabelRecord:
    """The fields of :class:`LabelModel` that are no arrays."""

    vocabulary: tuple[str, ...]
    spread: float
    temperature: float
    lexicon: tuple[dict[str, float], ...]
    name_weight: float
    beside_weight: float
    provenance: dict[str, Any]
    settings: Mapping[str, Any] = field(default_factory=dict)
    trust: tuple[float, ...] = ()


def _check_arrays(arrays: Mapping[str, NDArray[Any]], names: int, what: str) -> None:
    known = len(arrays.get("classes", ()))
    wanted = {
        "vectors": (np.float16, (known, FEATURE_WIDTH)), "sizes": (np.float32, (known, 3)),
        "classes": (np.int32, (known,)), "together": (np.float32, (names, names)),
    }  # fmt: skip
    for name, (kind, shape) in wanted.items():
        found = arrays.get(name)
        if found is None or found.dtype != kind or found.shape != shape or not np.isfinite(found).all():
            raise UniSGError(f"{what} is damaged ({name}): train it again")
    steps = np.diff(arrays["classes"], prepend=-1, append=names)
    if arrays.keys() != wanted.keys() or not ((steps >= 0) & (steps <= 1)).all():
        raise UniSGError(f"{what} is damaged (classes): train it again")


def distances(
    vectors: NDArray[np.floating], sizes: NDArray[np.floating], known_vectors: NDArray[np.floating],
    known_sizes: NDArray[np.floating], spread: float,
) -> Floats:  # fmt: skip
    """(N, M): distances in shape and size; features (N, 1024) and (M, 1024), size channels (N, 3) and (M, 3)."""
    first, second = vectors.astype(np.float64), known_vectors.astype(np.float64)
    square = np.square(first).sum(axis=1)[:, None] + np.square(second).sum(axis=1) - 2 * first @ second.T
    apart = np.linalg.norm(sizes[:, None] - known_sizes, axis=2)
    return np.sqrt(np.maximum(square, 0) / spread**2 + np.square(SIZE_WEIGHT * apart))


def nearest_of_class(apart: Floats, classes: NDArray[np.integer]) -> Floats:
    """(N, K): the least of the distances (N, M) to each class; ``classes`` (M,) sorted, without gaps."""
    return np.minimum.reduceat(apart, np.searchsorted(classes, np.arange(classes[-1] + 1)), axis=1)
