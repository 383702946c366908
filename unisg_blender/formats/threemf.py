"""3MF: objects of triangles, what they are composed of, and what is to be built, in the unit that the file names.

3MF Consortium, "3MF Core Specification", version 1.3. Parts in other files of the package are not followed.
"""

from __future__ import annotations

import zipfile
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from ..errors import UniSGError
from ..scene import Mesh, mesh_from_faces
from .axes import Array, numbers
from .collada import Part
from .plain_xml import parse_xml

UNITS = {"micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "inch": 0.0254, "foot": 0.3048, "meter": 1.0}
LONGEST = 1 << 28
DEEPEST = 30
MOST_PARTS = 100_000


def threemf_parts(path: Path) -> list[Part]:
    """What a file says is to be built, in metres, z up.

    Raises
    ------
    UniSGError
        If it is no such file, or its objects are within each other.
    """
    try:
        with zipfile.ZipFile(path) as package:
            name = next((each for each in package.namelist() if each.lower().endswith(".model")), "")
            if not name or package.getinfo(name).file_size > LONGEST:
                raise UniSGError(f"cannot read {path}: it has no model, or one of more than {LONGEST >> 20} MB")
            root = parse_xml(package.read(name), path)
    except (zipfile.BadZipFile, zipfile.LargeZipFile, NotImplementedError, RuntimeError) as error:
        raise UniSGError(f"cannot read {path}: {error}") from None
    metre = UNITS.get(root.get("unit", "millimeter"), 1e-3)
    objects = {each.get("id", ""): each for each in root.findall("resources/object")}
    meshes = {key: _mesh(each) for key, each in objects.items() if each.find("mesh") is not None}
    found: list[Part] = []

    def add(key: str, matrix: Array, depth: int) -> None:
        """Add an object, and what it is composed of."""
        if depth > DEEPEST or len(found) > MOST_PARTS:
            raise UniSGError(f"cannot read {path}: its objects are nested too deeply, or too many")
        if key in meshes:
            found.append((objects[key].get("name") or f"Object {key}", matrix, meshes[key]))
        for part in objects[key].findall("components/component") if key in objects else ():
            add(part.get("objectid", ""), matrix @ _matrix(part), depth + 1)

    for item in root.findall("build/item"):
        add(item.get("objectid", ""), np.diag([metre, metre, metre, 1.0]) @ _matrix(item), 0)
    return found


def _matrix(element: Element) -> Array:
    """Twelve numbers, of the matrix whose rows are columns here."""
    text, matrix = element.get("transform"), np.eye(4)
    if text:
        matrix[:3, :] = numbers(text.split(), 12).reshape(4, 3).T
    return matrix


def _mesh(element: Element) -> Mesh:
    points = [[float(each.get(axis, "0")) for axis in "xyz"] for each in element.iterfind("mesh/vertices/vertex")]
    faces = [
        [int(each.get(key, "0")) for key in ("v1", "v2", "v3")] for each in element.iterfind("mesh/triangles/triangle")
    ]
    array = np.array(faces, np.int64).reshape(-1, 3)
    if len(array) and (array.min() < 0 or array.max() >= len(points)):
        raise ValueError("a triangle has corners that are not there")
    return mesh_from_faces(element.get("name") or "Mesh", np.array(points, np.float64).reshape(-1, 3), array)
