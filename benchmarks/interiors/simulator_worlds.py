"""Worlds of robot simulators (SDF) and rooms described as robots (URDF) as scenegraphs; needs trimesh, pycollada."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import trimesh

from unisg_blender.scene import Mesh, SceneBuilder, SceneGraph, mesh_from_faces


def read_world(path: Path, root: Path, others: tuple[Path, ...] = ()) -> SceneGraph:
    """The scene of an SDF world or model, of a COLLADA file, or of a URDF file under ``root``.

    Models that it names are looked for under ``root``, then under ``others``.
    """
    builder, files = SceneBuilder(path.stem), _models((root, *others), (path.parent, path.parent.parent))
    if path.suffix.lower() in (".dae", ".obj", ".stl"):
        _add_file(builder, path.stem, path, np.eye(4), -1)
        return builder.build()
    tree = ElementTree.fromstring(path.read_text("utf8").strip())
    if path.suffix.lower() == ".urdf":
        _add_robot(builder, tree, files)
        return builder.build()
    world = tree.find("world")
    top = tree if world is None else world
    saved = {
        model.get("name", ""): _pose(model.find("pose")) for model in top.iterfind("state/model")
    }  # fmt: skip
    for element in top:
        _add_model(builder, element, np.eye(4), -1, files, saved)
    return builder.build()


Files = Callable[[str], Path]


def _models(roots: tuple[Path, ...], beside: tuple[Path, ...]) -> Files:
    """Finds what ``model://name/path`` and ``package://name/path`` mean, and what lies beside the world."""
    folders: dict[str, Path] = {}
    for root in reversed(roots):
        for found in sorted((*root.rglob("model.config"), *root.rglob("package.xml")), reverse=True):
            folders[found.parent.name] = found.parent

    def find(uri: str) -> Path:
        place = re.sub(r"^(model|package|file)://|^https?://.*/models/", "", uri.strip())
        place = place.replace("Ground Plane", "ground_plane")
        name, _, rest = place.partition("/")
        known = [folders[name] / rest] if name in folders else []
        places = [*known, *(folder / place for folder in (roots[0], *beside))]
        return next((found for found in places if found.exists()), places[0])

    return find


def _add_model(
    builder: SceneBuilder, element: ElementTree.Element, above: np.ndarray, parent: int, files: Files,
    saved: dict[str, np.ndarray] | None = None,
) -> None:  # fmt: skip
    """A <model> or an <include>, with its links and models."""
    if element.tag == "include":
        _add_include(builder, element, above, parent, files, saved or {})
    elif element.tag == "model":
        name = element.get("name", "model")
        local = (saved or {}).get(name, above @ _pose(element.find("pose")))
        number = builder.add(name, uid=f"{len(builder._names)} {name}", parent=parent, local=local)
        for link in element.iterfind("link"):
            for visual in link.iterfind("visual"):
                _add_visual(builder, visual, _pose(link.find("pose")) @ _pose(visual.find("pose")), number, files)
        for inner in element:
            _add_model(builder, inner, np.eye(4), number, files)


def _add_include(
    builder: SceneBuilder, element: ElementTree.Element, above: np.ndarray, parent: int, files: Files,
    saved: dict[str, np.ndarray],
) -> None:  # fmt: skip
    sdf = files(element.findtext("uri", "")) / "model.sdf"
    if not sdf.is_file():
        return
    model = ElementTree.fromstring(sdf.read_text("utf8").strip()).find("model")
    if model is None:
        return
    if element.findtext("name"):
        model.set("name", element.findtext("name", "").strip())
    if element.find("pose") is not None:
        above = above @ _pose(element.find("pose"))
        old = model.find("pose")
        if old is not None:
            model.remove(old)
    _add_model(builder, model, above, parent, files, saved)


def _add_visual(
    builder: SceneBuilder, visual: ElementTree.Element, local: np.ndarray, parent: int, files: Files
) -> None:
    """A shape, or the meshes of a file."""
    name = visual.get("name", "visual")
    for shape in visual.iterfind("geometry/*"):
        if shape.tag == "mesh":
            path = files(shape.findtext("uri", shape.get("filename", "")))
            scale = _numbers(shape.findtext("scale", shape.get("scale", "1 1 1")))
            if path.is_file():
                _add_file(builder, name, path, local @ np.diag([*scale, 1.0]), parent)
        else:
            found = _primitive(shape)
            if found is not None:
                points, faces = np.asarray(found.vertices), np.asarray(found.faces)
                mesh = mesh_from_faces(name, points, faces)
                builder.add(name, uid=f"{len(builder._names)} {name}", parent=parent, local=local, mesh=mesh)


def _primitive(shape: ElementTree.Element) -> trimesh.Trimesh | None:
    def value(key: str, default: str) -> str:
        return shape.findtext(key, shape.get(key, default))

    if shape.tag == "box":
        return trimesh.creation.box(_numbers(value("size", "1 1 1")))
    if shape.tag == "cylinder":
        return trimesh.creation.cylinder(float(value("radius", "1")), float(value("length", "1")), sections=24)
    if shape.tag == "sphere":
        return trimesh.creation.uv_sphere(float(value("radius", "1")), count=(12, 12))
    if shape.tag == "plane":
        x, y = _numbers(value("size", "1 1")) / 2
        points = [[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]]
        return trimesh.Trimesh(points, [[0, 1, 2], [0, 2, 3]], process=False)
    return None


def _add_file(builder: SceneBuilder, name: str, path: Path, local: np.ndarray, parent: int) -> None:
    for part, matrix, mesh in _meshes_of(path):
        builder.add(part or name, uid=f"{len(builder._names)} {name}", parent=parent, local=local @ matrix, mesh=mesh)


@lru_cache(None)
def _meshes_of(path: Path) -> tuple[tuple[str, np.ndarray, Mesh], ...]:
    """Names, matrices to metres, and meshes of a file, each mesh once; which axis is up is not asked, as in Gazebo."""
    head = path.read_bytes()[:20_000].decode("utf8", "ignore") if path.suffix.lower() == ".dae" else ""
    unit = re.search(r'<unit[^>]*meter="([^"]+)"', head)
    base = np.diag([float(unit.group(1))] * 3 + [1.0]) if unit else np.eye(4)
    loaded = trimesh.load_scene(path, process=False)
    meshes = {
        key: mesh_from_faces(key, np.asarray(part.vertices), np.asarray(part.faces))
        for key, part in loaded.geometry.items()
        if hasattr(part, "faces") and len(part.faces)
    }
    found = []
    for node in loaded.graph.nodes_geometry:
        matrix, key = loaded.graph[node]
        if key in meshes:
            found.append((str(node), base @ matrix, meshes[key]))
    return tuple(found)


def _add_robot(builder: SceneBuilder, robot: ElementTree.Element, files: Files) -> None:
    """The links of a URDF at rest, each under the link that its joint hangs it from."""
    joints = {joint.find("child").get("link"): joint for joint in robot.iterfind("joint")}
    links = {link.get("name"): link for link in robot.iterfind("link")}
    numbers: dict[str, int] = {}

    def add(name: str) -> int:
        if name not in numbers:
            joint, parent, local = joints.get(name), -1, np.eye(4)
            if joint is not None:
                parent, local = add(joint.find("parent").get("link")), _origin(joint.find("origin"))
            number = builder.add(name, uid=f"{len(builder._names)} {name}", parent=parent, local=local)
            numbers[name] = number
            for visual in links[name].iterfind("visual"):
                _add_visual(builder, visual, _origin(visual.find("origin")), number, files)
        return numbers[name]

    for name in links:
        add(name)


def _origin(element: ElementTree.Element | None) -> np.ndarray:
    if element is None:
        return np.eye(4)
    return _matrix(np.concatenate([_numbers(element.get("xyz", "0 0 0")), _numbers(element.get("rpy", "0 0 0"))]))


def _pose(element: ElementTree.Element | None) -> np.ndarray:
    return np.eye(4) if element is None or not (element.text or "").strip() else _matrix(_numbers(element.text or ""))


def _matrix(pose: np.ndarray) -> np.ndarray:
    """Translation and roll, pitch, yaw (6,) as a matrix."""
    matrix = trimesh.transformations.euler_matrix(*pose[3:6], "sxyz")
    matrix[:3, 3] = pose[:3]
    return matrix


def _numbers(text: str) -> np.ndarray:
    return np.array([float(part) for part in text.split()])
