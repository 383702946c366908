"""The forms against ``clifford``: product, action on points, parts, and the way there and back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from unisg_blender.poses import (
    FORMS,
    PoseError,
    compose,
    convert,
    dilator,
    from_multivector,
    rotor,
    split_motor,
    to_multivector,
    translator,
)

pga = pytest.importorskip("clifford.pga")
g3c = pytest.importorskip("clifford.g3c")

E4, E5 = g3c.blades["e4"], g3c.blades["e5"]
EINF, EO = E4 + E5, 0.5 * (E5 - E4)
unit = st.floats(-1.0, 1.0)
poses = st.builds(
    lambda q, t: FORMS["quaternion"].decode(np.array([*(5 * t), *q])),
    arrays(np.float64, 4, elements=unit).filter(lambda q: np.linalg.norm(q) > 0.01),
    arrays(np.float64, 3, elements=unit),
)
points = arrays(np.float64, 3, elements=unit)


def moved_pga(motor, point) -> np.ndarray:
    b = pga.blades
    image = (motor * (b["e123"] - point[0] * b["e023"] + point[1] * b["e013"] - point[2] * b["e012"]) * ~motor).value
    return np.array([-image[13], image[12], -image[11]]) / image[14]


def moved_cga(versor, point) -> np.ndarray:
    b = g3c.blades
    vector = point[0] * b["e1"] + point[1] * b["e2"] + point[2] * b["e3"]
    image = versor * (EO + vector + 0.5 * float(point @ point) * EINF) * ~versor
    return image.value[1:4] / -float((image | EINF).value[0])


@pytest.mark.slow
@settings(max_examples=80, deadline=None)
@given(poses, points)
def test_motors_move_points_as_matrices_do(matrix, point):
    expected = (matrix @ [*point, 1.0])[:3]
    np.testing.assert_allclose(moved_pga(to_multivector(FORMS["pga"].encode(matrix)), point), expected, atol=1e-13)
    motor = to_multivector(FORMS["cga"].encode(matrix), "cga")
    np.testing.assert_allclose(moved_cga(motor, point), expected, atol=1e-11)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(poses, points, st.floats(0.01, 100.0))
def test_similarities_scale_points(matrix, point, scale):
    matrix = matrix @ np.diag([scale, scale, scale, 1.0])
    versor = to_multivector(FORMS["cga_similarity"].encode(matrix), "cga_similarity")
    np.testing.assert_allclose(moved_cga(versor, point), (matrix @ [*point, 1.0])[:3], rtol=1e-9, atol=1e-9)
    assert float((versor * ~versor).value[0]) == pytest.approx(1.0, abs=1e-10)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(poses, poses)
def test_product_of_forms_is_product_of_matrices(a, b):
    for name, form in FORMS.items():
        product = compose(form.encode(a), form.encode(b), name)
        np.testing.assert_allclose(form.decode(product), a @ b, atol=1e-13)
    for name in ("pga", "cga", "cga_similarity"):
        product = to_multivector(FORMS[name].encode(a), name) * to_multivector(FORMS[name].encode(b), name)
        np.testing.assert_allclose(FORMS[name].decode(from_multivector(product)), a @ b, atol=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1.0, -1.0, 1e-3, -1e3])
@pytest.mark.parametrize("scale", [1.0, 0.25, 40.0])
@settings(max_examples=15, deadline=None)
@given(matrix=poses)
def test_parts_multiply_to_the_motor(factor, scale, matrix):
    motor = FORMS["pga"].encode(matrix)
    turn, slide, none = split_motor(factor * motor)
    assert none is None
    np.testing.assert_allclose(from_multivector(to_multivector(slide) * to_multivector(turn)), motor, atol=1e-13)
    versor = FORMS["cga_similarity"].encode(matrix @ np.diag([scale, scale, scale, 1.0]))
    turn, slide, grow = (to_multivector(part, "cga_similarity") for part in split_motor(factor * versor))
    np.testing.assert_allclose(from_multivector(slide * turn * grow), versor, atol=1e-12)
    np.testing.assert_allclose(from_multivector(turn * grow), from_multivector(grow * turn), atol=1e-14)
    np.testing.assert_allclose(from_multivector(grow), dilator(scale), atol=1e-13)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(poses)
def test_rotor_and_translator_are_the_stated_formulas(matrix):
    *t, w, x, y, z = FORMS["quaternion"].encode(matrix)
    b, c = pga.blades, g3c.blades
    np.testing.assert_allclose(rotor([w, x, y, z]), (w - z * b["e12"] + y * b["e13"] - x * b["e23"]).value, atol=1e-16)
    vector = t[0] * b["e1"] + t[1] * b["e2"] + t[2] * b["e3"]
    np.testing.assert_allclose(translator(t), (1 - 0.5 * b["e0"] * vector).value, atol=1e-15)
    np.testing.assert_allclose(
        rotor([w, x, y, z], "cga"), (w - z * c["e12"] + y * c["e13"] - x * c["e23"]).value, atol=1e-16
    )
    vector = t[0] * c["e1"] + t[1] * c["e2"] + t[2] * c["e3"]
    np.testing.assert_allclose(translator(t, "cga"), (1 - 0.5 * vector * EINF).value, atol=1e-15)
    np.testing.assert_allclose(convert(rotor([w, x, y, z]), "pga", "quaternion"), [0, 0, 0, w, x, y, z], atol=1e-15)


@pytest.mark.parametrize("scale", [1e-6, 0.5, 1.0, 1e6])
def test_dilator_is_the_stated_formula(scale):
    g = np.log(scale) / 2
    expected = np.cosh(g) - np.sinh(g) * g3c.blades["e45"]
    np.testing.assert_allclose(dilator(scale), expected.value, rtol=1e-13)


def test_dilator_needs_a_positive_scale():
    with pytest.raises(PoseError, match="row 1: the scale is not positive"):
        dilator([1.0, 0.0, -1.0])


@pytest.mark.parametrize("name", sorted(FORMS))
def test_there_and_back(name):
    rng = np.random.default_rng(0)
    features = FORMS[name].project(rng.normal(size=(2, 3, FORMS[name].width)))
    multivectors = to_multivector(features, name)
    assert multivectors.shape == (2, 3)
    again = from_multivector(multivectors, name)
    if name == "trs_matrix":  # a motor holds its rigid part only
        features = convert(features, name, "matrix")
    np.testing.assert_allclose(again, features, atol=1e-12)
    single = to_multivector(features[1, 2], name)
    np.testing.assert_allclose(from_multivector(single, name), again[1, 2], atol=1e-12)
    np.testing.assert_allclose(from_multivector(list(multivectors[0]), name), again[0], atol=1e-12)


def test_other_multivectors_are_refused():
    with pytest.raises(PoseError, match="32"):
        from_multivector(pytest.importorskip("clifford.g3").blades["e12"])
    with pytest.raises(PoseError, match="norm of zero"):
        from_multivector(pga.blades["e1"], "matrix")
    with pytest.raises(PoseError, match="16"):
        split_motor(np.zeros(8))
    with pytest.raises(PoseError, match="algebra"):
        rotor([1, 0, 0, 0], "sta")  # type: ignore[arg-type]
