"""Whether the other files that a scene is made of are what they were."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path

from ...runtime.atomic_files import DamagedError, checksum_of

Checksums = Mapping[str, str | None]
"""SHA-256 by path, relative to the scene file's folder where possible; None for a file that is not there."""


def checksums(path: Path, others: Iterable[Path]) -> dict[str, str | None]:
    """What the other files of a scene file are now."""
    folder = path.absolute().parent
    return {_relative(other, folder): _checksum(folder / other) for other in others}


def unchanged(path: Path, before: Checksums) -> bool:
    """Whether the other files of a scene file are what they were."""
    folder = path.absolute().parent
    return all(_checksum(folder / other) == total for other, total in before.items())


def _relative(path: Path, folder: Path) -> str:
    if sys.platform == "win32" and path.drive != folder.drive:
        return path.as_posix()
    return Path(os.path.relpath(path, folder)).as_posix()


def _checksum(path: Path) -> str | None:
    try:
        status = path.stat()
        return _known_checksum(path, status.st_size, status.st_mtime_ns)
    except (OSError, DamagedError):
        return None


@lru_cache(maxsize=1024)
def _known_checksum(path: Path, size: int, time: int) -> str:
    """The checksum of a file of that size and time: many scenes may share a library."""
    return checksum_of(path)
