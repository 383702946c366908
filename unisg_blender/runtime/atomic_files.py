"""Files written whole or not at all, and their checksums."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import UniSGError

DIGITS = 16
UNFINISHED = ".*.tmp*"
"""Pattern of the names of files that are being written."""


class DamagedError(UniSGError):
    """A file is not what was written."""


class DiskFullError(UniSGError):
    """There is no room for a file."""


def checksum(data: bytes | memoryview) -> str:
    """Hexadecimal SHA-256, as ``sha256sum`` prints it."""
    return hashlib.sha256(data).hexdigest()


def check_plain(path: Path) -> None:
    """OSError if a path is that of a pipe, a socket or a device: nobody knows when what is read of it ends."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise OSError(errno.EINVAL, "it is no plain file", str(path))


def read_plain(path: Path) -> bytes:
    """The bytes of a plain file; OSError if it is none, or cannot be read."""
    check_plain(path)
    return path.read_bytes()


def checksum_of(path: Path) -> str:
    """Hexadecimal SHA-256 of a file; DamagedError if it cannot be read."""
    try:
        check_plain(path)
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise DamagedError(f"{path} cannot be read: {error.strerror or error}") from None


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path to write a file to, which then takes the place of ``path``; if anything fails, nothing is left of it.

    It is in the same folder and has the same ending. The file is there whole or not at
    all, also if the process or the machine stops.

    Raises
    ------
    DiskFullError
        If the disk is full.
    UniSGError
        If the file cannot be written for another reason.
    """
    if not path.parent.is_dir():
        raise UniSGError(f"cannot write {path}: the folder {path.parent} does not exist")
    if path.is_dir():
        raise UniSGError(f"cannot write {path}: it is a folder")
    if not os.access(path.parent, os.W_OK):
        raise UniSGError(f"cannot write {path}: the folder {path.parent} is read-only")
    temporary = path.with_name(f".{path.stem}.{uuid.uuid4().hex[:8]}.tmp{path.suffix}")
    try:
        yield temporary
        with open(temporary, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        raise cannot_write(path, error) from None
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def made_folder(folder: Path) -> Iterator[None]:
    """A folder that is there, made with those above it if need be; what was made and stays empty is taken away again.

    Raises
    ------
    UniSGError
        If it cannot be made.
    """
    missing: list[Path] = []
    try:
        try:
            missing += [path for path in (folder, *folder.parents) if not path.exists()]
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise cannot_write(folder, error) from None
        yield
    finally:
        for path in missing:
            with contextlib.suppress(OSError):  # it is in use
                path.rmdir()


def cannot_write(path: Path, error: OSError) -> UniSGError:
    """The error for a file or folder that the system did not let be written."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return DiskFullError(f"the disk is full: no room for {path}")
    return UniSGError(f"cannot write {path}: {error.strerror or error}")


def write_file(path: Path, data: bytes | str) -> None:
    """Write bytes, or text as UTF-8, as :func:`replacing` does."""
    with replacing(path) as temporary, open(temporary, "wb") as file:
        file.write(data.encode() if isinstance(data, str) else data)


def write_named(folder: Path, stem: str, suffix: str, data: bytes) -> tuple[str, str]:
    """Write a file named after its content; returns its name ``stem-<digits of the checksum>suffix`` and checksum."""
    total = checksum(data)
    name = f"{stem}-{total[:DIGITS]}{suffix}"
    write_file(folder / name, data)
    return name, total
