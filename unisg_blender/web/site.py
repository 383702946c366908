"""A scene with its lesson as a page: the room as ``.glb``, one page, one script.

The script is the bundle of ``packaging/player`` with Babylon.js; what it is made of stands in ``player-licences.txt``.
It plays the behaviour graph that is in the file, and asks for no address outside the page.
"""

from __future__ import annotations

import base64
import json
from importlib.resources import files
from pathlib import Path
from string import Template
from tempfile import TemporaryDirectory
from typing import Any

from ..behaviour import operations
from ..errors import UniSGError
from ..formats.gltf.gltf_files import write_gltf
from ..interactivity import lesson_graph
from ..interactivity.lesson_sheet import lesson_sheet
from ..runtime.atomic_files import write_file
from ..runtime.read_report import ReadReport
from ..scene import SceneGraph
from ..scene.realize_instances import realize

ROOM, PAGE, SCRIPT, LICENCES = "room.glb", "index.html", "player.js", "player-licences.txt"
NAMES = (ROOM, PAGE, SCRIPT, LICENCES)
"""What a site's folder has."""

TO_PLAY = "Drag a thing to its place, or use the buttons."
TO_LOOK = "This scene has no lesson: drag to look around."
"""What a page says first."""


def write_site(graph: SceneGraph, folder: Path) -> ReadReport:
    """Write a site into a folder that is there; returns what the page cannot show or judge as UniSG does.

    Raises
    ------
    UniSGError
        If the scene has several lessons, its lesson is not sound, or something cannot be written.
    """
    sheet = _sheet(graph)
    report = write_gltf(graph, folder / ROOM, whole=False)
    for name in (SCRIPT, LICENCES):
        write_file(folder / name, _own(name))
    write_file(folder / PAGE, _page(sheet, "", f'<script src="{SCRIPT}"></script>'))
    return report


def write_page(graph: SceneGraph, path: Path) -> ReadReport:
    """Write everything as one page that opens from disk, otherwise as :func:`write_site`."""
    sheet = _sheet(graph)
    with TemporaryDirectory() as folder:
        report = write_gltf(graph, Path(folder, ROOM), whole=False)
        room = base64.b64encode(Path(folder, ROOM).read_bytes()).decode()
    code = _own(SCRIPT).replace("</script", "<\\/script")
    script = f'<script type="text/plain">{_own(LICENCES)}</script>\n<script>{code}</script>'
    write_file(path, _page(sheet, room, script))
    return report


def _sheet(graph: SceneGraph) -> dict[str, Any]:
    """What the page shows of the lesson; of a scene without one, its title."""
    found = operations(graph)
    if len(found) > 1:
        names = ", ".join(repr(each.name or each.uid) for each in found)
        raise UniSGError(f"the scene has several lessons ({names}), and a page plays one: leave the others out")
    return lesson_sheet(lesson_graph(realize(graph))) if found else {"title": graph.title}


def _own(name: str) -> str:
    return files(__package__).joinpath(name).read_text("utf-8")


def _page(sheet: dict[str, Any], room: str, script: str) -> str:
    text = json.dumps(sheet, ensure_ascii=False).replace("<", "\\u003c")  # no name ends the element it stands in
    return Template(_own("page.html")).substitute(
        sheet=text, room=room, script=script, message=TO_PLAY if "tasks" in sheet else TO_LOOK
    )
