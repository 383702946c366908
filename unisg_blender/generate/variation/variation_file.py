"""Read what varies from a TOML file; every mistake is told in one line that says where it is and what is meant."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from ...errors import UniSGError, did_you_mean
from ...runtime.atomic_files import read_plain
from ..counts import MOST_OBJECTS
from .variation import NOTHING, SCENE, TRAINING, Count, Jitter, Variation

LIKE = (TRAINING, SCENE)
MOST_TRIES = 1000
FARTHEST = 100.0
"""Metres that a thing may be moved at most: more is a slip of the unit."""


def read_record(path: Path) -> dict[str, Any]:
    """What a TOML file says, looked through; docs/examples/variations.toml has all that it may say, with comments.

    Raises
    ------
    UniSGError
        If it cannot be read, or says something else.
    """
    try:
        content = tomllib.loads(read_plain(path).decode("utf-8"))
    except OSError as error:
        raise UniSGError(f"cannot read {path}: {error.strerror}") from None
    except (ValueError, RecursionError) as error:
        raise UniSGError(f"{path} is not valid TOML: {error}") from None
    try:
        variation_from(content)
    except UniSGError as error:
        raise UniSGError(f"{path}: {error}") from None
    return content


def variation_from(content: Mapping[str, Any]) -> Variation:
    """What a record says that has the form of such a file; UniSGError for another form."""
    _check_keys(content, [field.name for field in fields(Variation)], "a variation")
    read: dict[str, Callable[[Any, str], Any]] = {
        "counts": _counts, "rest": _rest, "remove": _chances, "reroll": _chances, "swap": _chances, "lock": _names,
        "shapes": _names, "jitter": _jitter, "lesson": _yes_or_no, "refused": _share, "tries": _tries,
    }  # fmt: skip
    return Variation(**{key: read[key](value, key) for key, value in content.items()})


def _check_keys(content: Mapping[str, Any], known: list[str], what: str) -> None:
    for key in content:
        if key not in known:
            raise UniSGError(f"{what} has no {key!r}{did_you_mean(key, known)}: it has {', '.join(known)}")


def _counts(value: Any, key: str) -> dict[str, Count]:
    if not isinstance(value, dict):
        raise UniSGError(f"{key} must be a table: [counts] and lines such as Scalpel = [1, 3]")
    return {name: _count(one, f"{key}: {name}") for name, one in value.items()}


def _count(value: Any, where: str) -> Count:
    if isinstance(value, dict):
        _check_keys(value, ["count", "chance"], where)
        count = _count(value.get("count", 1), where)
        return Count(count.least, count.most, _share(value.get("chance", 1.0), where), count.like)
    if value in LIKE:
        return Count(like=value)
    ends = [value, value] if _is_whole(value) else value
    if not isinstance(ends, list) or len(ends) != 2 or not all(map(_is_whole, ends)):
        raise UniSGError(f'{where} must be a number, a range such as [1, 3], "{TRAINING}" or "{SCENE}"')
    if not 0 <= ends[0] <= ends[1] <= MOST_OBJECTS:
        raise UniSGError(f"{where} must be a range upward, from 0 on, such as [1, 3], not {ends}")
    return Count(*ends)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _rest(value: Any, key: str) -> str:
    known = (*LIKE, NOTHING)
    if value not in known:
        raise UniSGError(f"{key} must be one of {', '.join(map(repr, known))}, not {value!r}")
    return str(value)


def _chances(value: Any, key: str) -> dict[str, float]:
    if isinstance(value, dict):
        return {name: _share(chance, f"{key}: {name}") for name, chance in value.items()}
    return dict.fromkeys(_names(value, key), 1.0)


def _names(value: Any, key: str) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(name, str) and name for name in value):
        raise UniSGError(f'{key} must be a list of names such as ["Chair", "Book"]')
    return tuple(value)


def _jitter(value: Any, key: str) -> Jitter:
    if not isinstance(value, dict):
        raise UniSGError(f"{key} must be a table: [jitter], and lines such as distance = 0.05")
    _check_keys(value, [field.name for field in fields(Jitter)], key)
    distance = _number(value.get("distance", 0.0), 0, FARTHEST, f"{key}: distance, in metres,")
    angle = _number(value.get("angle", 0.0), 0, 180, f"{key}: angle, in degrees,")
    return Jitter(distance, angle, _names(value.get("things", ["*"]), f"{key}: things"))


def _yes_or_no(value: Any, key: str) -> bool:
    if not isinstance(value, bool):
        raise UniSGError(f"{key} must be true or false, not {value!r}")
    return value


def _share(value: Any, key: str) -> float:
    return _number(value, 0, 1, f"{key}, a share,")


def _tries(value: Any, key: str) -> int:
    if not _is_whole(value):
        raise UniSGError(f"{key} must be a whole number, not {value!r}")
    return int(_number(value, 1, MOST_TRIES, key))


def _number(value: Any, least: float, most: float, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not least <= value <= most:
        raise UniSGError(f"{where} must be a number from {least:g} to {most:g}, not {value!r}")
    return float(value)
