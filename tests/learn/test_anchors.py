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
from unisg_blender.learn.anchor_collisions import collision_term, drawn  # noqa: E402
from unisg_blender.learn.anchor_geometry import FREE, base_places, clearances, depths  # noqa: E402
from unisg_blender.learn.anchor_latent import LATENT, PoseEncoder, kl_divergence  # noqa: E402
from unisg_blender.learn.anchors import AnchorModel, AnchorSizes, height_nll, mixture_nll  # noqa: E402
from unisg_blender.learn.scenes import TrainingScene  # noqa: E402
from unisg_blender.learn.train_anchors import OUTPUTS, example_inputs, write_anchors  # noqa: E402
from unisg_blender.scene import world_matrices  # noqa: E402

VOCABULARY = ("Cup", "Floor", "Lamp", "Table", "Wall")
PLACES = (
    "target_category", "target_half", "target_bottom", "plan", "row", "latent", "category", "box",
    "flags", "mask",
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
    codes = torch.linspace(-1, 1, LATENT).expand(len(batch["mask"]), -1)
    with torch.no_grad():
        return network.places(*({"latent": codes, **batch}[name] for name in PLACES))


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
        nll = mixture_nll(spread, box, (middle + some[:, :2]).unsqueeze(1), some[:, 2:])
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
    half = torch.tensor([[0.3, 0.1, 0.2]])
    x, y, turn = base_places(box, flags, half, torch.zeros(1))
    quarter = (turn / (np.pi / 2)).round().long() % 2
    reach_x = torch.where(quarter == 0, 0.3, 0.1)
    reach_y = torch.where(quarter == 0, 0.1, 0.3)
    gap = torch.maximum(x.abs()[0, 0] - 1.0 - reach_x, y.abs()[0, 0] - 0.5 - reach_y)
    torch.testing.assert_close(gap, torch.zeros(48), atol=1e-6, rtol=0)
    on_x, on_y, _ = base_places(box, flags + torch.eye(FLAGS)[0], half, torch.zeros(1))
    over_x, over_y, _ = base_places(box, flags, half, torch.ones(1))  # above it: places over it
    torch.testing.assert_close(torch.stack([over_x, over_y]), torch.stack([on_x, on_y]))
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


def test_depths_agree_with_clearances_and_know_any_heading() -> None:
    box = torch.tensor([[[0, 0, 0.5, 2.0, 2.0, 0.5, 1, 0], [1.0, 0, 1.2, 0.3, 0.2, 0.2, 0.8, 0.6]]])
    flags = torch.zeros(1, 2, FLAGS)
    flags[0, 0, 0], flags[0, 0, 5] = 1, 0.25  # the support
    half, bottom, mask, none = torch.tensor([[0.3, 0.1, 0.1]]), torch.tensor([1.0]), torch.ones(1, 2), torch.zeros(1, 2)
    place = torch.tensor([[[0.9, 0.1], [1.0, 0.0], [-1.0, 0.0]]])
    heading = torch.tensor([[0.0, np.arctan2(0.6, 0.8), 0.3]])
    found = depths(box, flags, mask, half, bottom, none, place, heading)[0]
    grid = torch.zeros(1, 2, 48)
    straight = clearances(box, flags, mask, half, bottom, none, grid + 0.9, grid + 0.1)[0]
    assert float(found[0]) == pytest.approx(float(straight[0, 0, 0]), abs=1e-6)
    assert float(found[1]) == pytest.approx(0.3)  # turned alike: the smaller way out, 0.2 and 0.1
    assert float(found[2]) < 0


def test_nothing_stands_behind_a_wall_unless_the_wall_holds_it() -> None:
    box = torch.tensor([[[0, 0, -0.1, 3.0, 3.0, 0.1, 1, 0], [0, 2.0, 1.5, 3.0, 0.1, 1.5, 1, 0]]])
    flags = torch.zeros(1, 2, FLAGS)
    flags[0, 0, 0], flags[0, 1, 4] = 1, -1  # a floor, and a wall whose room is towards -y
    half, bottom, mask, none = torch.tensor([[0.1, 0.1, 0.1]]), torch.zeros(1), torch.ones(1, 2), torch.zeros(1, 2)
    places, heading = torch.tensor([[[0, 1.5], [0, 1.85], [0, 2.5], [0, 3.5]]]), torch.zeros(1, 4)
    in_front, touching, behind, far = depths(box, flags, mask, half, bottom, none, places, heading)[0]
    assert in_front == pytest.approx(-0.3, abs=1e-6)
    assert touching == pytest.approx(0.05, abs=1e-6)
    assert behind > 0.4
    assert far > 0.1  # within a metre and a half
    flags[0, 0, 0], flags[0, 1, 0] = 0, 1
    assert float(depths(box, flags, mask, half, bottom, none, places, heading)[0, 2]) < FREE / 2


def test_the_collision_term_moves_weight_away_from_obstacles(network: AnchorModel) -> None:
    batch = batch_of([4, 5, 6, 7])
    codes = torch.zeros(4, LATENT)

    def mixture() -> tuple[torch.Tensor, ...]:
        given = [codes if name == "latent" else batch[name] for name in PLACES]
        return network.places(*given)

    optimizer = torch.optim.SGD(network.parameters(), 0.05)
    torch.manual_seed(0)
    with torch.no_grad():
        before = np.mean([float(collision_term(network, mixture(), batch)[1].mean()) for _ in range(60)])
    for _ in range(60):
        term, _ = collision_term(network, mixture(), batch)
        optimizer.zero_grad()
        term.mean().backward()
        optimizer.step()
    with torch.no_grad():
        after = np.mean([float(collision_term(network, mixture(), batch)[1].mean()) for _ in range(60)])
    assert before > 0.02
    assert after < 0.5 * before


def test_draws_follow_the_mixture(network: AnchorModel) -> None:
    batch = batch_of([3])
    weight, mean, *rest = places_of(network, batch)
    only = torch.full_like(weight, -1e4)
    only[0, 5] = 0.0
    torch.manual_seed(1)
    position, _ = drawn((only, mean, *rest), batch["box"])
    limit = 6 * float(rest[0][0, 5].max())
    assert float((position[0] - mean[0, 5]).norm(dim=-1).max()) < limit


def test_the_encoder_sees_poses_only_relative_to_things() -> None:
    torch.manual_seed(0)
    encoder = PoseEncoder(4, FLAGS, LATENT)
    box = torch.rand(2, 3, 8)
    box[..., 6:] = torch.nn.functional.normalize(box[..., 6:], dim=-1)
    flags, mask, target, others = torch.zeros(2, 3, FLAGS), torch.ones(2, 3), torch.rand(2, 4), torch.rand(2, 3, 4)
    position, heading, angle = torch.rand(2, 2), torch.rand(2), 0.7
    turn = torch.tensor([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]], dtype=torch.float32)
    moved = box.clone()
    moved[..., :2] = box[..., :2] @ turn.T + 2.0
    moved[..., 6:] = box[..., 6:] @ turn.T
    one = encoder(target, others, box, flags, mask, position, heading)
    two = encoder(target, others, moved, flags, mask, position @ turn.T + 2.0, heading + angle)
    torch.testing.assert_close(one, two, atol=1e-4, rtol=1e-4)
    changed = encoder(target, others, box, flags, mask, position + 0.3, heading)
    assert float((changed[0] - one[0]).detach().abs().max()) > 1e-4


def test_the_divergence_of_the_standard_normal_is_zero() -> None:
    zero = torch.zeros(1, LATENT)
    assert float(kl_divergence(zero, zero)) == 0.0
    assert float(kl_divergence(zero + 1, zero)) == pytest.approx(LATENT / 2)
    spread = torch.distributions.Normal(0.3, 0.5)
    known = torch.distributions.kl_divergence(spread, torch.distributions.Normal(0.0, 1.0))
    assert float(kl_divergence(zero[:, :1] + 0.3, zero[:, :1] + 2 * np.log(0.5))) == pytest.approx(float(known))


def test_heights_are_a_density(network: AnchorModel) -> None:
    batch = batch_of([1])
    with torch.no_grad():
        _, *heights = network.choose(
            *(batch[name] for name in ("target_category", "target_half", "coming")),
            *(batch[f"support_{name}"] for name in ("category", "holder", "half", "load", "content", "near")),
        )
    z = torch.linspace(-20, 20, 400_001)
    weight, mean, sigma = (part[:, 0].expand(len(z), -1) for part in heights)
    total = float((-height_nll(weight, mean, sigma, z)).exp().double().sum()) * 1e-4
    assert total == pytest.approx(1.0, abs=1e-3)


def test_onnxruntime_agrees_with_torch(network: AnchorModel, tmp_path: Path) -> None:
    path = tmp_path / "model.onnx"
    write_anchors(network, Contract("anchors", VOCABULARY, Habits({}, {}, {}, []), latent=LATENT), path)
    model = load_model(path)
    for targets, tokens, supports in ((1, 1, 1), (3, 7, 20), (2, 40, 90)):
        inputs = example_inputs(len(VOCABULARY), targets, tokens, supports)
        found = model.run(list(OUTPUTS), **{name: value.numpy() for name, value in inputs.items()})
        with torch.no_grad():
            for ours, theirs in zip(found, network(**inputs), strict=True):
                np.testing.assert_allclose(ours, theirs.numpy(), atol=1e-5, rtol=1e-5)
