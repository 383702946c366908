"""Scenes side by side in columns: cut, joined, remapped. Everything here is plain arrays in a dict."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...runtime.wording import some_of
from .schema import COLUMNS, REFERENCES, STRINGS, TABLES, VOCABULARIES, table_of

Columns = dict[str, NDArray[Any]]
"""Columns by name as in :mod:`.schema`: of a shard, of some scenes, or of one."""

COLUMN_TABLES = {key: table_of(key) for key in COLUMNS}


def scene_count(columns: Columns) -> int:
    """How many scenes the columns hold."""
    return len(columns["scene.label"])


def pack_strings(texts: Iterable[str]) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
    """UTF-8 bytes and int64 offsets (K + 1,) of K strings; lone surrogates are kept."""
    encoded = [text.encode("utf-8", "surrogatepass") for text in texts]
    offsets = np.zeros(len(encoded) + 1, np.int64)
    np.cumsum([len(item) for item in encoded], out=offsets[1:])
    return np.frombuffer(b"".join(encoded), np.uint8), offsets


def unpack_strings(columns: Columns, key: str, start: int = 0, stop: int | None = None) -> tuple[str, ...]:
    """The strings ``start:stop`` of a string column such as "entity.name"."""
    offsets = columns[f"{key}.offsets"][start : None if stop is None else stop + 1]
    if len(offsets) < 2:
        return ()
    data = columns[f"{key}.bytes"][offsets[0] : offsets[-1]].tobytes()
    ends = (offsets - offsets[0]).tolist()
    return tuple(data[a:b].decode("utf-8", "surrogatepass") for a, b in pairwise(ends))


def cut(columns: Columns, start: int, stop: int) -> Columns:
    """The scenes ``start:stop``, as views where possible; of the mesh table only what they use."""
    spans = {table: _span(columns[f"{table}.ptr"], start, stop) for table in TABLES}
    spans["scene"] = (start, stop)
    part: Columns = {}
    for table in TABLES:
        ptr = columns[f"{table}.ptr"][start : stop + 1]
        part[f"{table}.ptr"] = ptr - ptr[0]
    for key, table in COLUMN_TABLES.items():
        if table in spans:
            part[key] = columns[key][slice(*spans[table])]
    for key in STRINGS:
        if (table := table_of(key)) in spans:
            part |= _cut_strings(columns, key, *spans[table])
    return part | _used_meshes(columns, part["entity.mesh"])


def _span(ptr: NDArray[np.int64], start: int, stop: int) -> tuple[int, int]:
    return int(ptr[start]), int(ptr[stop])


def _cut_strings(columns: Columns, key: str, start: int, stop: int) -> Columns:
    offsets = columns[f"{key}.offsets"][start : stop + 1]
    return {
        f"{key}.bytes": columns[f"{key}.bytes"][offsets[0] : offsets[-1]],
        f"{key}.offsets": offsets - offsets[0],
    }


def take_strings(columns: Columns, key: str, rows: NDArray[np.integer]) -> Columns:
    """A string column cut to some rows, in that order."""
    offsets = columns[f"{key}.offsets"]
    sizes = np.diff(offsets)[rows]
    ends = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    places = np.repeat(offsets[rows] - ends[:-1], sizes) + np.arange(ends[-1])
    return {f"{key}.bytes": columns[f"{key}.bytes"][places], f"{key}.offsets": ends}


def _used_meshes(columns: Columns, mesh: NDArray[np.int32]) -> Columns:
    """The rows of the mesh table that ``mesh`` names, in order of first use, and ``entity.mesh`` pointing to them."""
    rows = in_order_of_appearance(mesh[mesh >= 0])
    place = np.full(len(columns["mesh.bounds"]) + 1, -1, np.int32)  # the last one is for index -1, "no mesh"
    place[rows] = np.arange(len(rows))
    part = {key: columns[key][rows] for key, table in COLUMN_TABLES.items() if table == "mesh"}
    return part | take_strings(columns, "mesh.name", rows) | {"entity.mesh": place[mesh]}


def in_order_of_appearance(values: NDArray[Any]) -> NDArray[Any]:
    """Each value once, in the order in which they come."""
    found, first = np.unique(values, return_index=True)
    return found[np.argsort(first)]


def join(parts: Sequence[Columns]) -> Columns:
    """The scenes of all parts one after another; each mesh once."""
    if len(parts) == 1:
        return dict(parts[0])
    whole = {key: _stacked([part[key] for part in parts]) for key in COLUMNS}
    whole |= {f"{table}.ptr": _join_offsets([part[f"{table}.ptr"] for part in parts]) for table in TABLES}
    for key in STRINGS:
        whole[f"{key}.bytes"] = np.concatenate([part[f"{key}.bytes"] for part in parts])
        whole[f"{key}.offsets"] = _join_offsets([part[f"{key}.offsets"] for part in parts])
    sizes = [len(part["mesh.bounds"]) for part in parts]
    shift = np.repeat(np.cumsum([0, *sizes[:-1]]), [len(part["entity.mesh"]) for part in parts])
    whole["entity.mesh"] = np.where(whole["entity.mesh"] < 0, -1, whole["entity.mesh"] + shift).astype(np.int32)
    return _each_mesh_once(whole)


def mesh_checksums(columns: Columns) -> list[str]:
    """Hexadecimal checksum of each mesh."""
    return [bytes(value).hex() for value in columns["mesh.checksum"]]


def _stacked(parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """The rows of all parts; empty ones do not know the width of the mesh features yet."""
    return np.concatenate([part for part in parts if len(part)] or parts[:1])


def _join_offsets(parts: Sequence[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Offsets of joined ragged columns."""
    sizes = np.concatenate([np.diff(part) for part in parts])
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)


def _each_mesh_once(columns: Columns) -> Columns:
    """Merge rows of the mesh table with the same checksum; the first one stays, in its place."""
    sums = np.ascontiguousarray(columns["mesh.checksum"]).view("V16").reshape(-1)
    _, first, place = np.unique(sums, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    moved = np.append(rank[place], -1)  # index -1 stays -1
    merged = {key: columns[key][first[order]] for key, table in COLUMN_TABLES.items() if table == "mesh"}
    merged |= take_strings(columns, "mesh.name", first[order])
    return columns | merged | {"entity.mesh": moved[columns["entity.mesh"]].astype(np.int32)}


class Vocabulary:
    """Names by number, in order of first appearance; one list for each of :data:`.schema.VOCABULARIES`."""

    def __init__(self, names: Mapping[str, Sequence[str]] | None = None) -> None:
        self.names: dict[str, list[str]] = {kind: list((names or {}).get(kind, ())) for kind in VOCABULARIES}
        self._places = {kind: {name: place for place, name in enumerate(self.names[kind])} for kind in VOCABULARIES}

    def place(self, kind: str, name: str) -> int:
        """The number of a name, which is added if it is new; -1 for ""."""
        if not name:
            return -1
        places = self._places[kind]
        if name not in places:
            places[name] = len(places)
            self.names[kind].append(name)
        return places[name]

    def translate(self, columns: Columns, names: Mapping[str, Sequence[str]]) -> Columns:
        """Columns whose numbers mean ``names``, with this vocabulary's numbers instead; unseen names are added."""
        moved = {}
        for key, kind in REFERENCES.items():
            places = np.full(len(names[kind]) + 1, -1, np.int32)
            values = columns[key]
            for old in in_order_of_appearance(values[values >= 0]):  # only what occurs enters the vocabulary
                places[old] = self.place(kind, names[kind][old])
            moved[key] = places[values]
        return columns | moved


def check_covered(used: Mapping[str, Iterable[str]], vocabulary: Mapping[str, Sequence[str]], owner: str) -> None:
    """Refuse, with a UniSGError, a vocabulary that lacks names that ``owner`` uses."""
    for kind in VOCABULARIES:
        missing = [repr(name) for name in used[kind] if name not in vocabulary.get(kind, ())]
        if missing:
            shown = some_of(missing, 5)
            raise UniSGError(f"{owner} has {kind} that the vocabulary asked for lacks: {shown}; give one that has them")
