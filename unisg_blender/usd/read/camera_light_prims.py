"""Cameras, lights and visibility: the standard attributes, and from our own tables what those do not say.

Where a standard attribute no longer says what the table would have written there,
another tool has edited it, and the attribute counts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ...scene import components
from ...scene.component_table import Table, table
from .. import cameras, light_units, schema
from ..names import true_name
from .entity_selection import Entities
from .mesh_topology import NOW

Values = Mapping[str, Any]
SAME = 1e-5
"""Relative difference that single precision leaves between a value and its attribute."""
CAMERA_NAMES = tuple(cameras.camera_attributes(cameras.NEW))
LIGHT_INPUTS = (
    "color", "intensity", "angle", "radius", "width", "height",
    light_units.CONE, light_units.SOFTNESS, light_units.SHADOW,
    *light_units.COMMON, *light_units.SWITCHES,
)  # fmt: skip


def read_data(found: Entities, tables: dict[str, Table], metres: float) -> dict[str, Table]:
    """The components ``camera``, ``light`` and ``visibility``; ``metres`` is the size of a scene unit."""
    changed = {
        components.CAMERA: _merged(found, "CAMERA", tables.get(components.CAMERA), cameras.NEW, _camera(metres)),
        components.LIGHT: _merged(found, "LIGHT", tables.get(components.LIGHT), light_units.NEW, _light(metres)),
        components.VISIBILITY: _visibility(found, tables.get(components.VISIBILITY)),
    }
    return {name: each for name, each in changed.items() if each is not None and len(each.rows)}


def _merged(
    found: Entities, kind: str, stored: Table | None, new: dict[str, Any], read: Callable[[Any, Values], Values | None]
) -> Table | None:
    """The component of all entities of a kind; ``read`` gives what a prim says beyond what is known of it."""
    entries: dict[int, Values] = {}
    for row in np.flatnonzero([each == kind for each in found.kind]).tolist():
        known = {} if stored is None else {key: column[0] for key, column in stored.of(row).items() if len(column)}
        shape = found.shape[row]
        if not known and found.prim[row].HasAttribute(schema.UID) and not shape.GetAuthoredPropertyNames():
            continue  # written without the component
        said = read(shape, known)
        if said is not None:
            entries[row] = {**new, "data": true_name(shape), **known, **said}
    if stored is not None:
        for row in set(stored.rows.tolist()) - set(entries):
            entries[row] = new | {key: column[0] for key, column in stored.of(row).items()}
    if not entries:
        return None
    return table(
        list(entries), **{name: _column([entry[name] for entry in entries.values()], new[name]) for name in new}
    )


def _column(values: list[Any], example: Any) -> Any:
    if isinstance(example, str):
        return [str(value) for value in values]
    return np.array(values, bool if isinstance(example, bool) else np.float64)


def _camera(metres: float) -> Callable[[Any, Values], Values | None]:
    def read(prim: Any, known: Values) -> Values:
        """A camera's values, or what was edited of known ones."""
        found = {name: _value(prim, name) for name in CAMERA_NAMES}
        fit = str(known.get("fit", cameras.NEW["fit"]))
        said = cameras.camera_values(found, metres, fit)
        if not known:
            return said
        return _edits(said, cameras.camera_values(cameras.camera_attributes(known), 1.0, fit))

    return read


def _light(metres: float) -> Callable[[Any, Values], Values | None]:
    def read(prim: Any, known: Values) -> Values | None:
        """A light's values, or what was edited of known ones; None for what is no light."""
        inputs = {name: _value(prim, f"inputs:{name}") for name in LIGHT_INPUTS}
        inputs = {name: value for name, value in inputs.items() if value is not None}
        said = light_units.light_values(str(prim.GetTypeName()), inputs, metres)
        if not known or said is None:
            return said if not known else {}
        return _edits(said, light_units.light_values(*light_units.light_attributes(known), 1.0) or {})

    return read


def _value(prim: Any, name: str) -> Any:
    attribute = prim.GetAttribute(name)
    value = attribute.Get() if attribute else None
    return attribute.Get(NOW) if value is None and attribute else value


def _edits(said: Values, expected: Values) -> Values:
    """What of ``said`` is not ``expected``."""
    return {name: value for name, value in said.items() if not _same(value, expected.get(name))}


def _same(first: Any, second: Any) -> bool:
    if second is None or isinstance(first, str | bool):
        return bool(first == second)
    one, other = np.asarray(first, np.float64), np.asarray(second, np.float64)
    return bool((np.abs(one - other) <= SAME * np.maximum(np.abs(one), np.abs(other)) + 1e-9).all())


def _visibility(found: Entities, stored: Table | None) -> Table | None:
    """What is hidden: by our table, unless a prim was hidden or shown since."""
    hidden = np.array(found.hidden, bool)
    flags = {name: np.zeros(len(hidden), bool) for name in ("hidden", "viewport", "render")}
    if stored is not None:
        for name in flags:
            flags[name][stored.rows] = stored.columns[name]
    said = flags["hidden"] | flags["viewport"]
    leaf = ~np.isin(np.arange(len(hidden)), found.parent)  # what has children was not hidden: USD would hide those, too
    shown = said & leaf & ~hidden
    flags["hidden"] &= ~shown
    flags["viewport"] &= ~shown
    newly = hidden & ~said
    flags["viewport"] |= newly
    flags["render"] |= newly
    rows = np.flatnonzero(flags["hidden"] | flags["viewport"] | flags["render"])
    return table(rows, **{name: values[rows] for name, values in flags.items()})
