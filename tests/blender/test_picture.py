"""Pictures show the scene in the colours of its categories, and leave the scene as it was."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from tests.blender.helpers import add, box
from tests.spatial.built_rooms import SQUARE, joined, room, slab
from unisg_blender import UniSGError
from unisg_blender.blender import RoomView, render_picture
from unisg_blender.blender.render.picture import category_colors
from unisg_blender.blender.render.room_view import _whole_patches


def pixels(path: Path) -> np.ndarray:
    image = bpy.data.images.load(str(path))
    values = np.array(image.pixels[:]).reshape(image.size[1], image.size[0], 4)
    bpy.data.images.remove(image)
    return values


def two_boxes() -> None:
    for place, category in ((-1, "Left"), (1, "Right")):
        item = add(category, box(category))
        item.location, item["unisg_category"] = (place, 0, 0), category
    bpy.context.view_layer.update()


@pytest.mark.slow
def test_the_view_from_above(tmp_path: Path) -> None:
    two_boxes()
    render_picture(tmp_path / "top.png", view="top", size=(160, 120), by_category=True)
    picture = pixels(tmp_path / "top.png")[..., :3]
    assert picture.shape == (120, 160, 3)
    left, right, corner = picture[60, 30], picture[60, 130], picture[5, 80]
    assert np.abs(left - right).max() > 0.2
    assert np.abs(left - corner).max() > 0.1


def test_the_scene_stays_as_it_was(tmp_path: Path) -> None:
    two_boxes()
    kinds = ("scenes", "objects", "cameras", "lights", "worlds", "meshes", "materials", "collections")
    before = [list(getattr(bpy.data, kind).keys()) for kind in kinds]
    colors = [tuple(item.color) for item in bpy.context.scene.objects]
    render_picture(tmp_path / "view.png", size=(80, 60))
    assert [list(getattr(bpy.data, kind).keys()) for kind in kinds] == before
    assert [tuple(item.color) for item in bpy.context.scene.objects] == colors


def test_what_cannot_be_shown(tmp_path: Path) -> None:
    with pytest.raises(UniSGError, match="nothing to show"):
        render_picture(tmp_path / "view.png")
    two_boxes()
    with pytest.raises(UniSGError, match="nothing to show"):
        render_picture(tmp_path / "view.png", leave_out=("Left", "Right"))
    with pytest.raises(UniSGError, match="does not exist"):
        render_picture(tmp_path / "no folder" / "view.png")
    assert not list(tmp_path.iterdir())


def house(name: str = "House") -> RoomView:
    """A closed house of one mesh, 5 x 4 m with walls of 0.2 m, and a red ball in its middle."""
    points, faces = joined(list(room(SQUARE, 0.2, roof=True).values()))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], faces)
    add(name, mesh)
    ball = add("Ball", box("Ball"))
    ball.location, ball.scale, ball["unisg_category"] = (2.5, 2.0, 0.5), (1.2, 1.2, 1.2), "Ball"
    add("Tree", box("Tree")).location = (9, -6, 1)
    bpy.context.view_layer.update()
    return RoomView(SQUARE, 0.0, 2.5, {name})


def test_a_look_into_a_room(tmp_path: Path) -> None:
    view = house()
    kinds = ("scenes", "objects", "meshes")
    before = [list(getattr(bpy.data, kind).keys()) for kind in kinds]
    count = len(bpy.data.objects["House"].data.polygons)
    seen = {}
    for name, room_view in (("closed", None), ("open", view)):
        render_picture(tmp_path / f"{name}.png", size=(160, 120), room=room_view, by_category=True)
        picture = pixels(tmp_path / f"{name}.png")[..., :3]
        seen[name] = (picture.max(axis=2) - picture.min(axis=2) > 0.15).mean()  # what has a strong colour: the ball
    assert seen["closed"] == 0
    assert seen["open"] > 0.01
    assert [list(getattr(bpy.data, kind).keys()) for kind in kinds] == before
    assert len(bpy.data.objects["House"].data.polygons) == count


def test_a_look_into_a_room_in_centimetres(tmp_path: Path) -> None:
    view = house()
    render_picture(tmp_path / "metres.png", size=(160, 120), room=view, by_category=True)
    scene = bpy.context.scene
    scene.unit_settings.scale_length = 0.01
    for item in scene.objects:
        item.location, item.scale = item.location * 100, item.scale * 100
    bpy.context.view_layer.update()
    render_picture(tmp_path / "centimetres.png", size=(160, 120), room=view, by_category=True)
    first, second = (pixels(tmp_path / f"{name}.png") for name in ("metres", "centimetres"))
    assert (np.abs(first - second).max(axis=2) > 0.1).mean() < 0.01


def test_ceilings_and_walls_in_front_hide_a_room() -> None:
    view = RoomView(SQUARE, 0.0, 2.5, ())
    over, in_front = [[2.5, 2, 2.5], [2.5, 2, 2.6]], [[5, 2, 1.2], [2.5, 0, 1.2], [2.5, -0.2, 1.2]]
    seen = [[0, 2, 1.2], [2.5, 4, 1.2], [2.5, 2, 0], [2.5, 0, 0], [2.5, 0.5, 0.7]]
    faces = np.array([*over, *in_front, *seen], float)
    hidden = view.hides(faces, np.array([-0.55, 0.75, -0.75]))
    assert hidden.tolist() == [True, True, True, True, True, False, False, False, False, False]


def test_things_have_their_own_materials_unless_categories_are_asked_for(tmp_path: Path) -> None:
    """A red thing whose shader is red, though its colour in the viewport is the plain one, which it keeps."""
    item = add("Thing", box("Thing"))
    item["unisg_category"] = "Left"
    material = bpy.data.materials.new("Red")
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.9, 0.02, 0.02, 1)
    item.data.materials.append(material)
    before = tuple(material.diffuse_color)
    found = {}
    for by_category in (False, True):
        render_picture(tmp_path / "a.png", view="top", size=(80, 60), by_category=by_category)
        red, green, blue = pixels(tmp_path / "a.png")[30, 40, :3]
        found[by_category] = red > 2 * max(green, blue)
    assert found[False]
    assert tuple(material.diffuse_color) == before


def test_blank_and_black_pictures_are_told(tmp_path: Path) -> None:
    item = add("Thing", box("Thing"))
    assert render_picture(tmp_path / "a.png", size=(80, 60)) == ""
    item.location.x = 1e4
    bpy.context.view_layer.update()
    seen_from_elsewhere = np.array([[0.0, 0, 0], [1, 1, 1]])
    assert "blank" in render_picture(tmp_path / "a.png", size=(80, 60), points=seen_from_elsewhere)


@pytest.mark.parametrize("outline", [SQUARE, SQUARE * (3, 0.5), SQUARE * (0.4, 2)])
def test_a_room_fills_the_picture(tmp_path: Path, outline: np.ndarray) -> None:
    """Of width or height nearly all is used, and nothing of the room is beside it."""
    points, faces = slab(outline, -0.05, 0.0)
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata(points.tolist(), [], faces)
    add("Floor", mesh)
    room_view = RoomView(outline, 0.0, 0.1, ())
    render_picture(tmp_path / "a.png", size=(160, 120), room=room_view)
    picture = pixels(tmp_path / "a.png")[..., :3]
    shown = np.abs(picture - picture[0, 0]).max(axis=2) > 0.05
    rows, columns = np.flatnonzero(shown.any(axis=1)), np.flatnonzero(shown.any(axis=0))
    assert max(np.ptp(rows) / 120, np.ptp(columns) / 160) > 0.85
    assert rows.min() > 0
    assert columns.min() > 0
    assert rows.max() < 119
    assert columns.max() < 159


def test_colors_are_distinct() -> None:
    colors = category_colors([f"Category {number}" for number in range(30)])
    values = np.array(list(colors.values()))
    gaps = np.abs(values[:, None] - values[None]).max(axis=2) + np.eye(len(values))
    assert gaps.min() > 0.02


def test_flat_patches_are_left_out_whole_and_furniture_of_the_same_mesh_stays() -> None:
    """A wall of two triangles of which one hides, a board that hides and is low, a wall that hides nothing."""
    wall = [(0, 0, 0), (4, 0, 0), (4, 0, 2.5), (0, 0, 2.5)]
    board = [(1, 1, 0.4), (2, 1, 0.4), (2, 2, 0.4), (1, 2, 0.4)]
    other = [(0, 4, 0), (4, 4, 0), (4, 4, 2.5), (0, 4, 2.5)]
    split = [(x, y, z) for quad in (wall, board, other) for x, y, z in (*quad[:3], quad[0], *quad[2:])]
    mesh = bpy.data.meshes.new("House")
    mesh.from_pydata(split, [], [range(at, at + 3) for at in range(0, len(split), 3)])
    hiding = np.array([True, False, True, True, False, False])
    found = _whole_patches(mesh, np.array(split, float), hiding, 1.2)
    assert found.tolist() == [True, True, False, False, False, False]
    assert not _whole_patches(mesh, np.array(split, float), np.zeros(6, bool), 1.2).any()
