"""XML without what makes it dangerous: no entities of its own, bounded in depth and number of elements."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from ..errors import UniSGError

DEEPEST = 200
MOST_ELEMENTS = 5_000_000


def parse_xml(text: bytes, path: Path) -> Element:
    """The root element of a text, names without their namespaces.

    Raises
    ------
    UniSGError
        If it is no XML, defines entities, or is nested deeper than :data:`DEEPEST`.
    """
    builder, parser = TreeBuilder(), expat.ParserCreate(namespace_separator=" ")
    depth = count = 0

    def start(name: str, attributes: dict[str, str]) -> None:
        """Begin an element, unless there are too many."""
        nonlocal depth, count
        depth, count = depth + 1, count + 1
        if depth > DEEPEST or count > MOST_ELEMENTS:
            raise UniSGError(f"cannot read {path}: its XML is nested too deeply or has too many elements")
        builder.start(name.rpartition(" ")[2], attributes)

    def end(name: str) -> None:
        """End an element."""
        nonlocal depth
        depth -= 1
        builder.end(name.rpartition(" ")[2])

    def refuse(*about: object) -> None:
        raise UniSGError(f"cannot read {path}: its XML defines entities, which is refused")

    parser.buffer_text = True
    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(text.lstrip(), True)
        return builder.close()
    except expat.ExpatError as error:
        raise UniSGError(f"cannot read {path}: it is not valid XML: {error}") from None
