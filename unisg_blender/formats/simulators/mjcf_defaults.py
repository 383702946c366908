"""Defaults of MJCF: what an element has that does not say it itself, by its class and those that this inherits from."""

from __future__ import annotations

from xml.etree.ElementTree import Element

ROOT = "main"
DEEPEST = 100


class Defaults:
    """The classes of a model, by name."""

    def __init__(self, root: Element) -> None:
        self._classes: dict[str, dict[str, dict[str, str]]] = {ROOT: {}}
        for top in root.iterfind("default"):
            self._add(top, top.get("class", ROOT), {}, 0)

    def _add(self, element: Element, name: str, above: dict[str, dict[str, str]], depth: int) -> None:
        own = {tag: dict(values) for tag, values in self._classes.get(name, above).items()}
        for child in element:
            if child.tag != "default":
                own[child.tag] = own.get(child.tag, {}) | child.attrib
        self._classes[name] = own
        for child in element.iterfind("default"):
            if depth < DEEPEST:
                self._add(child, child.get("class", name), own, depth + 1)

    def of(self, element: Element, childclass: str) -> dict[str, str]:
        """All attributes of an element in a body whose things are of ``childclass``."""
        known = self._classes.get(element.get("class") or childclass or ROOT, self._classes[ROOT])
        return known.get(element.tag, {}) | element.attrib
