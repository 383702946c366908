"""Files written whole or not at all, and their checksums."""

from __future__ import annotations

import errno
import hashlib
import os
from pathlib import Path

from ..errors import UniSGError

DIGITS = 16


class DamagedError(UniSGError):
    """A file is not what was written."""


class DiskFullError(UniSGError):
    """There is no room for a file."""


def checksum(data: bytes | memoryview) -> str:
    """Hexadecimal SHA-256, as ``sha256sum`` prints it."""
    return hashlib.sha256(data).hexdigest()


def checksum_of(path: Path) -> str:
    """Hexadecimal SHA-256 of a file; DamagedError if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise DamagedError(f"{path} cannot be read: {error.strerror or error}") from None


def write_file(path: Path, data: bytes) -> None:
    """Write a file so that it is there whole or not at all, also if the process or the machine stops.

    Raises
    ------
    DiskFullError
        If the disk is full; the temporary file is gone then.
    UniSGError
        If the file cannot be written for another reason.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        with open(temporary, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise DiskFullError(f"the disk is full: no room for {path}") from None
        raise UniSGError(f"cannot write {path}: {error.strerror or error}") from None
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def write_named(folder: Path, stem: str, suffix: str, data: bytes) -> tuple[str, str]:
    """Write a file named after its content; returns its name ``stem-<digits of the checksum>suffix`` and checksum."""
    total = checksum(data)
    name = f"{stem}-{total[:DIGITS]}{suffix}"
    write_file(folder / name, data)
    return name, total
