"""The folder of a batch: held by one batch at a time, and nothing in it that is somebody's is replaced."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from ..dataset.format.writer import PARTS, dataset_folder
from ..errors import UniSGError
from ..runtime.atomic_files import UNFINISHED, made_folder
from ..runtime.folder_lock import folder_lock
from ..runtime.made_files import check_made, mark_made, marked_folder
from .batch_plan import PICTURES, Task
from .batch_report import REPORT
from .pictures.coco_files import INSTANCES, PANOPTIC
from .pictures.picture_worker import FOLDERS

GRAPHS = "graphs"
"""Folder of the dataset of what pictures show."""


@contextmanager
def batch_folder(out: Path, tasks: Sequence[Task], kind: str, resume: bool, overwrite: bool) -> Iterator[Path]:
    """The folder of a batch of a format, locked.

    Raises
    ------
    UniSGError
        If it holds what such a batch makes and neither ``resume`` nor ``overwrite`` is asked for, or files of those
        names that no batch has made, or cannot be used.
    """
    if kind == "dataset":
        with dataset_folder(out, overwrite, resume) as folder:
            yield folder
        return
    pictures = (*FOLDERS, GRAPHS, INSTANCES, PANOPTIC)
    names = pictures if kind == PICTURES else [f"{task['room']}.{kind}" for task in tasks]
    with made_folder(out), folder_lock(out), marked_folder(out):
        if not (resume or overwrite):
            taken = next((name for name in (PARTS, *names) if (out / name).exists()), None)
            if taken is not None:
                what = f"{out} holds an unfinished batch" if taken == PARTS else f"{out / taken} exists already"
                raise UniSGError(f"{what}: choose another folder, or use --resume or --overwrite")
        check_made(out, (REPORT, *names))
        mark_made(out, (REPORT, *names))
        for name in FOLDERS if kind == PICTURES else ():
            if overwrite:
                shutil.rmtree(out / name, ignore_errors=True)
            (out / name).mkdir(exist_ok=True)
        yield out


@contextmanager
def parts_folder(folder: Path, overwrite: bool) -> Iterator[Path]:
    """The folder of what is made but not finished; stays for ``resume`` unless it is empty or all is done."""
    parts = folder / PARTS
    if overwrite:
        shutil.rmtree(parts, ignore_errors=True)
    parts.mkdir(exist_ok=True)
    try:
        yield parts
    except BaseException:
        for place in (parts, folder, *(folder / name for name in FOLDERS)):
            for path in place.glob(UNFINISHED):
                path.unlink(missing_ok=True)
        for place in (parts, *(folder / name for name in FOLDERS)):
            if place.is_dir() and not any(place.iterdir()):
                place.rmdir()
        raise
    shutil.rmtree(parts, ignore_errors=True)
