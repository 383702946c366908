"""What Blender, or USD itself, shows of a scene file, without this library: judges what came of a file.

    python benchmarks/seen_geometry.py FILE [FRAME LAST]

prints as JSON, in metres: how many meshes and points are seen at the frame, their bounds and mean, and, where it plays,
the mean of all meshes' origins at its last frame. Blender files are seen at the frame they were saved on.
"""

from __future__ import annotations

import itertools
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

USD = (".usd", ".usda", ".usdc", ".usdz")
SHAPES = ("Cube", "Sphere", "Cylinder", "Cone", "Capsule", "Plane")
"""What USD describes without points, of which the corners around it are taken."""
IMPORTERS = {
    ".glb": ("io_scene_gltf2", "import_scene.gltf"),
    ".gltf": ("io_scene_gltf2", "import_scene.gltf"),
    ".fbx": ("io_scene_fbx", "import_scene.fbx"),
    ".obj": ("", "wm.obj_import"),
}
Parts = Iterator[tuple[np.ndarray, np.ndarray]]
"""Of each visible mesh its points and its matrix, both in metres and Z up."""


def seen(path: Path, frame: float | None, last: float | None) -> dict[str, Any]:
    """What is seen of a file, JSON-ready."""
    shapes: list[str] = []
    at, timed = _open_usd(path, shapes) if path.suffix.lower() in USD else _open_blender(path)
    first, stop = timed or (0.0, 0.0)
    frame, last = first if frame is None else frame, stop if last is None else last
    parts = list(at(frame))
    points = np.concatenate([np.zeros((0, 3)), *(points for points, _ in parts)])
    origins = np.array([matrix[:3, 3] for _, matrix in at(last)]).reshape(-1, 3)
    found: dict[str, Any] = {"frame": frame, "last": last}
    if not timed:
        found = {"frame": None, "last": None}
    found |= {"meshes": len(parts), "points": len(points), "shapes": len(shapes)}
    if len(points):
        found |= {"low": points.min(axis=0).tolist(), "high": points.max(axis=0).tolist()}
        found |= {"mean": points.mean(axis=0).tolist(), "origins": origins.mean(axis=0).tolist()}
    return found


def _open_blender(path: Path) -> tuple[Any, tuple[float, float] | None]:
    import bpy

    if path.suffix.lower() == ".blend":
        bpy.ops.wm.open_mainfile(filepath=str(path.absolute()), use_scripts=False)
    else:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        module, operator = IMPORTERS[path.suffix.lower()]
        if module:
            bpy.ops.preferences.addon_enable(module=module)
        room, name = operator.split(".")
        getattr(getattr(bpy.ops, room), name)(filepath=str(path.absolute()))
    scene = bpy.context.scene
    unit = scene.unit_settings.scale_length if scene.unit_settings.system != "NONE" else 1.0

    def at(frame: float) -> Parts:
        scene.frame_set(int(frame), subframe=frame - int(frame))
        for instance in bpy.context.evaluated_depsgraph_get().object_instances:
            if instance.object.type != "MESH" or not len(instance.object.data.vertices):
                continue
            points = np.empty(3 * len(instance.object.data.vertices), np.float32)
            instance.object.data.vertices.foreach_get("co", points)
            matrix = np.array(instance.matrix_world)
            matrix[:3] *= unit
            yield points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3], matrix

    return at, (scene.frame_current_final, float(scene.frame_end))


def _open_usd(path: Path, shapes: list[str]) -> tuple[Any, tuple[float, float] | None]:
    import bpy

    bpy.utils.expose_bundled_modules()
    from pxr import Usd, UsdGeom, UsdSkel

    stage = Usd.Stage.Open(str(path))
    stage.SetEditTarget(stage.GetSessionLayer())
    while instances := [prim for prim in stage.Traverse() if prim.IsInstance()]:
        for prim in instances:
            prim.SetInstanceable(False)
    timed = (stage.GetStartTimeCode(), stage.GetEndTimeCode()) if stage.HasAuthoredTimeCodeRange() else None
    UsdSkel.BakeSkinning(stage.Traverse())
    unit = np.eye(4)
    if UsdGeom.GetStageUpAxis(stage) == "Y":
        unit[1:3, 1:3] = [[0, -1], [1, 0]]
    unit[:3] *= UsdGeom.GetStageMetersPerUnit(stage)

    def at(time: float) -> Parts:
        cache = UsdGeom.XformCache(time)
        yield from parts(stage.GetPseudoRoot(), np.eye(4), cache, time)

    def parts(root: Any, above: np.ndarray, cache: Any, time: float) -> Parts:
        prims = iter(Usd.PrimRange(root))
        for prim in prims:
            shown = UsdGeom.Imageable(prim)
            if shown and shown.ComputePurpose() not in ("default", "render"):
                prims.PruneChildren()
                continue
            matrix = above @ np.array(cache.GetLocalToWorldTransform(prim)).T
            visible = bool(shown) and shown.ComputeVisibility(time) != "invisible"
            if prim.IsA(UsdGeom.PointInstancer):
                prims.PruneChildren()
                if visible:
                    yield from instanced(UsdGeom.PointInstancer(prim), matrix, cache, time)
            elif visible and len(points := points_of(prim, time)):
                placed = unit @ matrix
                yield points @ placed[:3, :3].T + placed[:3, 3], placed

    def points_of(prim: Any, time: float) -> np.ndarray:
        if prim.IsA(UsdGeom.Mesh):
            return np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(time) or [], float).reshape(-1, 3)
        if prim.GetTypeName() not in SHAPES:
            return np.zeros((0, 3))
        shapes.append(str(prim.GetPath()))
        corners = UsdGeom.Boundable.ComputeExtentFromPlugins(UsdGeom.Boundable(prim), time)
        return np.array(list(itertools.product(*np.array(corners, float).T)))

    def instanced(instancer: Any, matrix: np.ndarray, cache: Any, time: float) -> Parts:
        places = instancer.ComputeInstanceTransformsAtTime(time, time)
        numbers = list(instancer.GetProtoIndicesAttr().Get(time))
        shown = instancer.ComputeMaskAtTime(time) or [True] * len(numbers)
        numbers = [number for number, kept in zip(numbers, shown, strict=True) if kept]
        roots = [stage.GetPrimAtPath(target) for target in instancer.GetPrototypesRel().GetForwardedTargets()]
        for number, place in zip(numbers, places, strict=True):
            root = roots[number]
            own = np.array(cache.GetLocalToWorldTransform(root.GetParent())).T
            yield from parts(root, matrix @ np.array(place).T @ np.linalg.inv(own), cache, time)

    return at, timed


if __name__ == "__main__":
    print(json.dumps(seen(Path(sys.argv[1]), *([*map(float, sys.argv[2:4]), None, None][:2]))), flush=True)
    os._exit(0)
