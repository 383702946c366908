"""The other files that a scene file is made of.

Textures are not among them: nothing of a texture is read.
"""

from __future__ import annotations

import json
import mmap
import os
import re
from pathlib import Path
from urllib.parse import unquote

from ..runtime.file_endings import USD, is_of

MTLLIB = re.compile(rb"^mtllib[ \t]+([^\r\n]+)", re.MULTILINE)


def files_beside(path: Path) -> list[Path]:
    """The other files that the scene file that was read last is made of, as far as they can be known; missing ones too.

    Linked libraries and caches of a .blend, buffers of a glTF, material libraries of
    an OBJ, layers that a USD file refers to.
    """
    suffix = path.suffix.lower()
    if suffix == ".blend":
        from ..blender.blend_files import linked_files

        found = linked_files()
    elif is_of(path, USD):
        from ..usd.read.layer_files import layer_files

        found = layer_files(path)
    else:
        found = _buffers(path) if suffix == ".gltf" else _material_libraries(path) if suffix == ".obj" else []
    return sorted(set(found) - {path.absolute()})


def _buffers(path: Path) -> list[Path]:
    names = [buffer.get("uri", "") for buffer in json.loads(path.read_bytes()).get("buffers", ())]
    return [path.absolute().parent / unquote(name) for name in names if name and not name.startswith("data:")]


def _material_libraries(path: Path) -> list[Path]:
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        names = [os.fsdecode(match[1].strip()) for match in MTLLIB.finditer(data)]
    return [path.absolute().parent / name for name in names]
