"""Write a dataset: shards first, the manifest last, so that a folder either is a whole dataset or is none."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fnmatch import fnmatch
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from ... import __version__
from ...behaviour.lesson.action_vector import CHANNELS
from ...behaviour.lesson.behaviour_links import NODE_CHANNELS
from ...errors import UniSGError
from ...poses import FORMS
from ...poses.forms import STRETCH_CHANNELS
from ...runtime.atomic_files import UNFINISHED, made_folder, read_plain, write_file, write_named
from ...runtime.folder_lock import NAME as LOCK
from ...runtime.folder_lock import folder_lock
from ...runtime.json_records import parse_json
from ...runtime.steps import at_once
from ...scene.graph import TYPES, SceneGraph
from ..assets.asset_collector import AssetCollector
from ..assets.asset_file import assets_bytes
from .behaviour_rows import LINKS
from .columns import Columns, Vocabulary, join, scene_count
from .encoding import MeshEncoder, Sample, as_sample, encode_scenes, known_form
from .schema import INFO_CHANNELS, MESH_CHANNELS, SCHEMA, TABLES, VERSION
from .shards import pack_shard
from .source_counts import source_counts

MANIFEST = "manifest.json"
PARTS = ".parts"
OWN_NAMES = re.compile(r"((scenes-\d{6}|assets)-[0-9a-f]{16}|assets)\.safetensors|files-[0-9a-f]{16}\.jsonl")
"""Names that only this module gives, one of them in the first days; what else lies there is somebody's."""

SCENES_PER_SHARD = 4096
ENTITIES_PER_SHARD = 200_000
CHUNK = 128


class DatasetWriter:
    """Takes scenes in, writes shards as they fill, and the manifest at the end.

    Parameters
    ----------
    folder
        Where the dataset goes; exists.
    form
        Name of the form in which the features are.
    vocabulary
        Names to number as another dataset does; new ones are added behind them.

    Attributes
    ----------
    assets
        What the dataset keeps of its scenes' geometry; who adds scenes shows them to it.
    """

    def __init__(self, folder: Path, form: str, vocabulary: Mapping[str, Sequence[str]] | None = None) -> None:
        self.folder = folder
        self.form = known_form(form)
        self.vocabulary = Vocabulary(vocabulary)
        self.assets = AssetCollector()
        self._waiting: list[Columns] = []
        self._shards: list[dict[str, Any]] = []
        self._totals = dict.fromkeys(("scenes", "meshes", *TABLES), 0)
        self._categories: dict[int, int] = {}
        self._mesh_width = 0

    @property
    def written(self) -> list[str]:
        """Names of the shards written so far."""
        return [shard["file"] for shard in self._shards]

    def add(self, columns: Columns, names: Mapping[str, Sequence[str]] | None = None) -> None:
        """Take scenes in; ``names`` is the vocabulary that their numbers mean (this writer's own when omitted)."""
        self._waiting.append(columns if names is None else self.vocabulary.translate(columns, names))
        scenes = sum(scene_count(part) for part in self._waiting)
        if scenes >= SCENES_PER_SHARD or sum(len(part["entity.type"]) for part in self._waiting) >= ENTITIES_PER_SHARD:
            self._write_shard()

    def _write_shard(self) -> None:
        columns = join(self._waiting)
        self._waiting = []
        data = pack_shard(columns)
        name, total = write_named(self.folder, f"scenes-{len(self._shards):06d}", ".safetensors", data)
        scenes, entities = scene_count(columns), len(columns["entity.type"])
        self._shards.append({"file": name, "sha256": total, "scenes": scenes, "entities": entities})
        self._count(columns)

    def _count(self, columns: Columns) -> None:
        self._totals["scenes"] += scene_count(columns)
        self._totals["meshes"] += len(columns["mesh.bounds"])
        for table in TABLES:
            self._totals[table] += int(columns[f"{table}.ptr"][-1])
        found, counts = np.unique(columns["entity.category"], return_counts=True)
        for place, count in zip(found.tolist(), counts.tolist(), strict=True):
            self._categories[place] = self._categories.get(place, 0) + count
        if len(columns["mesh.feature"]):
            self._mesh_width = max(self._mesh_width, columns["mesh.feature"].shape[1])

    def finish(self, files: Sequence[Mapping[str, Any]] | None = None) -> dict[str, Any]:
        """Write what is left, the assets and the manifest; returns the manifest.

        Parameters
        ----------
        files
            One JSON-ready record per file that the scenes were read from.
        """
        if self._waiting:
            self._write_shard()
        names = self.vocabulary.names
        manifest: dict[str, Any] = {
            "schema": SCHEMA,
            "version": VERSION,
            "software": f"unisg_blender {__version__}",
            "form": self.form,
            "feature_channels": [*FORMS[self.form].channels, *STRETCH_CHANNELS],
            "action_channels": list(CHANNELS),
            "node_channels": list(NODE_CHANNELS),
            "mesh_channels": list(MESH_CHANNELS),
            "info_channels": list(INFO_CHANNELS),
            "mesh_feature_width": self._mesh_width,
            "types": list(TYPES),
            "link_kinds": [list(kind) for kind in LINKS],
            "vocabulary": names,
            "counts": self._totals,
            "category_counts": [self._categories.get(place, 0) for place in range(len(names["categories"]))],
            "shards": self._shards,
            "assets": None,
            "files": None,
            "sources": source_counts(files or ()),
        }
        if self.assets:
            manifest["assets"] = self._write("assets", ".safetensors", assets_bytes(*self.assets.pack()))
        if files is not None:
            lines = "".join(json.dumps(record, sort_keys=True) + "\n" for record in files)
            manifest["files"] = self._write("files", ".jsonl", lines.encode())
        write_file(self.folder / MANIFEST, json.dumps(manifest, indent=1).encode())
        remove_strays(self.folder, manifest)
        return manifest

    def _write(self, stem: str, suffix: str, data: bytes) -> dict[str, str]:
        name, total = write_named(self.folder, stem, suffix, data)
        return {"file": name, "sha256": total}


def remove_strays(folder: Path, manifest: Mapping[str, Any] | None) -> None:
    """Remove what earlier writers left behind: shards that no manifest names, and temporary files."""
    record = manifest or {}
    shards = record.get("shards")
    entries = [*(shards if isinstance(shards, list) else ()), record.get("assets"), record.get("files")]
    kept = [entry.get("file") for entry in entries if isinstance(entry, dict)]
    for path in folder.iterdir():
        if _is_written(path.name) and path.name not in kept:
            path.unlink(missing_ok=True)


def read_manifest(folder: Path) -> dict[str, Any] | None:
    """The manifest of a dataset, None if the folder holds none."""
    try:
        manifest = parse_json(read_plain(folder / MANIFEST), str(folder / MANIFEST))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, UniSGError) as error:
        raise UniSGError(f"{folder / MANIFEST} cannot be read ({error}): choose another folder") from None
    if not isinstance(manifest, dict):
        raise UniSGError(f"{folder / MANIFEST} is no manifest of a dataset: choose another folder")
    return manifest


@contextmanager
def dataset_folder(out: str | os.PathLike[str], overwrite: bool = False, resume: bool = False) -> Iterator[Path]:
    """A locked folder to write a dataset to; when writing fails, the dataset that it held is still whole.

    Parameters
    ----------
    out
        The folder, made if it is missing.
    overwrite
        Replace a dataset or an unfinished export that it holds.
    resume
        Go on with them.

    Raises
    ------
    UniSGError
        If the folder holds one of them and neither is asked for, holds something
        else, is being written to, or cannot be written.
    """
    folder = Path(out)
    with made_folder(folder), folder_lock(folder):
        _check_free(folder, overwrite, resume)
        if overwrite:
            shutil.rmtree(folder / PARTS, ignore_errors=True)
        try:
            yield folder
        except BaseException:
            remove_strays(folder, read_manifest(folder))
            raise


def _check_free(folder: Path, overwrite: bool, resume: bool) -> None:
    manifest = read_manifest(folder)
    if manifest is not None and manifest.get("schema") != SCHEMA:
        raise UniSGError(f"{folder} holds a {MANIFEST} of something else: choose another folder")
    if manifest is None and not all(_is_ours(path.name) for path in folder.iterdir()):
        raise UniSGError(f"{folder} is not empty and holds no dataset: choose another folder")
    if overwrite or resume:
        return
    if (folder / PARTS).exists():
        raise UniSGError(f"{folder} holds an unfinished export: resume it, or ask to overwrite it")
    if manifest is not None:
        raise UniSGError(f"{folder} holds a dataset already: choose another folder, or ask to overwrite it")


def _is_ours(name: str) -> bool:
    """Whether an interrupted export leaves files of that name."""
    return name in (LOCK, PARTS) or _is_written(name)


def _is_written(name: str) -> bool:
    return OWN_NAMES.fullmatch(name) is not None or fnmatch(name, UNFINISHED)


def write_steps(
    graphs: Iterable[SceneGraph | Sample],
    out: str | os.PathLike[str],
    form: str = "quaternion",
    *,
    mesh_encoder: MeshEncoder | None = None,
    vocabulary: Mapping[str, Sequence[str]] | None = None,
    overwrite: bool = False,
) -> Generator[int, None, dict[str, Any]]:
    """Write scenes as a dataset; never more than one shard in memory.

    Yields the number of scenes done; closing the generator leaves nothing. :func:`write_dataset` is the same at once.

    Parameters
    ----------
    graphs
        Scenes, bare or as :class:`~.encoding.Sample` with a source and a label; may be a generator.
    out
        Folder of the dataset, made if it is missing.
    form
        Name in ``FORMS``: how the poses are represented.
    mesh_encoder
        Gives a feature vector for each mesh; the dataset has none when omitted.
    vocabulary
        Names to number as another dataset does (``open_dataset(path).vocabulary``).
    overwrite
        Replace the dataset in that folder; it stays valid until the new one is complete.

    Returns
    -------
    dict
        The manifest.

    Raises
    ------
    UniSGError
        Unknown form, no scene, a folder in use, a full disk; nothing is left half-written.
    PoseError
        If a local matrix holds NaN or infinity, or is not affine.
    """
    known_form(form)
    samples = map(as_sample, graphs)
    with dataset_folder(out, overwrite) as folder:
        writer = DatasetWriter(folder, form, vocabulary)
        done = 0
        while chunk := list(islice(samples, CHUNK)):
            for sample in chunk:
                writer.assets.add(sample.graph, sample.source)
            writer.add(encode_scenes(chunk, form, writer.vocabulary, mesh_encoder))
            done += len(chunk)
            yield done
        if not done:
            raise UniSGError("there is no scene to write: nothing was written")
        return writer.finish()


write_dataset = at_once(write_steps)
"""Write scenes as a dataset, with the parameters of :func:`write_steps`; returns the manifest."""
