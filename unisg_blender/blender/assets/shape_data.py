"""Objects and collections that give new things their shape: found, or taken from another file, and read."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy

from ...errors import UniSGError
from ...scene import SceneGraph
from ..read.scene_reader import read_collection

OBJECT, COLLECTION = "OBJECT", "COLLECTION"
COLUMN = {OBJECT: "objects", COLLECTION: "collections"}
HOLDER = "unisg_holds"
"""Marks a collection that was made to show one object: it is in no scene."""


@dataclass(frozen=True)
class ShapeData:
    """An object or a collection by ``kind`` and ``name``; ``path`` is the file that it is linked from, "" for this one.

    ``take`` is the file that it is to be taken from first, "" where it is here already.
    """

    kind: str
    name: str
    path: str = ""
    take: str = ""

    @property
    def text(self) -> str:
        """The same as a text, see :func:`from_text`."""
        return json.dumps([self.kind, self.name, self.path, self.take])

    def found(self) -> bpy.types.Object | bpy.types.Collection | None:
        """It, None where it is not here."""
        for item in getattr(bpy.data, COLUMN[self.kind]):
            if item.name == self.name and _library(item) == self.path:
                return item
        return None


def from_text(text: str) -> ShapeData:
    """What :attr:`ShapeData.text` said."""
    return ShapeData(*json.loads(text))


def _library(item: bpy.types.ID) -> str:
    return bpy.path.abspath(item.library.filepath) if item.library else ""


def taken(shape: ShapeData, link: bool) -> ShapeData:
    """A shape that is here: linked, or appended, from the file that it is in; as it was if it is here already.

    Raises
    ------
    UniSGError
        If the file has gone, or has no such thing any more.
    """
    if not shape.take:
        return shape
    here = ShapeData(shape.kind, shape.name, shape.take if link else "")
    if link and here.found() is not None:
        return here
    column = COLUMN[shape.kind]
    try:
        with bpy.data.libraries.load(shape.take, link=link) as (there, wanted):
            if shape.name in getattr(there, column):
                setattr(wanted, column, [shape.name])
    except OSError as error:
        raise UniSGError(f"{shape.take} cannot be read: look through the asset libraries again") from error
    (item,) = getattr(wanted, column) or [None]
    if item is None:
        raise UniSGError(f"{shape.take} has no {shape.name!r} any more: look through the asset libraries again")
    return ShapeData(shape.kind, item.name, here.path)


def as_shown(shape: ShapeData) -> ShapeData:
    """A shape that a linked duplicate, or an instance, shows whole.

    An object with modifiers, or with others below it, becomes a collection of its own that is in no scene.
    """
    item = shape.found()
    if shape.kind == COLLECTION or item is None or not (item.modifiers or item.children or item.type != "MESH"):
        return shape
    for held in bpy.data.collections:
        if held.get(HOLDER) == shape.text:
            return ShapeData(COLLECTION, held.name)
    holder = bpy.data.collections.new(item.name)
    holder[HOLDER] = shape.text
    holder.instance_offset = item.matrix_world.translation
    for part in (item, *item.children_recursive):
        holder.objects.link(part)
    return ShapeData(COLLECTION, holder.name)


def read_shape(shape: ShapeData, scene: bpy.types.Scene) -> SceneGraph:
    """What a shape shows, in metres by a scene's unit, as modifiers leave it.

    Raises
    ------
    UniSGError
        If it is not here, or has no mesh.
    """
    item = shape.found()
    if item is None:
        raise UniSGError(f"{shape.name!r} is no {shape.kind.lower()} of this file")
    with _in_scene(item, scene) as collection:
        graph = read_collection(collection, scene)
    if not (graph.mesh >= 0).any():
        raise UniSGError(f"the {shape.kind.lower()} {shape.name!r} shows nothing that could be placed")
    return graph


@contextmanager
def _in_scene(item: bpy.types.Object | bpy.types.Collection, scene: bpy.types.Scene) -> Iterator[bpy.types.Collection]:
    """A collection with what is read; where modifiers change that it is in the scene meanwhile, to be evaluated."""
    alone = isinstance(item, bpy.types.Object)
    collection = bpy.data.collections.new(item.name) if alone else item
    if alone:
        collection.objects.link(item)
        collection.instance_offset = item.matrix_world.translation
    changed = any(each.modifiers for each in collection.all_objects)
    changed = changed and collection.name not in scene.collection.children
    if changed:
        scene.collection.children.link(collection)
    try:
        yield collection
    finally:
        if changed:
            scene.collection.children.unlink(collection)
        if alone:
            bpy.data.collections.remove(collection)
