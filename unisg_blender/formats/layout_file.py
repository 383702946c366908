"""What a reader of layouts is given: the parsed file, where its meshes lie, and a report for what it cannot say."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO, Protocol, cast
from xml.etree.ElementTree import Element

from ..errors import UniSGError
from ..runtime.atomic_files import check_plain
from ..runtime.file_endings import LAYOUT_LINES, is_of
from ..runtime.read_report import ReadReport
from ..scene import SceneGraph
from .asset_folder import AssetFolder
from .plain_xml import parse_xml

LONGEST = 1 << 28
"""Bytes that a text, unpacked, may have: a quarter of a gigabyte."""

GZIP = b"\x1f\x8b"
HELD_AS_WRONG = (
    LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError, EOFError, gzip.BadGzipFile,
)  # fmt: skip
"""What a reader raises over a file that is damaged."""


@dataclass(eq=False)
class LayoutFile:
    """One text of a file.

    Attributes
    ----------
    path
        The file.
    data
        What it says: the value of a JSON text, or the root element of an XML text.
    assets
        Where meshes are looked for: the folder that the user names, then the file's own.
    title
        What its scenes are called; of a file of lines with the number of the line.
    report
        Takes what the file cannot say, or what was not found.
    tell
        Progress, (done, total).
    """

    path: Path
    data: Any
    assets: AssetFolder
    title: str
    report: ReadReport = field(default_factory=ReadReport)
    tell: Callable[[int, int], None] = lambda done, total: None


class LayoutReader(Protocol):
    """A module that reads one kind of layout; docs/formats.md has an example."""

    NAME: str
    LICENCE: str

    def recognises(self, data: Any) -> bool:
        """Whether a parsed text is of this kind: told by what it holds."""
        ...

    def scenes(self, file: LayoutFile) -> Iterator[SceneGraph]:
        """The scenes of a text. What is damaged may raise any of :data:`HELD_AS_WRONG`."""
        ...


def texts(path: Path) -> Iterator[Any]:
    """What each text of a file says: the lines of a .jsonl, else the whole, unpacked if it is packed.

    Raises
    ------
    UniSGError
        If it cannot be read, is no JSON or XML, or is longer than :data:`LONGEST`.
    """
    try:
        check_plain(path)
        with open(path, "rb") as raw:
            packed = raw.read(2) == GZIP
            raw.seek(0)
            file = cast(BinaryIO, gzip.GzipFile(fileobj=raw) if packed else raw)
            if is_of(path, LAYOUT_LINES):
                while line := file.readline(LONGEST + 1):
                    if line.strip():
                        yield _parsed(line, path)
            else:
                yield _parsed(file.read(LONGEST + 1), path)
    except (OSError, EOFError) as error:
        raise UniSGError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from None


def _parsed(text: bytes, path: Path) -> Any:
    if len(text) > LONGEST:
        raise UniSGError(f"cannot read {path}: a text of more than {LONGEST >> 20} MB is not read")
    if text.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        return parse_xml(text, path)
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise UniSGError(f"cannot read {path}: it is not valid JSON: {error}") from None


def is_xml(data: Any, *tags: str) -> bool:
    """Whether a parsed text is XML whose root is one of some elements."""
    return isinstance(data, Element) and data.tag in tags


def has_lists(data: Any, *keys: str) -> bool:
    """Whether a parsed text is a JSON object with a list under each of some keys."""
    return isinstance(data, dict) and all(isinstance(data.get(key), list) for key in keys)
