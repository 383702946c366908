"""Read a dataset with numpy alone: shards are mapped into memory when they are first asked for."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...poses import FORMS
from ...runtime.atomic_files import DamagedError, checksum, checksum_of, read_plain
from ..assets.asset_file import AssetFile
from .columns import Columns, Vocabulary, check_covered, cut, join, unpack_strings
from .encoding import widths
from .schema import SCHEMA, VERSION
from .shards import Shard, map_shard
from .splits import split_rows
from .validation import check_columns, check_manifest, file_records
from .writer import MANIFEST, read_manifest

MEMORY = 2**30
SCENE_PAGES = 512 * 2**10  # what the system maps around one scene of every column
MOST_MAPPED = 500  # each takes one of the process's file handles


class Scene:
    """One scene of a dataset: ``scene["entity.parent"]`` is a column, see :mod:`.schema`."""

    def __init__(self, columns: Columns, form: str, vocabulary: Mapping[str, Sequence[str]]) -> None:
        self.columns = columns
        self.form = form
        self.vocabulary = vocabulary

    def __len__(self) -> int:
        return len(self.columns["entity.parent"])

    def __getitem__(self, key: str) -> NDArray[Any]:
        return self.columns[key]

    def strings(self, key: str) -> tuple[str, ...]:
        """A string column, such as "entity.name"."""
        return unpack_strings(self.columns, key)

    @property
    def parent(self) -> NDArray[np.int32]:
        """int32 (N,): row of the parent, -1 for a root."""
        return self.columns["entity.parent"]

    @property
    def features(self) -> NDArray[np.float32]:
        """float32 (N, width + 6): child-to-parent poses in the dataset's form, then stretch."""
        return self.columns["entity.features"]

    @property
    def bounds(self) -> NDArray[np.float32]:
        """float32 (N, 2, 3): corners of the meshes in their objects' frames, metres."""
        return self.columns["entity.bounds"]

    @property
    def categories(self) -> tuple[str, ...]:
        """The category of each entity, "" for none."""
        names = (*self.vocabulary["categories"], "")
        return tuple(names[place] for place in self.columns["entity.category"])

    @property
    def label(self) -> str:
        """Which kind of scene it is, "" if that is not known."""
        return (*self.vocabulary["scenes"], "")[self.columns["scene.label"][0]]

    @property
    def title(self) -> str:
        """Name of the scene."""
        return self.strings("scene.title")[0]

    @property
    def source(self) -> str:
        """File or maker that the scene comes from."""
        return self.strings("scene.source")[0]

    def local(self) -> NDArray[np.float64]:
        """float64 (N, 4, 4): child-to-parent matrices, decoded from the features."""
        return FORMS[self.form].decode(self.features.astype(np.float64), stretch=True)


class Dataset:
    """A dataset on disk; use :func:`open_dataset`. Can be sent to other processes, which map it anew."""

    def __init__(
        self,
        path: Path,
        manifest: dict[str, Any],
        verify: bool,
        memory: int,
        vocabulary: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        self.path = path
        self.manifest = manifest
        self.verify = verify
        self.memory = memory
        self.starts = np.cumsum([0, *(shard["scenes"] for shard in manifest["shards"])], dtype=np.int64)
        self._verified: set[int] = set()
        self._shards: dict[int, Shard] = {}
        self._touched: dict[int, int] = {}
        self._resident = 0
        self._asked = None if vocabulary is None else Vocabulary(vocabulary)

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_verified": set(), "_shards": {}, "_touched": {}, "_resident": 0}

    @property
    def form(self) -> str:
        """Name of the form in which poses are."""
        return self.manifest["form"]

    @cached_property
    def vocabulary(self) -> dict[str, tuple[str, ...]]:
        """The names that numbers stand for: "categories", "relations", "scenes"."""
        names = self.manifest["vocabulary"] if self._asked is None else self._asked.names
        return {kind: tuple(found) for kind, found in names.items()}

    @property
    def categories(self) -> tuple[str, ...]:
        """Category names by number."""
        return self.vocabulary["categories"]

    @cached_property
    def category_counts(self) -> dict[str, int]:
        """How many entities have each category that occurs."""
        names = self.manifest["vocabulary"]["categories"]
        return {name: count for name, count in zip(names, self.manifest["category_counts"], strict=True) if count}

    @cached_property
    def widths(self) -> dict[str, int]:
        """The widths that :data:`.schema.COLUMNS` names."""
        return widths(self.form, self.manifest["mesh_feature_width"])

    def __len__(self) -> int:
        return int(self.starts[-1])

    def __getitem__(self, index: int) -> Scene:
        shard, row = self.locate(range(len(self))[index])
        return Scene(cut(self.shard(shard, 1), row, row + 1), self.form, self.vocabulary)

    def __iter__(self) -> Iterator[Scene]:
        return (self[index] for index in range(len(self)))

    def locate(self, index: int) -> tuple[int, int]:
        """Number of the shard that holds a scene, and the scene's row in it."""
        shard = int(np.searchsorted(self.starts, index, side="right")) - 1
        return shard, int(index - self.starts[shard])

    def shard(self, number: int, scenes: int = 0) -> Columns:
        """The columns of a shard, mapped.

        ``scenes`` says how many scenes of it will be looked at, 0 for all: when
        more than ``memory`` bytes may be resident, everything else leaves memory.
        """
        shard = self._shards.get(number) or self._map(number)
        before, size = self._touched.get(number, 0), len(shard.data)
        now = min(size, before + scenes * SCENE_PAGES) if scenes else size
        if now > before:
            self._touched[number] = now
            self._resident += now - before
            if self._resident > self.memory:
                self._release_others(number)
        return shard.columns

    def _release_others(self, number: int) -> None:
        for other in self._touched:
            if other != number:
                self._shards[other].release()
        self._touched = {number: self._touched[number]}
        self._resident = self._touched[number]

    def _map(self, number: int) -> Shard:
        if len(self._shards) >= MOST_MAPPED:
            first = next(iter(self._shards))
            del self._shards[first]
            self._resident -= self._touched.pop(first, 0)
        fresh = self.verify and number not in self._verified
        shard = self._verified_shard(number) if fresh else map_shard(self._shard_path(number))
        self._verified.add(number)
        if self._asked is not None:
            shard.columns.update(self._asked.translate(shard.columns, self.manifest["vocabulary"]))
        self._shards[number] = shard
        return shard

    def _shard_path(self, number: int) -> Path:
        return self.path / self.manifest["shards"][number]["file"]

    def _verified_shard(self, number: int) -> Shard:
        path, entry = self._shard_path(number), self.manifest["shards"][number]
        shard = map_shard(path, entry["sha256"])
        check_columns(shard.columns, path, entry, self.widths, self.manifest)
        shard.release()
        return shard

    def columns(self, start: int, stop: int) -> Columns:
        """The scenes ``start:stop`` in one set of columns."""
        parts = []
        for number in range(self.locate(start)[0], self.locate(stop - 1)[0] + 1):
            first = int(self.starts[number])
            low, high = max(start, first), min(stop, int(self.starts[number + 1]))
            parts.append(cut(self.shard(number), low - first, high - first))
        return join(parts)

    def files(self) -> list[dict[str, Any]]:
        """One record per file that was exported: source, checksum, counts, what was lost, or why it failed."""
        entry = self.manifest["files"]
        if entry is None:
            return []
        try:
            data = read_plain(self.path / entry["file"])
        except OSError as error:
            raise DamagedError(f"{self.path / entry['file']} cannot be read: {error.strerror}") from None
        if checksum(data) != entry["sha256"]:
            raise DamagedError(f"{self.path / entry['file']} is damaged: its checksum is not the one in the manifest")
        return file_records(data, self.path / entry["file"])

    def assets(self) -> AssetFile | None:
        """What the dataset has of its scenes' geometry (see :mod:`..assets.asset`); None if it has none."""
        old = self.path / "assets.safetensors"
        if "assets" not in self.manifest and old.is_file():  # datasets of the first days
            return AssetFile(old)
        entry = self.manifest.get("assets")
        if entry is None:
            return None
        path = self.path / entry["file"]
        if self.verify and checksum_of(path) != entry["sha256"]:
            raise DamagedError(f"{path} is damaged: its checksum is not the one in the manifest; export it again")
        return AssetFile(path)

    def check(self) -> None:
        """Verify every file, its checksum and its columns; DamagedError if one is not what was written."""
        for number in range(len(self.manifest["shards"])):
            self._verified_shard(number)
        self.files()
        self.assets()

    def split(self, fractions: Sequence[float], seed: int, by_source: bool = False) -> list[NDArray[np.int64]]:
        """Scene numbers for training, validation ...; see :func:`split_rows`.

        With ``by_source`` scenes of one file stay together, so that none is tested on what it was trained on.
        """
        return split_rows(len(self), fractions, seed, self.sources() if by_source else None)

    def sources(self) -> list[str]:
        """The file, or the maker, that each scene comes from."""
        return [scene.source for scene in self]

    def licences(self) -> list[str]:
        """The licence of each scene's file and how that is known, "" for unknown."""
        of_file = {record["source"]: str(record.get("licence", "")) for record in self.files()}
        return [of_file.get(source, "") for source in self.sources()]


def open_dataset(
    path: str | os.PathLike[str],
    verify: bool = True,
    memory: int = MEMORY,
    vocabulary: Mapping[str, Sequence[str]] | None = None,
) -> Dataset:
    """Open a dataset; needs numpy only.

    Parameters
    ----------
    path
        Its folder.
    verify
        Compare the checksum of each shard when it is first used.
    memory
        Bytes of shards that may be resident at a time, about.
    vocabulary
        Names to number as another dataset does (``open_dataset("train").vocabulary``).

    Raises
    ------
    UniSGError
        If there is no dataset, a newer version wrote it, or it has names that the vocabulary asked for lacks.
    """
    manifest = read_manifest(folder := Path(path))
    if manifest is None and not folder.exists():
        raise UniSGError(f"there is no file or folder {folder}: check the path")
    if manifest is None or manifest.get("schema") != SCHEMA:
        raise UniSGError(f"{folder} holds no dataset: make one of scenes with 'unisg export SCENES --out DATASET'")
    if not isinstance(manifest.get("version"), int) or manifest["version"] > VERSION:
        raise UniSGError(f"{folder} was written by a newer version of this software: update it")
    known = manifest.get("form")
    if not isinstance(known, str) or known not in FORMS:
        raise UniSGError(f"{folder} is in the form {known!r}, which this software does not know: update it")
    check_manifest(manifest, folder / MANIFEST)
    dataset = Dataset(folder, manifest, verify, memory, vocabulary)
    if vocabulary is not None:
        check_covered(manifest["vocabulary"] | {"categories": dataset.category_counts}, vocabulary, str(folder))
    return dataset
