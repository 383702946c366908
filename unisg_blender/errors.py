"""The one error class that users meet, and the exit statuses of the command line."""

from __future__ import annotations

DONE = 0
UNUSABLE_INPUT = 1
MISUSE = 2
SOME_FAILED = 3


class UniSGError(Exception):
    """An input that cannot be used: the message says in one line what is wrong and what to do."""


class MissingPackageError(UniSGError):
    """A verb needs an optional package that is not installed; the message holds the install line."""

    def __init__(self, package: str, extra: str) -> None:
        super().__init__(f'this needs {package}, which is not installed: pip install "unisg-blender[{extra}]"')
