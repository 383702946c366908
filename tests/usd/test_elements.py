"""Scenes of the Elements framework, also damaged ones."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.usd import read_usd

ONE = """#usda 1.0
def "RooT"
{
    def "thing"
    {
        def "TRS"
        {
            custom matrix4d trs = ((1, 0, 0, 1), (0, 1, 0, 2), (0, 0, 1, 3), (0, 0, 0, 1))
        }
        def "Mesh"
        {
            custom point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
            INDICES
        }
    }
}
"""


def read(tmp_path, text):
    path = tmp_path / "scene.usda"
    path.write_text(text, encoding="utf-8")
    return read_usd(path)


@pytest.mark.parametrize(
    ("said", "corners"),
    [
        ("custom int[] indices = [0, 1, 2, 1, 2, 3]", [0, 1, 2, 1, 2, 3]),
        ("custom int[] indices = [0, 1, 2, 1, 2]", [0, 1, 2]),
        ("custom int[] indices = [0, 1, 2]\ncustom int primitive = 4", [0, 1, 2]),
        ("custom int[] indices = [0, 1, 2]\ncustom int primitive = 1", []),
        ("custom int[] indices = [0, 1, 4]", []),
        ("custom int[] indices = [0, 1, -1]", []),
        ("", []),
    ],
)
def test_triangles_are_kept_and_damaged_ones_leave_the_points(tmp_path, said, corners):
    thing = read(tmp_path, ONE.replace("INDICES", said))["thing"]
    np.testing.assert_allclose(thing.local[:3, 3], [1, -3, 2])  # Y up becomes Z up
    assert len(thing.mesh.points) == 4
    assert thing.mesh.corners.tolist() == corners


def test_a_component_of_that_name_alone_makes_no_elements_scene(tmp_path):
    text = '#usda 1.0\ndef "thing"\n{\n    def "TRS"\n    {\n        custom string note = "hello"\n    }\n}\n'
    assert "TRS" in read(tmp_path, text).name
