"""How many prims a file unfolds into, before USD unfolds it: nested references grow without end in a small file."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

from pxr import Sdf

from ...errors import UniSGError

MOST = 5_000_000
"""Prims that a scene may have; composing more takes hours and more memory than there is."""
LISTS = frozenset(("references", "payload", "inheritPaths", "specializes"))


def check_size(layer: Any, path: Path) -> None:
    """Refuse a file whose references unfold into more than :data:`MOST` prims.

    Every variant counts, so the number may be larger than what is shown. Circular
    references count once: USD tells of them itself.

    Raises
    ------
    UniSGError
        If there would be too many prims.
    """
    unfolding = _Unfolding()
    try:
        count = sum(unfolding.size(each, Sdf.Path.absoluteRootPath) for each in _with_sublayers(layer, set()))
    except RecursionError:
        raise UniSGError(f"{path}: its references nest too deeply to be read") from None
    if count > MOST:
        raise UniSGError(f"{path}: its references unfold into {count:.3g} prims; {MOST:,} can be read")


class _Specs:
    """The prims of one layer: how many are in and under a path, and what the arcs in and under it bring in."""

    def __init__(self, layer: Any) -> None:
        found: list[Any] = []
        layer.Traverse(Sdf.Path.absoluteRootPath, found.append)
        self._paths = [path for path in found if path.IsPrimPath() or path.IsPrimVariantSelectionPath()]
        single: dict[Any, bool] = {}
        self._arcs = []
        for path in self._paths:
            for asset, target in _arcs(layer.GetObjectAtPath(path)):
                if not asset and target not in single:
                    single[target] = _is_single(layer.GetPrimAtPath(target))
                if asset or not single[target]:
                    self._arcs.append((path, asset, target))

    @cached_property
    def _sorted(self) -> tuple[list[Any], list[tuple[Any, str, Any]]]:
        """Paths and arcs in USD's order, in which all that is under a path follows it."""
        return sorted(self._paths), sorted(self._arcs, key=lambda arc: arc[0])

    def count(self, above: Any) -> int:
        """Number of prims in and under a path."""
        return (
            len(self._paths) if above.IsAbsoluteRootPath() else len(_under(self._sorted[0], above, lambda path: path))
        )

    def arcs(self, above: Any) -> list[tuple[str, Any]]:
        """(asset, path) of what is brought in there, single prims left out."""
        found = self._arcs if above.IsAbsoluteRootPath() else _under(self._sorted[1], above, lambda arc: arc[0])
        return [(asset, target) for _, asset, target in found]


def _under(items: list[Any], above: Any, path_of: Callable[[Any], Any]) -> list[Any]:
    start = bisect_left(items, above, key=path_of)
    stop = bisect_left(items, True, lo=start, key=lambda item: not path_of(item).HasPrefix(above))
    return items[start:stop]


def _arcs(spec: Any) -> list[tuple[str, Any]]:
    """(asset, path) of all that a prim, or one of its variants, refers to."""
    prim = spec.primSpec if isinstance(spec, Sdf.VariantSpec) else spec
    keys = prim.ListInfoKeys()
    if LISTS.isdisjoint(keys):
        return []
    items = [item for name in LISTS.intersection(keys) for item in prim.GetInfo(name).GetAddedOrExplicitItems()]
    return [("", item) if isinstance(item, Sdf.Path) else (item.assetPath, item.primPath) for item in items]


def _is_single(prim: Any) -> bool:
    """Whether nothing is below a prim and nothing comes into it: such as a mesh that many share."""
    return prim is None or not (prim.nameChildren or prim.HasInfo("variantSetNames") or _arcs(prim))


class _Unfolding:
    """Sizes of parts of layers with all that their arcs bring in, each computed once."""

    def __init__(self) -> None:
        self._specs: dict[str, _Specs] = {}
        self._sizes: dict[tuple[str, Any], int] = {}

    def size(self, layer: Any, path: Any) -> int:
        """Number of prims in and under a path."""
        key = (layer.identifier, path)
        if key not in self._sizes:
            if layer.identifier not in self._specs:
                self._specs[layer.identifier] = _Specs(layer)
            specs = self._specs[layer.identifier]
            self._sizes[key] = 1  # while it is being computed: a cycle ends here
            brought = 0
            for asset, target in specs.arcs(path):
                brought += self._target(layer, asset, target)
            self._sizes[key] = specs.count(path) + brought
        return self._sizes[key]

    def _target(self, layer: Any, asset: str, path: Any) -> int:
        if asset:
            try:
                layer = Sdf.Layer.FindOrOpenRelativeToLayer(layer, asset)
            except Exception:  # Tf errors of damaged files, which opening the stage tells
                return 0
        if layer is None:
            return 0
        if path.isEmpty and layer.defaultPrim:
            path = Sdf.Path.absoluteRootPath.AppendChild(layer.defaultPrim)
        return max(self.size(layer, path) - 1, 0) if not path.isEmpty else 0  # it stands in the prim's own place


def _with_sublayers(layer: Any, seen: set[str]) -> list[Any]:
    """The layer and all below it, each once."""
    if layer is None or layer.identifier in seen:
        return []
    seen.add(layer.identifier)
    found = [layer]
    for asset in layer.subLayerPaths:
        try:
            found += _with_sublayers(Sdf.Layer.FindOrOpenRelativeToLayer(layer, asset), seen)
        except Exception:  # Tf errors, as above
            continue
    return found
