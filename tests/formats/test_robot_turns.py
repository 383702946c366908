"""Where simulators put their shapes: turns of planes, shapes between two points, sizes; told by hand."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.formats.reading import bounds, found_in, write
from unisg_blender.formats.simulators.mjcf_models import _shortest, _two_axes
from unisg_blender.formats.simulators.robot_shapes import _primitive, _towards

COORDINATE = st.floats(-3, 3)


@given(st.tuples(COORDINATE, COORDINATE, COORDINATE).filter(lambda n: np.linalg.norm(n) > 1e-3))
def test_a_plane_looks_along_its_normal(normal: tuple[float, float, float]) -> None:
    found = _towards(list(normal))
    np.testing.assert_allclose(found[:3, 2], np.array(normal) / np.linalg.norm(normal), atol=1e-9)
    np.testing.assert_allclose(found[:3, :3].T @ found[:3, :3], np.eye(3), atol=1e-9)
    assert np.linalg.det(found) == pytest.approx(1)
    assert not found[:3, 3].any()


@given(st.tuples(COORDINATE, COORDINATE, COORDINATE).filter(lambda n: np.linalg.norm(n) > 1e-3))
def test_the_shortest_turn_takes_z_to_a_direction(direction: tuple[float, float, float]) -> None:
    found, unit = _shortest(np.array(direction)), np.array(direction) / np.linalg.norm(direction)
    np.testing.assert_allclose(found[:, 2], unit, atol=1e-7)
    np.testing.assert_allclose(found.T @ found, np.eye(3), atol=1e-7)
    assert np.linalg.det(found) == pytest.approx(1)
    assert np.trace(found) == pytest.approx(1 + 2 * unit[2], abs=1e-6)  # by no more than the angle between them


@given(st.tuples(*[COORDINATE] * 6))
def test_two_axes_make_a_turn_that_keeps_the_first(values: tuple[float, ...]) -> None:
    x, y = np.array(values[:3]), np.array(values[3:])
    assume(np.linalg.norm(np.cross(x, y)) > 0.05)
    found = _two_axes(np.array(values))
    np.testing.assert_allclose(found[:, 0], x / np.linalg.norm(x), atol=1e-9)
    np.testing.assert_allclose(found.T @ found, np.eye(3), atol=1e-9)
    assert np.linalg.det(found) == pytest.approx(1)
    assert found[:, 1] @ y > 0
    assert abs(found[:, 2] @ y) < 1e-9


def test_axes_that_say_nothing_are_no_error() -> None:
    assert np.isfinite(_two_axes(np.zeros(6))).all()
    np.testing.assert_allclose(_shortest(np.array([0, 0, -1.0]))[:, 2], [0, 0, -1], atol=1e-9)


@pytest.mark.parametrize(
    ("text", "kind", "numbers"),
    [
        ("<box><size>1 2 3</size></box>", "box", [1, 2, 3]), ('<box size="1 2 3"/>', "box", [1, 2, 3]),
        ("<box/>", "box", [1, 1, 1]), ('<cylinder radius="2" length="5"/>', "cylinder", [2, 5]),
        ("<capsule><radius>2</radius><length>5</length></capsule>", "capsule", [2, 5]), ("<sphere/>", "sphere", [1]),
        ("<ellipsoid><radii>1 2 3</radii></ellipsoid>", "ellipsoid", [1, 2, 3]),
        ("<plane><size>4 5</size></plane>", "plane", [4, 5]),
    ],
)  # fmt: skip
def test_shapes_have_the_sizes_that_are_told(text: str, kind: str, numbers: list[float]) -> None:
    found = _primitive(ElementTree.fromstring(text))
    assert found is not None
    np.testing.assert_allclose(found[0], np.eye(4), atol=1e-12)
    assert found[1:] == (kind, numbers)
    assert _primitive(ElementTree.fromstring("<heightmap/>")) is None


@pytest.mark.parametrize(
    ("geom", "low", "high"),
    [
        ('type="box" size="1 2 3" pos="1 0 0"', (0, -2, -3), (2, 2, 3)),
        ('type="box" size="1 2 3" euler="0 0 90"', (-2, -1, -3), (2, 1, 3)),
        ('type="box" size="1 2 3" quat="0.7071067811865476 0 0.7071067811865476 0"', (-3, -2, -1), (3, 2, 1)),
        ('type="box" size="1 2 3" axisangle="0 0 1 90"', (-2, -1, -3), (2, 1, 3)),
        ('type="box" size="1 2 3" xyaxes="0 1 0 -1 0 0"', (-2, -1, -3), (2, 1, 3)),
        ('type="box" size="1 2 3" zaxis="1 0 0"', (-3, -2, -1), (3, 2, 1)),
        ('type="box" size="1 2 3" zaxis="5 0 0"', (-3, -2, -1), (3, 2, 1)),
        ('type="box" size="1 2 3" xyaxes="0 3 0 -2 1 0"', (-2, -1, -3), (2, 1, 3)),
        ('size="0.5"', (-0.5,) * 3, (0.5,) * 3),
        ('type="cylinder" size="1 2"', (-1, -1, -2), (1, 1, 2)),
        ('type="capsule" size="1 2"', (-1, -1, -3), (1, 1, 3)),
        ('type="ellipsoid" size="1 2 3"', (-1, -2, -3), (1, 2, 3)),
        ('type="cylinder" size="0.5" fromto="1 2 0 1 2 4"', (0.5, 1.5, 0), (1.5, 2.5, 4)),
        ('type="capsule" size="0.5" fromto="0 2 1 6 2 1"', (-0.5, 1.5, 0.5), (6.5, 2.5, 1.5)),
        ('type="box" size="0.5" fromto="0 0 0 0 4 0"', (-0.5, 0, -0.5), (0.5, 4, 0.5)),
        ('type="plane" size="2 3 1"', (-2, -3, 0), (2, 3, 0)),
        ('type="plane" size="0 3 1"', (-10, -3, 0), (10, 3, 0)),
    ],
)  # fmt: skip
def test_shapes_of_mjcf_stand_where_they_are_told(
    tmp_path: Path, geom: str, low: tuple[float, ...], high: tuple[float, ...]
) -> None:
    text = f'<mujoco><worldbody><body name="b" pos="0 0 10"><geom name="it" {geom}/></body></worldbody></mujoco>'
    (found,) = found_in(write(tmp_path / "room.xml", text))
    expected = np.add([low, high], [0, 0, 10])
    np.testing.assert_allclose(bounds(found.graph, "it"), expected, atol=0.03)


def test_what_is_not_seen_is_left_out_and_radians_are_heeded(tmp_path: Path) -> None:
    text = """<mujoco><compiler angle="radian"/><worldbody><body name="b">
      <geom name="seen" type="box" size="1 2 3" euler="0 0 1.5707963267948966"/>
      <geom name="glass" type="box" size="1 1 1" rgba="1 1 1 0"/>
      <geom name="tinted" type="box" size="1 1 1" rgba="0 0 0 0.5"/></body></worldbody></mujoco>"""
    (found,) = found_in(write(tmp_path / "room.xml", text))
    np.testing.assert_allclose(bounds(found.graph, "seen"), [[-2, -1, -3], [2, 1, 3]], atol=1e-6)
    assert "glass" not in found.graph.name
    assert "tinted" in found.graph.name


def test_of_a_body_what_collides_with_nothing_is_shown(tmp_path: Path) -> None:
    text = """<mujoco><worldbody>
      <body name="both"><geom name="hull" type="box" size="1 1 1"/>
        <geom name="half" type="box" size="1 1 1" contype="0"/>
        <geom name="skin" type="box" size="2 2 2" contype="0" conaffinity="0"/></body>
      <body name="hulls"><geom name="one" type="box" size="1 1 1" contype="0"/>
        <geom name="two" type="box" size="1 1 1" conaffinity="0"/></body></worldbody></mujoco>"""
    (found,) = found_in(write(tmp_path / "room.xml", text))
    assert {"skin", "one", "two"} <= set(found.graph.name)
    assert not {"hull", "half"} & set(found.graph.name)


@pytest.mark.parametrize("kind", ["light", "actor"])
def test_what_a_world_of_gazebo_has_that_is_not_read_is_told(tmp_path: Path, kind: str) -> None:
    box = "<visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual>"
    model = f"<model name='m'><link name='l'>{box}</link></model>"
    for name, extra in (("with", f"<{kind} name='it'/>"), ("without", "")):
        text = f"<sdf version='1.9'><world name='w'>{model}{extra}</world></sdf>"
        (found,) = found_in(write(tmp_path / f"{name}.world", text))
        assert any(f"{kind}s are not read" in line for line in found.report) == (name == "with")


def test_defaults_within_defaults_end(tmp_path: Path) -> None:
    deep = "".join(f'<default class="c{k}">' for k in range(150)) + '<geom size="3"/>' + "</default>" * 150
    text = f'<mujoco><default><geom size="1"/><default class="a"><geom size="2"/>{deep}</default></default><worldbody>'
    text += (
        '<body name="b"><geom name="shallow" class="a"/><geom name="deep" class="c149"/></body></worldbody></mujoco>'
    )
    (found,) = found_in(write(tmp_path / "room.xml", text))
    np.testing.assert_allclose(bounds(found.graph, "shallow")[1], [2, 2, 2], atol=0.05)
    np.testing.assert_allclose(bounds(found.graph, "deep")[1], [1, 1, 1], atol=0.05)  # too deep: not heeded
