"""Short hands for authoring prim, attribute and relationship specs in a layer.

Authoring specs is several times faster than the stage interface, which
recomposes the scene after every step.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Sdf, Vt

from ..names import clean

Types = Sdf.ValueTypeNames


def define(parent: Any, identifier: str, kind: str, name: str | None = None) -> Any:
    """A new prim of type ``kind`` ("" for none) under a prim spec or a layer; ``name`` is its true name."""
    prim = Sdf.PrimSpec(parent, identifier, Sdf.SpecifierDef, kind)
    if name is not None and name != identifier:
        prim.SetInfo("displayName", clean(name))
    return prim


def define_class(parent: Any, identifier: str) -> Any:
    """A new scope whose contents no tool draws or lists; references may point into it."""
    return Sdf.PrimSpec(parent, identifier, Sdf.SpecifierClass, "Scope")


def attribute(prim: Any, name: str, kind: Any, value: Any, *, uniform: bool = True, interpolation: str = "") -> Any:
    """A new attribute of a standard schema with its default value."""
    spec = Sdf.AttributeSpec(prim, name, kind, Sdf.VariabilityUniform if uniform else Sdf.VariabilityVarying)
    if value is not None:
        spec.default = _typed(kind, value)
    if interpolation:
        spec.SetInfo("interpolation", interpolation)
    return spec


def custom(prim: Any, name: str, kind: Any, value: Any, *, uniform: bool = True) -> Any:
    """A new attribute that belongs to no standard schema."""
    spec = Sdf.AttributeSpec(prim, name, kind, Sdf.VariabilityUniform if uniform else Sdf.VariabilityVarying, True)
    if value is not None:
        spec.default = _typed(kind, value)
    return spec


def _typed(kind: Any, value: Any) -> Any:
    """Tuples as USD vectors, lists as USD arrays."""
    if isinstance(value, tuple):
        return kind.type.pythonClass(*value)
    return kind.type.pythonClass(value) if isinstance(value, list) else value


def relationship(prim: Any, name: str, paths: Sequence[Any], *, is_custom: bool = True) -> None:
    """A new relationship to prims; a target named twice counts once."""
    spec = Sdf.RelationshipSpec(prim, name, is_custom, Sdf.VariabilityUniform)
    spec.targetPathList.explicitItems = list(dict.fromkeys(paths))


def apply_schema(prim: Any, *names: str) -> None:
    """Apply API schemas to a prim."""
    prim.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=list(names)))


def points(values: NDArray[np.floating]) -> Any:
    """(K, 3) numbers as ``float3[]``."""
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(values, np.float32).reshape(-1, 3))


def pairs(values: NDArray[np.floating]) -> Any:
    """(K, 2) numbers as ``float2[]``."""
    return Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(values, np.float32).reshape(-1, 2))


def integers(values: NDArray[np.integer]) -> Any:
    """(K,) whole numbers as ``int[]``."""
    return Vt.IntArray.FromNumpy(np.ascontiguousarray(values, np.int32))


def matrices(values: NDArray[np.floating]) -> Any:
    """(K, 4, 4) matrices for column vectors as ``matrix4d[]``, which USD keeps for row vectors."""
    turned = np.asarray(values, np.float64).reshape(-1, 4, 4).transpose(0, 2, 1)
    return Vt.Matrix4dArray.FromNumpy(np.ascontiguousarray(turned))
