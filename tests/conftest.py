"""What all tests share: where real scenes are, and how many of them a run used."""

from __future__ import annotations

import os
from pathlib import Path

SCENE_ENDINGS = (".blend", ".glb", ".gltf", ".fbx", ".obj", ".usd", ".usda", ".usdc", ".usdz")


def scene_files() -> list[Path]:
    """Files of the folder that UNISG_SCENES names; an empty list without it."""
    folder = os.environ.get("UNISG_SCENES")
    return sorted(path for path in Path(folder).rglob("*") if path.suffix in SCENE_ENDINGS) if folder else []


def pytest_report_header() -> str:
    """Say how many real scenes this run uses."""
    return f"real scenes: {len(scene_files())} (set UNISG_SCENES to a folder of scenes to use more)"
