"""The one error class that users meet, what its messages guess, and the exit statuses of the command line."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

DONE = 0
UNUSABLE_INPUT = 1
MISUSE = 2
SOME_FAILED = 3

NEAR = 0.65
"""How alike a name must be to a word to be guessed, 0 to 1: "Cpu" and "Cup" are, "Third" and "Other" are not."""


class UniSGError(Exception):
    """An input that cannot be used: the message says in one line what is wrong and what to do."""


class MissingPackageError(UniSGError):
    """A verb needs an optional package that is not installed; the message holds the install line."""

    def __init__(self, package: str, extra: str) -> None:
        super().__init__(f'this needs {package}, which is not installed: pip install "unisg-blender[{extra}]"')


def one_line(message: object) -> str:
    """A message without the line breaks that a name in it may have."""
    return " ".join(str(message).split())


UNFORESEEN = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
"""What reading stumbles with over a file whose parts do not fit together."""


def unforeseen(path: object, program: str, error: Exception) -> UniSGError:
    """The error for a file over which the reading of a ``program``'s files stumbled: its fault, or ours."""
    what = f"{type(error).__name__}: {one_line(error)[:200]}"
    return UniSGError(f"cannot read {path}: is it damaged? If {program} shows it, please report this: {what}")


def system_reason(error: OSError) -> str:
    """What the system says, in one line: a name too long, a disk that fails, what no reader has put into words."""
    name = "" if error.filename is None else f"{str(error.filename)[:200]}: "
    return one_line(f"{name}{error.strerror or error}")


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """The end of a message about a word that nothing has: " (did you mean 'Cup'?)", or "" if no name is near it."""
    names = {name.casefold(): name for name in known}
    near = get_close_matches(word.casefold(), names, 1, NEAR)
    return f" (did you mean {names[near[0]]!r}?)" if near else ""
