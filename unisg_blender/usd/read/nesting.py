"""How deep things nest in the files of a stage, before USD reads them: its readers of text end the process far down."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from xml.parsers import expat

from ...errors import UniSGError

DEEPEST = 1000
"""Braces, brackets and parentheses within each other, or XML elements, that are still read."""
_PLAIN = rb"[^\[\](){}\"'@#/]*+"
_TOKENS = re.compile(
    rb'"""[^"\\]*+(?:(?:\\.|"(?!""))[^"\\]*+)*+(?:"""|\Z)|'
    rb"'''[^'\\]*+(?:(?:\\.|'(?!''))[^'\\]*+)*+(?:'''|\Z)|"
    rb"\"[^\"\\\n]*+(?:\\.[^\"\\\n]*+)*+\"?+|'[^'\\\n]*+(?:\\.[^'\\\n]*+)*+'?+|"
    rb"@@@.*?(?:(?<!\\)@@@|\Z)|@[^@\n]*+@?+|#[^\n]*+|//[^\n]*+|/\*.*?(?:\*/|\Z)|"
    rb"\((?:" + _PLAIN + rb")\)|\[(?:" + _PLAIN + rb"\(" + _PLAIN + rb"\))*+" + _PLAIN + rb"\]|"
    rb"([\[({])|([\])}])",
    re.DOTALL,
)
"""Strings, asset paths, comments, tuples and arrays, which are passed over; an opening; a closing."""


def check_nesting(file: Path) -> None:
    """Refuse a layer, or a package of layers, in which things nest deeper than :data:`DEEPEST`.

    Raises
    ------
    UniSGError
        If they do, or if the file cannot be read.
    """
    try:
        deepest = max((_depth(data) for data in _texts(file)), default=0)
    except OSError as error:
        raise UniSGError(f"{file}: cannot be read: {error.strerror or error}") from None
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError):
        raise UniSGError(f"{file}: not a readable USD file: its package is damaged") from None
    if deepest > DEEPEST:
        raise UniSGError(f"{file}: things nest {deepest} deep in it, more than the {DEEPEST} that can be read")


def _texts(file: Path) -> Iterator[bytes]:
    """The text files that a file is, or packs."""
    with file.open("rb") as stream:
        start = stream.read(8)
        if start.startswith(b"PK"):
            with zipfile.ZipFile(stream) as package:
                yield from (data for name in package.namelist() if _is_text((data := package.read(name))[:8]))
        elif _is_text(start):
            stream.seek(0)
            yield stream.read()


def _is_text(start: bytes) -> bool:
    return start.startswith((b"#usda", b"#sdf", b"<"))


def _depth(data: bytes) -> int:
    if data.startswith(b"<"):
        return _xml_depth(data)
    depth = deepest = 0
    for found in _TOKENS.finditer(data):
        if found[1]:
            depth += 1
            deepest = max(deepest, depth)
        elif found[2]:
            depth -= 1
    return deepest


def _xml_depth(data: bytes) -> int:
    """Depth of a MaterialX file; of one that is no XML the number of its tags, which is more."""
    depths, depth = [0], 0

    def start(name: str, attributes: dict[str, str]) -> None:
        """One deeper."""
        nonlocal depth
        depth += 1
        depths.append(depth)

    def end(name: str) -> None:
        nonlocal depth
        depth -= 1

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = start, end
    try:
        parser.Parse(data, True)
    except expat.ExpatError:
        return data.count(b"<")
    return max(depths)
