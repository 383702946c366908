"""A short film of a simulation: Workbench pictures with the list of actions beside them."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import bpy
import mathutils
import numpy as np
from numpy.typing import NDArray

from ...errors import MissingPackageError
from ...scene.graph import SceneGraph
from ..lookup import objects_by_uid
from ..scene_units import metres_per_unit, scale_translations
from .picture import corner_points, render_picture

Frame = tuple[float, NDArray[np.float64], Sequence[tuple[str, str]]]
"""Time in seconds, world matrices (N, 4, 4), and names with their status, to be shown as a list."""

SIZE = (480, 360)
LIST = 260


class Puppets:
    """The objects of a scene, freed from parents, constraints and animation so that they stand where they are put.

    For files that are thrown away afterwards: nothing is put back.
    """

    def __init__(self, scene: bpy.types.Scene, graph: SceneGraph) -> None:
        self.scene, self.objects = scene, objects_by_uid(scene)
        self.rows = [(row, uid) for row, uid in enumerate(graph.uid) if uid in self.objects]
        for item in self.objects.values():
            item.animation_data_clear()
            item.constraints.clear()
            item.parent = None
            item.delta_location, item.delta_scale = (0, 0, 0), (1, 1, 1)
            item.delta_rotation_euler, item.delta_rotation_quaternion = (0, 0, 0), (1, 0, 0, 0)

    def pose(self, world: NDArray[np.float64]) -> None:
        """Put all objects at world matrices (N, 4, 4) in metres, in the graph's order."""
        world = scale_translations(world, 1.0 / metres_per_unit(self.scene))
        for row, uid in self.rows:
            self.objects[uid].matrix_world = mathutils.Matrix(world[row])
        bpy.context.view_layer.update()


def write_film(
    path: str | os.PathLike[str],
    scene: bpy.types.Scene,
    graph: SceneGraph,
    frames: Sequence[Frame],
    *,
    speed: float = 1.0,
    leave_out: Sequence[str] = (),
    progress: Callable[[Sequence[Frame]], Iterable[Frame]] = iter,
) -> None:
    """Write an animated GIF; the scene's objects are left wherever the last frame has them.

    Parameters
    ----------
    frames
        What to show; a status is "waiting", "open", "done" or "skipped".
    speed
        How many times as fast as it happened.
    leave_out
        Categories that are not drawn, such as a ceiling.
    progress
        Goes through the frames and may show how far it has come.
    """
    try:
        from PIL import Image
    except ImportError:
        raise MissingPackageError("Pillow", "figures") from None
    puppets = Puppets(scene, graph)
    points = []
    for _, world, _ in frames[:: max(1, len(frames) // 8)]:
        puppets.pose(world)
        points.append(corner_points([item for item in scene.objects if not item.hide_render]))
    seen = np.concatenate(points)
    pictures = []
    with tempfile.TemporaryDirectory() as folder:
        for time, world, states in progress(frames):
            puppets.pose(world)
            shot = Path(folder) / "frame.png"
            render_picture(shot, scene, size=SIZE, leave_out=leave_out, points=seen, by_category=True)
            with Image.open(shot) as image:
                pictures.append(_with_list(image.convert("RGB"), time, states))
    times = [time for time, _, _ in frames]
    lasts = [*np.diff(times), 1.5 * speed]
    pictures[0].save(
        path, format="GIF", save_all=True, append_images=pictures[1:], loop=0,
        duration=[max(20, round(1000 * float(last) / speed)) for last in lasts],
    )  # fmt: skip


def _with_list(image, time, states):  # type: ignore[no-untyped-def]
    from PIL import Image, ImageDraw

    colors = {"waiting": (150, 150, 150), "open": (215, 130, 0), "done": (0, 140, 60), "skipped": (190, 190, 190)}
    whole = Image.new("RGB", (image.width + LIST, image.height), (250, 250, 250))
    whole.paste(image, (0, 0))
    draw = ImageDraw.Draw(whole)
    draw.text((image.width + 12, 10), f"{time:6.1f} s", fill=(30, 30, 30))
    step = min(18, (image.height - 40) // max(len(states), 1))
    for place, (name, status) in enumerate(states):
        y = 34 + place * step
        draw.ellipse((image.width + 12, y + 2, image.width + 20, y + 10), fill=colors[status])
        draw.text((image.width + 28, y), name[:36], fill=colors[status])
    return whole
