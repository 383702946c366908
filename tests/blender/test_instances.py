"""Collection instances and what geometry nodes draw: kept, realized, written back."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from tests.blender.helpers import add, assert_same_scene, box, relative_gap
from unisg_blender.blender import ReadReport, read_scene, write_scene
from unisg_blender.scene import world_matrices
from unisg_blender.scene.realize_instances import realize


def drawn_boxes() -> np.ndarray:
    """World matrices of everything Blender draws from mesh objects, instances included, sorted."""
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    found = [
        np.array(drawn.matrix_world).ravel()
        for drawn in depsgraph.object_instances
        if drawn.object.type == "MESH" and len(drawn.object.data.polygons)
    ]
    return np.array(sorted(map(tuple, found)))


def meshes_of(graph) -> np.ndarray:
    rows = np.flatnonzero(graph.mesh >= 0)
    rows = [row for row in rows if len(graph.meshes[graph.mesh[row]].offsets) > 1]
    return np.array(sorted(tuple(world.ravel()) for world in world_matrices(graph)[rows]))


def nested_collections() -> None:
    """A collection with a hierarchy, inside another one, twice in the scene: turned, scaled and mirrored."""
    inner, outer = bpy.data.collections.new("Inner"), bpy.data.collections.new("Outer")
    parent, child = bpy.data.objects.new("Parent", box()), bpy.data.objects.new("Child", box("Small", 0.3))
    child.parent = parent
    parent.location, parent.rotation_euler, child.location = (1, 0, 0.5), (0.3, 0.2, 0.1), (0, 0, 1)
    parent["unisg_category"] = "Box"
    for item in (parent, child):
        inner.objects.link(item)
    inner.instance_offset = (0.5, 0.25, 0)
    holder = bpy.data.objects.new("Holder", None)
    holder.instance_type, holder.instance_collection, holder.location = "COLLECTION", inner, (0, 3, 0)
    outer.objects.link(holder)
    for number, scale in enumerate([(1, 1, 1), (-2, 1, 0.5)]):
        item = add(f"Instance {number}")
        item.instance_type, item.instance_collection = "COLLECTION", outer
        item.location, item.rotation_euler, item.scale = (number * 5, 0, 0), (0.1, number, 0), scale


def test_collections_are_kept_once_and_come_back() -> None:
    nested_collections()
    graph = read_scene()
    assert len(graph) == 2
    entries = graph.components["instances"]
    assert entries.columns["prototype"][0] is entries.columns["prototype"][1]
    prototype = entries.columns["prototype"][0]
    assert prototype.name == ("Holder",)
    assert prototype.components["instances"].columns["prototype"][0]["Parent"].category == "Box"
    expected = drawn_boxes()
    again = write_scene(graph)
    assert_same_scene(graph, read_scene(again))
    bpy.context.window.scene = again
    assert relative_gap(drawn_boxes(), expected) < 1e-5


def test_realized_instances_stand_where_blender_draws_them() -> None:
    nested_collections()
    graph = read_scene(instances="realized")
    assert "instances" not in graph.components
    assert len(graph) == 2 + 2 * 3
    assert len(set(graph.uid)) == len(graph)
    assert len(graph.meshes) == 2
    assert relative_gap(meshes_of(graph), drawn_boxes()) < 1e-5
    assert graph.uid == realize(read_scene()).uid


def instance_on_points(item: bpy.types.Object, source: bpy.types.Object) -> None:
    """A modifier that puts a cube of its own, and another object, on every point."""
    tree = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    nodes, link = tree.nodes, tree.links.new
    start, end, join = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput"), nodes.new("GeometryNodeJoinGeometry")
    cube, info = nodes.new("GeometryNodeMeshCube"), nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = source, True
    for geometry in (cube.outputs["Mesh"], info.outputs["Geometry"]):
        place = nodes.new("GeometryNodeInstanceOnPoints")
        place.inputs["Scale"].default_value = (0.1, 0.2, 0.3)
        link(start.outputs[0], place.inputs["Points"])
        link(geometry, place.inputs["Instance"])
        link(place.outputs[0], join.inputs[0])
    link(join.outputs[0], end.inputs[0])
    item.modifiers.new("Instances", "NODES").node_group = tree


def test_geometry_nodes() -> None:
    source = add("Source", box("Source"))
    grid = add("Grid", box("Grid", 4))
    grid.location, grid.rotation_euler, grid.scale = (1, 2, 3), (0.3, 0.2, 0.1), (1, -1, 2)
    instance_on_points(grid, source)
    bpy.context.view_layer.update()
    graph = read_scene()
    entries = graph["Grid"].component("instances")
    assert len(entries["matrix"]) == 16
    assert len({id(prototype) for prototype in entries["prototype"]}) == 2
    expected = drawn_boxes()
    assert relative_gap(meshes_of(realize(graph)), expected) < 1e-5
    assert "instances" not in read_scene(geometry="original").components
    again = write_scene(graph)
    assert_same_scene(graph, read_scene(again))
    bpy.context.window.scene = again
    assert relative_gap(drawn_boxes(), expected) < 1e-5


@pytest.mark.parametrize("kind", ["VERTS", "FACES"])
def test_duplication_on_vertices_and_faces(kind: str) -> None:
    above = add("Above", box("Above", 3))
    add("Below", box("Small", 0.2), above)
    above.instance_type, above.location = kind, (1, 2, 3)
    graph = read_scene()
    assert len(graph["Above"].component("instances")["matrix"]) == {"VERTS": 8, "FACES": 6}[kind]


def test_what_an_instanced_collection_draws_itself_is_reported() -> None:
    collection = bpy.data.collections.new("Inner")
    grid = bpy.data.objects.new("Grid", box("Grid", 4))
    collection.objects.link(grid)
    instance_on_points(grid, add("Source", box("Source")))
    item = add("Instance")
    item.instance_type, item.instance_collection = "COLLECTION", collection
    report = ReadReport()
    read_scene(report=report)
    assert "Grid: instances that it may draw inside an instanced collection are not read" in list(report)


def bevelled_curve(name: str) -> bpy.types.Object:
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.1
    curve.splines.new("POLY").points.add(2)
    for place, point in enumerate(curve.splines[0].points):
        point.co = (place, place * place, 0, 1)
    return add(name, curve)


def text(name: str) -> bpy.types.Object:
    letters = bpy.data.curves.new(name, "FONT")
    letters.body, letters.extrude = "Exit", 0.05
    letters.follow_curve = add(f"{name} line", bpy.data.curves.new("Line", "CURVE"))
    return add(name, letters)


def surface(name: str) -> bpy.types.Object:
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    bpy.context.object.name = name
    return bpy.context.object


def metaballs(name: str) -> bpy.types.Object:
    """Two of one family: Blender makes one mesh of both and gives it to the first."""
    for number in range(2):
        bpy.ops.object.metaball_add(location=(number, 0, 0))
        bpy.context.object.name = f"{name}.{number:03d}" if number else name
    return bpy.data.objects[name]


CURVE_LIKE = {"CURVE": bevelled_curve, "FONT": text, "SURFACE": surface, "META": metaballs}


@pytest.mark.parametrize("kind", CURVE_LIKE)
def test_a_curve_and_its_like_are_read_once(kind: str) -> None:
    item = CURVE_LIKE[kind]("Pipe")
    item.location = (0, 0, 2)
    graph = read_scene()
    assert graph.name.count("Pipe") == 1
    assert "instances" not in graph.components
    assert graph["Pipe"].type == kind
    expected = drawn_boxes()
    assert len(expected) == 1
    assert relative_gap(meshes_of(graph), expected) < 1e-6
    again = write_scene(graph)
    assert len(again.objects) == len(graph)
    bpy.context.window.scene = again
    assert relative_gap(drawn_boxes(), expected) < 1e-6


@pytest.mark.parametrize("itself", [False, True])
def test_nodes_draw_a_curve_once(itself: bool) -> None:
    pipe = bevelled_curve("Pipe")
    instance_on_points(pipe if itself else add("Above", box("Above", 3)), add("Source", box()) if itself else pipe)
    bpy.context.view_layer.update()
    assert relative_gap(meshes_of(realize(read_scene())), drawn_boxes()) < 1e-5


@pytest.mark.parametrize("instancer", ["vertices", "particles"])
def test_an_instanced_curve_is_drawn_once(instancer: str) -> None:
    pipe, above = bevelled_curve("Pipe"), add("Above", box("Above", 3))
    if instancer == "vertices":
        pipe.parent, above.instance_type = above, "VERTS"
    else:
        above.modifiers.new("Hair", "PARTICLE_SYSTEM")
        settings = above.particle_systems[0].settings
        settings.type, settings.count, settings.use_advanced_hair = "HAIR", 8, True
        settings.render_type, settings.instance_object = "OBJECT", pipe
    graph = read_scene()
    drawn = graph["Above"].component("instances")["prototype"]
    assert [prototype.meshes for prototype in drawn] == [(graph["Pipe"].mesh,)] * 8


def test_points_that_nodes_make_are_kept_and_curves_reported() -> None:
    grid = add("Grid", box("Grid"))
    tree = bpy.data.node_groups.new("Parts", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    nodes = ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeJoinGeometry")
    entry, leave, join = map(tree.nodes.new, nodes)
    for kind in ("GeometryNodeMeshToPoints", "GeometryNodeMeshToCurve"):
        node = tree.nodes.new(kind)
        tree.links.new(entry.outputs[0], node.inputs[0])
        tree.links.new(node.outputs[0], join.inputs[0])
    tree.links.new(entry.outputs[0], join.inputs[0])
    tree.links.new(join.outputs[0], leave.inputs[0])
    grid.modifiers.new("Parts", "NODES").node_group = tree
    report = ReadReport()
    graph = read_scene(report=report)
    (prototype,) = graph["Grid"].component("instances")["prototype"]
    assert len(graph["Grid"].mesh.points) == len(prototype.meshes[0].points) == 8
    assert "Grid: geometry of type curve in it is not read" in list(report)
