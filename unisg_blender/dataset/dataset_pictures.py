"""Pictures of a dataset: histograms, and top-down views of some of its scenes. Needs matplotlib."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..geometry.boxes import corners
from ..runtime.made_files import filling
from ..runtime.matplotlib_figure import new_figure
from ..scene.mesh import BOX_FACES
from ..spatial import oriented_boxes
from .dataset_description import describe_dataset, entity_sizes, scene_numbers
from .format.reader import Dataset, Scene, open_dataset
from .rebuild import to_scenegraph

SCENES = 24
COLUMNS = 6
CATEGORIES = 40


def draw_dataset(path: str | os.PathLike[str], out: str | os.PathLike[str]) -> list[Path]:
    """Write ``histograms.png`` and ``scenes.png`` (a contact sheet) to the folder ``out``; returns their paths.

    Raises
    ------
    UniSGError
        If matplotlib is missing, there is no dataset, or the folder cannot be written.
    """
    dataset, record = open_dataset(path), describe_dataset(path)
    folder = Path(out)
    pictures = {
        "histograms.png": _histograms(new_figure(12, 8), dataset, record),
        "scenes.png": _contact_sheet(new_figure(6.4, 4.8), dataset),
    }
    with filling(folder) as draft:
        for name, figure in pictures.items():
            figure.savefig(draft / name, dpi=110)
    return [folder / name for name in pictures]


def _histograms(figure: Any, dataset: Dataset, record: dict[str, Any]) -> Any:
    """Entities by category, scenes by number of entities, and sizes of objects."""
    grid = figure.add_gridspec(2, 2)
    counts = dict(list(record["categories"].items())[:CATEGORIES])
    bars = figure.add_subplot(grid[0, :])
    bars.bar(range(len(counts)), list(counts.values()))
    bars.set_xticks(range(len(counts)), list(counts), rotation=60, ha="right", fontsize=8)
    bars.set(title="entities by category", ylabel="entities")
    shards = [dataset.shard(number) for number in range(len(dataset.manifest["shards"]))]
    sizes = np.concatenate([np.diff(columns["entity.ptr"]) for columns in shards])
    scenes = figure.add_subplot(grid[1, 0])
    scenes.hist(sizes, bins=min(50, int(sizes.max() - sizes.min()) + 1))
    scenes.set(title="scenes by number of entities", xlabel="entities", ylabel="scenes")
    longest = np.concatenate([entity_sizes(columns) for columns in shards])
    longest = longest[longest > 0]
    lengths = figure.add_subplot(grid[1, 1])
    if len(longest):
        edges = np.geomspace(longest.min(), max(longest.max(), 1.001 * longest.min()), 50)
        lengths.hist(longest, bins=edges)
        lengths.set_xscale("log")
    lengths.set(title="entities by longest side (own frame)", xlabel="metres", ylabel="entities")
    return figure


def _contact_sheet(figure: Any, dataset: Dataset) -> Any:
    """Top-down views of scenes spread over the dataset, coloured by category."""
    numbers = scene_numbers(dataset, SCENES)
    rows = -(-len(numbers) // COLUMNS)
    figure.set_size_inches(2.6 * min(COLUMNS, len(numbers)), 2.8 * rows)
    for place, number in enumerate(numbers):
        axes = figure.add_subplot(rows, min(COLUMNS, len(numbers)), place + 1)
        draw_top_view(axes, dataset[number])
        name = Path(dataset[number].source).name or dataset[number].title
        axes.set_title(f"{number}: {name}"[:32], fontsize=7)
    return figure


def draw_top_view(axes: Any, scene: Scene) -> None:
    """The boxes of a scene from above, low ones first, one colour per category."""
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection

    boxes = oriented_boxes(to_scenegraph(scene))
    solid = np.flatnonzero(boxes.solid)
    points = corners(boxes)
    order = solid[np.argsort(points[solid, :, 2].max(axis=1))]
    quads: NDArray[np.float64] = points[order][:, BOX_FACES][..., :2].reshape(-1, 4, 2)
    colour = colormaps["tab20"](scene["entity.category"][order] % 20)
    colour[scene["entity.category"][order] < 0] = (0.85, 0.85, 0.85, 1.0)
    faces = np.repeat(colour, len(BOX_FACES), axis=0)
    axes.add_collection(PolyCollection(list(quads), facecolors=faces, edgecolors="black", linewidths=0.2, alpha=0.8))
    axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xticks=[], yticks=[])
