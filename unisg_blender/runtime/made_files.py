"""Which files of a folder were made here: a marker names them, and only they are ever replaced."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import UniSGError
from .atomic_files import cannot_write, made_folder, write_file

MARKER = ".unisg-blender"
"""A file beside what was made: the software's name and version, and the names of what it made."""
SOFTWARE = "unisg_blender"


def made_in(folder: Path) -> set[str] | None:
    """The names of what was made in a folder, None where no marker says that anything was."""
    try:
        record = json.loads((folder / MARKER).read_text(encoding="utf-8"))
        names = record["made"]
        known = isinstance(record[SOFTWARE], str) and isinstance(names, list)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return {name for name in names if isinstance(name, str)} if known else None


def mark_made(folder: Path, names: Iterable[str]) -> None:
    """Add names to those that the folder's marker has."""
    from .. import __version__

    made = sorted({*(made_in(folder) or ()), *names})
    write_file(folder / MARKER, json.dumps({SOFTWARE: __version__, "made": made}, indent=1) + "\n")


def check_made(folder: Path, names: Iterable[str]) -> None:
    """Refuse to replace what was not made here.

    Raises
    ------
    UniSGError
        If one of the names is there and no marker says that it was made here.
    """
    made = made_in(folder) or set()
    strange = next((name for name in names if name not in made and (folder / name).exists()), None)
    if strange is not None:
        raise UniSGError(f"{folder / strange} was not made by unisg, and is not replaced: choose another folder")


def check_own(option: str, folder: Path | None) -> None:
    """Refuse a folder for results that holds something, unless an earlier run has made or marked it.

    Raises
    ------
    UniSGError
        If that is so.
    """
    if folder is not None and folder.is_dir() and made_in(folder) is None and any(folder.iterdir()):
        raise UniSGError(f"{folder} holds files that unisg has not made: give {option} a new folder, or an empty one")


@contextmanager
def own_folder(option: str, folder: Path) -> Iterator[None]:
    """A marked folder for results that come in parts; one in which nothing was made is taken away again.

    Raises
    ------
    UniSGError
        As :func:`check_own`, or if the folder cannot be made.
    """
    check_own(option, folder)
    with made_folder(folder), marked_folder(folder):
        mark_made(folder, ())
        yield


@contextmanager
def marked_folder(folder: Path) -> Iterator[None]:
    """A folder whose marker is taken away in the end where it is all that is left."""
    try:
        yield
    finally:
        if [path.name for path in folder.iterdir()] == [MARKER]:
            with contextlib.suppress(OSError):
                (folder / MARKER).unlink()


@contextmanager
def filling(folder: Path) -> Iterator[Path]:
    """A folder to write to, whose contents go to ``folder`` (made if it is missing) when all of them are written.

    What an earlier call made is replaced, and folders with it; what else is there stays.

    Raises
    ------
    UniSGError
        If the folder cannot be written to, or holds something of those names that was not made so.
    """
    try:
        with made_folder(folder), tempfile.TemporaryDirectory(dir=folder, prefix=".unfinished-") as name:
            yield Path(name)
            whole = sorted(Path(name).iterdir())
            check_made(folder, [made.name for made in whole])
            mark_made(folder, [made.name for made in whole])
            for made in whole:
                target = folder / made.name
                if target.is_dir():
                    shutil.rmtree(target)
                os.replace(made, target)
    except OSError as error:
        raise cannot_write(folder, error) from None
