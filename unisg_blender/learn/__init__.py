"""Networks and their training, a folder for each model, down to the ONNX file. Training needs the extra ``learn``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..runtime.lazy_names import lazy_names
from .hyperparameters import Settings
from .job_list import JOBS, train

if TYPE_CHECKING:
    from .object_categories.training import fit_labels
    from .training_job import TrainingJob, train_model

__all__ = ["JOBS", "Settings", "TrainingJob", "fit_labels", "train", "train_model"]

__getattr__, __dir__ = lazy_names(
    __name__,
    {"TrainingJob": ".training_job", "fit_labels": ".object_categories.training", "train_model": ".training_job"},
)
