"""The network of behaviour: order and place do not matter, masks hold, and the exported file says the same."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("pytorch_lightning")

from tests.generate.rooms import room  # noqa: E402
from unisg_blender.dataset import open_dataset, write_dataset  # noqa: E402
from unisg_blender.generate.behaviour.action_kinds import Kinds, behaviour_path  # noqa: E402
from unisg_blender.generate.behaviour.action_policy import RoleMasks  # noqa: E402
from unisg_blender.generate.behaviour.action_statistics import learn_kinds  # noqa: E402
from unisg_blender.generate.behaviour.network_policy import INPUTS, load_behaviour, observation_arrays  # noqa: E402
from unisg_blender.generate.behaviour.observation import BehaviourObservation, observe_behaviour  # noqa: E402
from unisg_blender.learn.behaviour.examples import BehaviourExamples, collate  # noqa: E402
from unisg_blender.learn.behaviour.network import BehaviourNet  # noqa: E402
from unisg_blender.learn.behaviour.training import make_network, train_beside, write_behaviour  # noqa: E402
from unisg_blender.learn.hyperparameters import Settings  # noqa: E402
from unisg_blender.worlds import living_room  # noqa: E402


@cache
def taught() -> tuple[Kinds, BehaviourObservation, BehaviourNet]:
    """Kinds of a few living rooms, one of these, and a network with random weights."""
    torch.manual_seed(0)
    rooms = [living_room(seed) for seed in range(3)]
    kinds = learn_kinds(rooms)
    play = observe_behaviour(rooms[0], kinds, rooms[0].uid[:20])
    return kinds, play, make_network(kinds).eval()


def ask(network: BehaviourNet, play: BehaviourObservation, kinds: Kinds) -> list[np.ndarray]:
    """What the network says of a scene."""
    arrays = observation_arrays(play, kinds)
    with torch.no_grad():
        return [part[0].numpy() for part in network(**{name: torch.from_numpy(arrays[name][None]) for name in INPUTS})]


def test_the_order_of_things_and_actions_does_not_matter() -> None:
    kinds, play, network = taught()
    objects, roled = np.random.default_rng(0).permutation(len(play.rows)), np.arange(len(play.kind))[::-1]
    place = np.argsort(objects)
    shuffled = replace(
        play, rows=play.rows[objects], category=play.category[objects], new=play.new[objects],
        support=np.where(play.support >= 0, place[play.support], -1)[objects], relation=play.relation[objects],
        position=play.position[objects], below=play.below[np.ix_(objects, objects)], kind=play.kind[roled],
        slots=np.where(play.slots >= 0, place[play.slots], -1)[roled], leaf_stage=play.leaf_stage[roled],
        leaf_order=play.leaf_order[roled],
    )  # fmt: skip
    one, two = ask(network, play, kinds), ask(network, shuffled, kinds)
    np.testing.assert_allclose(one[0], two[0], atol=1e-4)
    np.testing.assert_allclose(one[1][:, objects], two[1], atol=1e-3)
    np.testing.assert_allclose(one[2][:, objects][:, :, objects], two[2], atol=1e-3)


def test_moving_and_turning_the_room_changes_nothing() -> None:
    kinds, play, network = taught()
    turned = replace(play, position=play.position @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]]) + (3.0, -2.0, 0.5))
    for one, two in zip(ask(network, play, kinds), ask(network, turned, kinds), strict=True):
        np.testing.assert_allclose(one, two, atol=2e-3)


def test_what_may_not_play_has_no_chance() -> None:
    kinds, play, network = taught()
    casting, (_, target, tool, frame, _) = RoleMasks(kinds), ask(network, play, kinds)
    for number, kind in enumerate(kinds.kinds):
        for slot, scores in enumerate((target[number], tool[number, 0], frame[number, 0])):
            if kind.slots[slot]:
                able = casting.allowed[number, slot, play.category]
                assert np.exp(scores[able]).sum() == pytest.approx(1.0, abs=1e-3)
                assert (scores[~able] < -100).all()


def test_padding_changes_nothing() -> None:
    kinds, play, network = taught()
    examples = BehaviourExamples([play, observe_behaviour(living_room(1), kinds)], kinds, 6, 0, fresh=False)
    items = [examples[number] for number in range(6)]
    batch = collate(items, len(kinds.kinds))
    with torch.no_grad():
        together = network.encode(batch).wanted
        for number, item in enumerate(items):
            alone = collate([item], len(kinds.kinds))
            np.testing.assert_allclose(together[number], network.encode(alone).wanted[0], atol=1e-4)


@pytest.mark.slow
def test_the_exported_file_says_the_same(tmp_path: Path) -> None:
    kinds, play, network = taught()
    path = tmp_path / "model.behaviour.onnx"
    write_behaviour(network, kinds, path)
    policy = load_behaviour(path)
    assert policy.kinds == kinds
    for some in (play, play.keep_actions(np.arange(2)), play.keep_actions(np.arange(0))):
        scores = policy.scores(some)
        if len(some.kind):
            wanted, target, tool, _, _ = ask(network, some, kinds)
            np.testing.assert_allclose(scores.wanted, 1 / (1 + np.exp(-wanted)), atol=1e-5)
            for number, kind in enumerate(kinds.kinds):
                able = RoleMasks(kinds).allowed[number, 0, some.category]
                np.testing.assert_allclose(scores.target[number, able], target[number, able], atol=1e-4)
                assert tool.shape == scores.tool.shape, kind


@pytest.mark.slow
def test_a_folder_of_scenes_teaches_its_own_behaviour_and_too_few_are_told(tmp_path: Path) -> None:
    torch.set_num_threads(1)
    few, enough, model = tmp_path / "few", tmp_path / "enough", tmp_path / "model.onnx"
    write_dataset((room(seed) for seed in range(4)), few)
    write_dataset((room(seed) for seed in range(12)), enough)
    (note,) = train_beside([open_dataset(few)], model, Settings(quiet=True))["notes"]
    assert "4 scenes have actions, 10 are needed" in note
    assert not behaviour_path(model).exists()
    report = train_beside([open_dataset(enough)], model, Settings(epochs=2, quiet=True))
    assert (report["scenes_trained"], report["scenes_held_out"]) == (11, 1)
    policy, scene = load_behaviour(behaviour_path(model)), room(500)
    (kind,) = policy.kinds.kinds
    assert (kind.type, kind.name, kind.slots) == ("Remove", "Take the cup", ({"Cup": 24}, {}, {"Table": 24}))
    scores = policy.scores(observe_behaviour(scene, policy.kinds, [scene.uid[scene.row("Cup.0")]]))
    assert scores.wanted.shape == (1,)
