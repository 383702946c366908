from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.meshes import AtlasNetEncoder, decode_cloud, decode_mesh
from unisg_blender.meshes.atlasnet_sessions import load_network
from unisg_blender.meshes.decode import allot, decode_unit, patch_areas, signed_volume
from unisg_blender.meshes.feature_text import feature_from_text, feature_to_text
from unisg_blender.meshes.normalise import normalise
from unisg_blender.meshes.shape_feature import atlasnet_feature, cloud
from unisg_blender.meshes.sphere import box_template, sphere_template
from unisg_blender.scene import Mesh, mesh_from_faces

from .shapes import box, is_closed_and_oriented, joined, sphere


@pytest.fixture(scope="module")
def encoder() -> AtlasNetEncoder:
    return AtlasNetEncoder()


def test_normalised_and_back() -> None:
    points = np.random.default_rng(0).normal(size=(200, 3)) * (1, 2, 30) + (5, 6, 7)
    unit, placement = normalise(points)
    assert np.linalg.norm(unit, axis=1).max() == pytest.approx(1, abs=1e-6)
    assert np.allclose(unit.mean(axis=0), 0, atol=1e-6)
    assert np.allclose(placement.restore(unit), points, atol=1e-4)


def test_coinciding_points_do_not_divide_by_zero() -> None:
    unit, placement = normalise(np.full((10, 3), 1e6, np.float32))
    assert not unit.any()
    assert placement.scale == 1


def test_feature_of_a_mesh(encoder: AtlasNetEncoder) -> None:
    feature = encoder.encode([box((1, 2, 3), (10, 0, 0))])[0]
    assert feature.vector.shape == (1024,)
    assert feature.vector.dtype == np.float32
    assert np.allclose(feature.placement.center, (10.5, 1, 1.5), atol=0.05)
    assert feature.placement.scale == pytest.approx(np.sqrt(14) / 2, rel=0.05)


def test_size_and_place_do_not_change_the_vector(encoder: AtlasNetEncoder) -> None:
    small, large = encoder.encode([box((1, 2, 3)), box((10, 20, 30), (-7, 8, 9))])
    assert np.allclose(small.vector, large.vector, atol=1e-3 * np.abs(small.vector).max())


def test_batches_give_what_single_meshes_give() -> None:
    meshes = [box((1, 1 + k, 2)) for k in range(20)]
    together = AtlasNetEncoder().encode(meshes)
    for mesh, feature in zip(meshes[::7], together[::7], strict=True):
        assert np.allclose(AtlasNetEncoder().encode([mesh])[0].vector, feature.vector, atol=1e-4)


def test_shared_geometry_is_encoded_once(monkeypatch: pytest.MonkeyPatch) -> None:
    encoder, seen = AtlasNetEncoder(), []
    run = encoder.encode_clouds
    monkeypatch.setattr(encoder, "encode_clouds", lambda clouds: seen.append(len(clouds)) or run(clouds))
    same = mesh_from_faces("other name", box().points, [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3],
                                                        [0, 4, 6, 2], [1, 3, 7, 5]])  # fmt: skip
    first, second = encoder.encode([box(), same])
    encoder.encode([box(), sphere()])
    assert seen == [1, 1]
    assert np.array_equal(first.vector, second.vector)


@pytest.mark.parametrize("count", [1, 3, 5000])
def test_a_point_cloud_is_encoded_from_its_points(count: int) -> None:
    points = np.random.default_rng(1).random((count, 3))
    mesh = mesh_from_faces("cloud", points, [])
    found = cloud(mesh, 1024)
    assert found.shape == (1024, 3)
    assert len(np.unique(found, axis=0)) == min(count, 1024)
    assert np.isfinite(atlasnet_feature(mesh)).all()


def test_broken_points_are_passed_over() -> None:
    points = np.vstack([box().points, [[np.nan, 0, 0]]])
    faces = [mesh_face.tolist() for mesh_face in box().corners.reshape(-1, 4)]
    broken = mesh_from_faces("broken", points, [*faces, [0, 1, 8]])
    assert np.allclose(atlasnet_feature(broken), atlasnet_feature(box()), atol=0.05)


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.full((4, 3), np.nan)])
def test_a_mesh_without_points(points: np.ndarray, encoder: AtlasNetEncoder) -> None:
    mesh = mesh_from_faces("empty", points, [])
    with pytest.raises(UniSGError, match="'empty' has no points"):
        encoder.encode([mesh])
    assert not encoder(mesh).any()


@pytest.mark.parametrize("faces", [4, 5, 6, 50, 101, 2000])
def test_decoded_mesh_is_closed_with_the_chosen_number_of_faces(faces: int, encoder: AtlasNetEncoder) -> None:
    mesh = decode_mesh(encoder.encode([box((1, 2, 3), (4, 0, 0))])[0], faces)
    assert len(mesh.offsets) - 1 == faces + faces % 2
    assert is_closed_and_oriented(mesh.triangles)
    assert signed_volume(mesh.points, mesh.triangles) > 0


def test_decoded_shape_is_near_the_encoded_one(encoder: AtlasNetEncoder) -> None:
    truth = box((1.0, 1.6, 0.8), (4, 5, 6))
    feature = encoder.encode([truth])[0]
    points = decode_cloud([feature], 2000)[0]
    outside = np.maximum(np.maximum(truth.bounds[0] - points, points - truth.bounds[1]), 0)
    assert np.linalg.norm(outside, axis=1).mean() < 0.08
    assert (np.ptp(points, axis=0) / (1.0, 1.6, 0.8) > 0.6).all()


def test_no_faces_is_an_error() -> None:
    for make in (sphere_template, box_template, lambda faces: decode_unit(np.zeros(1024, np.float32), faces)):
        with pytest.raises(UniSGError, match="4 faces or more"):
            make(3)


@pytest.mark.parametrize("faces", [4, 7, 12, 30, 500])
def test_a_sphere_cut_like_a_box(faces: int) -> None:
    points, triangles = box_template(faces)
    assert len(triangles) == faces + faces % 2
    assert is_closed_and_oriented(triangles)
    assert signed_volume(points, triangles) > 0
    assert np.allclose(np.linalg.norm(points, axis=1), 1)


def test_faces_of_a_box_do_not_cross_its_edges() -> None:
    points, triangles = box_template(500)
    box_points = points / np.abs(points).max(axis=1, keepdims=True)
    assert signed_volume(box_points, triangles) == pytest.approx(8)


def test_patches_share_the_faces_by_area(encoder: AtlasNetEncoder) -> None:
    vector = encoder.encode([box((1, 2, 3))])[0].vector
    areas = patch_areas(vector)
    assert len(areas) > 1
    assert (areas > 0).all()
    assert allot(101, areas, 3).sum() == 101
    assert allot(10, np.array([0.1, 5, 3]), 2).tolist() == [2, 5, 3]
    assert len(np.unique(decode_unit(vector, 6)[1])) == 5  # one patch remains


def test_stored_feature_round_trip(encoder: AtlasNetEncoder) -> None:
    feature = encoder.encode([joined(box(), sphere(200))])[0]
    back = feature_from_text(feature_to_text(feature))
    assert np.array_equal(back.vector, feature.vector)
    assert np.array_equal(back.placement.center, feature.placement.center)
    assert back.placement.scale == feature.placement.scale


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"version": 1, "vector": "AAAA", "center": [0, 0, 0], "scale": 1}'])
def test_a_damaged_stored_feature(text: str) -> None:
    with pytest.raises(UniSGError, match="encode the mesh again"):
        feature_from_text(text)


def test_unusable_model_files(tmp_path: Path) -> None:
    with pytest.raises(UniSGError, match="there is no model"):
        load_network(tmp_path / "missing.onnx")
    (tmp_path / "damaged.onnx").write_bytes(b"nothing")
    with pytest.raises(UniSGError, match="is no ONNX model: give another file"):
        load_network(tmp_path / "damaged.onnx")


def test_a_model_for_something_else(tmp_path: Path) -> None:
    onnx = pytest.importorskip("onnx")
    info = onnx.helper.make_tensor_value_info("x", 1, [1])
    node = onnx.helper.make_node("Identity", ["x"], ["y"])
    graph = onnx.helper.make_graph([node], "g", [info], [onnx.helper.make_tensor_value_info("y", 1, [1])])
    model = onnx.helper.make_model(graph, opset_imports=[onnx.helper.make_opsetid("", 18)], ir_version=10)
    onnx.helper.set_model_props(model, {"unisg": '{"contract": 1, "task": "generate"}'})
    onnx.save(model, tmp_path / "other.onnx")
    with pytest.raises(UniSGError, match="model for 'generate'"):
        load_network(tmp_path / "other.onnx")


def test_many_faces_take_bounded_memory_and_time() -> None:
    import tracemalloc

    side = 500
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side), [0.0], indexing="ij"), axis=-1).reshape(-1, 3)
    low = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    corners = np.stack([low, low + side, low + side + 1, low + 1], axis=1).astype(np.int32)
    mesh = Mesh("terrain", grid.astype(np.float32), corners.ravel(), np.arange(len(corners) + 1, dtype=np.int32) * 4)
    tracemalloc.start()
    assert cloud(mesh, 1024).shape == (1024, 3)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 600 * 2 * len(corners)  # bytes: 600 for each triangle
