"""Scene files of any kind, behind one read and one write."""

from __future__ import annotations

from .json_scenes import read_json, write_json
from .scene_files import read_all_scenes, read_scene_file, write_scene_file

__all__ = ["read_all_scenes", "read_json", "read_scene_file", "write_json", "write_scene_file"]
