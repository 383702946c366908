"""Sparse component tables: what some entities of a scenegraph have and most have not."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError


@dataclass(frozen=True, eq=False)
class Table:
    """A sparse component: some rows of the scenegraph have values, most have none.

    ``rows`` is int32 (K,) in ascending order and may repeat (an entity with two
    actions has two rows). Every column has length K along its first axis.
    References to other entities are uids, never row numbers, so that rows can be
    reordered and removed freely. UniSGError if the lengths differ.
    """

    rows: NDArray[np.int32]
    columns: Mapping[str, NDArray[Any]]

    def __post_init__(self) -> None:
        for key, column in self.columns.items():
            if len(column) != len(self.rows):
                raise UniSGError(f"the column {key!r} of a component has {len(column)} entries, not {len(self.rows)}")

    def of(self, row: int) -> dict[str, NDArray[Any]]:
        """The values of one row: every column cut to the entries of ``row``."""
        start, stop = np.searchsorted(self.rows, (row, row + 1))
        return {name: column[start:stop] for name, column in self.columns.items()}

    def groups(self) -> Iterator[tuple[int, dict[str, NDArray[Any]]]]:
        """Every row that has values, once, with what :meth:`of` gives for it."""
        rows, starts = np.unique(self.rows, return_index=True)
        for row, start, stop in zip(
            rows.tolist(), starts.tolist(), [*starts[1:].tolist(), len(self.rows)], strict=True
        ):
            yield row, {name: column[start:stop] for name, column in self.columns.items()}

    def take(self, rows: NDArray[np.integer], count: int) -> Table:
        """The table after the scenegraph kept ``rows`` (of ``count``) in that order."""
        place = np.full(count, -1, np.int64)
        place[rows] = np.arange(len(rows))
        moved = place[self.rows]
        order = np.argsort(moved, kind="stable")
        order = order[moved[order] >= 0]
        return Table(moved[order].astype(np.int32), {name: column[order] for name, column in self.columns.items()})


def table(rows: Sequence[int] | NDArray[np.integer], **columns: Sequence[Any] | NDArray[Any]) -> Table:
    """A table from rows (K,) in any order and columns (K, ...); lists become object arrays."""
    order = np.argsort(np.asarray(rows, np.int64), kind="stable")
    arrays = {name: _column(values)[order] for name, values in columns.items()}
    return Table(np.asarray(rows, np.int32)[order], arrays)


def entry_table(entries: Iterable[Sequence[Any]], *columns: str) -> Table:
    """A table from entries (row, value in each column), as :meth:`.graph.SceneGraph.entries` gives them."""
    rows, *values = [*zip(*entries, strict=True)] or [()] * (1 + len(columns))
    return table(rows, **dict(zip(columns, values, strict=True)))


def joined(parts: Sequence[tuple[Table, int]]) -> Table:
    """One table out of several, the rows of each moved by a number; entries of one row stay in the order of the parts.

    Parts with other columns than the first are left out.
    """
    names = parts[0][0].columns.keys()
    kept = [(part, shift) for part, shift in parts if part.columns.keys() == names]
    rows = np.concatenate([part.rows + shift for part, shift in kept])
    return table(rows, **{name: np.concatenate([part.columns[name] for part, _ in kept]) for name in names})


def _column(values: Sequence[Any] | NDArray[Any]) -> NDArray[Any]:
    if isinstance(values, np.ndarray):
        return values
    column = np.empty(len(values), object)
    for place, value in enumerate(values):  # one by one: numpy would unpack tuples and arrays of equal length
        column[place] = value
    return column
