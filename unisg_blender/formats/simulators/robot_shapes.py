"""What SDF and URDF have in common: visible shapes of links, files of meshes, and packages in which these lie."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import UniSGError
from ...runtime.large_file_pointer import is_pointer
from ..axes import Array, pose
from ..layout_file import LayoutFile
from ..mesh_parts import KINDS, mesh_parts
from ..room_builder import RoomBuilder
from .shapes import shape, text_numbers

SCHEMES = re.compile(r"^(model|package|file)://|^https?://.*/models/")


@dataclass(eq=False)
class RobotShapes:
    """Adds shapes to a scene; what a name such as ``model://chair`` means is looked for in the file's folders."""

    file: LayoutFile
    builder: RoomBuilder

    def place(self, uri: str) -> Path | None:
        """The file or folder of a name: below the folders, or in a folder ``models`` of theirs."""
        plain = SCHEMES.sub("", uri.strip()).lstrip("/")
        plain = plain.replace("Ground Plane", "ground_plane").replace("Sun", "sun")
        package, _, rest = plain.partition("/")
        known = self.file.assets.package(package)
        if known is not None and (known / rest).exists():
            return known / rest
        tried = [plain, f"models/{plain}"]
        for root in self.file.assets.around:
            if root.name == package:
                tried.append(f"{rest}")
        found = (self.file.assets.at(name) for name in tried if name)
        return next((place for place in found if place is not None), None)

    def add(self, visual: Element, local: Array, parent: int) -> None:
        """Add what a <visual> shows below an entity."""
        name = visual.get("name", "visual")
        for each in visual.iterfind("geometry/*"):
            if each.tag == "mesh":
                self._add_mesh(each, name, local, parent)
            elif each.tag == "polyline":
                self.file.report.add(name, "polylines are not read")
            else:
                found = _primitive(each)
                if found is None:
                    self.file.report.add(name, f"a {each.tag} is not read")
                    continue
                turn, kind, size = found
                self.builder.add("", local @ turn, shape(kind, *size), parent=parent, name=name)

    def _add_mesh(self, element: Element, name: str, local: Array, parent: int) -> None:
        uri = (element.findtext("uri") or element.get("filename") or "").strip()
        scale = text_numbers(element.findtext("scale") or element.get("scale"), 3, np.ones(3))
        path = self.place(uri)
        if path is None or not path.is_file() or path.suffix.lower() not in KINDS:
            self.file.report.add(uri, "this mesh is not there: it is left out")
            return
        try:
            parts = mesh_parts(path, upright=False)
        except UniSGError:
            why = "is only a pointer of Git LFS" if is_pointer(path) else "cannot be read"
            self.file.report.add(uri, f"this mesh {why}: it is left out")
            return
        sized = local @ np.diag([*scale, 1.0])
        for part, matrix, mesh in parts:
            self.builder.add("", sized @ matrix, mesh, parent=parent, name=part or name)


def _primitive(element: Element) -> tuple[Array, str, list[float]] | None:
    """Turn (4, 4), kind and size of a shape; None if it is none of ours."""

    def values(key: str, count: int, default: Array) -> list[float]:
        return text_numbers(element.findtext(key) or element.get(key), count, default).tolist()

    one = np.ones(1)
    match element.tag:
        case "box":
            return np.eye(4), "box", values("size", 3, np.ones(3))
        case "cylinder" | "capsule":
            return np.eye(4), element.tag, values("radius", 1, one) + values("length", 1, one)
        case "sphere":
            return np.eye(4), "sphere", values("radius", 1, one)
        case "ellipsoid":
            return np.eye(4), "ellipsoid", values("radii", 3, np.ones(3))
        case "plane":
            return _towards(values("normal", 3, np.array([0.0, 0, 1]))), "plane", values("size", 2, np.ones(2))
    return None


def _towards(normal: list[float]) -> Array:
    """A turn that takes z to a direction."""
    z = np.asarray(normal) / (np.linalg.norm(normal) or 1.0)
    x = np.cross((0.0, 1.0, 0.0) if abs(z[1]) < 0.9 else (1.0, 0.0, 0.0), z)
    x /= np.linalg.norm(x) or 1.0
    return pose((0, 0, 0), np.stack([x, np.cross(z, x), z], axis=1))
