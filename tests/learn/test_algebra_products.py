"""Products, maps and embeddings of multivectors as tensors: what ``clifford`` computes is the reference."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

torch = pytest.importorskip("torch")
pga = pytest.importorskip("clifford.pga")

from unisg_blender.errors import UniSGError  # noqa: E402
from unisg_blender.learn.algebra import (  # noqa: E402
    SYMMETRIES,
    commuting_maps,
    embed_direction,
    embed_frame,
    embed_motor,
    embed_plane,
    embed_point,
    extract_direction,
    extract_motor,
    extract_plane,
    extract_point,
    geometric_product,
    inner_product,
    invariant_elements,
    invariant_parts,
    join,
    moved,
    reverse,
)
from unisg_blender.poses import FORMS  # noqa: E402

SEEDS = st.integers(0, 10_000)


def motions(count: int, seed: int, upright: bool = False) -> np.ndarray:
    """Random rigid motions (N, 4, 4), about the vertical only if ``upright``."""
    rng = np.random.default_rng(seed)
    found = np.tile(np.eye(4), (count, 1, 1))
    turn = Rotation.from_rotvec(np.outer(rng.uniform(-np.pi, np.pi, count), [0, 0, 1]))
    found[:, :3, :3] = (turn if upright else Rotation.random(count, random_state=seed)).as_matrix()
    found[:, :3, 3] = rng.normal(0, 3, (count, 3))
    return found


def random(*shape: int, seed: int = 0) -> torch.Tensor:
    return torch.tensor(np.random.default_rng(seed).normal(size=shape))


@settings(max_examples=20)
@given(SEEDS)
def test_products_are_those_of_clifford(seed: int) -> None:
    x, y = random(2, 16, seed=seed)
    one, two = (pga.layout.MultiVector(value.numpy()) for value in (x, y))
    assert_allclose(geometric_product(x, y), (one * two).value, atol=1e-12)
    assert_allclose(join(x, y), one.vee(two).value, atol=1e-12)
    assert_allclose(reverse(x), (~one).value, atol=0)
    assert_allclose(inner_product(x, y), (one * ~two).value[0], atol=1e-12)


def test_products_broadcast_and_keep_the_precision() -> None:
    x, y = random(3, 1, 16), random(5, 16, seed=1)
    for product in (geometric_product, join):
        both = product(x, y)
        assert both.shape == (3, 5, 16)
        assert_allclose(both[2, 4], product(x[2, 0], y[4]), atol=1e-14)
        single = product(x.float(), y.float())
        assert single.dtype == torch.float32
        assert_allclose(single, both, atol=1e-5)


@settings(max_examples=20)
@given(SEEDS)
def test_motors_move_multivectors_as_clifford_does(seed: int) -> None:
    motor, x = embed_motor(torch.tensor(motions(1, seed))[0]), random(16, seed=seed)
    versor = pga.layout.MultiVector(motor.numpy())
    assert_allclose(moved(motor, x), (versor * pga.layout.MultiVector(x.numpy()) * ~versor).value, atol=1e-11)


def test_the_maps_are_those_of_gatr_where_mirrors_count() -> None:
    maps = commuting_maps("mirrors")
    grades = np.array([len(name) - 1 if name != "1" else 0 for name in FORMS["pga"].channels])
    by_hand = [np.diag((grades == grade).astype(float)) for grade in range(5)]
    e0 = torch.eye(16, dtype=torch.float64)[1].expand(16, 16)
    left = geometric_product(e0, torch.eye(16, dtype=torch.float64)).numpy().T
    by_hand += [left @ np.diag((grades == grade).astype(float)) for grade in range(4)]
    assert len(maps) == 9
    spanned = np.concatenate([maps.reshape(9, -1), np.reshape(by_hand, (9, -1))])
    assert np.linalg.matrix_rank(spanned) == np.linalg.matrix_rank(np.reshape(by_hand, (9, -1))) == 9


@pytest.mark.parametrize("symmetry", SYMMETRIES)
def test_all_that_commutes_is_found_and_nothing_else(symmetry: str) -> None:
    """Beside the maps there are as many as motions themselves leave: the kernel of what random motions change."""
    motors = embed_motor(torch.tensor(motions(12, 3, upright=symmetry == "rooms")))
    unit = torch.eye(16, dtype=torch.float64)
    acts = moved(motors[:, None], unit).transpose(1, 2).numpy()
    if symmetry == "mirrors":
        signs = np.diag([(-1.0) ** (0 if name == "1" else len(name) - 1) for name in FORMS["pga"].channels])
        mirror = geometric_product(geometric_product(unit[2].expand(16, 16), unit), unit[2].expand(16, 16)).numpy().T
        acts = np.concatenate([acts, (mirror @ signs)[None]])
    maps, parts, elements = commuting_maps(symmetry), invariant_parts(symmetry), invariant_elements(symmetry)
    assert_allclose(np.einsum("kab,nbc->nkac", maps, acts), np.einsum("nab,kbc->nkac", acts, maps), atol=1e-10)
    assert_allclose(
        np.einsum("ka,nab->nkb", parts, acts), np.broadcast_to(parts, (len(acts), *parts.shape)), atol=1e-10
    )
    assert_allclose(np.einsum("nab,kb->nka", acts, elements), np.broadcast_to(elements, (len(acts), *elements.shape)),
                    atol=1e-10)  # fmt: skip
    equations = [np.kron(np.eye(16), act.T) - np.kron(act, np.eye(16)) for act in acts]
    assert len(maps) == 256 - np.linalg.matrix_rank(np.concatenate(equations), tol=1e-8)
    assert len(elements) == 16 - np.linalg.matrix_rank(np.concatenate(acts - np.eye(16)), tol=1e-8)
    assert len(parts) == 16 - np.linalg.matrix_rank(np.concatenate(np.swapaxes(acts, 1, 2) - np.eye(16)), tol=1e-8)


def test_an_unknown_symmetry_is_named() -> None:
    with pytest.raises(UniSGError, match=r"unknown symmetry 'room'.*did you mean 'rooms'"):
        commuting_maps("room")


@settings(max_examples=20)
@given(SEEDS)
def test_what_is_embedded_is_moved_as_the_matrix_moves_it(seed: int) -> None:
    matrix = torch.tensor(motions(1, seed))[0]
    motor, values = embed_motor(matrix), random(4, 3, seed=seed)
    turned, placed = values @ matrix[:3, :3].T, values @ matrix[:3, :3].T + matrix[:3, 3]
    assert_allclose(extract_point(moved(motor, embed_point(values))), placed, atol=1e-10)
    assert_allclose(extract_direction(moved(motor, embed_direction(values))), turned, atol=1e-10)
    normals = torch.nn.functional.normalize(values, dim=-1)
    normal, distance = extract_plane(moved(motor, embed_plane(normals, values[:, 0])))
    expected = normals @ matrix[:3, :3].T
    assert_allclose(normal, expected, atol=1e-10)
    assert_allclose(distance, values[:, 0] + expected @ matrix[:3, 3], atol=1e-10)
    other = torch.tensor(motions(3, seed + 1))
    assert_allclose(moved(motor, embed_frame(other)), embed_frame(matrix @ other), atol=1e-10)
    assert_allclose(extract_motor(geometric_product(motor, embed_motor(other))), matrix @ other, atol=1e-10)


def test_extracting_takes_any_weight_and_sign() -> None:
    points, weights = random(5, 3), torch.tensor([1.0, -2.0, 0.1, -0.3, 7.0])[:, None]
    assert_allclose(extract_point(weights * embed_point(points)), points, atol=1e-12)
    assert_allclose(extract_motor(-3.0 * embed_motor(torch.tensor(motions(5, 0)))), motions(5, 0), atol=1e-12)
    for extract in (extract_point, extract_direction):
        assert extract(torch.zeros(2, 16)).isfinite().all()
    assert all(part.isfinite().all() for part in extract_plane(torch.zeros(2, 16)))


def test_a_point_and_a_plane_join_to_their_distance_and_points_to_their_line() -> None:
    point, plane = (
        embed_point(random(3)),
        embed_plane(torch.tensor([0.0, 0.0, 1.0]).double(), torch.tensor(0.5).double()),
    )
    assert abs(float(join(plane, point)[0])) == pytest.approx(abs(float(random(3)[2]) - 0.5))
    other = embed_point(random(3, seed=1))
    length = inner_product(join(point, other), join(point, other)).sqrt()
    assert float(length) == pytest.approx(float((random(3) - random(3, seed=1)).norm()))
