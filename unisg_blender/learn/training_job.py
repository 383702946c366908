"""A model that can be trained: what its folder's ``training`` module has, and how that becomes a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

from torch import Tensor, nn
from torch.utils.data import DataLoader

from ..dataset.format.reader import Dataset
from .hyperparameters import Settings
from .provenance import provenance
from .trainer import Schedule, fit


@dataclass(frozen=True, eq=False)
class Prepared:
    """A network before its first step, and what it is to learn from.

    ``loaders`` are for training and validation; ``scenes`` counts those to train on and those held out; ``contract``
    goes into the file; ``beside`` is what else :meth:`TrainingJob.export` needs; ``facts`` are entries of the
    provenance.
    """

    network: nn.Module
    loaders: Sequence[DataLoader[Any]]
    scenes: tuple[int, int]
    contract: Any
    beside: Any = None
    schedule: Schedule = field(default_factory=Schedule)
    facts: Mapping[str, Any] = field(default_factory=dict)


class TrainingJob(Protocol):
    """The module ``learn.MODEL.training``."""

    EPOCHS: int
    FORM: str | None

    def prepare(self, datasets: Sequence[Dataset], settings: Settings) -> Prepared:
        """Load the data, and make the network; UniSGError if there is too little to learn from."""

    def terms(self, network: nn.Module, batch: Any) -> Mapping[str, Tensor]:
        """The terms of the loss of a batch; "loss" is what is minimised."""

    def export(self, prepared: Prepared, source: dict[str, Any], out: Path) -> None:
        """Write the trained network with its provenance, to which measurements may be added."""


def train_model(job: TrainingJob, datasets: Sequence[Dataset], out: Path, settings: Settings) -> dict[str, Any]:
    """Train and export; returns the provenance that the model carries.

    Raises
    ------
    UniSGError
        Too little data, settings that the model does not know, or no such accelerator.
    """
    settings = replace(settings, epochs=settings.epochs or job.EPOCHS, form=settings.form or job.FORM)
    prepared = job.prepare(datasets, settings)
    losses = fit(prepared.network, job.terms, prepared.loaders, prepared.schedule, settings)
    source = provenance(datasets[0], settings, prepared.scenes, losses, prepared.network) | dict(prepared.facts)
    job.export(prepared, source, out)
    return source
