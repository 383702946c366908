"""Scenes judged by SceneEval's own code, unchanged: collision, out of bound, navigability, clearance of openings.

SceneEval (3dlg-hcvc/SceneEval, MIT) keeps each scene twice, in Blender and in trimesh. Here its own ``TrimeshScene``
loads a ``sceneState``, and a stand-in gives the matrices that its Blender half would: an object's is the one that takes
its model with z up to the scene, an opening's is turned so that its front (-y) looks into the room.

Its packages ``scenes``, ``metrics`` and ``assets`` import all that they have; they are replaced by empty ones
over the same folders, so that only the files that are wanted are loaded. Needed besides trimesh: python-fcl, rtree,
shapely, mapbox_earcut, manifold3d, opencv-python-headless, omegaconf, pydantic and mathutils (bpy has it).
"""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import sys
import types
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy  # noqa: F401  it brings mathutils
import matplotlib
import numpy as np
from mathutils import Matrix

UP = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
"""From y up to z up."""

METRICS = ("collision", "out_of_bound", "navigability", "opening_clearance")


def load(folder: Path) -> None:
    """Make SceneEval's files importable; pictures are drawn nowhere."""
    matplotlib.use("Agg")
    from matplotlib import pyplot

    pyplot.savefig = lambda *args, **named: None
    sys.path.insert(0, str(folder))
    for name in ("scenes", "metrics", "assets"):
        package = types.ModuleType(name)
        package.__path__ = [str(folder / name)]
        sys.modules[name] = package
    sys.modules["assets"].Retriever = object
    sys.modules["scenes"].Scene = StandIn


@dataclass
class Models:
    """Finds the models that lie beside a scene."""

    folder: Path

    def get_asset_info(self, model: str) -> Any:
        """What SceneEval asks of a model."""
        said = _said(self.folder / model)
        path = self.folder / model / f"{model}.glb"
        return types.SimpleNamespace(
            asset_id=model, file_path=path, description=said["description"], extra_rotation_transform=None
        )


def _said(model: Path) -> dict[str, Any]:
    return json.loads((model / "data.json").read_text("utf8"))["annotations"]


class StandIn:
    """What SceneEval's metrics ask of a ``Scene``, without its Blender half."""

    def __init__(self, state: Path) -> None:
        scenes = importlib.import_module("scenes.trimesh_scene")
        read = importlib.import_module("scenes.scene_state").SceneState(state)
        models = Models(state.with_name(state.name.removesuffix(".json") + ".assets"))
        config = importlib.import_module("scenes.config").SceneConfig()
        self.trimesh_scene = scenes.TrimeshScene(models, read, config, scenes.TrimeshConfig())
        self.t_objs, self.t_architecture = self.trimesh_scene.t_objs, self.trimesh_scene.t_architecture
        self.matrices = {
            f"idx{item.index}_{item.model_id}": Matrix(np.reshape(item.transform.data, (4, 4)).T @ UP.T)
            for item in read.objs
        }
        self.openings = openings(read.architecture, self.t_architecture)

    def get_obj_ids(self) -> list[str]:
        """All objects."""
        return list(self.t_objs)

    def get_obj_matrix(self, obj_id: str) -> Matrix:
        """From an object's own frame to the world."""
        return self.matrices[obj_id]

    def get_obj_z_rotation(self, obj_id: str) -> float:
        """Turn about the vertical, radians."""
        return self.matrices[obj_id].to_euler("XYZ").z

    def get_arch_matrix(self, arch_id: str) -> Matrix:
        """From an opening's own frame to the world."""
        return self.openings[arch_id]

    def _own(self, mesh: Any, matrix: Matrix) -> tuple[np.ndarray, np.ndarray]:
        moved = mesh.copy()
        moved.apply_transform(np.asarray(matrix.inverted()))
        return moved.bounds[0] + moved.extents / 2, moved.extents

    def get_obj_bbox_center(self, obj_id: str) -> np.ndarray:
        """Middle of an object's box, in the world."""
        middle = self._own(self.t_objs[obj_id], self.matrices[obj_id])[0]
        return (np.asarray(self.matrices[obj_id]) @ np.append(middle, 1))[:3]

    def get_default_pose_obj_bbox_extents(self, obj_id: str) -> np.ndarray:
        """Size of an object's box in its own frame."""
        return self._own(self.t_objs[obj_id], self.matrices[obj_id])[1]

    def get_arch_bbox_center(self, arch_id: str) -> np.ndarray:
        """Middle of an opening."""
        middle = self._own(self.t_architecture[arch_id], self.openings[arch_id])[0]
        return (np.asarray(self.openings[arch_id]) @ np.append(middle, 1))[:3]

    def get_default_pose_arch_bbox_extents(self, arch_id: str) -> np.ndarray:
        """Width, thickness and height of an opening."""
        return self._own(self.t_architecture[arch_id], self.openings[arch_id])[1]


def openings(architecture: Any, meshes: dict[str, Any]) -> dict[str, Matrix]:
    """Frames of doors and windows: along their wall, the front into the room, as SceneEval turns them in Blender."""
    from shapely.geometry import Point, Polygon

    floors = [Polygon(np.asarray(each.points)[:, :2]) for each in architecture.elements if each.type == "Floor"]
    found = {}
    for wall in (each for each in architecture.elements if each.type == "Wall"):
        first, second = (np.asarray(point, float) for point in wall.points)
        angle = np.arctan2(second[1] - first[1], second[0] - first[0])
        middle = (first + second) / 2
        front = np.array([np.sin(angle), -np.cos(angle)]) * 0.1
        if floors and not floors[-1].contains(Point(middle[:2] + front)):
            angle += np.pi
        for number, hole in enumerate(wall.holes):
            name = f"{hole.type.lower()}_{number}_{wall.id}"
            if name in meshes:
                at = meshes[name].bounds.mean(axis=0)
                found[name] = Matrix.Translation(at) @ Matrix.Rotation(angle, 4, "Z")
    return found


def judged(state: Path, folder: Path) -> dict[str, Any]:
    """What SceneEval says of a scene; ``folder`` takes the empty folders that its metrics make."""
    with contextlib.redirect_stdout(io.StringIO()):
        scene = StandIn(state)
        found = {name: _run(name, scene, folder) for name in METRICS}
    named = {key: scene.trimesh_scene.obj_descriptions[key] for key in scene.get_obj_ids()}
    hits = found["collision"]["collision_results"]
    pairs = {tuple(sorted((named[one], named[two]))) for one, hit in hits.items() for two in hit["colliding_with"]}
    outside = [named[key] for key, value in found["out_of_bound"].items() if value["out_of_bound"]]
    sides = {
        kind: [side for each in found["opening_clearance"][f"{kind}_clearance"].values() for side in each]
        for kind in ("door", "window")
    }
    return {
        "objects": len(named), "collide": sorted(named[key] for key, hit in hits.items() if hit["in_collision"]),
        "pairs": sorted(pairs), "outside": outside, "navigability": float(found["navigability"]["navigability"]),
        **{f"{kind}s": len(each) for kind, each in sides.items()},
        **{f"{kind}s_clear": sum(not side["occlusion_info"]["opening_occluded"] for side in each)
           for kind, each in sides.items()},
    }  # fmt: skip


def navigability_without(state: Path, folder: Path, category: str) -> float:
    """Navigability of a scene from which the things of a category are left out."""
    whole = json.loads(state.read_text("utf8"))
    assets = state.with_name(state.name.removesuffix(".json") + ".assets")
    whole["scene"]["object"] = [
        item for item in whole["scene"]["object"]
        if _said(assets / item["modelId"])["description"] != category
    ]  # fmt: skip
    state.write_text(json.dumps(whole), "utf8")
    with contextlib.redirect_stdout(io.StringIO()):
        return float(_run("navigability", StandIn(state), folder)["navigability"])


def _run(name: str, scene: StandIn, folder: Path) -> dict[str, Any]:
    module = importlib.import_module(f"metrics.{name}")
    title = "".join(word.title() for word in name.split("_"))
    config = getattr(module, f"{title}MetricConfig")()
    return getattr(module, f"{title}Metric")(scene=scene, output_dir=folder, cfg=config).run().data
