"""Figures that are drawn without a window. Needs matplotlib."""

from __future__ import annotations

from typing import Any

from ..errors import MissingPackageError


def new_figure(width: float, height: float) -> Any:
    """An empty ``matplotlib.figure.Figure`` of a size in inches, whose parts make room for one another.

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
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure
