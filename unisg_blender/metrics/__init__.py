"""How good a scene, a pose, a set of relations or a cloud of points is: functions without state."""

from __future__ import annotations

from .edge_metrics import area_under_roc, average_precision, best_threshold, f1_score
from .layout_features import scene_features
from .point_clouds import chamfer_l2, f_score
from .pose_errors import pose_report, rotation_errors, translation_errors
from .scene_validity import SceneReport, find_collisions, measure_scene, outside_room, summarise
from .two_sample_test import c2st

__all__ = [
    "SceneReport", "area_under_roc", "average_precision", "best_threshold", "c2st", "chamfer_l2", "f1_score", "f_score",
    "find_collisions", "measure_scene", "outside_room", "pose_report", "rotation_errors",
    "scene_features", "summarise", "translation_errors",
]  # fmt: skip
