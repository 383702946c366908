"""Scene files of any kind as scenegraphs and back: one reader and one writer for each kind."""

from __future__ import annotations

import importlib
import re
import sys
import warnings
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ..errors import UniSGError
from ..runtime.file_endings import BLENDER, JSON, READABLE, USD, WRITABLE, is_of
from ..runtime.guarded_work import reading, still_reading
from ..runtime.output_capture import captured_output, heard
from ..runtime.read_report import Loss, ReadReport
from ..scene.graph import SceneGraph
from .json_scenes import read_json, write_json

Progress = Callable[[int, int], None]
PRIM = re.compile(r"(/\S+): (.*)", re.DOTALL)


def check_kinds(source: Path | None, target: Path | None = None) -> None:
    """Refuse file names that cannot be read or written, and load Blender if it will be needed.

    Raises
    ------
    UniSGError
        If a file is of an unknown kind.
    """
    if source is not None and not is_of(source, READABLE):
        raise UniSGError(f"cannot read {source}: the known kinds are {', '.join(READABLE)}")
    if target is not None and not is_of(target, WRITABLE):
        raise UniSGError(f"cannot write {target}: the known kinds are {', '.join(WRITABLE)}")
    if any(path is not None and is_of(path, BLENDER) for path in (source, target)):
        load_blender()


def load_blender() -> None:
    """Load Blender, if it is installed: it must come before the first USD file, for it brings a USD of its own."""
    if "bpy" in sys.modules or find_spec("bpy"):
        importlib.import_module("..blender", __package__)


def read_scene_file(
    path: Path | str,
    progress: Progress | None = None,
    *,
    geometry: Any = "evaluated",
    animation: bool = False,
    scene: str = "",
) -> tuple[SceneGraph, ReadReport]:
    """The scenegraph of a file, and what it could not hold.

    USD and JSON files are read directly, all others through Blender, which samples their
    motion where ``animation`` is wanted; ``progress`` then counts frames. ``scene`` names
    one of a Blender file's scenes.

    Raises
    ------
    UniSGError
        If the file cannot be read.
    """
    path = Path(path)
    if is_of(path, (*USD, *JSON)):
        if scene:
            raise UniSGError(f"{path}: only a Blender file has several scenes")
        return _read_directly(path, progress)
    from ..blender.blend_files import read_file

    with reading(path):
        return read_file(path, geometry=geometry, animation=animation, scene=scene, progress=_alive(progress))


def read_all_scenes(path: Path) -> tuple[list[SceneGraph], str]:
    """As :func:`read_scene_file`, all scenes of a file that have entities, and in one line what they could not hold."""
    if is_of(path, (*USD, *JSON)):
        graph, lost = _read_directly(path, None)
        return [graph] if len(graph) else [], lost.summary()
    from ..blender.blend_files import read_all_scenes

    with reading(path):
        graphs, report = read_all_scenes(path)
    return [graph for graph in graphs if len(graph)], report.summary()


def _read_directly(path: Path, progress: Progress | None) -> tuple[SceneGraph, ReadReport]:
    if is_of(path, JSON):
        return read_json(path), ReadReport()
    from ..usd import read_usd
    from ..usd.pxr_library import require_pxr

    require_pxr()
    with warnings.catch_warnings(record=True) as caught, reading(path), captured_output():
        warnings.simplefilter("always", UserWarning)
        graph = read_usd(path, _alive(progress and heard(progress)))
    report = ReadReport()
    for item in caught:
        if isinstance(item.message, Loss):
            for name in item.message.names:
                report.add(name, item.message.text)
        elif isinstance(item.message, UserWarning):
            report.add(*_of_prim(str(item.message)))
    return graph, report


def _alive(progress: Progress | None) -> Progress:
    """Progress that also tells who waits for this process that the reading goes on."""

    def tell(done: int, total: int) -> None:
        """Tell both."""
        still_reading()
        if progress is not None:
            progress(done, total)

    return tell


def _of_prim(message: str) -> tuple[str, str]:
    """The path of a prim, which has no blank, and what is said of it; "" where a message is about the file."""
    found = PRIM.fullmatch(message)
    return (found[1], found[2]) if found else ("", message)


def write_scene_file(graph: SceneGraph, path: Path | str, progress: Progress | None = None) -> ReadReport:
    """Write a scenegraph in the kind that the path's ending names; returns what that kind could not hold.

    The file is complete, or is not written at all.

    Raises
    ------
    UniSGError
        If the file cannot be written.
    """
    path = Path(path)
    if is_of(path, USD):
        from ..usd import write_usd

        write_usd(graph, path, progress)
        return ReadReport()
    if is_of(path, JSON):
        write_json(graph, path)
        return ReadReport()
    from ..blender.blend_files import write_blend

    return write_blend(graph, path)
