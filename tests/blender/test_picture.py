"""Pictures show the scene in the colours of its categories, and leave the scene as it was."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from tests.blender.helpers import add, box
from unisg_blender import UniSGError
from unisg_blender.blender import render_picture
from unisg_blender.blender.render.picture import category_colors


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
    render_picture(tmp_path / "top.png", view="top", size=(160, 120))
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


def test_colors_are_distinct() -> None:
    colors = category_colors([f"Category {number}" for number in range(30)])
    values = np.array(list(colors.values()))
    gaps = np.abs(values[:, None] - values[None]).max(axis=2) + np.eye(len(values))
    assert gaps.min() > 0.02
