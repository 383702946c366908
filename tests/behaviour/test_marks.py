from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.behaviour.playing.guide_lines import box_lines, circle, cone_lines, dashes, sphere_lines


def test_a_box_has_twelve_edges_of_its_lengths():
    matrix = np.eye(4)
    matrix[:3, 3] = 5
    lines = box_lines(np.zeros(3), np.array([1.0, 2.0, 3.0]), matrix).reshape(12, 2, 3)
    lengths = np.linalg.norm(lines[:, 0] - lines[:, 1], axis=1)
    assert sorted(np.round(lengths, 9)) == [1] * 4 + [2] * 4 + [3] * 4
    assert lines.min() == 5


def test_circles_are_closed_and_round():
    lines = circle(np.ones(3), np.array([2.0, 0, 0]), np.array([0, 2.0, 0]))
    assert np.allclose(np.linalg.norm(lines - 1, axis=1), 2)
    assert np.allclose(lines[1:-1:2], lines[2::2])
    assert np.allclose(lines[0], lines[-1])
    assert np.allclose(np.linalg.norm(sphere_lines(np.zeros(3), 0.5), axis=1), 0.5)


@pytest.mark.parametrize("angle", [0.1, 1.0, np.pi / 2, 3.0])
def test_the_rims_of_cones_are_turned_by_the_angle(angle):
    lines = cone_lines(np.diag([2.0, 3, 4, 1]), angle, 0.3)
    rims = lines[np.linalg.norm(lines, axis=1) > 1e-9]
    turned = np.arccos(rims / 0.3)
    assert (np.isclose(turned[:, 0], angle) | np.isclose(turned[:, 2], angle)).all()


def test_dashes_start_and_end_where_they_should():
    lines = dashes(np.zeros(3), np.array([1.0, 0, 0]))
    assert lines[0, 0] == 0
    assert lines[-1, 0] == 1
    assert len(lines) == 24
