"""Relations between entities and their JSON form."""

from __future__ import annotations

import json
from dataclasses import dataclass

from ..errors import UniSGError

VERSION = 1


@dataclass(frozen=True)
class Relation:
    """``subject`` (the entity that carries the property) stands in ``kind`` to the entity with uid ``target``."""

    kind: str
    target: str


def relations_to_json(relations: tuple[Relation, ...]) -> str:
    """The value of the custom property ``unisg_relations``."""
    pairs = [{"kind": relation.kind, "target": relation.target} for relation in relations]
    return json.dumps({"version": VERSION, "relations": pairs}, ensure_ascii=False, sort_keys=True)


def relations_from_json(text: str) -> tuple[Relation, ...]:
    """Relations from the value of the custom property ``unisg_relations``.

    Raises
    ------
    UniSGError
        If the text is not of that form, or was written by a newer version.
    """
    try:
        record = json.loads(text)
        version, pairs = record["version"], record["relations"]
        relations = tuple(Relation(str(pair["kind"]), str(pair["target"])) for pair in pairs)
    except (ValueError, KeyError, TypeError):
        form = '{"version": 1, "relations": [{"kind": ..., "target": ...}]}'
        raise UniSGError(f"unisg_relations must be {form}") from None
    if not isinstance(version, int) or version > VERSION:
        raise UniSGError(f"these relations have version {version}; this software reads up to {VERSION}: update it")
    return relations
