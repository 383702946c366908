"""Opening and saving USD files: clear errors, and never a half-written file."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from ..errors import UNFORESEEN, UniSGError, unforeseen
from ..runtime.atomic_files import replacing
from ..runtime.file_endings import USD, is_of
from ..scene.parents import depths
from .entity_progress import Progress, ticks
from .pxr_library import require_pxr
from .read.nesting import DEEPEST

MOST_LEVELS = DEEPEST - 100
"""Levels of parents in a scene, so that what is written can be read."""

if TYPE_CHECKING:
    from ..scene.graph import SceneGraph


def write_usd(graph: SceneGraph, path: str | os.PathLike[str], progress: Progress | None = None) -> None:
    """Write a scenegraph as a USD master file.

    Parameters
    ----------
    graph
        The scenegraph.
    path
        Ends in ``.usda`` (text), ``.usdc`` or ``.usd`` (binary) or ``.usdz`` (package). An
        existing file is replaced in one step, and stays as it is if writing fails.
    progress
        Called from time to time with (entities written, entities in all).

    Raises
    ------
    UniSGError
        If the path cannot be written, or a component holds values that have no USD form.
    """
    path = Path(path)
    if not is_of(path, USD):
        raise UniSGError(f"{path}: a USD file ends in {', '.join(USD)}")
    require_pxr()
    from pxr import Sdf

    from .write.layer_writer import nested_graphs, write_layer

    graphs = nested_graphs(graph)
    levels = max(int(depths(each.parent).max(initial=0)) for each in graphs)
    if levels > MOST_LEVELS:
        raise UniSGError(f"{path}: {levels} levels of parents are more than the {MOST_LEVELS} that USD files can have")
    with replacing(path) as temporary, TemporaryDirectory() as folder:
        packed = path.suffix.lower() == ".usdz"
        place = Path(folder, "scene.usdc") if packed else temporary
        layer = Sdf.Layer.CreateNew(str(place))
        write_layer(graph, layer, ticks(sum(map(len, graphs)), progress))
        if not layer.Save():
            raise UniSGError(f"{path}: USD could not write this file")
        del layer
        if packed:
            _package(place, temporary)


def read_usd(path: str | os.PathLike[str], progress: Progress | None = None) -> SceneGraph:
    """Read a USD file, the project's own or any other, as a scenegraph.

    Units and the upward axis of the file are turned into metres and Z up.
    References, payloads, variants as selected and native instances are
    followed; point instancers become the component ``instances``. What could
    not be read is told in :class:`UserWarning` messages.

    Parameters
    ----------
    path
        A ``.usd``, ``.usda``, ``.usdc`` or ``.usdz`` file.
    progress
        Called from time to time with (entities read, entities in all).

    Raises
    ------
    UniSGError
        If the file is missing, damaged, or written by a newer version.
    """
    path = Path(path)
    if not path.is_file():
        raise UniSGError(f"{path}: " + ("is no file" if path.exists() else "there is no such file"))
    if not is_of(path, USD):
        raise UniSGError(f"{path}: a USD file ends in {', '.join(USD)}")
    require_pxr()
    from .read.stage import open_stage
    from .read.stage_reader import read_stage

    try:
        return read_stage(open_stage(path), path.stem, progress)
    except UNFORESEEN as error:
        raise unforeseen(path, "usdview", error) from error


def _package(layer: Path, path: Path) -> None:
    """Pack a binary layer into a package."""
    from pxr import Sdf, Usd

    package = (Sdf if hasattr(Sdf, "ZipFileWriter") else Usd).ZipFileWriter.CreateNew(str(path))
    package.AddFile(str(layer), "scene.usdc")
    if not package.Save():
        raise UniSGError(f"{path.name}: USD could not write this package")
