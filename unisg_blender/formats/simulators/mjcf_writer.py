"""A scene as MJCF: one file, and beside it a folder with the meshes that are seen. MuJoCo loads it without a warning.

Things move as :func:`~...spatial.bodies.simulated_scene` says, or the scene's own component ``rigid_bodies``. Of each
body the meshes are seen and collide with nothing; what collides are boxes or the convex pieces of their parts, whose
corners stand in the file. Categories are in ``<name>_metadata.json``, as MolmoSpaces has them.
"""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from ...runtime.atomic_files import replacing
from ...runtime.file_endings import MJCF, is_of
from ...runtime.made_files import filling
from ...runtime.read_report import ReadReport
from ...scene import SceneGraph
from ...scene.components import RIGID_BODIES
from ...scene.hierarchy import world_matrices
from ...spatial.bodies import simulated_scene
from .mjcf_geoms import BodyGeoms, Frame, pose_attributes

ASSETS = ".assets"
LEFT_OUT = ("actions", "lsa", "relations", "animation", "camera", "light", "joints", "instances")


def is_mjcf(path: Path) -> bool:
    """Whether a file's name says that it is MJCF to be written."""
    return is_of(path, MJCF)


def write_mjcf(graph: SceneGraph, path: Path) -> ReadReport:
    """Write a scene; returns what the format cannot hold. UniSGError if the files cannot be written."""
    report, scene = ReadReport(), simulated_scene(graph)
    stem = path.name.rpartition(".")[0]
    root = Element("mujoco", model=scene.title or stem)
    SubElement(root, "compiler", angle="radian", meshdir=stem + ASSETS)
    geoms = BodyGeoms(scene, SubElement(root, "asset"), report)
    categories = _write_bodies(scene, SubElement(root, "worldbody"), geoms)
    ElementTree.indent(root)
    with (
        replacing(path) as unfinished,
        replacing(path.with_name(f"{stem}_metadata.json")) as metadata,
        filling(path.with_name(stem + ASSETS)) as folder,
    ):
        for name, text in geoms.files.items():
            (folder / name).write_text(text, "utf-8")
        metadata.write_text(json.dumps({"objects": {name: {"category": kind} for name, kind in categories.items()}}))
        ElementTree.ElementTree(root).write(unfinished, "utf-8", xml_declaration=True)
    for name in LEFT_OUT:
        if name in scene.components:
            report.add("", f"{name} are not written to MJCF")
    return report


def _write_bodies(scene: SceneGraph, world: Element, geoms: BodyGeoms) -> dict[str, str]:
    """A body for each thing: those that move in the world, others within what they hang under. Category by body."""
    names, frames = _names(scene), Frame.of(world_matrices(scene))
    kinds = {row: kind for row, kind in scene.entries(RIGID_BODIES, "kind")}
    elements: dict[int, tuple[Element, int]] = {}
    categories, moving = {}, set()
    for row, parent in enumerate(scene.parent.tolist()):  # parents come first
        above, place = elements.get(parent, (world, -1))
        own = scene.category[row] >= 0 or kinds.get(row) == "active" or (scene.mesh[row] >= 0 and place < 0)
        if own:
            pose = frames.relative(row, place)
            element = SubElement(above, "body", {"name": names[row]} | pose_attributes(pose))
            if kinds.get(row) == "active" and above is world:
                SubElement(element, "freejoint")
                moving.add(row)
            elif place in moving:
                moving.add(row)
            if scene.category[row] >= 0:
                categories[names[row]] = scene.category_name(row)
            elements[row] = (element, row)
        else:
            elements[row] = (above, place)
        if scene.mesh[row] >= 0:
            geoms.add(elements[row][0], row, frames, elements[row][1], elements[row][1] in moving)
    _drop_empty(world)
    there = {body.get("name") for body in world.iter("body")}
    return {name: kind for name, kind in categories.items() if name in there}


def _names(scene: SceneGraph) -> list[str]:
    """The entities' names, those that are not unique with their uid."""
    count: dict[str, int] = {}
    for name in scene.name:
        count[name] = count.get(name, 0) + 1
    return [
        name if count[name] == 1 and name != "world" else f"{name} {uid}"
        for name, uid in zip(scene.name, scene.uid, strict=True)
    ]


def _drop_empty(element: Element) -> bool:
    """Leave out bodies without any shape, which MuJoCo refuses where they move; whether there is nothing in it."""
    for child in [child for child in element if child.tag == "body" and _drop_empty(child)]:
        element.remove(child)
    return not any(child.tag in ("geom", "body") for child in element)
