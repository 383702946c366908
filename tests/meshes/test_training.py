from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from unisg_blender.learn.atlasnet.network import AtlasNet, PointNetEncoder  # noqa: E402
from unisg_blender.learn.atlasnet.patch_decoder import PatchDecoder, draw_template  # noqa: E402
from unisg_blender.learn.atlasnet.training import MeshTraining, augment, random_rotation, train  # noqa: E402
from unisg_blender.learn.losses.chamfer import chamfer  # noqa: E402
from unisg_blender.learn.object_categories.training import standing_together, temperature  # noqa: E402
from unisg_blender.meshes.shape_files import ShapeFile  # noqa: E402
from unisg_blender.metrics.point_clouds import chamfer_l2, f_score  # noqa: E402
from unisg_blender.predict.category_model import nearest_of_class  # noqa: E402
from unisg_blender.worlds import WORLDS  # noqa: E402

from .shapes import box, sphere  # noqa: E402

MODELS = [ShapeFile("box", "Box", "train", "box", box()), ShapeFile("ball", "Ball", "train", "ball", sphere(400))]
QUICK = MeshTraining(steps=50, batch=4, points=64, targets=128, drawn=64, patches=4)


def plain(encoder: PointNetEncoder, points: torch.Tensor) -> torch.Tensor:
    hidden = points.reshape(-1, 3)
    for place, (layer, norm) in enumerate(zip(encoder.layers, encoder.norms, strict=True)):
        hidden = norm(layer(hidden))
        hidden = hidden.relu() if place < 2 else hidden
    return hidden.reshape(*points.shape[:2], -1).amax(dim=1)


@pytest.mark.slow
@pytest.mark.parametrize("training", [True, False])
def test_pooling_of_winners_is_exact(training: bool) -> None:
    torch.manual_seed(0)
    first, second = PointNetEncoder().double(), PointNetEncoder().double()
    for norm in first.norms:
        torch.nn.init.normal_(norm.weight)
        torch.nn.init.normal_(norm.bias)
    second.load_state_dict(first.state_dict())
    first.train(training)
    second.train(training)
    points = torch.randn(3, 50, 3, dtype=torch.float64)
    ours, theirs = first(points), plain(second, points)
    assert torch.allclose(ours, theirs, atol=1e-10)
    weights = torch.randn_like(ours)
    (ours * weights).sum().backward()
    (theirs * weights).sum().backward()
    for own, other in zip(first.parameters(), second.parameters(), strict=True):
        assert torch.allclose(own.grad, other.grad, atol=1e-7 * float(other.grad.abs().max() + 1))


def test_folded_encoder_is_the_encoder() -> None:
    torch.manual_seed(1)
    encoder = PointNetEncoder()
    for _ in range(3):
        encoder(torch.randn(4, 60, 3))
    encoder.eval()
    points = torch.randn(2, 30, 3)
    assert torch.allclose(encoder(points), encoder.folded()(points), atol=1e-5)


def test_chamfer_distance_is_that_of_the_evaluation() -> None:
    generator = np.random.default_rng(0)
    first, second = generator.random((2, 40, 3)), generator.random((2, 70, 3))
    ours = chamfer(torch.tensor(first), torch.tensor(second))
    assert np.allclose(ours, [chamfer_l2(a, b) for a, b in zip(first, second, strict=True)])
    assert f_score(first[0], first[0], 1e-6) == 1
    assert f_score(first[0], first[0] + 5, 0.1) == 0


def test_augmented_points_stay_in_the_unit_sphere() -> None:
    generator = np.random.default_rng(0)
    for _ in range(20):
        points = augment(generator.random((100, 3)).astype(np.float32) * (1, 5, 0.1), QUICK, generator)
        assert np.linalg.norm(points, axis=1).max() < 1.05
        turn = random_rotation(generator)
        assert np.allclose(turn @ turn.T, np.eye(3))
        assert np.linalg.det(turn) == pytest.approx(1)


@pytest.mark.slow
def test_training_learns_and_repeats() -> None:
    losses: list[float] = []
    first, report = train(MODELS, QUICK, lambda step, loss: losses.append(loss))
    assert np.mean(losses[-5:]) < 0.5 * losses[0]
    assert report["models"] == 2
    second, _ = train(MODELS, QUICK)
    for own, other in zip(first.parameters(), second.parameters(), strict=True):
        assert torch.equal(own, other)


@pytest.mark.slow
def test_exported_networks_are_the_trained_ones(tmp_path: Path) -> None:
    pytest.importorskip("onnxscript")
    from unisg_blender.learn.atlasnet.export import export
    from unisg_blender.meshes.atlasnet_sessions import load_network

    torch.manual_seed(2)
    network = AtlasNet(5, 32, 3).eval()
    encoder, decoder = (load_network(path) for path in export(network, tmp_path, {"command": "test"}))
    assert decoder.metadata["patches"] == 5
    points, sphere_points = torch.randn(3, 40, 3), torch.nn.functional.normalize(torch.randn(3, 25, 3), dim=2)
    feature = encoder.run(points=points.numpy())[0]
    expected = network.encoder(points).detach().numpy()
    assert np.abs(feature - expected).max() < 2e-3 * np.abs(expected).max()
    patch = torch.arange(75).reshape(3, 25) % 5
    decoded = decoder.run(feature=feature, sphere=sphere_points.numpy(), patch=patch.numpy())[0]
    expected = network.decoder(torch.from_numpy(feature), sphere_points, patch).detach().numpy()
    assert np.abs(decoded - expected).max() < 2e-3


def test_template_points_cover_the_boxes_evenly() -> None:
    frames = torch.zeros(1, 2, 7, 3)
    frames[0, 0, 3:6] = torch.diag(torch.tensor([3.0, 1.0, 1.0]))
    frames[0, 1, 3:6] = 0.5 * torch.eye(3)
    sphere_points, patch = draw_template(frames.flatten(2), 20_000, np.random.default_rng(0))
    assert torch.allclose(sphere_points.norm(dim=2), torch.ones(1, 20_000))
    large = patch[0] == 0
    assert float(large.float().mean()) == pytest.approx(14 / 15.5, abs=0.03)  # surfaces of 56 and 6
    ends = (sphere_points[0, large].abs().argmax(dim=1) == 0).float().mean()
    assert float(ends) == pytest.approx(1 / 7, abs=0.02)


def test_a_patch_is_a_closed_image_of_its_sphere() -> None:
    torch.manual_seed(3)
    decoder = PatchDecoder(3, 16, 2)
    feature, sphere_points = torch.randn(1, 1024), torch.nn.functional.normalize(torch.randn(1, 30, 3), dim=2)
    alone = decoder(feature, sphere_points[:, :1], torch.ones(1, 1, dtype=torch.long))
    together = decoder(feature, sphere_points, torch.ones(1, 30, dtype=torch.long))
    assert torch.allclose(alone[0, 0], together[0, 0], atol=1e-6)
    frame = decoder.layout(feature)[0][0, 1].unflatten(0, (7, 3))
    assert (together[0] - frame[6]).norm(dim=1).max() < 3


def test_no_meshes_is_an_error() -> None:
    from unisg_blender.errors import UniSGError

    with pytest.raises(UniSGError, match="no meshes to train on"):
        train([], QUICK)


def test_nearest_known_mesh_of_each_class() -> None:
    apart = np.array([[3.0, 1, 2, 9, 4]])
    assert np.array_equal(nearest_of_class(apart, np.array([0, 0, 1, 2, 2])), [[1, 2, 4]])


def test_temperature_is_low_where_neighbours_are_right() -> None:
    generator = np.random.default_rng(0)
    classes, families = np.repeat(np.arange(4), 30), np.arange(120)
    centres = generator.normal(size=(4, 20)) * 2
    near = centres[classes] + 0.1 * generator.normal(size=(120, 20))
    mixed = generator.normal(size=(120, 20))
    low, high = (
        temperature(np.linalg.norm(points[:, None] - points, axis=2) / 10, classes, families)
        for points in (near, mixed)
    )
    assert low < high
    assert temperature(np.zeros((2, 2)), np.array([0, 1]), np.array([0, 1])) > 0


def test_things_stand_beside_each_other() -> None:
    graph = WORLDS["operating-room"](3)
    vocabulary = ("Forceps", "Scalpel", "Unicorn", "Waste Bin")
    habits = standing_together([graph], vocabulary)
    assert habits[0, 1] > habits[0, 3] - 1e-9
    assert not habits[2].any()
    assert not standing_together([], vocabulary).any()
