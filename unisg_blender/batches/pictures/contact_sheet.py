"""Pictures beside what is known of them, on one sheet: the picture, its masks, its depth, and its scenegraph."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...dataset import open_dataset
from ...dataset.format.reader import Scene
from ...runtime.matplotlib_figure import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLES = "picture", "masks", "depth in metres", "scenegraph"
EDGE, TEXT = "#2f6f9f", "#1d2430"
FAINT = 0.12
MOST_NAMES = 14
"""Names in one picture: more would lie on one another."""


def write_contact_sheet(folder: Path, graphs: Path, path: Path, names: Sequence[str]) -> None:
    """Draw some pictures of a folder that ``unisg render`` made, with their ``graphs``, a row each (.png, .pdf ...).

    Raises
    ------
    MissingPackageError
        Without matplotlib.
    """
    figure = new_figure(14, 3.1 * len(names))
    from matplotlib.image import imread

    known = {scene.source: scene for scene in open_dataset(graphs)}
    for axes, name in zip(np.atleast_2d(figure.subplots(len(names), len(TITLES))), names, strict=True):
        picture = imread(folder / "pictures" / f"{name}.png")
        with np.load(folder / "truth" / f"{name}.npz") as truth:
            instance, depth = truth["instance"], truth["depth"]
        objects = json.loads((folder / "labels" / f"{name}.json").read_text("utf-8"))["objects"]
        axes[0].imshow(picture)
        axes[0].set_ylabel(name)
        axes[1].imshow(mask_colours(instance))
        axes[2].imshow(np.where(np.isfinite(depth), depth, np.nan), cmap="viridis_r")
        _draw_graph(axes[3], picture, objects, known[name])
    for axes, title in zip(figure.axes[: len(TITLES)], TITLES, strict=True):
        axes.set_title(title)
    for axes in figure.axes:
        axes.set_xticks([])
        axes.set_yticks([])
    figure.savefig(path, dpi=100)


def mask_colours(instance: NDArray[np.int32]) -> NDArray[np.uint8]:
    """A colour for each object (H, W, 3), far from that of the number before; white where nothing is."""
    number = instance.astype(np.int64)[..., None]
    colours = 60 + (number * np.array([67, 151, 211])) % 180
    return np.where(number == 0, 255, colours).astype(np.uint8)


def _draw_graph(axes: Axes, picture: NDArray[Any], objects: list[dict[str, Any]], scene: Scene) -> None:
    """Objects where they are seen, with their relations."""
    axes.imshow(0.25 * picture[..., :3] + 0.75)
    middle = {each["uid"]: _middle(each["bbox"]) for each in objects}
    for one, other, strength in _pairs(scene):
        if one in middle and other in middle:
            axes.plot(*zip(middle[one], middle[other], strict=True), color=EDGE, linewidth=0.8, alpha=strength)
    for each in objects:
        axes.plot(*middle[each["uid"]], "o", color=EDGE, markersize=3)
    for each in sorted(objects, key=lambda each: -int(each["pixels"]))[:MOST_NAMES]:
        axes.annotate(each["category"] or each["name"], middle[each["uid"]], fontsize=6, color=TEXT)


def _middle(box: Sequence[float]) -> tuple[float, float]:
    left, top, width, height = box
    return left + width / 2, top + height / 2


def _pairs(scene: Scene) -> Iterator[tuple[str, str, float]]:
    """uids of entities that a relation, or the hierarchy, joins, and how strongly that is drawn."""
    uids = scene.strings("entity.uid")
    yield from ((uids[row], uids[parent], 1.0) for row, parent in enumerate(scene.parent.tolist()) if parent >= 0)
    for one, other in zip(scene["relation.subject"].tolist(), scene["relation.target"].tolist(), strict=True):
        yield uids[one], uids[other], FAINT
