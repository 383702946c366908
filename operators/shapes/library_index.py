"""What the asset libraries of the preferences have, as it was when they were last looked through; kept on the disk."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy

from ...unisg_blender.blender.assets.asset_catalogs import catalogs_for, words_of
from ...unisg_blender.blender.assets.shape_data import ShapeData
from ...unisg_blender.runtime.atomic_files import replacing
from ..preferences import NAME

FILE, VERSION = "asset-libraries.json", 1
DEEPEST = 6
"""Folders below a library's own in which files are looked for."""


@dataclass(frozen=True)
class LibraryAsset:
    """An object or a collection of a library, and the words that say what it is, the surest first."""

    library: str
    shape: ShapeData
    words: tuple[str, ...]


_files: dict[str, dict[str, Any]] = {}
"""By path of a file when it was written, how large it is, and what assets it has."""
_read: list[bool] = []
_known: dict[tuple[tuple[str, Path], ...], list[LibraryAsset]] = {}
"""What was made of it, by libraries: panels ask often."""


def libraries() -> dict[str, Path]:
    """The asset libraries of the preferences by name, those whose folders are there."""
    listed = bpy.context.preferences.filepaths.asset_libraries
    paths = {item.name: Path(bpy.path.abspath(item.path)) for item in listed if item.path}
    return {name: path for name, path in paths.items() if path.is_dir()}


def blend_files(folders: Iterable[Path]) -> dict[str, list[float]]:
    """All blend files in some folders: path to when each was written, and its size."""
    found = {}
    for top in folders:
        for folder, below, names in os.walk(top):
            if len(Path(folder).relative_to(top).parts) >= DEEPEST:
                below.clear()
            for name in names:
                if name.endswith(".blend"):
                    path = os.path.join(folder, name)
                    state = os.stat(path)
                    found[path] = [state.st_mtime, float(state.st_size)]
    return found


def changed_files(there: dict[str, list[float]]) -> list[str]:
    """Those that are not known as they are now; what has gone is forgotten."""
    _load()
    for path in set(_files) - set(there):
        del _files[path]
        _known.clear()
    return sorted(path for path, state in there.items() if _files.get(path, {}).get("state") != state)


def remember(record: dict[str, Any], state: list[float]) -> None:
    """What a file has."""
    _files[str(record["path"])] = {"state": state, "assets": record["assets"]}
    _known.clear()


def known_assets() -> list[LibraryAsset]:
    """What the libraries of the preferences have, as far as they were looked through."""
    _load()
    listed = tuple(libraries().items())
    if listed not in _known:
        _known.clear()
        _known[listed] = _of_libraries(dict(listed))
    return _known[listed]


def _of_libraries(listed: dict[str, Path]) -> list[LibraryAsset]:
    found = []
    for name, top in listed.items():
        for path, known in _files.items():
            if top in Path(path).parents and known["assets"]:
                catalogs = catalogs_for(Path(path), top)
                for item in known["assets"]:
                    shape = ShapeData(item["kind"], item["name"], take=path)
                    found.append(LibraryAsset(name, shape, tuple(words_of(item, catalogs))))
    return found


def save() -> None:
    """Keep it for the next time Blender is started, where there is a folder for that."""
    folder = _folder(create=True)
    if folder is not None:
        with replacing(folder / FILE) as temporary:
            temporary.write_text(json.dumps({"version": VERSION, "files": _files}), encoding="utf-8")


def forget() -> None:
    """Know nothing, as when Blender starts."""
    for kept in (_files, _known, _read):
        kept.clear()


def _load() -> None:
    if _read:
        return
    _read.append(True)
    folder = _folder(create=False)
    try:
        kept = json.loads((folder / FILE).read_text("utf-8")) if folder is not None else {}
    except (OSError, ValueError):
        return  # not looked through yet, or damaged: to be looked through again
    if isinstance(kept, dict) and kept.get("version") == VERSION:
        _files.update(kept["files"])


def _folder(create: bool) -> Path | None:
    """Where an extension may write; None for one that is not installed, as in scripts."""
    try:
        return Path(bpy.utils.extension_path_user(NAME, create=create))
    except (ValueError, AttributeError):
        return None


CLASSES = ()


def unregister() -> None:
    """Let it go."""
    forget()
