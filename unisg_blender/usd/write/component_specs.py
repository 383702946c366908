"""Component tables without a standard schema: one prim per table, one array per column."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Vt

from ...errors import UniSGError
from ...scene import components
from ...scene.graph import SceneGraph
from .. import schema
from ..names import Identifiers, clean
from .specs import Types, custom, define, define_class

ON_PRIMS = (
    components.ACTIONS, components.LSA, components.RELATIONS, components.PROPERTIES, components.WORLD,
    components.ANIMATION, components.RECORDING, components.EVENTS, components.INSTANCES,
)  # fmt: skip
"""Tables that stand on the prims of their entities."""


def write_components(parent: Any, graph: SceneGraph) -> None:
    """Author all other tables in a scope under ``parent``.

    Raises
    ------
    UniSGError
        If a column holds values that have no JSON form.
    """
    tables = {name: found for name, found in graph.components.items() if name not in ON_PRIMS}
    if not tables:
        return
    scope = define_class(parent, schema.COMPONENT_SCOPE)
    identifiers = Identifiers()
    for name, found in tables.items():
        prim = define(scope, identifiers.take(name), "", name)
        custom(prim, schema.ENTITIES, Types.StringArray, [clean(graph.uid[row]) for row in found.rows])
        columns = Identifiers()
        layout = {}
        for column, values in found.columns.items():
            identifier = columns.take(column)
            kind, form, array = encode_column(values, f"{name}.{column}")
            custom(prim, schema.COLUMN + identifier, kind, array)
            layout[identifier] = {"name": column, "form": form, "shape": list(values.shape[1:])}
        custom(prim, schema.LAYOUT, Types.String, clean(json.dumps(layout, ensure_ascii=False, sort_keys=True)))


def encode_column(values: NDArray[Any], name: str) -> tuple[Any, str, Any]:
    """A column as (USD type, form, flat array); the form says how to decode it: a dtype, "str", "tuple" or "json"."""
    flat = values.reshape(-1)
    if values.dtype == object:
        if all(isinstance(value, str) for value in flat):
            return Types.StringArray, "str", [clean(value) for value in flat]
        form = "tuple" if all(isinstance(value, tuple) for value in flat) else "json"
        try:
            return Types.StringArray, form, [clean(json.dumps(value, ensure_ascii=False)) for value in flat]
        except (TypeError, ValueError):
            raise UniSGError(f"the component {name} holds values that USD cannot: make them numbers or JSON") from None
    form = values.dtype.str
    if values.dtype.kind == "U":
        return Types.StringArray, form, [clean(value) for value in flat.tolist()]
    if values.dtype.kind == "b":
        return Types.BoolArray, form, Vt.BoolArray(flat.tolist())
    if values.dtype.kind == "u" and values.dtype.itemsize == 8:
        return Types.UInt64Array, form, Vt.UInt64Array.FromNumpy(np.ascontiguousarray(flat))
    if values.dtype.kind in "iu":
        return Types.Int64Array, form, Vt.Int64Array.FromNumpy(flat.astype(np.int64))
    if values.dtype.kind == "f":
        return Types.DoubleArray, form, Vt.DoubleArray.FromNumpy(flat.astype(np.float64))
    raise UniSGError(f"the component {name} holds values that USD cannot: make them numbers or JSON")
