"""Pictures of a scene, in its own materials or coloured by category: from above, or in perspective."""

from __future__ import annotations

import colorsys
import os
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Literal

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...runtime.atomic_files import replacing
from ...runtime.output_capture import captured_output
from ...scene.categories import STRUCTURE
from ...scene.properties import CATEGORY
from ..depsgraph import updated_depsgraph
from ..scene_units import metres_per_unit
from .picture_faults import picture_fault
from .room_view import FROM_THE_RIGHT, RoomView, opened
from .surface_colors import shader_colors

View = Literal["perspective", "top"]
Engine = Literal["workbench", "cycles"]
Color = tuple[float, float, float, float]
GREY: Color = (0.55, 0.55, 0.55, 1.0)
PALE = (*(name.casefold() for name in STRUCTURE), "room")  # what stands in the room is what matters
GOLDEN = 0.61803398875  # steps of this around the colour circle keep neighbours apart
SHOWN = ("MESH", "CURVE", "SURFACE", "FONT", "META", "EMPTY")
ROUNDS = 12  # in which the camera is moved to where the points fill the picture


def render_picture(
    path: str | os.PathLike[str],
    scene: bpy.types.Scene | None = None,
    *,
    view: View = "perspective",
    size: tuple[int, int] = (960, 720),
    engine: Engine = "workbench",
    leave_out: Collection[str] = (),
    points: NDArray[np.float64] | None = None,
    room: RoomView | None = None,
    by_category: bool = False,
) -> str:
    """Render a scene into a PNG file; the scene itself is not changed.

    Parameters
    ----------
    path
        The PNG file to write.
    scene
        The current scene when omitted.
    view
        "perspective" from a corner above, or "top": straight down, +Y up.
    size
        Width and height in pixels.
    engine
        "workbench": plain colours and images, about a second without a graphics
        card; "cycles": the materials, with light.
    leave_out
        Categories that are not drawn, such as a ceiling that would hide the room.
    points
        World points (K, 3), in the scene's unit, that the picture has to show; the objects when omitted.
    room
        The room that the picture looks into: what hides it is left out, and it fills the picture.
    by_category
        Colours by category instead of the things' own materials.

    Returns
    -------
    str
        What is wrong with the picture, "" for nothing: it is blank, or black.

    Raises
    ------
    UniSGError
        If there is nothing to show, or the file cannot be written.
    """
    path = Path(path).absolute()
    scene = scene or bpy.context.scene
    items = _drawn(scene, leave_out)
    if points is None:
        points = room.points / metres_per_unit(scene) if room is not None else _all_points(scene, items)
    if not len(points):
        raise UniSGError(f"scene {scene.name!r} has nothing to show: add objects with a mesh")
    toward = _direction(view, room)
    view_of = nullcontext(items) if room is None else opened(scene, items, room, tuple(toward))
    with replacing(path) as unfinished, view_of as seen, shader_colors(seen), _stage(seen, engine) as stage:
        _aim(stage.camera, points, toward, size)
        _set_output(stage, unfinished, size, engine, by_category)
        _render(stage, path)
        return picture_fault(unfinished)


def _render(stage: bpy.types.Scene, path: Path) -> None:
    try:
        with captured_output():
            bpy.ops.render.render(write_still=True, scene=stage.name)
    except RuntimeError as error:
        raise UniSGError(f"cannot render {path}: {str(error).strip()}") from None


def _drawn(scene: bpy.types.Scene, leave_out: Collection[str]) -> list[bpy.types.Object]:
    shown = (item for item in scene.objects if item.type in SHOWN and not item.hide_render)
    return [item for item in shown if category_of(item) not in leave_out]


def _all_points(scene: bpy.types.Scene, items: Sequence[bpy.types.Object]) -> NDArray[np.float64]:
    _, depsgraph = updated_depsgraph(scene)
    return corner_points([item.evaluated_get(depsgraph) for item in items])


def _direction(view: View, room: RoomView | None) -> mathutils.Vector:
    """The way the camera looks."""
    if view == "top":
        return mathutils.Vector((0, 0, -1))
    return mathutils.Vector(FROM_THE_RIGHT if room is None else room.toward).normalized()


def category_of(item: bpy.types.Object) -> str:
    """The category that an object carries, "" for none."""
    value = item.get(CATEGORY, "")
    return value if isinstance(value, str) else ""


def corner_points(items: Sequence[bpy.types.Object]) -> NDArray[np.float64]:
    """Corners (K, 3) in the world of the boxes around all evaluated objects that have geometry."""
    found = [np.zeros((0, 3))]
    for item in items:
        if item.type != "EMPTY":
            world = np.array(item.matrix_world)
            found.append(np.array(item.bound_box) @ world[:3, :3].T + world[:3, 3])
    points = np.concatenate(found)
    return points[np.isfinite(points).all(axis=1)]


def category_colors(names: Collection[str]) -> dict[str, Color]:
    """A colour for each category: grey for none, pale for walls and floors, else distinct by sorted place."""
    colors: dict[str, Color] = {"": GREY}
    for place, name in enumerate(sorted(set(names) - {""})):
        pale = any(word in name.casefold() for word in PALE)
        red, green, blue = colorsys.hsv_to_rgb(place * GOLDEN % 1, 0.06 if pale else 0.62, 0.8 if pale else 0.9)
        colors[name] = (red, green, blue, 1.0)
    return colors


@contextmanager
def _stage(items: Sequence[bpy.types.Object], engine: Engine) -> Iterator[bpy.types.Scene]:
    """A scene of its own with the objects, a camera and lights, removed afterwards with all that was made."""
    stage = bpy.data.scenes.new("unisg picture")
    camera = bpy.data.cameras.new("unisg picture")
    sun = bpy.data.lights.new("unisg picture", "SUN")
    made = [bpy.data.objects.new("unisg picture", camera), bpy.data.objects.new("unisg picture", sun)]
    before = [tuple(item.color) for item in items]
    colors = category_colors([category_of(item) for item in items])
    try:
        for item in (*items, *made):
            stage.collection.objects.link(item)
        for item in items:
            item.color = colors[category_of(item)]
        sun.energy, made[1].rotation_euler = 1.5, (0.6, 0.3, 0.4)
        stage.camera = made[0]
        stage.world = bpy.data.worlds.new("unisg picture")
        stage.world.color = (0.9, 0.9, 0.92) if engine == "workbench" else (0.4, 0.4, 0.42)
        yield stage
    finally:
        for item, color in zip(items, before, strict=True):
            item.color = color
        world = stage.world
        bpy.data.scenes.remove(stage)
        for item in made:
            bpy.data.objects.remove(item)
        bpy.data.cameras.remove(camera)
        bpy.data.lights.remove(sun)
        if world is not None:
            bpy.data.worlds.remove(world)


def _aim(item: bpy.types.Object, points: NDArray[np.float64], toward: mathutils.Vector, size: tuple[int, int]) -> None:
    """Point the camera so that all points are in the picture, with a margin, and fill it."""
    camera = item.data
    top = toward.z < -0.999
    rotation = mathutils.Matrix.Identity(3) if top else toward.to_track_quat("-Z", "Y").to_matrix()
    seen = points @ np.array(rotation)  # in the camera's axes
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    wide, high, deep = (seen.max(axis=0) - seen.min(axis=0)) * 1.05 + 1e-3
    aspect = size[0] / size[1]
    if top:
        camera.type, camera.ortho_scale = "ORTHO", max(wide, high * aspect) if aspect >= 1 else max(wide / aspect, high)
        back = deep
    else:
        camera.angle = 0.7
        middle, back = _filling(seen, middle, aspect)
    place = np.array(rotation) @ (middle + np.array([0, 0, back]))
    item.matrix_world = mathutils.Matrix.Translation(place) @ rotation.to_4x4()
    camera.clip_start, camera.clip_end = max(back - 2 * deep, back * 1e-3, 1e-4), back + 4 * deep


def _filling(
    seen: NDArray[np.float64], middle: NDArray[np.float64], aspect: float
) -> tuple[NDArray[np.float64], float]:
    """Where a camera looks at, and from how far, for points (K, 3) in its axes to fill the picture.

    What is near looks larger: the middle of the picture is not that of the points.
    """
    middle, back = middle.copy(), 0.0
    for _ in range(ROUNDS):
        reach = np.abs(seen[:, :2] - middle[:2]) * np.array([1.0, aspect]) * 1.05
        back = float((seen[:, 2] - middle[2] + reach.max(axis=1) / np.tan(0.35) * max(1.0, 1 / aspect)).max())
        away = np.maximum(middle[2] + back - seen[:, 2], 1e-9)
        flat = (seen[:, :2] - middle[:2]) / away[:, None]
        middle[:2] += (flat.min(axis=0) + flat.max(axis=0)) / 2 * away.mean()
    return middle, back


def _set_output(stage: bpy.types.Scene, path: Path, size: tuple[int, int], engine: Engine, by_category: bool) -> None:
    render = stage.render
    render.filepath = str(path)
    render.image_settings.file_format = "PNG"
    render.resolution_x, render.resolution_y = size
    stage.view_settings.view_transform = "Standard"
    if engine == "cycles":
        render.engine = "CYCLES"
        stage.cycles.samples, stage.cycles.device, stage.cycles.use_denoising = 16, "CPU", False
        return
    render.engine = "BLENDER_WORKBENCH"
    shading = stage.display.shading
    shading.light, shading.color_type = "STUDIO", "OBJECT" if by_category else "TEXTURE"
    shading.show_cavity, shading.show_object_outline = True, True
    shading.background_type = "WORLD"
    stage.display.render_aa = "5"
