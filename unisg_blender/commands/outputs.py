"""What a verb is asked to write, tried before its work begins."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from pathlib import Path

from ..errors import UniSGError
from ..runtime.atomic_files import made_folder
from ..runtime.file_endings import NO_FOLDERS, is_of
from ..runtime.made_files import check_own


def check_file(
    option: str, path: Path | None, endings: tuple[str, ...] = (), others: Iterable[Path | None] = ()
) -> None:
    """Refuse a file that could not be written in the end.

    Parameters
    ----------
    option
        What the user knows it as, such as "--out".
    path
        The file, None for none.
    endings
        Those that its name may have, all if omitted.
    others
        What is read, or written too: it must be none of it.

    Raises
    ------
    UniSGError
        If its ending is another, it is one of ``others``, is there and no plain file, or nothing can be written beside.
    """
    if path is None:
        return
    if endings and path.suffix.lower() not in endings:
        raise UniSGError(f"cannot write {path}: {option} takes {', '.join(endings)}")
    try:
        _check_differs(option, path, others)
        if path.exists() and not path.is_file():
            raise UniSGError(f"cannot write {path}: it is no file; give another {option}")
        if not path.parent.is_dir():
            raise UniSGError(f"cannot write {path}: there is no folder {path.parent}; give another {option}")
        with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.stem}.", suffix=f".tmp{path.suffix}"):
            pass  # a name as long as the one that it will have until it is whole
    except OSError as error:
        raise UniSGError(f"cannot write {path}: {error.strerror or error}; give another {option}") from None


def check_results(option: str, path: Path | None, others: Iterable[Path | None] = ()) -> None:
    """Refuse a folder as :func:`check_folder` does, or one whose files are somebody else's."""
    check_folder(option, path, others)
    check_own(option, path)


def check_folder(option: str, path: Path | None, others: Iterable[Path | None] = ()) -> None:
    """Refuse a folder that can be neither made nor written to, has a file's name, or is one of ``others``."""
    if path is None:
        return
    try:
        _check_differs(option, path, others)
        if path.exists() and not path.is_dir():
            raise UniSGError(f"cannot write to {path}: it is no folder; give another {option}")
        if is_of(path, NO_FOLDERS) and not path.is_dir():
            raise UniSGError(f"cannot write to {path}: that names a file, and a folder is made; give another {option}")
        with made_folder(path), tempfile.TemporaryFile(dir=path):
            pass
    except OSError as error:
        raise UniSGError(f"cannot write to {path}: {error.strerror or error}; give another {option}") from None


def _check_differs(option: str, path: Path, others: Iterable[Path | None]) -> None:
    for other in others:
        if other is not None and os.path.realpath(other) == os.path.realpath(path):
            raise UniSGError(f"cannot write {path}: it is read, or written as something else; give another {option}")
