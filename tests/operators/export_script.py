"""Runs inside Blender: the operator and the panel of datasets, as scripts use them. Prints what it saw as JSON."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tests.extension_package import load_extension


def main(out: Path) -> dict:
    extension = load_extension()
    extension.register()
    seen: dict = {}
    (out / "files").mkdir()
    bpy.data.objects["Cube"]["unisg_category"] = "Box"
    before = sorted(item.name for item in bpy.data.objects)
    export = bpy.ops.unisg.export_dataset
    seen["new"] = sorted(export(filepath=str(out / "ds"), form="pga"))
    for name, words in (("again", {}), ("nowhere", {"filepath": ""}), ("unsaved", {"filepath": "//ds"})):
        try:
            export(**({"filepath": str(out / "ds"), "form": "pga"} | words))
        except RuntimeError as error:
            seen[name] = str(error)
    other = bpy.data.scenes.new("Second")
    other.collection.objects.link(bpy.data.objects.new("Empty", None))
    seen["all"] = sorted(export(filepath=str(out / "ds"), all_scenes=True, overwrite=True))
    bpy.ops.wm.save_as_mainfile(filepath=str(out / "files" / "one.blend"), copy=True)
    seen["files"] = sorted(export(filepath=str(out / "batch"), inputs=str(out / "files")))
    seen["resumed"] = sorted(export(filepath=str(out / "batch"), inputs=str(out / "files"), resume=True))
    seen["default"] = bpy.context.window_manager.unisg_dataset.form
    seen["untouched"] = before == sorted(item.name for item in bpy.data.scenes["Scene"].objects)
    extension.unregister()
    return seen


if __name__ == "__main__":
    result = main(Path(sys.argv[1]))
    print("RESULT" + json.dumps(result), flush=True)
    os._exit(0)
