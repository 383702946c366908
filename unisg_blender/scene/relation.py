"""Relations between entities and their JSON form."""

from __future__ import annotations

import json
from dataclasses import dataclass

from ..errors import UniSGError
from ..runtime.json_records import check_version, parse_json

VERSION = 1


@dataclass(frozen=True)
class Relation:
    """``subject`` (the entity that carries the property) stands in ``kind`` to the entity with uid ``target``."""

    kind: str
    target: str


def relations_to_json(relations: tuple[Relation, ...]) -> str:
    """The value of the custom property ``unisg_relations``."""
    return json.dumps(
        {"version": VERSION, "relations": [vars(relation) for relation in relations]},
        ensure_ascii=False,
        sort_keys=True,
    )


def relations_from_json(text: str) -> tuple[Relation, ...]:
    """Relations from the value of the custom property ``unisg_relations``.

    Raises
    ------
    UniSGError
        If the text is not of that form, or was written by a newer version.
    """
    record = parse_json(text, "unisg_relations")
    try:
        relations = tuple(Relation(str(pair["kind"]), str(pair["target"])) for pair in record["relations"])
        check_version(record["version"], "these relations have", VERSION)
    except (KeyError, TypeError):
        form = '{"version": 1, "relations": [{"kind": ..., "target": ...}]}'
        raise UniSGError(f"unisg_relations must be {form}") from None
    return relations
