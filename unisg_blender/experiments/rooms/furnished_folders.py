"""Rooms that somebody else's generator furnished: a dataset, or a folder of scene files that becomes one."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

from ...dataset.export.batch_export import ExportOptions, export_dataset
from ...dataset.export.sources import SUFFIXES, find_sources
from ...dataset.format.writer import MANIFEST
from ...errors import UniSGError
from ...runtime.file_endings import JSON
from ...words.category_mapping import Patterns


def rooms_dataset(folder: Path, work: Path, mapping: Patterns | None, jobs: int) -> Path:
    """The folder itself if it is a dataset, else a dataset of its scene files in ``work``, in the order of their names.

    What a second call finds there is brought up to date.

    Raises
    ------
    UniSGError
        If there is no scene file, or one cannot be read.
    """
    if (folder / MANIFEST).is_file():
        return folder
    depends = f"{folder.resolve()} {mapping}"
    out = work / f"given-{hashlib.sha256(depends.encode()).hexdigest()[:16]}" / folder.resolve().name
    out.parent.mkdir(parents=True, exist_ok=True)
    records = export_dataset(_files(folder), out, ExportOptions(mapping=mapping), jobs=jobs, resume=out.is_dir())
    failed = [record for record in records if record["status"] == "failed"]
    if failed:
        first = f"{failed[0]['source']}: {failed[0]['reason']}"
        raise UniSGError(f"{len(failed)} of {len(records)} rooms cannot be read; {first}")
    return out


def _files(folder: Path) -> Sequence[Path]:
    """The scene files below a folder; .json only where there are no others, for a .json may be anything."""
    try:
        return find_sources([folder], SUFFIXES)
    except UniSGError:
        return find_sources([folder], JSON)
