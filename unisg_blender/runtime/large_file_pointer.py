"""Pointers of Git LFS: lines of text that stand where a large file was not fetched."""

from __future__ import annotations

from pathlib import Path

from ..errors import UniSGError

BEGINNING = b"version https://git-lfs.github.com/spec/"

LONGEST = 1024
"""Bytes of a pointer at most, by the specification of Git LFS."""


def is_pointer(path: Path) -> bool:
    """Whether a file is only a pointer; what cannot be read is none: that is for its reader to say."""
    try:
        if not path.is_file() or path.stat().st_size > LONGEST:
            return False
        with open(path, "rb") as file:
            return file.read(len(BEGINNING)) == BEGINNING
    except OSError:
        return False


def refuse_pointer(path: Path) -> None:
    """Say of a file that is only a pointer how the file itself is to be had.

    Raises
    ------
    UniSGError
        If it is one.
    """
    if is_pointer(path):
        raise UniSGError(
            f"cannot read {path}: it is only a pointer of Git LFS: `git lfs pull` in its repository brings the file"
        )
