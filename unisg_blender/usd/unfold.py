"""How many prims a file unfolds into, before USD unfolds it: nested references grow without end in a small file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pxr import Sdf

from ..errors import UniSGError

MOST = 5_000_000
"""Prims that a scene may have; composing more takes hours and more memory than there is."""


def check_size(layer: Any, path: Path) -> None:
    """Refuse a file whose references unfold into more than :data:`MOST` prims.

    Every variant counts, so the number may be larger than what is shown. Circular
    references count once: USD tells of them itself.

    Raises
    ------
    UniSGError
        If there would be too many prims.
    """
    try:
        count = sum(_Unfolding().size(each, prim) for each in _with_sublayers(layer, set()) for prim in each.rootPrims)
    except RecursionError:
        raise UniSGError(f"{path}: its references nest too deeply to be read") from None
    if count > MOST:
        raise UniSGError(
            f"{path}: its references unfold into {count:.3g} prims, more than the {MOST:,} that can be read"
        )


class _Unfolding:
    """Sizes of prim specs with all that their arcs bring in, each computed once."""

    def __init__(self) -> None:
        self._sizes: dict[tuple[str, Any], int] = {}

    def size(self, layer: Any, prim: Any) -> int:
        """Number of prims that a spec stands for, itself included."""
        key = (layer.identifier, prim.path)
        if key not in self._sizes:
            self._sizes[key] = 1  # while it is being computed: a cycle ends here
            self._sizes[key] = 1 + self._below(layer, prim) + self._brought(layer, prim)
        return self._sizes[key]

    def _below(self, layer: Any, prim: Any) -> int:
        count = 0
        for child in prim.nameChildren:
            count += self.size(layer, child)
        if prim.HasInfo("variantSetNames"):
            for variants in prim.variantSets:
                for variant in variants.variants:
                    count += self._below(layer, variant.primSpec) + self._brought(layer, variant.primSpec)
        return count

    def _brought(self, layer: Any, prim: Any) -> int:
        count = 0
        for name in ("references", "payload"):
            if prim.HasInfo(name):
                for arc in prim.GetInfo(name).GetAddedOrExplicitItems():
                    count += self._target(layer, arc.assetPath, arc.primPath)
        for name in ("inheritPaths", "specializes"):
            if prim.HasInfo(name):
                for target in prim.GetInfo(name).GetAddedOrExplicitItems():
                    count += self._target(layer, "", target)
        return count

    def _target(self, layer: Any, asset: str, path: Any) -> int:
        if asset:
            try:
                layer = Sdf.Layer.FindOrOpenRelativeToLayer(layer, asset)
            except Exception:  # Tf errors of damaged files, which opening the stage tells
                return 0
        if layer is None:
            return 0
        if path.isEmpty:
            path = Sdf.Path.absoluteRootPath.AppendChild(layer.defaultPrim) if layer.defaultPrim else path
        prim = layer.GetPrimAtPath(path) if not path.isEmpty else None
        return self.size(layer, prim) - 1 if prim else 0  # the target itself stands in the prim's place


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
