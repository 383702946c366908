"""The anchor mixture: a density, invariant to motions of the room, blind to padding, and the same in ONNX."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from tests.generate.rooms import room  # noqa: E402
from unisg_blender.generate.context import FLAGS  # noqa: E402
from unisg_blender.generate.contract import Contract  # noqa: E402
from unisg_blender.generate.habits import Habits, learn_habits  # noqa: E402
from unisg_blender.generate.model import load_model  # noqa: E402
from unisg_blender.generate.things import things_of  # noqa: E402
from unisg_blender.learn.anchor_batches import Layout, Order, example, padded  # noqa: E402
from unisg_blender.learn.anchor_geometry import base_places, clearances  # noqa: E402
from unisg_blender.learn.anchors import AnchorModel, AnchorSizes, height_nll, mixture_nll  # noqa: E402
from unisg_blender.learn.scenes import TrainingScene  # noqa: E402
from unisg_blender.learn.train_anchors import OUTPUTS, example_inputs, write_anchors  # noqa: E402
from unisg_blender.scene import world_matrices  # noqa: E402

VOCABULARY = ("Cup", "Floor", "Lamp", "Table", "Wall")
PLACES = (
    "target_category", "target_half", "target_bottom", "plan", "row", "category", "box", "flags", "mask",
)  # fmt: skip


@pytest.fixture
def network() -> AnchorModel:
    torch.manual_seed(0)
    return AnchorModel(AnchorSizes(len(VOCABULARY), layers=1)).eval()


def batch_of(seeds: list[int]) -> dict[str, torch.Tensor]:
    examples = []
    for seed in seeds:
        graph = room(seed, cups=1 + seed % 3)
        things = things_of(graph, VOCABULARY)
        order = Order.of(VOCABULARY, learn_habits([things], VOCABULARY))
        world = world_matrices(graph)[things.row]
        layout = Layout(TrainingScene(things, world, world), order)
        target = int(np.flatnonzero(things.category == 0)[0])
        examples.append(example(layout, target, order, np.random.default_rng(seed)))
    return padded(examples)


def places_of(network: AnchorModel, batch: dict[str, torch.Tensor]) -> tuple[torch.Tensor, ...]:
    with torch.no_grad():
        return network.places(*(batch[name] for name in PLACES))


def test_the_mixture_integrates_to_one(network: AnchorModel) -> None:
    batch = batch_of([1])
    batch |= {name: batch[name][:, :1] for name in ("category", "box", "flags", "mask")}  # the table alone
    mixture, middle = places_of(network, batch), batch["box"][0, 0, :2]
    line, step = torch.linspace(-1.2, 1.2, 121), 0.02
    x, y, turn = torch.meshgrid(line, line, torch.linspace(-np.pi, np.pi, 17)[:-1], indexing="ij")
    total = 0.0
    for some in torch.split(torch.stack([x, y, turn], dim=-1).reshape(-1, 3), 40_000):
        count = len(some)
        spread = tuple(part.expand(count, *part.shape[1:]) for part in mixture)
        box = batch["box"].expand(count, 1, 8)
        nll = mixture_nll(spread, box, middle + some[:, :2], some[:, 2])
        total += float((-nll).exp().double().sum())
    assert total * step**2 * (2 * np.pi / 16) == pytest.approx(1.0, abs=0.01)


def test_turning_and_moving_the_room_turns_and_moves_the_places(network: AnchorModel) -> None:
    batch = batch_of([1, 2])
    before = places_of(network, batch)
    angle, shift = 0.7, torch.tensor([3.0, -2.0])
    turn = torch.tensor([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]], dtype=torch.float32)
    box = batch["box"].clone()
    box[..., :2] = box[..., :2] @ turn.T + shift
    box[..., 6:] = box[..., 6:] @ turn.T
    after = places_of(network, batch | {"box": box})
    real = (batch["mask"] > 0).repeat_interleave(48, dim=1)
    torch.testing.assert_close(after[0][real], before[0][real], atol=2e-4, rtol=1e-4)
    torch.testing.assert_close(after[1][real], (before[1] @ turn.T + shift)[real], atol=1e-3, rtol=1e-4)
    torch.testing.assert_close(after[2][real], before[2][real], atol=1e-4, rtol=1e-3)
    turned = torch.remainder(after[3] - before[3] - angle + np.pi, 2 * np.pi) - np.pi
    assert float(turned[real].abs().max()) < 1e-3


def test_the_order_of_the_things_does_not_matter(network: AnchorModel) -> None:
    batch = batch_of([4])
    count = batch["box"].shape[1]
    order = torch.from_numpy(np.random.default_rng(1).permutation(count))
    moved = batch | {name: batch[name][:, order] for name in ("category", "box", "flags", "mask")}
    one, two = places_of(network, batch), places_of(network, moved)
    torch.testing.assert_close(
        two[0].unflatten(1, (count, 48)), one[0].unflatten(1, (count, 48))[:, order], atol=1e-4, rtol=1e-4
    )


def test_padding_is_not_seen(network: AnchorModel) -> None:
    batch = batch_of([4])
    wide = dict(batch)
    for name in ("category", "box", "flags", "mask"):
        extra = torch.full((1, 3, *batch[name].shape[2:]), 2 if name == "category" else 0).to(batch[name].dtype)
        wide[name] = torch.cat([batch[name], extra], dim=1)
    one, two = places_of(network, batch), places_of(network, wide)
    torch.testing.assert_close(two[0][:, : one[0].shape[1]], one[0], atol=1e-4, rtol=1e-4)
    assert float(two[0][:, one[0].shape[1] :].max()) < -1000
    for start, stop in zip(one[1:], two[1:], strict=True):
        torch.testing.assert_close(stop[:, : start.shape[1]], start, atol=1e-4, rtol=1e-4)


def test_base_places_touch_the_sides(network: AnchorModel) -> None:
    box = torch.tensor([[[0, 0, 0, 1.0, 0.5, 0.4, 1, 0]]])
    flags = torch.zeros(1, 1, FLAGS)
    x, y, turn = base_places(box, flags, torch.tensor([[0.3, 0.1, 0.2]]))
    quarter = (turn / (np.pi / 2)).round().long() % 2
    reach_x = torch.where(quarter == 0, 0.3, 0.1)
    reach_y = torch.where(quarter == 0, 0.1, 0.3)
    gap = torch.maximum(x.abs()[0, 0] - 1.0 - reach_x, y.abs()[0, 0] - 0.5 - reach_y)
    torch.testing.assert_close(gap, torch.zeros(48), atol=1e-6, rtol=0)
    on_x, on_y, _ = base_places(box, flags + torch.eye(FLAGS)[0], torch.tensor([[0.3, 0.1, 0.2]]))
    assert ((on_x.abs()[0, 0] + reach_x <= 1.0 + 1e-6) & (on_y.abs()[0, 0] + reach_y <= 0.5 + 1e-6)).all()


def test_clearances_are_depths_and_gaps_to_the_nearest_obstacle() -> None:
    box = torch.tensor([[[0, 0, 0.5, 2.0, 2.0, 0.5, 1, 0], [1.0, 0, 1.2, 0.3, 0.2, 0.2, 0.8, 0.6]]])
    flags = torch.zeros(1, 2, FLAGS)
    flags[0, 0, 0], flags[0, 0, 5] = 1, 0.25  # the support
    half, bottom, mask = torch.tensor([[0.1, 0.1, 0.1]]), torch.tensor([1.0]), torch.ones(1, 2)

    def at(x: float, y: float, tolerance: float = 0.0) -> list[float]:
        places = torch.zeros(1, 2, 48)
        found = clearances(box, flags, mask, half, bottom, torch.full((1, 2), tolerance), places + x, places + y)
        return [float(part[0, 0, 0]) for part in found]

    assert at(1.0, 0.0)[0] == pytest.approx(0.34)  # along its own narrow side: 0.2 and (0.8 + 0.6) times 0.1
    assert at(1.0, 0.0, 0.1)[0] == pytest.approx(0.24)
    assert at(1.95, 0.0)[1] == pytest.approx(0.05)  # over the edge of the support
    _, inside, room_x, room_y = at(0.0, 0.0)
    assert inside == pytest.approx(-1.0)
    assert room_x == pytest.approx(1.0 - 0.36 - 0.1)  # 0.36: half its width as seen along x
    assert room_y == pytest.approx(10.0)
    assert at(1.0, 0.0)[2] == pytest.approx(10.0)  # what is met already does not count
    flags[0, 1, 2] = 1  # something that holds the support is no obstacle
    assert at(1.0, 0.0)[0] == pytest.approx(-1.0)


def test_heights_are_a_density(network: AnchorModel) -> None:
    batch = batch_of([1])
    with torch.no_grad():
        _, *heights = network.choose(
            *(batch[name] for name in ("target_category", "target_half", "coming")),
            *(batch[f"support_{name}"] for name in ("category", "holder", "half", "load", "content")),
        )
    z = torch.linspace(-20, 20, 400_001)
    weight, mean, sigma = (part[:, 0].expand(len(z), -1) for part in heights)
    total = float((-height_nll(weight, mean, sigma, z)).exp().double().sum()) * 1e-4
    assert total == pytest.approx(1.0, abs=1e-3)


def test_onnxruntime_agrees_with_torch(network: AnchorModel, tmp_path: Path) -> None:
    path = tmp_path / "model.onnx"
    write_anchors(network, Contract("anchors", VOCABULARY, Habits({}, {}, {}, [])), path)
    model = load_model(path)
    for targets, tokens, supports in ((1, 1, 1), (3, 7, 20), (2, 40, 90)):
        inputs = example_inputs(len(VOCABULARY), targets, tokens, supports)
        found = model.run(list(OUTPUTS), **{name: value.numpy() for name, value in inputs.items()})
        with torch.no_grad():
            for ours, theirs in zip(found, network(**inputs), strict=True):
                np.testing.assert_allclose(ours, theirs.numpy(), atol=1e-5, rtol=1e-5)
