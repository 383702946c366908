"""What is marked as an asset in files: run by a Blender of its own, so that the one with the window need not load them.

``blender -b --factory-startup --python asset_script.py -- OUT LIST``: LIST is a file with a path in each line, OUT gets
a line of JSON for each. It stands alone: nothing but ``bpy`` is imported.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import bpy

KINDS = {"objects": "OBJECT", "collections": "COLLECTION"}


def marked_assets(path: str) -> list[dict[str, Any]]:
    """The objects and collections of a file that are marked as assets; the open file is as it was.

    Each is a record: ``kind``, ``name``, ``category`` (its ``unisg_category``), ``catalog`` (its identifier), ``tags``.
    """
    before = set(bpy.data.libraries)
    with bpy.data.libraries.load(path, link=True, assets_only=True) as (there, wanted):
        for column in KINDS:
            setattr(wanted, column, list(getattr(there, column)))
    found = [asset_record(item) for column in KINDS for item in getattr(wanted, column) if item is not None]
    bpy.data.batch_remove(set(bpy.data.libraries) - before)
    return found


def asset_record(item: Any) -> dict[str, Any]:
    """What is known of an object or a collection that is marked as an asset."""
    marks = item.asset_data
    return {
        "kind": KINDS["objects" if isinstance(item, bpy.types.Object) else "collections"],
        "name": item.name,
        "category": str(item.get("unisg_category", "")),
        "catalog": str(marks.catalog_id),
        "tags": [tag.name for tag in marks.tags],
    }


def main(out: str, listed: str) -> None:
    """Write a line for each file; one that cannot be read has an ``error``."""
    with open(listed, encoding="utf-8") as file:
        paths = file.read().splitlines()
    with open(out, "a", encoding="utf-8") as lines:
        for path in paths:
            try:
                record: dict[str, Any] = {"path": path, "assets": marked_assets(path)}
            except Exception as error:  # whatever is wrong with a file, the others are read
                record = {"path": path, "assets": [], "error": str(error).strip()}
            lines.write(json.dumps(record) + "\n")
            lines.flush()


if __name__ == "__main__":
    main(*sys.argv[-2:])
