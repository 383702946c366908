"""Scene files given where a dataset is asked for: they become one first."""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ..dataset.export.batch_export import ExportOptions, export_steps
from ..dataset.export.sources import SUFFIXES, find_sources
from ..dataset.format.writer import MANIFEST
from ..errors import UniSGError
from ..runtime.progress import Progress
from ..runtime.steps import drain
from ..words import read_mapping

Record = dict[str, Any]


def is_dataset(path: Path) -> bool:
    """Whether a folder is a dataset, or what is left of one."""
    return (path / MANIFEST).is_file()


def check_mapping(args: argparse.Namespace, given: Sequence[Path]) -> None:
    """Refuse ``--mapping`` and ``--assets`` where they would change nothing, since there are only datasets.

    Raises
    ------
    UniSGError
        If one of them is given, and every input is a dataset.
    """
    options = [name for name in ("mapping", "assets") if getattr(args, name) is not None]
    if options and all(map(is_dataset, given)):
        raise UniSGError(
            f"{given[0]} is a dataset, in which --{options[0]} changes nothing: give it to 'unisg export' when the "
            "dataset is made, or give the folder of scene files here"
        )


def dataset_of(args: argparse.Namespace, given: Path, work: Path, jobs: int | None = None) -> Path:
    """The folder itself if it is a dataset, else a dataset of its scene files in ``work``, in the order of their names.

    What has no category gets that of ``--mapping``. What a second call finds in ``work`` is brought up to date.

    Raises
    ------
    UniSGError
        If there is no scene file, or one cannot be read.
    """
    if is_dataset(given):
        return given
    mapping = None if args.mapping is None else read_mapping(args.mapping)
    assets = "" if args.assets is None else str(args.assets.absolute())
    depends = f"{given.resolve()} {mapping} {assets}"
    out = work / f"given-{hashlib.sha256(depends.encode()).hexdigest()[:16]}" / given.resolve().name
    steps = export_steps(
        scene_files(given), out, ExportOptions(mapping=mapping, assets=assets), jobs=jobs, resume=out.is_dir()
    )
    out.parent.mkdir(parents=True, exist_ok=True)
    bar, done = Progress(0, "files read", args.quiet), list[Record]()

    def show(step: tuple[Record | None, int]) -> None:
        """Show how many of the files are read."""
        record, files = step
        if record is None:
            bar.start(files)
        else:
            done.append(record)
            bar.update(len(done))

    try:
        _check_all_read(drain(steps, show))
    finally:
        bar.close()
    return out


@contextmanager
def named_as_given(given: Sequence[Path], datasets: Sequence[Path]) -> Iterator[None]:
    """Errors speak of what was given, not of the datasets that were made of it."""
    try:
        yield
    except UniSGError as error:
        text = str(error)
        for path, dataset in zip(given, datasets, strict=True):
            text = text.replace(str(dataset), str(path))
        if text == str(error):
            raise
        raise UniSGError(text) from error


def _check_all_read(records: list[Record]) -> None:
    failed = [record for record in records if record["status"] == "failed"]
    if failed:
        first = f"{failed[0]['source']}: {failed[0]['reason']}"
        raise UniSGError(f"{len(failed)} of {len(records)} scene files cannot be read; {first}")


def scene_files(given: Path) -> list[Path]:
    """A scene file, or those below a folder."""
    if not given.exists():
        raise UniSGError(f"there is no file or folder {given}: check the path")
    with suppress(UniSGError):
        return find_sources([given])
    raise UniSGError(f"{given} holds neither a dataset nor a scene file: the known kinds are {', '.join(SUFFIXES)}")
