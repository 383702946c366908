"""Names of things as words."""

from __future__ import annotations

import re

HUMPS = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
TAIL = re.compile(r"[\s_.\-]*\d*$")


def words(name: str) -> str:
    """ "CoffeeTable" as "Coffee Table"; "TVStand" as "TV Stand"."""
    return HUMPS.sub(" ", name)


def without_number(name: str) -> str:
    """ "sofa-0" as "sofa", "desk_lamp_2" as "desk lamp"."""
    return TAIL.sub("", name).replace("_", " ").strip()
