"""The other files that a scene is made of: an export notices when one of them changes.

Textures are not among them: nothing of a texture enters a dataset.
"""

from __future__ import annotations

import json
import mmap
import os
import re
import sys
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from urllib.parse import unquote

from ...runtime.atomic_files import DamagedError, checksum_of

MTLLIB = re.compile(rb"^mtllib[ \t]+([^\r\n]+)", re.MULTILINE)

Checksums = Mapping[str, str | None]
"""SHA-256 by path, relative to the scene file's folder where possible; None for a file that is not there."""


def files_beside(path: Path) -> list[Path]:
    """The other files that a scene file, open in Blender, is made of, as far as they can be known; missing ones too.

    Linked libraries and caches of a .blend, buffers of a glTF, material libraries of
    an OBJ, layers that a USD file refers to (where Blender offers USD to Python).
    """
    suffix = path.suffix.lower()
    if suffix == ".blend":
        found = _linked()
    elif suffix == ".gltf":
        found = _buffers(path)
    elif suffix == ".obj":
        found = _material_libraries(path)
    else:
        found = _layers(path) if suffix.startswith(".usd") else []
    return sorted(set(found) - {path.absolute()})


def _linked() -> list[Path]:
    import bpy

    libraries = [bpy.path.abspath(item.filepath, library=item.parent) for item in bpy.data.libraries]
    return [Path(os.path.normpath(name)) for name in [*libraries, *map(_cache_path, bpy.data.cache_files)]]


def _cache_path(item: object) -> str:
    import bpy

    return bpy.path.abspath(item.filepath, library=item.library)  # type: ignore[attr-defined]


def _buffers(path: Path) -> list[Path]:
    names = [buffer.get("uri", "") for buffer in json.loads(path.read_bytes()).get("buffers", ())]
    return [path.absolute().parent / unquote(name) for name in names if name and not name.startswith("data:")]


def _material_libraries(path: Path) -> list[Path]:
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        names = [os.fsdecode(match[1].strip()) for match in MTLLIB.finditer(data)]
    return [path.absolute().parent / name for name in names]


def _layers(path: Path) -> list[Path]:
    """All layers that the file refers to, through other layers, too."""
    import bpy

    if not hasattr(bpy.utils, "expose_bundled_modules"):
        return []
    bpy.utils.expose_bundled_modules()
    from pxr import Sdf

    found: dict[str, None] = {}
    waiting = [str(path.absolute())]
    while waiting:
        layer = Sdf.Layer.FindOrOpen(waiting.pop())
        names = [] if layer is None else [layer.ComputeAbsolutePath(name) for name in _references(layer)]
        waiting += [name for name in names if name not in found]
        found |= dict.fromkeys(names)
    return [Path(name) for name in found if "[" not in name]  # what lies inside a package is part of the package


def _references(layer: object) -> list[str]:
    return [name for name in layer.GetCompositionAssetDependencies() if name]  # type: ignore[attr-defined]


def checksums(path: Path, others: Iterable[Path]) -> dict[str, str | None]:
    """What the other files of a scene file are now."""
    folder = path.absolute().parent
    return {_relative(other, folder): _checksum(folder / other) for other in others}


def unchanged(path: Path, before: Checksums) -> bool:
    """Whether the other files of a scene file are what they were."""
    folder = path.absolute().parent
    return all(_checksum(folder / other) == total for other, total in before.items())


def _relative(path: Path, folder: Path) -> str:
    if sys.platform == "win32" and path.drive != folder.drive:
        return path.as_posix()
    return Path(os.path.relpath(path, folder)).as_posix()


def _checksum(path: Path) -> str | None:
    try:
        status = path.stat()
        return _known_checksum(path, status.st_size, status.st_mtime_ns)
    except (OSError, DamagedError):
        return None


@lru_cache(maxsize=1024)
def _known_checksum(path: Path, size: int, time: int) -> str:
    """The checksum of a file of that size and time: many scenes may share a library."""
    return checksum_of(path)
