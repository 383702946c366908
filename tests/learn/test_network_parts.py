"""What networks compute outside of their weights: frames, waves, attention, mixtures; each beside a plain loop."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytest.importorskip("torch")

import torch
from torch import Tensor, nn

from unisg_blender.learn.anchors import network as anchors
from unisg_blender.learn.anchors.critic import CLOSE, FINE, PlaceCritic, _boxes_at, _seen_from
from unisg_blender.learn.anchors.network import LEVELS, LOG_KAPPA, SIGMA_FLOOR, AnchorModel, AnchorSizes, _size_features
from unisg_blender.learn.anchors.pair_geometry import PAIR_FEATURES, base_places, pair_features, relative, scale_of
from unisg_blender.learn.anchors.pose_encoder import PoseEncoder, _in_frames
from unisg_blender.learn.atiss import network as atiss

RNG = np.random.default_rng(3)


def boxes(count: int) -> np.ndarray:
    """Boxes (1, count, 8) anywhere."""
    yaw = RNG.uniform(-np.pi, np.pi, count)
    return np.column_stack([RNG.normal(size=(count, 3)), RNG.uniform(0.1, 1, (count, 3)), np.cos(yaw), np.sin(yaw)])[
        None
    ]


def tensor(values: np.ndarray) -> Tensor:
    return torch.from_numpy(np.asarray(values, np.float64))


def corners(box: np.ndarray) -> np.ndarray:
    x, y, _, a, b, _, cos, sin = box
    return np.array([[x + i * a * cos - j * b * sin, y + i * a * sin + j * b * cos] for i in (-1, 1) for j in (-1, 1)])


def seen(points: np.ndarray, box: np.ndarray) -> np.ndarray:
    cos, sin = box[6], box[7]
    return (points - box[:2]) @ np.array([[cos, -sin], [sin, cos]])


def test_others_lie_in_the_boxes_frames() -> None:
    mine, others = boxes(4), boxes(5)
    found = [part[0].numpy() for part in relative(tensor(mine), tensor(others))]
    for m, box in enumerate(mine[0]):
        for n, other in enumerate(others[0]):
            x, y = seen(other[:2], box)
            turn = math.atan2(other[7], other[6]) - math.atan2(box[7], box[6])
            reach = np.abs(seen(corners(other), box) - [x, y]).max(axis=0)
            expected = [x, y, math.cos(turn), math.sin(turn), abs(x) - box[3] - reach[0], abs(y) - box[4] - reach[1]]
            np.testing.assert_allclose([part[m, n] for part in found], expected, atol=1e-9)


def test_pairs_are_told_by_28_numbers() -> None:
    mine, others, scale = boxes(3), boxes(4), np.array([[0.7]])
    found = pair_features(tensor(mine), tensor(scale), tensor(others))[0].numpy()
    parts = [part[0].numpy() for part in relative(tensor(mine), tensor(others))]
    for m, n in np.ndindex(3, 4):
        x, y, cos, sin, gap_x, gap_y = (float(part[m, n]) for part in parts)
        scaled = [float(np.clip(value / 0.7, -4, 4)) for value in (x, y)]
        waves = [wave(f * math.pi / 2 * value) for f in (1, 2, 4) for value in scaled for wave in (math.sin, math.cos)]
        waves += [wave(1.5 * value) for value in (x, y) for wave in (math.sin, math.cos)]
        gaps = [*np.clip([gap_x, gap_y], -3, 6), *np.clip([gap_x / 0.7, gap_y / 0.7], -3, 4)]
        rise = others[0, n, 2] - mine[0, m, 2]
        expected = [x / 3, y / 3, *scaled, *waves, cos, sin, *gaps, rise, math.hypot(x, y) / 3]
        assert len(expected) == PAIR_FEATURES
        np.testing.assert_allclose(found[m, n], expected, atol=1e-5)


def test_the_scale_is_the_longer_half_side_of_the_support() -> None:
    box, flags = boxes(3), np.zeros((1, 3, 6))
    assert float(scale_of(tensor(box), tensor(flags))) == 1
    flags[0, 1, 0] = 1
    assert float(scale_of(tensor(box), tensor(flags))) == pytest.approx(box[0, 1, 3:5].max())
    box[0, 1, 3:5] = 50
    assert float(scale_of(tensor(box), tensor(flags))) == 4
    box[0, 1, 3:5] = 0.01
    assert float(scale_of(tensor(box), tensor(flags))) == 0.05


PLACES = [(along, side) for side in (1, -1) for along in (-1, 0, 1)]


@pytest.mark.parametrize("turn", range(4))
def test_base_places(turn: int) -> None:
    """Beside what stands there, on what holds it or is above or below, along the inner side of walls."""
    box = np.array([[[0, 0, 0.4, 1.0, 0.5, 0.4, 1, 0]] * 4])
    box[0, 2, 2] = 5.0  # far above the target
    flags = np.zeros((1, 4, 6))
    flags[0, 1, 0], flags[0, 3, 4] = 1, -1
    half = np.array([[0.3, 0.1, 0.2]])
    x, y, heading = (
        part.numpy() for part in base_places(tensor(box), tensor(flags), tensor(half), tensor(np.zeros(1)))
    )
    p, q = (0.3, 0.1) if turn % 2 == 0 else (0.1, 0.3)
    assert heading[turn::4] == pytest.approx(turn * np.pi / 2)
    beside = [(side * (1 + p), along * (0.5 - q)) for along, side in PLACES]
    beside += [(along * (1 - p), side * (0.5 + q)) for along, side in PLACES]
    np.testing.assert_allclose(np.stack([x[0, 0, turn::4], y[0, 0, turn::4]], axis=1), beside)
    grid = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)] + [(-0.5, 0), (0.5, 0), (0, 0.5)]
    on = [(i * (1 - p), j * (0.5 - q)) for i, j in grid]
    for token in (1, 2):
        np.testing.assert_allclose(np.stack([x[0, token, turn::4], y[0, token, turn::4]], axis=1), on)
    wall = [(share * (1 - p), -(0.5 + q)) for share in np.linspace(-1, 1, 9)]
    wall += [(share * (1 - p), -(0.5 + q + 0.5)) for share in (-0.6, 0, 0.6)]
    np.testing.assert_allclose(np.stack([x[0, 3, turn::4], y[0, 3, turn::4]], axis=1), wall, atol=1e-12)


def test_what_reaches_into_the_target_by_more_than_a_touch_is_beside_it() -> None:
    half, flags = np.array([[0.3, 0.1, 0.2]]), np.zeros((1, 1, 6))
    for low, on in ((0.399, True), (0.397, False), (-0.799, True), (-0.797, False)):
        box = np.array([[[0, 0, low + 0.4, 1.0, 0.5, 0.4, 1, 0]]])
        x = base_places(tensor(box), tensor(flags), tensor(half), tensor(np.zeros(1)))[0].numpy()
        assert (np.abs(x).max() < 1) == on, low


def test_poses_are_seen_in_the_frames_of_things() -> None:
    box, position, heading, scale = boxes(4), RNG.normal(size=(1, 2)), np.array([0.9]), np.array([[0.6]])
    found = _in_frames(tensor(box), tensor(scale), tensor(position), tensor(heading))[0].numpy()
    for m, own in enumerate(box[0]):
        x, y = seen(position[0], own)
        turn = heading[0] - math.atan2(own[7], own[6])
        gaps = np.clip([abs(x) - own[3], abs(y) - own[4]], -3, 6)
        scaled = np.clip([x / 0.6, y / 0.6], -4, 4)
        np.testing.assert_allclose(found[m], [x / 3, y / 3, *scaled, math.cos(turn), math.sin(turn), *gaps], atol=1e-9)


def test_codes_are_of_what_is_there() -> None:
    torch.manual_seed(0)
    encoder, box, flags = PoseEncoder(3, 6, 2).double(), boxes(4), np.zeros((1, 4, 6))
    mask = np.array([[1, 1, 1, 0.0]])
    target, others = tensor(RNG.normal(size=(1, 3))), tensor(RNG.normal(size=(1, 4, 3)))
    position, heading = tensor(RNG.normal(size=(1, 2))), tensor(np.array([0.3]))
    asked = (target, others, tensor(box), tensor(flags), tensor(mask), position, heading)
    mean, spread = encoder(*asked)
    fewer = [part[:, :3] if part.ndim > 1 and part.shape[1] == 4 else part for part in asked]
    for one, two in zip((mean, spread), encoder(*fewer), strict=True):
        torch.testing.assert_close(one, two)
    place = _in_frames(tensor(box), scale_of(tensor(box), tensor(flags)), position, heading)
    rows = torch.cat([target.expand(4, 3), others[0], tensor(flags)[0], place[0]], dim=-1)
    expected = encoder.out(encoder.each(rows)[:3].mean(dim=0))
    torch.testing.assert_close(torch.cat([mean, spread], dim=-1)[0], expected)


def test_the_critic_pools_over_what_is_there() -> None:
    torch.manual_seed(0)
    critic, box, half = PlaceCritic(5).double(), boxes(3), np.array([[0.3, 0.2, 0.1]])
    place, bottom, scale = RNG.normal(size=(1, 2, 3)), np.array([0.4]), np.array([[0.5]])
    view, mask = RNG.normal(size=(1, 3, 5)), np.array([[1, 0, 1.0]])
    found = critic(*map(tensor, (view, box, mask, scale, half, bottom, place)))[0]
    target = _boxes_at(tensor(place), tensor(half), tensor(bottom))
    np.testing.assert_allclose(
        target[0, 1], [*place[0, 1, :2], 0.5, 0.3, 0.2, 0.1, np.cos(place[0, 1, 2]), np.sin(place[0, 1, 2])]
    )
    told = _seen_from(tensor(box), target, tensor(scale))
    for s in range(2):
        hidden = [critic.each(critic.view(tensor(view)[0, m]) + critic.seen(told[0, m, s])) for m in (0, 2)]
        pooled = torch.cat([sum(hidden) / 8, torch.maximum(*hidden)])  # type: ignore[arg-type]
        torch.testing.assert_close(found[s], critic.out(pooled)[0])


def test_the_critic_is_told_of_gaps_on_several_scales() -> None:
    box, target, scale = boxes(3), boxes(2), np.array([[0.5]])
    found = _seen_from(tensor(box), tensor(target), tensor(scale))[0].numpy()
    there = pair_features(tensor(box), tensor(scale), tensor(target))[0].numpy()
    back = [part[0].numpy() for part in relative(tensor(target), tensor(box))]
    forth = [part[0].numpy() for part in relative(tensor(box), tensor(target))]
    for m, s in np.ndindex(3, 2):
        x, y, _, _, gap_x, gap_y = (float(part[s, m]) for part in back)
        own = [x / 3, y / 3, *np.clip([gap_x, gap_y], -3, 6)]
        gap = max(gap_x, gap_y, float(forth[4][m, s]), float(forth[5][m, s]))
        expected = [*there[m, s], *own, *(math.tanh(gap / metres) for metres in CLOSE)]
        offset = [float(forth[0][m, s]), float(forth[1][m, s])]
        expected += [wave(rate * value) for rate in FINE for wave in (math.sin, math.cos) for value in offset]
        np.testing.assert_allclose(found[m, s], expected, atol=1e-6)


def silent(model: nn.Module) -> nn.Module:
    """All weights and biases 0: what is left is built in."""
    for part in model.parameters():
        nn.init.zeros_(part)
    return model.double()


def anchor_inputs(tokens: int) -> dict[str, Tensor]:
    categories, candidates = 4, 3
    sizes = AnchorSizes(categories, embedding=6, width=16, heads=2, layers=1, pair=8, latent=2)
    made = anchors.AnchorModel(sizes)
    flags = np.zeros((1, tokens, anchors.FLAGS))
    flags[0, 0, 0] = 1
    inputs = {
        "box": boxes(tokens), "flags": flags, "mask": np.ones((1, tokens)), "target_half": np.array([[0.3, 0.1, 0.2]]),
        "target_bottom": np.zeros(1), "plan": np.zeros((1, anchors.PLAN_WIDTH)), "latent": np.zeros((1, 2)),
        "row": np.zeros((1, categories)), "coming": np.zeros((1, categories)), "whole": np.zeros(1),
        "support_half": RNG.uniform(0.1, 1, (1, candidates, 3)),
        "support_load": np.zeros((1, candidates, anchors.OCCUPANCY_WIDTH)),
        "support_content": np.zeros((1, candidates, categories + 1)),
        "support_near": np.zeros((1, candidates, categories + 1)),
    }  # fmt: skip
    found = {name: tensor(values) for name, values in inputs.items()}
    for name, shape in (("category", (1, tokens)), ("target_category", (1,)), ("support_category", (1, candidates)),
                        ("support_holder", (1, candidates))):  # fmt: skip
        found[name] = torch.zeros(shape, dtype=torch.int64)
    assert made.sizes is sizes
    return found


def silent_model() -> AnchorModel:
    sizes = AnchorSizes(4, embedding=6, width=16, heads=2, layers=1, pair=8, latent=2)
    model = silent(AnchorModel(sizes))
    assert isinstance(model, AnchorModel)
    return model


def test_a_network_that_knows_nothing_proposes_heights_evenly_over_the_support() -> None:
    inputs = anchor_inputs(3)
    score, weight, mean, sigma = (part[0].detach().numpy() for part in silent_model().choose(inputs))
    assert not score.any()
    np.testing.assert_allclose(weight, -np.log(LEVELS))
    for k, half in enumerate(inputs["support_half"][0].numpy()):
        np.testing.assert_allclose(mean[k], np.linspace(0, 2 * half[2], LEVELS))
    np.testing.assert_allclose(sigma, SIGMA_FLOOR + np.exp(-3))


def test_heights_are_by_the_support_by_the_target_and_as_they_are() -> None:
    model, inputs = silent_model(), anchor_inputs(3)
    with torch.no_grad():
        model.height.bias.copy_(torch.cat([torch.full((LEVELS,), value) for value in (0.0, 0.5, 0.25, 0.1, 2.0)]))
    _, _, mean, sigma = (part[0].detach().numpy() for part in model.choose(inputs))
    for k, half in enumerate(inputs["support_half"][0].numpy()):
        np.testing.assert_allclose(mean[k], (0.5 + np.linspace(0, 1, LEVELS)) * 2 * half[2] + 0.25 * 0.4 + 0.1)
    np.testing.assert_allclose(sigma, SIGMA_FLOOR + np.exp(-1))


def test_a_network_that_knows_nothing_proposes_the_base_places_of_what_is_there() -> None:
    model, inputs = silent_model(), anchor_inputs(3)
    inputs["mask"] = tensor(np.array([[1, 1, 0.0]]))
    weight, mean, sigma, heading, kappa, view = (part[0].detach().numpy() for part in model.places(inputs))
    np.testing.assert_allclose(weight[: 2 * 48], -np.log(96), atol=1e-6)
    assert (weight[2 * 48 :] < -1000).all()
    scale = float(scale_of(inputs["box"], inputs["flags"]))
    np.testing.assert_allclose(sigma, SIGMA_FLOOR + scale * np.exp(-2.5))
    np.testing.assert_allclose(kappa, np.exp(np.clip(2, *LOG_KAPPA)))
    x, y, turn = (
        part.numpy() for part in base_places(*(inputs[n] for n in ("box", "flags", "target_half", "target_bottom")))
    )
    for m, box in enumerate(inputs["box"][0].numpy()):
        local = np.stack([x[0, m], y[0, m]], axis=1)
        world = box[:2] + local @ np.array([[box[6], box[7]], [-box[7], box[6]]])
        np.testing.assert_allclose(mean[48 * m : 48 * m + 48], world, atol=1e-9)
        np.testing.assert_allclose(heading[48 * m : 48 * m + 48], math.atan2(box[7], box[6]) + turn, atol=1e-6)
    assert view.shape == (3, 48)


def test_sizes_are_told_plain_and_as_logarithms() -> None:
    found = _size_features(tensor(np.array([[0.5, 1, 2.0]])))[0].numpy()
    np.testing.assert_allclose(found, [0.5, 1, 2, *(0.5 * np.log(np.array([0.5, 1, 2]) + 1e-3))])
    np.testing.assert_allclose(atiss._size(tensor(np.array([[0.5, 1, 2.0]])))[0].numpy(), found)


def attention(
    block: nn.Module, query: Tensor, key: Tensor, value: Tensor, mask: np.ndarray, extra: Tensor | None
) -> Tensor:
    """(N, heads, d) each, one query and one head at a time."""
    there = np.flatnonzero(mask)
    rows = []
    for i in range(query.shape[0]):
        heads = []
        for h in range(query.shape[1]):
            score = torch.stack([query[i, h] @ key[j, h] / math.sqrt(query.shape[2]) for j in there])
            weight = (score if extra is None else score + extra[i, there, h]).softmax(0)
            heads.append((weight, sum(w * value[j, h] for w, j in zip(weight, there, strict=True))))
        rows.append(heads)
    return rows  # type: ignore[return-value]


def test_attention_over_pairs() -> None:
    torch.manual_seed(1)
    sizes = AnchorSizes(4, width=8, heads=2, pair=3)
    layer = anchors._PairAttention(sizes).double()
    hidden, pair, mask = torch.randn(1, 4, 8).double(), torch.randn(1, 4, 4, 3).double(), np.array([1, 0, 1, 1])
    found = layer(hidden, pair, tensor(mask[None]))[0]
    query, key, value = layer.queries(layer.norm(hidden[0])).reshape(4, 3, 2, 4).unbind(1)
    rows = attention(layer, query, key, value, mask, layer.bias(pair[0]))
    for i, heads in enumerate(rows):
        between = [
            sum(w * pair[0, i, j] for w, j in zip(weight, np.flatnonzero(mask), strict=True)) for weight, _ in heads
        ]
        out = hidden[0, i] + layer.out(torch.cat([*(seen for _, seen in heads), *between]))
        torch.testing.assert_close(found[i], out + layer.feed(out))


def test_attention_of_one_set_to_another() -> None:
    torch.manual_seed(1)
    block = atiss._Block(8, 2).double()
    asking, asked, mask = torch.randn(1, 2, 8).double(), torch.randn(1, 4, 8).double(), np.array([1, 0, 1, 1])
    found = block(asking, asked, tensor(mask[None]))[0]
    query = block.query(block.norm(asking[0])).reshape(2, 2, 4)
    key, value = block.seen(block.norm_seen(asked[0])).reshape(4, 2, 2, 4).unbind(1)
    for i, heads in enumerate(attention(block, query, key, value, mask, None)):
        out = asking[0, i] + block.out(torch.cat([seen for _, seen in heads]))
        torch.testing.assert_close(found[i], out + block.feed(out))


def test_waves_are_16_to_half_a_metre_long() -> None:
    place = np.array([[0.3, -2.0, 7.0]])
    found = atiss._waves(tensor(place))[0].numpy()
    lengths = [16, 8, 4, 2, 1, 0.5]
    angles = [2 * np.pi * value / length for length in lengths for value in place[0]]
    np.testing.assert_allclose(found, [*np.sin(angles), *np.cos(angles)], atol=1e-9)


def test_mixtures_of_logistics_begin_spread_over_their_reach() -> None:
    raw = np.zeros((1, 3, 5))
    raw[0, 1, 2], raw[0, 2, :2] = 0.1, (2.0, 99.0)
    weight, mean, scale = atiss._mixture(tensor(raw), 3.0)[0].numpy()
    np.testing.assert_allclose(weight, -np.log(5))
    np.testing.assert_allclose(mean, [-3, -1.5, 0.3, 1.5, 3])
    np.testing.assert_allclose(scale, atiss.SCALE_FLOOR + np.exp([1, 3, -1, -1, -1]))
