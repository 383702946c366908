"""The catalogs of an asset library: ``blender_assets.cats.txt``, beside its files or above them."""

from __future__ import annotations

from pathlib import Path

FILE = "blender_assets.cats.txt"
NONE = "00000000-0000-0000-0000-000000000000"


def read_catalogs(path: Path) -> dict[str, str]:
    """Paths of catalogs ("Furniture/Chairs") by identifier; of a file that is missing or no such file none."""
    found = {}
    try:
        lines = path.read_text("utf-8", errors="replace").splitlines()
    except OSError:
        return {}
    for line in lines:
        identifier, colon, rest = line.partition(":")
        if colon and not line.startswith(("#", "VERSION")):
            found[identifier.strip()] = rest.partition(":")[0].strip()
    return found


def catalogs_for(blend: Path, top: Path | None = None) -> dict[str, str]:
    """The catalogs that a file's assets are in: of the nearest folder that has them, up to the library's ``top``."""
    for folder in blend.parents:
        if (folder / FILE).is_file():
            return read_catalogs(folder / FILE)
        if folder == top:
            break
    return {}


def words_of(record: dict[str, object], catalogs: dict[str, str]) -> list[str]:
    """What says what an asset is: its category alone where it has one; else its catalogs, its tags, its name."""
    if record["category"]:
        return [str(record["category"])]
    catalog = catalogs.get(str(record["catalog"]), "") if record["catalog"] != NONE else ""
    tags = record["tags"]
    assert isinstance(tags, list)
    words = [*reversed(catalog.split("/")), *map(str, tags), str(record["name"])]
    return [word for word in words if word]
