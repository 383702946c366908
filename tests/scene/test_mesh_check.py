"""Meshes whose arrays are not what they say are refused by name; sound ones are taken."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.meshes.shapes import box
from unisg_blender.errors import UniSGError
from unisg_blender.scene.mesh import Mesh, check_mesh


def sound() -> Mesh:
    mesh = box()
    corners = len(mesh.corners)
    return replace(
        mesh, normals=np.zeros((corners, 3), np.float32), uvs={"map": np.zeros((corners, 2), np.float32)},
        material_index=np.array([0, 1, 0, 1, 0, 1], np.int32), materials=("a", "b"),
        edges=np.array([[0, 7]], np.int32),
    )  # fmt: skip


def test_a_sound_mesh_is_taken() -> None:
    check_mesh(sound())
    check_mesh(replace(sound(), normals=None, material_index=None, uvs={}))


FAULTS: dict[str, tuple[str, dict[str, Any]]] = {
    "points of one axis": ("points", {"points": np.zeros(24, np.float32)}),
    "points of four": ("points", {"points": np.zeros((8, 4), np.float32)}),
    "points of three axes": ("points", {"points": np.zeros((8, 3, 1), np.float32)}),
    "points in double": ("points", {"points": np.zeros((8, 3))}),
    "corners in rows": ("corners", {"corners": np.zeros((24, 1), np.int32)}),
    "corners beyond": ("corners", {"corners": np.full(24, 8, np.int32)}),
    "corners before": ("corners", {"corners": np.full(24, -1, np.int32)}),
    "edges of three": ("edges", {"edges": np.zeros((1, 3), np.int32)}),
    "edges beyond": ("edges", {"edges": np.array([[0, 8]], np.int32)}),
    "edges before": ("edges", {"edges": np.array([[0, -1]], np.int32)}),
    "too few normals": ("normals", {"normals": np.zeros((23, 3), np.float32)}),
    "too few texture places": ("uv map", {"uvs": {"map": np.zeros((23, 2), np.float32)}}),
    "texture places of three": ("uv map", {"uvs": {"map": np.zeros((24, 3), np.float32)}}),
    "too many slots": ("material_index", {"material_index": np.zeros(7, np.int32)}),
    "a slot beyond": ("material_index", {"material_index": np.full(6, 2, np.int32)}),
    "a slot where there are none": ("material_index", {"material_index": np.ones(6, np.int32), "materials": ()}),
    "offsets beyond": ("offsets", {"offsets": np.array([0, 4, 8, 12, 16, 20, 25], np.int32)}),
    "offsets that begin late": ("", {"offsets": np.array([1, 4, 8, 12, 16, 20, 24], np.int32)}),
    "offsets that end early": ("", {"offsets": np.array([0, 4, 8, 12, 16, 20, 23], np.int32)}),
    "offsets that fall": ("", {"offsets": np.array([0, 8, 4, 12, 16, 20, 24], np.int32)}),
}


@pytest.mark.parametrize("name", FAULTS)
def test_what_is_not_as_it_says_is_refused(name: str) -> None:
    text, change = FAULTS[name]
    with pytest.raises(UniSGError, match=f"the {text} of" if text else "box"):
        check_mesh(replace(sound(), **change))
