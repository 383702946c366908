"""Look through the asset libraries of the preferences: a Blender of its own reads what was changed."""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

from ...unisg_blender.blender.assets import asset_script
from ..base import SteppedOperator, Steps, redraw_views
from ..threaded_steps import in_thread
from .library_index import blend_files, changed_files, known_assets, libraries, remember, save

LOOK = 0.05
"""Seconds between two looks how far it is."""


class UNISG_OT_look_through_libraries(SteppedOperator):
    """Look which assets the asset libraries of the preferences have; what was not changed is not read again"""

    bl_idname = "unisg.look_through_libraries"
    bl_label = "Look Through Asset Libraries"
    bl_options = {"REGISTER"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if libraries() else "The preferences have no asset library: add one under File Paths"

    def steps(self, context: bpy.types.Context) -> Steps:
        folders = list(libraries().values())
        there = yield from in_thread(lambda share: blend_files(folders), "Looking for files")
        paths = changed_files(there)
        self._bad, done = list[str](), 0
        for record in _read(paths):
            if record is not None:
                done += 1
                remember(record, there[record["path"]])
                if "error" in record:
                    self._bad.append(f"{record['path']}: {record['error']}")
            yield done / len(paths), f"Reading {done} of {len(paths)} files"
        self._files, self._changed = len(there), len(paths)

    def stopped(self, context: bpy.types.Context) -> str:
        save()
        return "what was read is kept"

    def finish(self, context: bpy.types.Context) -> None:
        save()
        for line in self._bad:
            self.report({"WARNING"}, f"cannot be read: {line}")
        count = len(known_assets())
        self.report({"INFO"}, f"{count} assets in {self._files} files ({self._changed} read anew)")
        redraw_views(context)


def _read(paths: list[str]) -> Iterator[dict[str, Any] | None]:
    """What each file has, None while nothing is new."""
    if not paths:
        return
    if not bpy.app.binary_path:  # Python's bpy: there is no Blender to start
        for path in paths:
            try:
                yield {"path": path, "assets": asset_script.marked_assets(path)}
            except (OSError, RuntimeError) as error:
                yield {"path": path, "assets": [], "error": str(error).strip()}
        return
    with tempfile.TemporaryDirectory(prefix="unisg-") as folder:
        out, listed = Path(folder) / "assets.jsonl", Path(folder) / "files.txt"
        listed.write_text("\n".join(paths), encoding="utf-8")
        out.touch()
        command = [bpy.app.binary_path, "-b", "--factory-startup", "--python", asset_script.__file__]
        with open(out, encoding="utf-8") as lines:
            reader = subprocess.Popen(
                [*command, "--", str(out), str(listed)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
            try:
                while True:
                    over = _wait(reader)
                    for line in _whole_lines(lines):
                        yield json.loads(line)
                    if over:
                        return
                    yield None
            finally:
                if reader.poll() is None:
                    reader.kill()
                    reader.wait()


def _wait(process: subprocess.Popen[bytes]) -> bool:
    """Wait for a moment; whether it has ended."""
    try:
        process.wait(LOOK)
    except subprocess.TimeoutExpired:
        return False
    return True


def _whole_lines(lines: Any) -> Iterator[str]:
    """The lines that were written since."""
    while True:
        place = lines.tell()
        line = lines.readline()
        if not line.endswith("\n"):
            lines.seek(place)
            return
        yield line


CLASSES = (UNISG_OT_look_through_libraries,)
