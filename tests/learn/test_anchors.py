"""The anchor mixture: a density, invariant to motions of the room, blind to padding, and the same in ONNX."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import truncnorm

torch = pytest.importorskip("torch")

from tests.generate.rooms import room  # noqa: E402
from unisg_blender.generate.observe.contract import Contract  # noqa: E402
from unisg_blender.generate.observe.observed_scene import ObservedScene  # noqa: E402
from unisg_blender.generate.observe.prior_tables import PriorTables  # noqa: E402
from unisg_blender.generate.observe.scene_tokens import FLAGS  # noqa: E402
from unisg_blender.generate.observe.support_priors import CategoryPriors, learn_priors  # noqa: E402
from unisg_blender.generate.propose.mixture import TAIL  # noqa: E402
from unisg_blender.generate.propose.trained_model import load_model  # noqa: E402
from unisg_blender.learn.anchors.critic import DRAWS, drawn  # noqa: E402
from unisg_blender.learn.anchors.examples import (  # noqa: E402
    BARE,
    JITTER,
    LESS,
    RANDOM_SUBSETS,
    TURN_JITTER,
    RoomLayout,
    example,
    padded,
    shaken,
    visible_with,
)
from unisg_blender.learn.anchors.network import AnchorModel, AnchorSizes  # noqa: E402
from unisg_blender.learn.anchors.pair_geometry import base_places  # noqa: E402
from unisg_blender.learn.anchors.pose_encoder import LATENT, PoseEncoder  # noqa: E402
from unisg_blender.learn.anchors.training import OUTPUTS, example_inputs, write_anchors  # noqa: E402
from unisg_blender.learn.losses.mixtures import height_nll, mixture_nll  # noqa: E402
from unisg_blender.learn.losses.ranking import ranking_loss  # noqa: E402
from unisg_blender.learn.losses.variational import kl_divergence  # noqa: E402
from unisg_blender.learn.training_scenes import TrainingScene  # noqa: E402
from unisg_blender.scene import world_matrices  # noqa: E402
from unisg_blender.spatial.objects import scene_objects  # noqa: E402

VOCABULARY = ("Cup", "Floor", "Lamp", "Table", "Wall")


@pytest.fixture
def network() -> AnchorModel:
    torch.manual_seed(0)
    return AnchorModel(AnchorSizes(len(VOCABULARY), layers=1)).eval()


def batch_of(seeds: list[int]) -> dict[str, torch.Tensor]:
    examples = []
    for seed in seeds:
        graph = room(seed, cups=1 + seed % 3)
        objects = scene_objects(graph, VOCABULARY)
        tables = PriorTables.of(learn_priors([objects], VOCABULARY), VOCABULARY)
        world = world_matrices(graph)[objects.row]
        layout = RoomLayout(TrainingScene(objects, world, world), tables)
        target = int(np.flatnonzero(objects.category == 0)[0])
        examples.append(example(layout, target, tables, np.random.default_rng(seed)))
    return padded(examples)


def test_the_building_is_there_before_all_else() -> None:
    graph = room(3, cups=2)
    objects = scene_objects(graph, VOCABULARY)
    tables = PriorTables.of(learn_priors([objects], VOCABULARY), VOCABULARY)
    world = world_matrices(graph)[objects.row]
    layout = RoomLayout(TrainingScene(objects, world, world), tables)
    table, walls = int(np.flatnonzero(objects.category == 3)[0]), objects.category == 4
    seen = [visible_with(layout, table, np.random.default_rng(seed)) for seed in range(200)]
    whole = np.mean([chosen[walls].all() and placed[walls].all() for chosen, placed, _ in seen])
    assert whole >= 1 - 2 * BARE
    assert whole < 1
    assert not any(placed[table] for _, placed, _ in seen)


def test_in_order_rows_are_filled_from_one_end_and_otherwise_anyhow() -> None:
    objects = scene_objects(graph := room(3, cups=4), VOCABULARY)
    tables, world = PriorTables.of(learn_priors([objects], VOCABULARY), VOCABULARY), world_matrices(graph)[objects.row]
    layout = RoomLayout(TrainingScene(objects, world, world), tables)
    cups = np.flatnonzero(objects.category == 0)
    ordered, from_one_end = [], []
    for seed in range(400):
        target = cups[seed % 4]
        _, placed, in_order = visible_with(layout, int(target), np.random.default_rng(seed))
        ordered.append(in_order)
        from_one_end.append((placed[cups] == (layout.row[cups] < layout.row[target])).all())
    assert np.mean(ordered) == pytest.approx(1 - RANDOM_SUBSETS, abs=0.1)
    assert np.all(np.array(from_one_end)[ordered])
    assert np.mean(np.array(from_one_end)[~np.array(ordered)]) < 0.5


def test_the_whole_is_all_that_lies_there_and_else_less_may_come() -> None:
    objects = scene_objects(graph := room(3, cups=4), VOCABULARY)
    tables, world = PriorTables.of(learn_priors([objects], VOCABULARY), VOCABULARY), world_matrices(graph)[objects.row]
    layout = RoomLayout(TrainingScene(objects, world, world), tables)
    cups, beside = np.flatnonzero(objects.category == 0), {True: [], False: []}
    for seed in range(400):
        seen = example(layout, int(cups[seed % 4]), tables, np.random.default_rng(seed))
        there, coming = seen["flags"][:, 1].sum(), np.expm1(seen["row"]).sum()
        assert seen["whole"] == seen["plan"][-1]
        beside[bool(seen["whole"])].append(round(float(there + coming)))
    assert set(beside[True]) == {3}
    assert min(beside[False]) < 3
    assert len(beside[True]) / 400 == pytest.approx((1 - RANDOM_SUBSETS) * (1 - LESS), abs=0.1)


def test_shaking_does_not_turn_walls() -> None:
    objects = scene_objects(graph := room(3, cups=2), VOCABULARY)
    scene, walls = ObservedScene.of(objects, world_matrices(graph)[objects.row]), objects.category == 4
    seen = [shaken(scene, np.random.default_rng(seed), 1.0, walls) for seed in range(100)]
    turns, moves = np.abs([one.yaw - scene.yaw for one in seen]), np.abs([one.center - scene.center for one in seen])
    assert turns[:, walls].max() == 0
    assert np.radians(1) < turns[:, ~walls].max() <= TURN_JITTER
    assert 0 < moves[:, walls].max() <= JITTER + 1e-12
    assert moves[..., 2].max() == 0


def places_of(network: AnchorModel, batch: dict[str, torch.Tensor]) -> tuple[torch.Tensor, ...]:
    codes = torch.linspace(-1, 1, LATENT).expand(len(batch["mask"]), -1)
    with torch.no_grad():
        return network.places({"latent": codes, **batch})


def test_the_mixture_integrates_to_one(network: AnchorModel) -> None:
    batch = batch_of([1])
    batch |= {name: batch[name][:, :1] for name in ("category", "box", "flags", "mask")}  # the table alone
    mixture, middle = places_of(network, batch)[:-1], batch["box"][0, 0, :2]
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


def with_padding(batch: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """The same with three tokens that are not there."""
    wide = dict(batch)
    for name in ("category", "box", "flags", "mask"):
        extra = torch.full((1, 3, *batch[name].shape[2:]), 2 if name == "category" else 0).to(batch[name].dtype)
        wide[name] = torch.cat([batch[name], extra], dim=1)
    return wide


def test_padding_is_not_seen(network: AnchorModel) -> None:
    batch = batch_of([4])
    wide = with_padding(batch)
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


def judged(network: AnchorModel, batch: dict[str, torch.Tensor], place: torch.Tensor) -> torch.Tensor:
    view = places_of(network, batch)[-1]
    return network.judge(batch, view, place)


def some_places(batch: dict[str, torch.Tensor], count: int) -> torch.Tensor:
    torch.manual_seed(2)
    spread = torch.randn(len(batch["box"]), count, 3)
    return spread + torch.cat([batch["position"], batch["heading"].unsqueeze(1)], dim=1).unsqueeze(1)


def test_the_critic_sees_places_only_relative_to_things(network: AnchorModel) -> None:
    batch = batch_of([1, 2])
    place, angle, shift = some_places(batch, 5), 0.7, torch.tensor([3.0, -2.0])
    turn = torch.tensor([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]], dtype=torch.float32)
    moved, box = place.clone(), batch["box"].clone()
    box[..., :2], moved[..., :2] = box[..., :2] @ turn.T + shift, place[..., :2] @ turn.T + shift
    box[..., 6:] = box[..., 6:] @ turn.T
    moved[..., 2] += angle
    one, two = judged(network, batch, place), judged(network, batch | {"box": box}, moved)
    torch.testing.assert_close(two, one, atol=1e-3, rtol=1e-3)
    assert float(one.detach().std()) > 0


def test_the_critic_does_not_see_padding(network: AnchorModel) -> None:
    batch = batch_of([4])
    wide = with_padding(batch)
    place = some_places(batch, 5)
    torch.testing.assert_close(judged(network, wide, place), judged(network, batch, place), atol=1e-4, rtol=1e-4)


def test_the_critic_learns_to_tell_true_places(network: AnchorModel) -> None:
    batch = batch_of([4, 5, 6, 7])
    true = torch.cat([batch["position"], batch["heading"].unsqueeze(1)], dim=1).unsqueeze(1)
    mixture = places_of(network, batch)[:-1]
    optimizer = torch.optim.Adam(network.critic.parameters(), 0.01)
    losses = []
    torch.manual_seed(0)
    for _ in range(60):
        loss = ranking_loss(judged(network, batch, torch.cat([true, drawn(mixture, batch["box"])], dim=1))).mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(float(loss.detach()))
    assert losses[0] == pytest.approx(np.log(1 + DRAWS), abs=0.5)
    assert np.mean(losses[-10:]) < 0.5 * losses[0]


def test_draws_follow_the_mixture(network: AnchorModel) -> None:
    batch = batch_of([3])
    weight, mean, sigma, heading, kappa, _ = places_of(network, batch)
    only = torch.full_like(weight, -1e4)
    only[0, 5] = 0.0
    torch.manual_seed(1)
    place = drawn((only, mean, sigma, heading, kappa + 1e6), batch["box"], 4000)[0]
    cos, sin = batch["box"][0, 0, 6:]
    offset = place[:, :2] - mean[0, 5]
    along = torch.stack([cos * offset[:, 0] + sin * offset[:, 1], cos * offset[:, 1] - sin * offset[:, 0]], -1)
    z = along / sigma[0, 5]
    assert float(z.abs().max()) <= TAIL + 1e-3
    cut = float(truncnorm.std(-TAIL, TAIL))
    torch.testing.assert_close(z.std(dim=0), torch.full((2,), cut), atol=0.03, rtol=0)
    assert float((place[:, 2] - heading[0, 5]).abs().max()) < 0.01


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
        _, *heights = network.choose(batch)
    z = torch.linspace(-20, 20, 400_001)
    weight, mean, sigma = (part[:, 0].expand(len(z), -1) for part in heights)
    total = float((-height_nll(weight, mean, sigma, z)).exp().double().sum()) * 1e-4
    assert total == pytest.approx(1.0, abs=1e-3)


@pytest.mark.slow
def test_onnxruntime_agrees_with_torch(network: AnchorModel, tmp_path: Path) -> None:
    path = tmp_path / "model.onnx"
    write_anchors(network, Contract("anchors", VOCABULARY, CategoryPriors({}, {}, {}, []), latent=LATENT), path)
    model = load_model(path)
    for targets, tokens, supports in ((1, 1, 1), (3, 7, 20), (2, 40, 90)):
        inputs = example_inputs(network, targets=targets, tokens=tokens, supports=supports)
        found = model.run(list(OUTPUTS), **{name: value.numpy() for name, value in inputs.items()})
        with torch.no_grad():
            for ours, theirs in zip(found, network(**inputs), strict=True):
                np.testing.assert_allclose(ours, theirs.numpy(), atol=1e-5, rtol=1e-5)
