"""Figures of reports, drawn without a window."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..runtime.matplotlib_figure import new_figure


def figure_of(size: tuple[float, float], rows: int, columns: int) -> tuple[Any, Any]:
    """A figure of a size in inches, and its axes row by row.

    Raises
    ------
    MissingPackageError
        Without matplotlib.
    """
    figure = new_figure(*size)
    return figure, figure.subplots(rows, columns, squeeze=False).reshape(-1)


def save_figure(figure: Any, paths: Sequence[Path]) -> None:
    """Write it as pictures, the endings say which."""
    for path in paths:
        figure.savefig(path, dpi=110)
