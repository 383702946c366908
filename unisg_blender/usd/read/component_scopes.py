"""Component tables that stand as arrays in a scope."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...runtime.json_records import parse_json
from ...scene.component_table import Table, table
from .. import schema
from ..names import true_name


def read_components(holder: Any, uids: Sequence[str]) -> dict[str, Table]:
    """The tables in the scope under the prim ``holder``; ``uids`` of the rows. Damaged tables are told and left out."""
    scope = holder.GetChild(schema.COMPONENT_SCOPE) if holder else None
    if not scope:
        return {}
    row_of_uid = {uid: row for row, uid in enumerate(uids)}
    tables = {}
    for prim in scope.GetAllChildren():
        name = true_name(prim)
        try:
            found = _read_table(prim, row_of_uid)
        except (TypeError, ValueError, KeyError, AttributeError, IndexError, UniSGError) as error:
            warnings.warn(f"{prim.GetPath()}: damaged component table: {error}", stacklevel=2)
            continue
        if len(found.rows):
            tables[name] = found
    return tables


def _read_table(prim: Any, row_of_uid: dict[str, int]) -> Table:
    entities = list(prim.GetAttribute(schema.ENTITIES).Get() or ())
    kept = [item for item, uid in enumerate(entities) if uid in row_of_uid]
    layout = parse_json(prim.GetAttribute(schema.LAYOUT).Get(), schema.LAYOUT)
    columns = {}
    for identifier, form in layout.items():
        value = prim.GetAttribute(schema.COLUMN + identifier).Get()
        columns[form["name"]] = decode_column(value, form["form"], (len(entities), *form["shape"]))[kept]
    return table([row_of_uid[entities[item]] for item in kept], **columns)


def decode_column(values: Any, form: str, shape: tuple[int, ...]) -> NDArray[Any]:
    """A column from its flat array; see :func:`~..write.component_specs.encode_column`."""
    values = () if values is None else values
    if form in ("str", "tuple", "json"):
        flat = np.empty(len(values), object)
        flat[:] = [text if form == "str" else parse_json(text, "an entry") for text in values]
        if form == "tuple":
            flat[:] = [tuple(value) for value in flat]
    elif np.dtype(form).kind == "U":
        flat = np.array(list(values), form)
    else:
        flat = np.array(values).astype(np.dtype(form))
    return flat.reshape(shape)
