"""What a user can choose about a training."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Settings:
    """Choices that the command line offers; None leaves a choice to the job.

    ``logs`` is a folder that keeps checkpoints and metrics: a second run with the
    same folder goes on where the first stopped. After ``patience`` epochs without a
    better validation loss the training ends, with the best weights.
    """

    form: str | None = None
    epochs: int | None = None
    seed: int = 0
    paper: bool = False
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
