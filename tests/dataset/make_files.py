"""Runs inside Blender: writes scene files that are made of other files, and one with instances of all kinds."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy


def cube(name: str, size: float) -> bpy.types.Object:
    """A cube that is in no scene yet."""
    mesh = bpy.data.meshes.new(name)
    corners = [(x * size, y * size, z * size) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata(corners, [], faces)
    return bpy.data.objects.new(name, mesh)


def empty_file() -> None:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def save(path: Path) -> None:
    bpy.ops.wm.save_as_mainfile(filepath=str(path), relative_remap=True)


def library(path: Path) -> None:
    """A file with a collection of a chair."""
    empty_file()
    chairs = bpy.data.collections.new("Chairs")
    bpy.context.scene.collection.children.link(chairs)
    chairs.objects.link(cube("Chair", 0.5))
    save(path)


def hall(path: Path, chairs: Path) -> None:
    """A linked collection shown twice, and a book that geometry nodes put on the corners of a shelf."""
    empty_file()
    with bpy.data.libraries.load(str(chairs), link=True) as (_, wanted):
        wanted.collections = ["Chairs"]
    for number in range(2):
        shown = bpy.data.objects.new(f"Chairs.{number}", None)
        shown.instance_type, shown.instance_collection = "COLLECTION", bpy.data.collections["Chairs"]
        shown.location = (2.0 * number, 0, 0)
        bpy.context.scene.collection.objects.link(shown)
    book, shelf = cube("Book", 0.1), cube("Shelf", 1.0)
    book["unisg_category"], shelf["unisg_category"] = "Book", "Shelf"
    for item in (book, shelf):
        bpy.context.scene.collection.objects.link(item)
    shelf.modifiers.new("Books", "NODES").node_group = on_points(book)
    save(path)


def on_points(item: bpy.types.Object) -> bpy.types.NodeTree:
    """Geometry nodes that keep the mesh and put an object on each of its points."""
    tree = bpy.data.node_groups.new("Books", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    names = ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeInstanceOnPoints", "GeometryNodeObjectInfo")
    begin, end, place, info = (tree.nodes.new(name) for name in names)
    both = tree.nodes.new("GeometryNodeJoinGeometry")
    info.inputs["Object"].default_value = item
    info.inputs["As Instance"].default_value = True
    tree.links.new(begin.outputs[0], place.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], place.inputs["Instance"])
    tree.links.new(begin.outputs[0], both.inputs[0])
    tree.links.new(place.outputs[0], both.inputs[0])
    tree.links.new(both.outputs[0], end.inputs[0])
    return tree


def others(folder: Path) -> None:
    """A cube as glTF with a buffer of its own, as OBJ with materials, and as USD behind a reference."""
    import addon_utils  # is there once bpy is

    empty_file()
    addon_utils.enable("io_scene_gltf2", default_set=False)
    item = cube("Chair", 1.0)
    item.data.materials.append(bpy.data.materials.new("Wood"))
    bpy.context.scene.collection.objects.link(item)
    bpy.ops.export_scene.gltf(filepath=str(folder / "b two.gltf"), export_format="GLTF_SEPARATE")
    bpy.ops.wm.obj_export(filepath=str(folder / "c.obj"))
    (folder / "parts").mkdir()
    bpy.ops.wm.usd_export(filepath=str(folder / "parts" / "deep.usdc"))
    (folder / "parts" / "inner.usda").write_text('#usda 1.0\ndef "B" (references = @./deep.usdc@</root>) {}\n')
    text = '#usda 1.0\n(upAxis = "Z")\ndef "A" (references = @./parts/inner.usda@</B>) {}\n'
    (folder / "d.usda").write_text(text)


if __name__ == "__main__":
    target = Path(sys.argv[1])
    library(target / "lib" / "chairs.blend")
    hall(target / "in" / "a.blend", target / "lib" / "chairs.blend")
    others(target / "in")
    os._exit(0)
