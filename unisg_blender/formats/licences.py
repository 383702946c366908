"""Under which licence a scene file is: by the file that says it, else as such files are published."""

from __future__ import annotations

import re
from pathlib import Path

NAMES = re.compile(r"(licen[cs]e|copying)([-_.].*)?", re.IGNORECASE)
LEVELS = 4
"""Folders upward in which a licence file is looked for; a folder with a .git is the last."""

HEAD = 4000
KINDS = (
    (r"attribution-noncommercial-sharealike 4\.0|by-nc-sa[/ -]4\.0", "CC-BY-NC-SA-4.0"),
    (r"attribution-noncommercial-noderivatives 4\.0|by-nc-nd[/ -]4\.0", "CC-BY-NC-ND-4.0"),
    (r"attribution-noncommercial 4\.0|by-nc[/ -]4\.0", "CC-BY-NC-4.0"),
    (r"attribution-sharealike 4\.0|by-sa[/ -]4\.0", "CC-BY-SA-4.0"),
    (r"attribution 4\.0|creativecommons\.org/licenses/by/4\.0", "CC-BY-4.0"),
    (r"cc0 1\.0|publicdomain/zero", "CC0-1.0"),
    (r"mit no attribution|mit-0", "MIT-0"),
    (r"apache license", "Apache-2.0"),
    (r"gnu affero general public", "AGPL"),
    (r"gnu lesser general public", "LGPL"),
    (r"gnu general public", "GPL"),
    (r"redistribution and use in source and binary forms.*neither the name", "BSD-3-Clause"),
    (r"redistribution and use in source and binary forms", "BSD-2-Clause"),
    (r"permission is hereby granted, free of charge", "MIT"),
)
"""Words of a licence's text, and its name; the first that is found counts."""

FORBIDS = re.compile(r"\bNC\b|\bND\b|non-?commercial|research only", re.IGNORECASE)


def licence_of(path: Path, usual: str = "") -> str:
    """The licence of a file and how that is known: "MIT (LICENSE.txt)", "Apache-2.0 (as published)", "" for unknown."""
    folder = path.absolute().parent
    for place in [folder, *folder.parents][:LEVELS]:
        try:
            for found in sorted(place.iterdir()):
                if NAMES.fullmatch(found.name) and found.is_file() and (kind := _kind(found)):
                    return f"{kind} ({found.name})"
            if (place / ".git").exists():
                break
        except OSError:
            break
    return f"{usual} (as published)" if usual else ""


def _kind(path: Path) -> str:
    with path.open(encoding="utf-8", errors="replace") as file:
        text = " ".join(file.read(HEAD).lower().split())
    return next((name for words, name in KINDS if re.search(words, text)), "")


def forbids_shipping(licence: str) -> bool:
    """Whether what is made of files under a licence may not be sold, or not be made at all."""
    return FORBIDS.search(licence) is not None
