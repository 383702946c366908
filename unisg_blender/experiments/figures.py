"""Figures of reports, drawn without a window."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..errors import MissingPackageError


def figure_of(size: tuple[float, float], rows: int, columns: int) -> tuple[Any, Any]:
    """A figure of a size in inches, and its axes row by row.

    Raises
    ------
    MissingPackageError
        Without matplotlib.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingPackageError("matplotlib", "figures") from None
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, squeeze=False).reshape(-1)


def save_figure(figure: Any, paths: Sequence[Path]) -> None:
    """Write it as pictures, the endings say which."""
    for path in paths:
        figure.savefig(path, dpi=110)
