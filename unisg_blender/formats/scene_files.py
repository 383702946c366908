"""Scene files of any kind as scenegraphs and back: one reader and one writer for each kind."""

from __future__ import annotations

import importlib
import re
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import Any

from ..errors import UniSGError
from ..runtime.file_endings import BLENDER, GLTF, JSON, LAYOUTS, MESHES, READABLE, SCENE_STATE, USD, WRITABLE, is_of
from ..runtime.guarded_work import reading, still_reading
from ..runtime.large_file_pointer import refuse_pointer
from ..runtime.output_capture import captured_output, heard
from ..runtime.read_report import Loss, ReadReport
from ..scene.graph import SceneGraph
from .gltf.gltf_files import read_own_gltf, write_gltf
from .json_scenes import is_own_scene, read_json, write_json
from .layout_scenes import FoundScene, asset_folder, layout_scenes
from .licences import licence_of
from .linked_files import files_beside
from .mesh_scenes import mesh_scene
from .scene_state_writer import write_scene_state
from .simulators.mjcf_writer import is_mjcf, write_mjcf

Progress = Callable[[int, int], None]
PRIM = re.compile(r"(/\S+): (.*)", re.DOTALL)


def check_kinds(source: Path | None, target: Path | None = None) -> None:
    """Refuse file names that cannot be read or written, and load Blender if it will be needed.

    Raises
    ------
    UniSGError
        If a file is of an unknown kind.
    """
    if source is not None and source.is_dir():
        raise UniSGError(f"cannot read {source}: it is a folder; name a file in it")
    if source is not None and not is_of(source, READABLE):
        raise UniSGError(f"cannot read {source}: the known kinds are {', '.join(READABLE)}")
    if target is not None and not is_of(target, WRITABLE):
        raise UniSGError(f"cannot write {target}: the known kinds are {', '.join(WRITABLE)}")
    if (source is not None and is_of(source, BLENDER)) or (target is not None and is_of(target, (".blend",))):
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
    assets: Path | None = None,
) -> tuple[SceneGraph, ReadReport]:
    """The scenegraph of a file, and what it could not hold.

    Files of :data:`~..runtime.file_endings.BLENDER` are read through Blender, which samples their motion where
    ``animation`` is wanted (``progress`` then counts frames), all others directly. ``scene`` names one of several
    scenes of a file, of a layout also by number; ``assets`` is a folder with the meshes of a layout's things.

    Raises
    ------
    UniSGError
        If the file cannot be read.
    """
    path = Path(path)
    refuse_pointer(path)
    own = read_own_gltf(path) if is_of(path, GLTF) and not scene else None
    if own is not None:
        return own, ReadReport()
    if not is_of(path, BLENDER):
        if is_layout(path):
            return _one_layout(path, scene, assets, progress)
        if scene:
            raise UniSGError(f"{path}: only a Blender file or one with several layouts has several scenes")
        return _read_directly(path, progress)
    from ..blender.blend_files import read_file

    with reading(path):
        return read_file(path, geometry=geometry, animation=animation, scene=scene, progress=_alive(progress))


def opened_by_blender(path: Path) -> bool:
    """Whether :func:`read_scene_file` opens a file in Blender, where it then stands."""
    return is_of(path, BLENDER) and not (is_of(path, GLTF) and read_own_gltf(path) is not None)


@dataclass(frozen=True, eq=False)
class AllScenes:
    """What a file holds.

    Attributes
    ----------
    graphs
        Its scenes that have entities; of a file of many layouts one after the other, so that memory need not hold all.
    note
        In one line what they could not hold, "" for nothing; to be asked when all scenes have been taken.
    beside
        The other files that they are made of, as far as they can be known, missing ones too; to be asked then.
    format
        Which kind of layout it is, "" for none.
    licence
        As :func:`~.licences.licence_of` says.
    """

    graphs: Iterable[SceneGraph]
    note: Callable[[], str]
    beside: Callable[[], list[Path]]
    format: str = ""
    licence: str = ""


def read_all_scenes(path: Path, assets: Path | None = None) -> AllScenes:
    """As :func:`read_scene_file`, all scenes of a file."""
    refuse_pointer(path)
    if is_layout(path):
        return _all_layouts(path, assets)
    own = read_own_gltf(path) if is_of(path, GLTF) else None
    if own is not None:
        graphs, report = [own], ReadReport()
    elif is_of(path, BLENDER):
        from ..blender.blend_files import read_all_scenes

        with reading(path):
            graphs, report = read_all_scenes(path)
    else:
        graph, report = _read_directly(path, None)
        graphs = [graph]
    others, kept = files_beside(path), [graph for graph in graphs if len(graph)]
    return AllScenes(kept, report.summary, lambda: others, licence=licence_of(path))


def _all_layouts(path: Path, assets: Path | None) -> AllScenes:
    report, places = ReadReport(), asset_folder(path, assets)
    rest = layout_scenes(path, places)
    first = next(rest, None)
    reader = None if first is None else first.reader

    def graphs() -> Iterator[SceneGraph]:
        """The scenes, while what they lack is collected."""
        for found in chain([first] if first else [], rest):
            report.extend(found.report)
            if len(found.graph):
                yield found.graph

    kind, usual = (reader.NAME, reader.LICENCE) if reader else ("", "")
    return AllScenes(graphs(), report.summary, lambda: sorted(places.used), kind, licence_of(path, usual))


def is_layout(path: Path) -> bool:
    """Whether a file is one of another program's layouts, by its ending, or for a .json by what it holds."""
    return is_of(path, LAYOUTS) or (is_of(path, JSON) and not is_own_scene(path))


def _one_layout(
    path: Path, scene: str, assets: Path | None, progress: Progress | None
) -> tuple[SceneGraph, ReadReport]:
    """The first scene of a file of layouts, or the one of that title or number."""
    first: FoundScene | None = None
    with reading(path):
        for number, found in enumerate(layout_scenes(path, asset_folder(path, assets), _alive(progress))):
            if scene in (found.graph.title, str(number)):
                return found.graph, found.report
            if not scene and first is not None:
                first.report.add("", f"other scenes of the file: this is {first.graph.title!r}, the first (--scene)")
                break
            first = first or found
    if first is None:
        raise UniSGError(f"cannot read {path}: it holds no scene")
    if scene:
        raise UniSGError(
            f"{path} has no scene {scene!r}: the first is {first.graph.title!r}, or give its number, from 0"
        )
    return first.graph, first.report


def _read_directly(path: Path, progress: Progress | None) -> tuple[SceneGraph, ReadReport]:
    if is_of(path, JSON):
        return read_json(path), ReadReport()
    if is_of(path, MESHES):
        with reading(path):
            return mesh_scene(path)
    check_kinds(path)
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
    if is_of(path, (SCENE_STATE,)):
        return write_scene_state(graph, path)
    if is_mjcf(path):
        return write_mjcf(graph, path)
    if is_of(path, JSON):
        write_json(graph, path)
        return ReadReport()
    if is_of(path, GLTF):
        return write_gltf(graph, path)
    from ..blender.blend_files import write_blend

    return write_blend(graph, path)
