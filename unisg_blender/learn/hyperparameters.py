"""What a user can choose about a training."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import UniSGError

if TYPE_CHECKING:
    import torch


ACCELERATORS = ("auto", "cpu", "gpu")


@dataclass(frozen=True)
class Settings:
    """Choices that the command line offers; None leaves a choice to the job.

    ``logs`` is a folder that keeps checkpoints and metrics: a second run with the
    same folder goes on where the first stopped. After ``patience`` epochs without a
    better validation loss the training ends, with the best weights. ``accelerator``, "auto", "cpu" or "gpu", is
    what computes, ``devices`` how many of it on each of ``nodes`` machines.
    """

    form: str | None = None
    epochs: int | None = None
    seed: int = 0
    paper: bool = False
    accelerator: str = "auto"
    devices: int = 1
    nodes: int = 1
    logs: Path | None = None
    patience: int | None = None
    quiet: bool = False
    command: str = ""

    def to_record(self) -> dict[str, Any]:
        """What decides about the result, JSON-ready."""
        record = asdict(self)
        return {name: record[name] for name in ("form", "epochs", "seed", "paper", "command")}


def accelerator_device(accelerator: str) -> torch.device:
    """Where a training computes: on a GPU (CUDA, or Apple's) if there is one, unless ``accelerator`` is "cpu".

    Raises
    ------
    UniSGError
        If a GPU is asked for and torch finds none.
    """
    import torch

    there = torch.accelerator.is_available()
    if accelerator == "gpu" and not there:
        raise UniSGError("torch finds no GPU on this machine: leave --accelerator out, or install a torch with CUDA")
    found = torch.accelerator.current_accelerator() if there and accelerator != "cpu" else None
    return found or torch.device("cpu")
