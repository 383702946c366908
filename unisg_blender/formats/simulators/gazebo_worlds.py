"""Worlds and models of Gazebo (SDF): models, the models that they include, links, and what is visible of them.

Right-handed, z up, metres; a pose is x y z and roll, pitch, yaw about fixed axes in radians. ``model://name`` is looked
for beside the world, in folders ``models`` there, and in the folder of assets; which axis is up in a mesh is not asked,
as in Gazebo. http://sdformat.org/spec, 1.3 to 1.11.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import UniSGError
from ...scene import SceneGraph
from ..axes import Array, fixed_turn, pose, quaternion_turn
from ..layout_file import LayoutFile, is_xml
from ..plain_xml import parse_xml
from ..room_builder import RoomBuilder
from .robot_shapes import RobotShapes
from .shapes import shape, text_numbers

NAME = "Gazebo world"
LICENCE = ""
GROUND = 100.0
"""Metres of a side of the model "ground_plane", which comes with Gazebo and so is beside no world."""

DEEPEST = 20
"""Models within models, included ones too."""


def recognises(data: Any) -> bool:
    """Whether its root is that of SDF."""
    return is_xml(data, "sdf", "gazebo")


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """Each world, or the models of a file without one."""
    worlds = file.data.findall("world") or [file.data]
    for number, world in enumerate(worlds):
        title = world.get("name", file.title) if len(worlds) > 1 else file.title
        yield _World(file, f"{title}" if number == 0 or world.get("name") else f"{title} {number}").graph(world)


class _World:
    def __init__(self, file: LayoutFile, title: str) -> None:
        self.file, self.builder = file, RoomBuilder(title)
        self.shapes = RobotShapes(file, self.builder)
        self.saved: dict[str, Array] = {}

    def graph(self, world: Element) -> SceneGraph:
        """All models of a world, where its saved state has them, if it has one."""
        self.saved = {each.get("name", ""): _pose(each.find("pose")) for each in world.iterfind("state/model")}
        models = [each for each in world if each.tag in ("model", "include")]
        for number, model in enumerate(models):
            self._add(model, -1, 0, top=True)
            self.file.tell(number + 1, len(models))
        self.file.report.add("", "categories and what stands on what are not told")
        for kind in ("light", "actor"):
            if world.find(kind) is not None:
                self.file.report.add("", f"{kind}s are not read")
        return self.builder.build()

    def _add(self, element: Element, parent: int, depth: int, top: bool = False) -> None:
        """A <model> or an <include> below another."""
        if depth > DEEPEST:
            raise UniSGError(f"its models are more than {DEEPEST} deep")
        if element.tag == "include":
            self._include(element, parent, depth, top)
        elif element.tag == "model":
            name = element.get("name", "model")
            local = _pose(element.find("pose"))
            self._model(element, name, self.saved.get(name, local) if top else local, parent, depth)

    def _include(self, element: Element, parent: int, depth: int, top: bool) -> None:
        uri = (element.findtext("uri") or "").strip()
        path = self.shapes.place(uri)
        path = path / "model.sdf" if path is not None and path.is_dir() else path
        if (path is None or not path.is_file()) and uri.rstrip("/").endswith("ground_plane"):
            plane = shape("plane", GROUND, GROUND)
            self.builder.add("", _pose(element.find("pose")), plane, name="ground_plane", parent=parent)
            return
        if path is None or not path.is_file():
            self.file.report.add(uri, "this model is not there: it is left out")
            return
        model = parse_xml(path.read_bytes(), path).find("model")
        if model is None:
            self.file.report.add(uri, "there is no model in it: it is left out")
            return
        name = (element.findtext("name") or model.get("name") or "model").strip()
        local = _pose(element.find("pose") if element.find("pose") is not None else model.find("pose"))
        self._model(model, name, self.saved.get(name, local) if top else local, parent, depth)

    def _model(self, model: Element, name: str, local: Array, parent: int, depth: int) -> None:
        others = {"static": True} if (model.findtext("static") or "").strip() in ("1", "true") else None
        number = self.builder.add("", local, name=name, parent=parent, others=others)
        for link in model.iterfind("link"):
            for visual in link.iterfind("visual"):
                self.shapes.add(visual, _pose(link.find("pose")) @ _pose(visual.find("pose")), number)
        for inner in model:
            self._add(inner, number, depth + 1)


def _pose(element: Element | None) -> Array:
    """The matrix of a <pose>; frames that it is relative to are not followed."""
    if element is None or not (element.text or "").strip():
        return np.eye(4)
    if element.get("rotation_format") == "quat_xyzw":
        x, y, z, *turn = text_numbers(element.text, 7)
        return pose((x, y, z), quaternion_turn(turn[3], *turn[:3]))
    values = text_numbers(element.text, 6)
    angles = np.radians(values[3:]) if element.get("degrees") == "true" else values[3:]
    return pose(values[:3], fixed_turn(*angles))
