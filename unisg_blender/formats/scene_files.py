"""Scene files of any kind as scenegraphs and back, for the verbs."""

from __future__ import annotations

import importlib
import json
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..errors import UniSGError
from ..runtime.atomic_files import write_file
from ..runtime.progress import Progress as Bar
from ..scene.graph import SceneGraph
from ..usd.usd_files import SUFFIXES as USD

BLENDER = (".blend", ".glb", ".gltf", ".fbx", ".obj")
READABLE = (*BLENDER, *USD)
WRITABLE = (".blend", ".json", *USD)
Progress = Callable[[int, int], None]
MOMENT = 1.0  # seconds


def check_kinds(source: Path, target: Path | None) -> None:
    """Refuse file names that cannot be read or written, and load Blender if it will be needed.

    Blender must come before the first USD file: it brings a USD of its own.

    Raises
    ------
    UniSGError
        If a file is of an unknown kind, or Blender is needed and is not there.
    """
    if source.suffix.lower() not in READABLE:
        raise UniSGError(f"cannot read {source}: the known kinds are {', '.join(READABLE)}")
    if target is not None and target.suffix.lower() not in WRITABLE:
        raise UniSGError(f"cannot write {target}: the known kinds are {', '.join(WRITABLE)}")
    if any(path is not None and path.suffix.lower() in BLENDER for path in (source, target)):
        importlib.import_module("..blender", __package__)


@contextmanager
def shown(quiet: bool, unit: str) -> Iterator[Progress]:
    """A progress bar on stderr, for work that takes longer than a moment."""
    bars: list[Bar] = []
    begin = time.monotonic()

    def tell(done: int, total: int) -> None:
        """Show a bar as soon as it takes longer than a moment."""
        if not bars and time.monotonic() - begin > MOMENT and done < total:
            bars.append(Bar(total, unit, quiet))
        for bar in bars:
            bar.update(done)

    try:
        yield tell
    finally:
        for bar in bars:
            bar.close()


def read_scene_file(
    path: Path,
    progress: Progress | None = None,
    *,
    geometry: Any = "evaluated",
    animation: bool = False,
    scene: str = "",
) -> tuple[SceneGraph, list[str]]:
    """The scenegraph of a file, and what it could not hold, one line each.

    USD files are read directly, all others through Blender, which samples their motion
    where ``animation`` is wanted; ``progress`` then counts frames. ``scene`` names one of a
    Blender file's scenes.

    Raises
    ------
    UniSGError
        If the file cannot be read.
    """
    if path.suffix.lower() in USD:
        from ..usd import read_usd

        if scene:
            raise UniSGError(f"{path}: a USD file has one scene")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", UserWarning)
            graph = read_usd(path, progress)
        return graph, [str(item.message) for item in caught if issubclass(item.category, UserWarning)]
    from ..blender.blend_files import read_file

    graph, report = read_file(path, geometry=geometry, animation=animation, scene=scene, progress=progress)
    return graph, list(report)


def write_scene_file(graph: SceneGraph, path: Path, progress: Progress | None = None) -> list[str]:
    """Write a scenegraph in the kind that the path's ending names; what that kind could not hold, one line each.

    The file is complete, or is not written at all.

    Raises
    ------
    UniSGError
        If the file cannot be written.
    """
    if path.suffix.lower() in USD:
        from ..usd import write_usd

        write_usd(graph, path, progress)
        return []
    if path.suffix.lower() == ".json":
        _write_json(graph, path)
        return []
    return _write_blend(graph, path)


def _write_json(graph: SceneGraph, path: Path) -> None:
    from ..scene.lesson_node import lesson_to_json
    from ..scene.scene_text import summary, to_records

    lsa = graph.components.get("lsa")
    lessons: Sequence[Any] = () if lsa is None else [json.loads(lesson_to_json(each)) for each in lsa.columns["data"]]
    record = summary(graph) | {"entities": to_records(graph), "lessons": lessons}
    write_file(path, json.dumps(record, ensure_ascii=False))


def _write_blend(graph: SceneGraph, path: Path) -> list[str]:
    import bpy

    from ..blender import ReadReport, new_file, save_blend, write_scene

    report = ReadReport()
    new_file()
    bpy.context.scene.name = graph.title
    write_scene(graph, bpy.context.scene, report=report)
    save_blend(path)
    return list(report)
