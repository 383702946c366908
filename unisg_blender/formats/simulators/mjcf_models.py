"""MJCF (MuJoCo's own XML; RoboCasa, MolmoSpaces): bodies at rest, what is visible of them, and their joints.

Right-handed, z up, metres; quaternions are w x y z, angles degrees unless the file says radian. Of a body that has
shapes which collide with nothing, only these are shown: they are what is seen, the others are what collides. Categories
are those of ``<name>_metadata.json`` beside the file, as MolmoSpaces has them. https://mujoco.readthedocs.io/en/stable/
XMLreference.html. Not followed: models that are attached, height fields, skins, flexible parts, replication.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import UniSGError
from ...scene import SceneGraph
from ..axes import Array, euler_turn, numbers, pose, quaternion_turn
from ..layout_file import LayoutFile, is_xml
from ..mesh_parts import KINDS, whole_mesh
from ..plain_xml import parse_xml
from ..room_builder import RoomBuilder
from .joints import Joint, with_joints
from .mjcf_defaults import Defaults
from .shapes import shape, text_numbers

NAME = "MJCF"
LICENCE = ""
DEEPEST = 150
MOST_FILES = 2000
JOINTS = {"hinge": "revolute", "slide": "prismatic", "ball": "ball", "free": "free"}
PLANE = 10.0
"""Metres: half the side of a plane without an end."""

NOT_READ = ("attach", "replicate", "flexcomp", "composite")


def recognises(data: Any) -> bool:
    """Whether its root is MuJoCo's."""
    return is_xml(data, "mujoco")


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The model."""
    yield _Model(file).graph()


class _Model:
    def __init__(self, file: LayoutFile) -> None:
        self.file, self.root, self.builder = file, file.data, RoomBuilder(file.title)
        self._files = 0
        self._include(self.root, file.path, 0)
        self.compiler = {key: value for each in self.root.iterfind("compiler") for key, value in each.items()}
        self.degrees = self.compiler.get("angle", "degree") != "radian"
        self.defaults = Defaults(self.root)
        self.meshes = {_name(each): each for each in self.root.iterfind("asset/mesh")}
        self.joints: list[Joint] = []
        self.categories = _metadata(file.path)

    def graph(self) -> SceneGraph:
        """All bodies of the world."""
        for world in self.root.iterfind("worldbody"):
            self._body(world, -1, np.eye(4), "", 0)
        self.file.report.add("", "what stands on what is not told")
        return with_joints(self.builder.build(), self.joints)

    def _include(self, element: Element, path: Path, depth: int) -> None:
        """Put what other files hold in the place of <include>; UniSGError if that does not end."""
        place = 0
        while place < len(element):
            child = element[place]
            if child.tag != "include":
                self._include(child, path, depth)
                place += 1
                continue
            self._files += 1
            if depth > DEEPEST or self._files > MOST_FILES:
                raise UniSGError("its files include each other")
            found = self.file.assets.at(child.get("file", ""))
            element.remove(child)
            if found is None or not found.is_file():
                self.file.report.add(child.get("file", ""), "this file is not there: it is left out")
                continue
            root = parse_xml(found.read_bytes(), found)
            self._include(root, found, depth + 1)
            for offset, inner in enumerate(root):
                element.insert(place + offset, inner)
            place += len(root)

    def _body(self, body: Element, parent: int, local: Array, childclass: str, depth: int) -> None:
        """A body, or the world or a frame within one, with its shapes, joints and bodies."""
        if depth > DEEPEST:
            raise UniSGError(f"its bodies are more than {DEEPEST} deep")
        childclass = body.get("childclass", childclass)
        if body.tag == "body":
            name = body.get("name", "body")
            parent = self.builder.add(self.categories.get(name, ""), local, name=name, uid=name, parent=parent)
            local = np.eye(4)
            self._add_joints(body, name, childclass)
        geoms = [self.defaults.of(each, childclass) for each in body.iterfind("geom")]
        seen = [each for each in geoms if each.get("contype") == "0" and each.get("conaffinity") == "0"]
        for geom in seen or geoms:
            self._geom(geom, local, parent)
        for child in body:
            if child.tag in ("body", "frame"):
                self._body(child, parent, local @ self._pose(child.attrib), childclass, depth + 1)
            elif child.tag in NOT_READ:
                self.file.report.add(child.get("model", ""), f"<{child.tag}> is not followed")

    def _geom(self, geom: Mapping[str, str], local: Array, parent: int) -> None:
        kind = geom.get("type", "mesh" if "mesh" in geom else "sphere")
        name = geom.get("name") or geom.get("mesh") or kind
        if (geom.get("rgba") or "1 1 1 1").split()[-1] in ("0", "0.0"):
            return  # a shape that is not seen at all
        if kind in ("mesh", "sdf"):
            self._mesh(geom, local @ self._pose(geom), parent, name)
            return
        if kind not in ("plane", "sphere", "capsule", "ellipsoid", "cylinder", "box"):
            self.file.report.add(name, f"a {kind} is not read")
            return
        frame, size = self._pose(geom), [float(each) for each in geom.get("size", "").split()]
        if "fromto" in geom:
            frame, half = _between(text_numbers(geom["fromto"], 6))
            size = [size[0], half] if kind in ("capsule", "cylinder") else [size[0], size[0], half]
        self.builder.add("", local @ frame, shape(kind, *_sizes(kind, size)), parent=parent, name=name)

    def _mesh(self, geom: Mapping[str, str], local: Array, parent: int, name: str) -> None:
        asset = self.meshes.get(geom.get("mesh", ""))
        attributes = {} if asset is None else self.defaults.of(asset, "")
        file = attributes.get("file", "")
        folder = self.compiler.get("meshdir", self.compiler.get("assetdir", ""))
        found = self.file.assets.at(f"{folder}/{file}" if folder and file else file) or self.file.assets.at(file)
        if found is None or not found.is_file() or found.suffix.lower() not in KINDS:
            self.file.report.add(geom.get("mesh", name), "this mesh is not there: it is left out")
            return
        own = pose(text_numbers(attributes.get("refpos"), 3, np.zeros(3)))
        if "refquat" in attributes:
            own = own @ pose((0, 0, 0), quaternion_turn(*text_numbers(attributes["refquat"], 4)))
        scale = text_numbers(attributes.get("scale"), 3, np.ones(3))
        matrix = local @ np.linalg.inv(own) @ np.diag([*scale, 1.0])
        try:
            self.builder.add("", matrix, whole_mesh(found, False), parent=parent, name=name)
        except UniSGError:
            self.file.report.add(geom.get("mesh", name), "this mesh cannot be read: it is left out")

    def _add_joints(self, body: Element, uid: str, childclass: str) -> None:
        joints = [self.defaults.of(each, childclass) for each in body.iterfind("joint")]
        joints += [{"type": "free", **each.attrib} for each in body.iterfind("freejoint")]
        for joint in joints:
            kind = JOINTS.get(joint.get("type", "hinge"), "revolute")
            low, high = -np.inf, np.inf
            if "range" in joint and joint.get("limited") != "false" and kind in ("revolute", "prismatic"):
                low, high = text_numbers(joint["range"], 2) * (self._radian if kind == "revolute" else 1.0)
            axis = text_numbers(joint.get("axis"), 3, np.array([0.0, 0, 1]))
            anchor = text_numbers(joint.get("pos"), 3, np.zeros(3))
            name = joint.get("name", "")
            self.joints.append(
                Joint(uid, name, kind, tuple(axis.tolist()), tuple(anchor.tolist()), float(low), float(high))
            )

    @property
    def _radian(self) -> float:
        """Radians of one unit of angle."""
        return float(np.pi / 180) if self.degrees else 1.0

    def _pose(self, said: Mapping[str, str]) -> Array:
        """The frame of an element, by whichever way it tells its turn."""
        place, turn = text_numbers(said.get("pos"), 3, np.zeros(3)), np.eye(3)
        if "quat" in said:
            turn = quaternion_turn(*text_numbers(said["quat"], 4))
        elif "axisangle" in said:
            values = text_numbers(said["axisangle"], 4)
            half, axis = values[3] * self._radian / 2, values[:3] / (np.linalg.norm(values[:3]) or 1.0)
            turn = quaternion_turn(np.cos(half), *(np.sin(half) * axis))
        elif "euler" in said:
            turn = self._euler(text_numbers(said["euler"], 3) * self._radian)
        elif "xyaxes" in said:
            turn = _two_axes(text_numbers(said["xyaxes"], 6))
        elif "zaxis" in said:
            turn = _shortest(text_numbers(said["zaxis"], 3))
        return pose(place, turn)

    def _euler(self, angles: Array) -> Array:
        """Lower-case axes of the sequence turn with the body, upper-case ones stay."""
        sequence, turn = self.compiler.get("eulerseq", "xyz"), np.eye(3)
        for axis, angle in zip(numbers_of_axes(sequence), angles, strict=True):
            step = euler_turn(axis.lower(), (angle,))
            turn = turn @ step if axis.islower() else step @ turn
        return turn


def numbers_of_axes(sequence: str) -> str:
    """The axes of an Euler sequence; ValueError if they are not three of x, y, z."""
    if len(sequence) != 3 or set(sequence.lower()) - set("xyz"):
        raise ValueError(f"{sequence!r} is no sequence of axes")
    return sequence


def _name(asset: Element) -> str:
    return asset.get("name") or Path(asset.get("file", "")).stem


def _sizes(kind: str, size: list[float]) -> list[float]:
    """MuJoCo's half sizes as those of :func:`~.shapes.shape`."""
    if kind == "plane":
        return [2 * (each or PLANE) for each in (*size, 0.0, 0.0)[:2]]
    if kind in ("capsule", "cylinder"):
        return [size[0], 2 * size[1]]
    if kind == "box":
        return [2 * each for each in size[:3]]
    return size[: 3 if kind == "ellipsoid" else 1]


def _between(ends: Array) -> tuple[Array, float]:
    """The frame in the middle of two points, z along them, and half their distance."""
    step = ends[3:] - ends[:3]
    return pose((ends[:3] + ends[3:]) / 2, _shortest(step)), float(np.linalg.norm(step) / 2)


def _shortest(direction: Array) -> Array:
    """The least turn that takes z to a direction."""
    z = numbers(direction, 3) / (np.linalg.norm(direction) or 1.0)
    if z[2] < -1 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    return quaternion_turn(1 + z[2], -z[1], z[0], 0.0)


def _two_axes(values: Array) -> Array:
    x = values[:3] / (np.linalg.norm(values[:3]) or 1.0)
    y = values[3:] - (values[3:] @ x) * x
    y = y / (np.linalg.norm(y) or 1.0)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def _metadata(path: Path) -> dict[str, str]:
    """Categories by body."""
    beside = path.with_name(f"{path.stem}_metadata.json")
    if not beside.is_file():
        return {}
    objects = json.loads(beside.read_text("utf-8")).get("objects", {})
    return {name: str(said.get("category", "")) for name, said in objects.items()}
