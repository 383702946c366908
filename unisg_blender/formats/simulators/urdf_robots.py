"""URDF: the links of a robot, or of a room described as one, at rest, each below the link that its joint hangs it from.

Right-handed, z up, metres, radians; roll, pitch and yaw about fixed axes. Joints are kept as the component ``joints``.
http://wiki.ros.org/urdf/XML.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import UniSGError
from ...scene import SceneGraph
from ..axes import Array, fixed_turn, pose
from ..layout_file import LayoutFile, is_xml
from ..room_builder import RoomBuilder
from .joints import Joint, with_joints
from .robot_shapes import RobotShapes
from .shapes import text_numbers

NAME = "URDF"
LICENCE = ""
KINDS = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic", "floating": "free"}


def recognises(data: Any) -> bool:
    """Whether its root is a robot."""
    return is_xml(data, "robot")


def scenes(file: LayoutFile) -> Iterator[SceneGraph]:
    """The robot; UniSGError if its joints go around in a circle."""
    builder = RoomBuilder(file.title)
    shapes, numbers_of = RobotShapes(file, builder), dict[str, int]()
    links = {link.get("name", ""): link for link in file.data.iterfind("link")}
    joints = {_end(joint, "child"): joint for joint in file.data.iterfind("joint")}
    found: list[Joint] = []
    for first in links:
        chain = [first]
        while (joint := joints.get(chain[-1])) is not None and chain[-1] not in numbers_of:
            chain.append(_end(joint, "parent"))
            if len(chain) > len(links) + 1 or chain[-1] not in links:
                raise UniSGError(f"the joint {joint.get('name')!r} hangs from a link that is not there, or from itself")
        for name in reversed(chain):
            if name not in numbers_of:
                joint = joints.get(name)
                parent, local = -1, np.eye(4)
                if joint is not None:
                    parent, local = numbers_of[_end(joint, "parent")], _origin(joint.find("origin"))
                    found.append(_joint(name, joint))
                numbers_of[name] = builder.add("", local, name=name, uid=name, parent=parent)
                for visual in links[name].iterfind("visual"):
                    shapes.add(visual, _origin(visual.find("origin")), numbers_of[name])
    file.report.add("", "categories and what stands on what are not told")
    yield with_joints(builder.build(), found)


def _end(joint: Element, side: str) -> str:
    found = joint.find(side)
    return "" if found is None else found.get("link", "")


def _joint(child: str, joint: Element) -> Joint:
    axis, limit = joint.find("axis"), joint.find("limit")
    kind = KINDS.get(joint.get("type", ""), "fixed")
    low, high = -np.inf, np.inf
    if limit is not None and joint.get("type") != "continuous":
        low, high = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
    direction = text_numbers(None if axis is None else axis.get("xyz"), 3, np.array([1.0, 0, 0]))
    return Joint(child, joint.get("name", ""), kind, tuple(direction.tolist()), (0.0, 0.0, 0.0), low, high)


def _origin(element: Element | None) -> Array:
    if element is None:
        return np.eye(4)
    zero = np.zeros(3)
    return pose(text_numbers(element.get("xyz"), 3, zero), fixed_turn(*text_numbers(element.get("rpy"), 3, zero)))
