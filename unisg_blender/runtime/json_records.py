"""Dataclasses as JSON records and back: the types of their fields say what a record may hold.

A record leaves out what is at its default. A dataclass with a field ``extra`` keeps in it what
its record has besides; of any other one, a record with more than its fields is refused.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from functools import cache
from types import UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from ..errors import UniSGError, did_you_mean

DEEPEST = 100
"""Levels of lists and objects inside each other that a text may have."""

LONGEST = 300
"""Digits that an integer may have, so that it is also a float."""

Item = TypeVar("Item")

_BRACKETS = re.compile(r'"(?:[^"\\]|\\.)*"|([\[{])|[\]}]', re.DOTALL)
_SIMPLE: dict[Any, tuple[Callable[[Any], bool], str]] = {
    str: (lambda value: isinstance(value, str), "str"),
    bool: (lambda value: isinstance(value, bool), "bool"),
    int: (lambda value: isinstance(value, int) and not isinstance(value, bool), "int"),
    float: (lambda value: isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value),
            "finite number"),
}  # fmt: skip


def parse_json(text: str | bytes, what: str) -> Any:
    """What a JSON text says.

    Raises
    ------
    UniSGError
        If it is not valid JSON, nested deeper than :data:`DEEPEST` or with integers longer than
        :data:`LONGEST`; ``what`` is what the message calls the text.
    """
    try:
        text = text if isinstance(text, str) else text.decode("utf-8")
        if text.count("[") + text.count("{") > DEEPEST:
            _check_depth(text)
        return json.loads(text, parse_int=_integer)
    except ValueError as error:
        raise UniSGError(f"{what} is not valid JSON: {error}") from None


def _integer(digits: str) -> int:
    if len(digits) > LONGEST:
        raise ValueError(f"an integer has {len(digits)} digits")
    return int(digits)


def _check_depth(text: str) -> None:
    depth = 0
    for found in _BRACKETS.finditer(text):
        if not found[0].startswith('"'):
            depth += 1 if found[1] else -1
            if depth > DEEPEST:
                raise ValueError(f"it is nested deeper than {DEEPEST} levels")


def check_version(version: Any, subject: str, newest: int) -> None:
    """UniSGError if a record is of a version that is not known; ``subject`` is such as "this lesson has"."""
    if not isinstance(version, int) or version > newest:
        raise UniSGError(f"{subject} version {version}; this software reads up to {newest}: update it")


def to_record(item: Any) -> dict[str, Any]:
    """A dataclass as JSON-ready values, without what is at its default."""
    record: dict[str, Any] = dict(getattr(item, "extra", {}))
    kind: Any = type(item)
    for name, required, default in _written(kind):
        value = getattr(item, name)
        if required or value != default:
            record[name] = _plain(value)
    return record


@cache
def _written(kind: Any) -> list[tuple[str, bool, Any]]:
    """The fields of a dataclass that its records have: name, whether each record has it, and the default."""
    known = [each for each in fields(kind) if each.name != "extra"]
    return [(each.name, _required(each), None if _required(each) else _default(each)) for each in known]


def _required(each: Field[Any]) -> bool:
    return each.default is MISSING and each.default_factory is MISSING


def _default(each: Field[Any]) -> Any:
    return each.default if each.default_factory is MISSING else each.default_factory()


def _plain(value: Any) -> Any:
    if is_dataclass(value):
        return to_record(value)
    if isinstance(value, Mapping):
        return {key: _plain(entry) for key, entry in value.items()}
    return [_plain(entry) for entry in value] if isinstance(value, tuple | list) else value


def from_record(kind: type[Item], record: Any, what: str) -> Item:
    """A dataclass from what :func:`to_record` made of it, its values checked against the types of its fields.

    Raises
    ------
    UniSGError
        If a value is missing, is one too many or of another type; the message begins with ``what``
        and the record's ``uid``, if it has one.
    """
    if not isinstance(record, dict):
        raise UniSGError(f"{what} must be a JSON object")
    what = f"{what} {record['uid']!r}" if "uid" in record else what
    types, known = _types(kind), {each.name: each for each in fields(kind) if each.name != "extra"}  # type: ignore[arg-type]
    missing = [name for name, each in known.items() if _required(each) and name not in record]
    if missing:
        raise UniSGError(f"{what} needs {' and '.join(map(repr, missing))}")
    rest = {name: value for name, value in record.items() if name not in known}
    if rest and "extra" not in types:
        strange = next(iter(rest))
        hint = did_you_mean(str(strange), known)
        raise UniSGError(f"{what} may have {', '.join(sorted(known))}, not {strange!r}{hint}")
    values = {name: _value(record[name], types[name], name, what) for name in known if name in record}
    return kind(**values, **({"extra": rest} if "extra" in types else {}))


@cache
def _types(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _value(value: Any, kind: Any, name: str, what: str) -> Any:
    origin, parts = get_origin(kind), get_args(kind)
    if kind is Any:
        return value
    if origin is UnionType:  # "or None"
        return None if value is None else _value(value, parts[0], name, what)
    if is_dataclass(kind):
        return from_record(kind, value, f"{what}: {name!r}")  # type: ignore[arg-type]
    if origin is tuple and isinstance(value, list | tuple):
        kinds = (parts[0],) * len(value) if parts[1:] == (Ellipsis,) else parts
        if len(value) == len(kinds):
            return tuple(_value(entry, each, name, what) for entry, each in zip(value, kinds, strict=True))
    elif origin is list and isinstance(value, list | tuple):
        return [_value(entry, parts[0], name, what) for entry in value]
    elif origin in (dict, Mapping) and isinstance(value, dict):
        return {key: _value(entry, parts[1], name, what) for key, entry in value.items()}
    elif kind in _SIMPLE and _SIMPLE[kind][0](value):
        return value
    raise UniSGError(f"{what}: {name!r} must be {_wanted(kind)}")


def _wanted(kind: Any) -> str:
    """A type in words."""
    origin, parts = get_origin(kind), get_args(kind)
    if origin in (tuple, list):
        many = "" if origin is list or parts[1:] == (Ellipsis,) else f"{len(parts)} "
        return f"a list of {many}{_name(parts[0])} values"
    if origin in (dict, Mapping):
        return f"an object of {_name(parts[1])} values"
    return f"{'an' if kind is int else 'a'} {_name(kind)}"


def _name(kind: Any) -> str:
    return _SIMPLE[kind][1] if kind in _SIMPLE else getattr(kind, "__name__", str(kind))
