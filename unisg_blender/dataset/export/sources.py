"""Which files an export reads: files, folders and globs, in an order that is always the same."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from ...errors import UniSGError
from ...formats.json_scenes import is_own_scene
from ...formats.layout_scenes import holds_layout
from ...runtime.file_endings import ANYTHING, BLENDER, JSON, LAYOUTS, MESHES, PARTS, READABLE, USD, is_of

SUFFIXES = (*BLENDER, *USD, *LAYOUTS, *MESHES)
"""Kinds of scene file that are looked for in folders, and those .json that hold a layout of another program.

A scene that was saved as .json is read where it is named, or where a folder has no others: it may stand beside the
file that it was made of. Where a folder has layouts, files of meshes are what these are made of, and no scenes.
"""


def find_sources(inputs: Iterable[str | os.PathLike[str]], suffixes: tuple[str, ...] = SUFFIXES) -> list[Path]:
    """The files behind some inputs, each once (links included, the first path counts), sorted by path.

    Parameters
    ----------
    inputs
        Files (of any kind), folders (searched with what is below them; hidden
        files are left out) and globs (``**`` goes through folders).
    suffixes
        Kinds of file that count in folders.

    Raises
    ------
    UniSGError
        If an input does not exist, or holds no scene file.
    """
    paths: list[Path] = []
    for item in inputs:
        try:
            files = list(_files(Path(item), suffixes))
        except OSError as error:
            raise UniSGError(f"cannot look for {item}: {error.strerror}") from None
        if not files:
            raise UniSGError(f"there is no scene file in {item}: the known kinds are {', '.join(suffixes)}")
        paths += files
    found: dict[str, Path] = {}
    for path in sorted(paths, key=lambda path: path.as_posix()):
        found.setdefault(os.path.realpath(path), path)
    return list(found.values())


def largest_first(paths: Iterable[Path]) -> list[Path]:
    """The files in an order in which several jobs end at about the same time."""
    return sorted(paths, key=_size, reverse=True)


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0


def _files(item: Path, suffixes: tuple[str, ...]) -> Iterator[Path]:
    if item.is_dir():
        yield from _below(item, suffixes)
    elif item.exists():
        yield item
    else:
        matches = sorted(glob.glob(str(item), recursive=True))
        if not matches:
            raise UniSGError(f"there is no file {item}: check the path")
        for match in matches:
            if Path(match).is_dir():
                yield from _below(Path(match), suffixes)
            elif is_of(Path(match), READABLE) if is_of(item, READABLE) else _is_scene(Path(match), suffixes):
                yield Path(match)  # a glob that says its ending names the files


def _below(folder: Path, suffixes: tuple[str, ...]) -> list[Path]:
    found = list(_found(folder, suffixes))
    if suffixes == SUFFIXES and not found:
        return [path for path in _found(folder, JSON) if is_own_scene(path)]
    if suffixes == SUFFIXES and any(is_of(path, (*LAYOUTS, *JSON)) for path in found):
        return [path for path in found if not is_of(path, PARTS)]
    return found


def _found(folder: Path, suffixes: tuple[str, ...]) -> Iterator[Path]:
    for root, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".")]
        for name in names:
            if not name.startswith(".") and _is_scene(Path(root, name), suffixes):
                yield Path(root, name)


def _is_scene(path: Path, suffixes: tuple[str, ...]) -> bool:
    """Whether a file counts that nobody has named: by its ending, or by what it holds where that may be anything."""
    return holds_layout(path) if suffixes == SUFFIXES and is_of(path, ANYTHING) else is_of(path, suffixes)
