"""Files of other programs as scenes: which program's a file is, told by its content, and its scenes one by one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from ..errors import UniSGError
from ..runtime.file_endings import LAYOUT_LINES, is_of
from ..runtime.read_report import ReadReport
from ..scene import SceneGraph
from .asset_folder import AssetFolder
from .json_scenes import KEY, read_json
from .layout_file import HELD_AS_WRONG, LayoutFile, LayoutReader, texts
from .layouts import (
    front3d_houses,
    habitat_scenes,
    internscenes_layouts,
    ithor_plans,
    procthor_houses,
    sage_rooms,
    scene_states,
    ssr_rooms,
    tdw_layouts,
    virtualhome_graphs,
)
from .simulators import gazebo_worlds, mjcf_models, urdf_robots

READERS: tuple[LayoutReader, ...] = (
    procthor_houses,
    ithor_plans,
    virtualhome_graphs,
    tdw_layouts,
    internscenes_layouts,
    scene_states,
    habitat_scenes,
    sage_rooms,
    front3d_houses,
    ssr_rooms,
    gazebo_worlds,
    urdf_robots,
    mjcf_models,
)
"""Who reads a file: the first that recognises what it holds."""

Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class FoundScene:
    """A scene of a file, who read it (None: it is one of ours), and what is not in it."""

    graph: SceneGraph
    reader: LayoutReader | None
    report: ReadReport


def reader_of(data: Any) -> LayoutReader | None:
    """Who reads a parsed text; None if nobody knows it."""
    for reader in READERS:
        try:
            if reader.recognises(data):
                return reader
        except HELD_AS_WRONG:
            continue
    return None


def holds_layout(path: Path) -> bool:
    """Whether a file is a layout of another program, by its first text."""
    try:
        return any(reader_of(data) is not None for data in islice(texts(path), 1))
    except UniSGError:
        return False


def layout_scenes(path: Path, assets: AssetFolder, progress: Progress | None = None) -> Iterator[FoundScene]:
    """The scenes of a file, as they are read.

    Parameters
    ----------
    path
        JSON or XML, perhaps packed; of a .jsonl each line is a text of its own.
    assets
        Where its meshes and what else its kind needs are looked for: :func:`asset_folder`.
    progress
        Called with (done, total) by readers of files that take long.

    Raises
    ------
    UniSGError
        If a text cannot be read, is of no known kind, or is damaged; scenes before it have been given.
    """
    lines = is_of(path, LAYOUT_LINES)
    for number, data in enumerate(texts(path)):
        reader = reader_of(data)
        if reader is None and isinstance(data, dict) and KEY in data:
            yield FoundScene(read_json(path), None, ReadReport())
            return
        if reader is None:
            kinds = ", ".join(each.NAME for each in READERS)
            raise UniSGError(f"cannot read {path}: it holds no scene with its geometry, nor one of the layouts {kinds}")
        title = f"{path.name.split('.')[0]}-{number:03d}" if lines else path.name.split(".")[0]
        file = LayoutFile(path, data, assets, title, tell=progress or _nothing)
        yield from _read(file, reader, f"line {number + 1}: " if lines else "")


def _read(file: LayoutFile, reader: LayoutReader, where: str) -> Iterator[FoundScene]:
    try:
        for graph in reader.scenes(file):
            yield FoundScene(graph, reader, file.report)
            file.report = ReadReport()
    except KeyError as error:
        raise UniSGError(f"cannot read {file.path} as {reader.NAME}: {where}it lacks {error}") from None
    except HELD_AS_WRONG as error:
        raise UniSGError(f"cannot read {file.path} as {reader.NAME}: {where}{error}".splitlines()[0]) from None
    except UniSGError as error:
        told = str(error)
        raise UniSGError(told if str(file.path) in told else f"cannot read {file.path}: {where}{told}") from None


def asset_folder(path: Path, named: Path | None = None) -> AssetFolder:
    """Where what belongs to a file is looked for: the folder that the user names, the file's own, and the two above.

    UniSGError if the named folder is not there.
    """
    folder = path.absolute().parent
    return AssetFolder(named, tuple(dict.fromkeys([folder, folder.parent, folder.parent.parent])))


def _nothing(done: int, total: int) -> None:
    """Nobody listens."""
