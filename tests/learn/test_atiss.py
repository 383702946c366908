from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from tests.generate.models import shared_dataset  # noqa: E402
from unisg_blender.dataset import open_dataset  # noqa: E402
from unisg_blender.dataset.scenes_with_shapes import scenes_with_shapes  # noqa: E402
from unisg_blender.experiments.rooms.atiss_proposer import AtissProposer, load_generator  # noqa: E402
from unisg_blender.experiments.rooms.cases import case_of  # noqa: E402
from unisg_blender.experiments.rooms.furnishing import ByModel  # noqa: E402
from unisg_blender.generate.observe.contract import Contract  # noqa: E402
from unisg_blender.generate.observe.placeable import box_placeable  # noqa: E402
from unisg_blender.generate.observe.support_priors import CategoryPriors  # noqa: E402
from unisg_blender.learn import job_list  # noqa: E402
from unisg_blender.learn.atiss.network import Atiss, AtissSizes  # noqa: E402
from unisg_blender.learn.atiss.training import example_inputs, write_atiss  # noqa: E402
from unisg_blender.learn.hyperparameters import Settings  # noqa: E402
from unisg_blender.learn.losses.mixtures import logistics_nll  # noqa: E402


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    out = tmp_path_factory.mktemp("atiss") / "atiss.onnx"
    report = job_list.train("atiss", [open_dataset(shared_dataset())], out, Settings(epochs=3, quiet=True))
    assert report["scenes_trained"] + report["scenes_held_out"] == 12
    return out


def network() -> Atiss:
    torch.manual_seed(0)
    return Atiss(AtissSizes(4)).eval()


def inputs(objects: int = 6) -> dict:
    torch.manual_seed(1)
    found = dict(example_inputs(objects))
    found["category"] = torch.arange(objects)[None] % 4
    return found


def test_the_order_of_the_things_does_not_matter() -> None:
    given = inputs()
    order = torch.tensor([3, 1, 5, 0, 2, 4])
    moved = given | {name: given[name][:, order] for name in ("category", "box", "mask")}
    for one, two in zip(network()(**given), network()(**moved), strict=True):
        torch.testing.assert_close(one, two, atol=1e-5, rtol=1e-5)


def test_what_is_masked_is_not_seen_and_targets_do_not_see_each_other() -> None:
    given = inputs()
    hidden = {name: value.clone() for name, value in given.items()}
    hidden["mask"][:, 4:] = 0
    changed = {name: value.clone() for name, value in hidden.items()}
    changed["box"][:, 4:] = 7.0
    changed["target_half"][:, 1] = 3.0
    for one, two in zip(network()(**hidden), network()(**changed), strict=True):
        torch.testing.assert_close(one[:, 0], two[:, 0], atol=1e-5, rtol=1e-5)
        assert not torch.allclose(one[:, 1], two[:, 1])


@pytest.mark.parametrize("turn", [False, True])
def test_the_density_integrates_to_one(turn: bool) -> None:
    mixture = torch.tensor([[-0.5, -0.9327], [0.3, 2.9], [0.2, 0.4]])
    values = torch.linspace(-math.pi, math.pi, 4001) if turn else torch.linspace(-12, 16, 20001)
    density = torch.exp(-logistics_nll(mixture, values, turn))
    assert torch.trapezoid(density, values).item() == pytest.approx(1.0, abs=0.01)


@pytest.mark.slow
def test_the_file_says_what_the_network_says(tmp_path: Path) -> None:
    words = ("Box", "Cup", "Door", "Floor")
    write_atiss(network(), Contract("atiss", words, CategoryPriors({}, {}, {}, [])), tmp_path / "a.onnx")
    given = inputs()
    arrays = {name: value.numpy() for name, value in given.items()}
    found = load_generator(tmp_path / "a.onnx").model.run(["position", "heading"], **arrays)
    with torch.no_grad():
        for one, two in zip(network()(**given), found, strict=True):
            np.testing.assert_allclose(one.numpy(), two, atol=1e-5, rtol=1e-5)


@pytest.mark.slow
def test_rooms_are_furnished_and_the_same_seed_gives_the_same(model: Path) -> None:
    generator = load_generator(model)
    room = next(iter(scenes_with_shapes(open_dataset(shared_dataset()))))
    case = case_of(room, generator.categories)
    assert case is not None
    made = [ByModel(generator, settle).furnish(case, 3) for settle in (False, True)]
    again = ByModel(generator, True).furnish(case, 3)
    assert len(made[0].scene) == len(room)
    np.testing.assert_array_equal(made[1].scene.local, again.scene.local)


@pytest.mark.slow
def test_drawn_places_are_where_the_density_is_high(model: Path) -> None:
    from unisg_blender.generate.observe.observed_scene import ObservedScene
    from unisg_blender.generate.propose.proposer import Query
    from unisg_blender.scene import world_matrices
    from unisg_blender.spatial.objects import scene_objects

    generator = load_generator(model)
    room = next(iter(scenes_with_shapes(open_dataset(shared_dataset()))))
    objects = scene_objects(room, generator.categories)
    scene = ObservedScene.of(objects, world_matrices(room)[objects.row])
    proposer, placeable = AtissProposer(generator.model), box_placeable("Cup", np.array([0.1, 0.1, 0.1]))
    query = Query(scene, 0, placeable, np.ones(len(objects), bool), {})
    drawn = proposer.propose(query, 40, np.random.default_rng(0))
    near = np.mean([proposer.log_density(query, -1, place) for place in drawn.places])
    far = np.mean([proposer.log_density(query, -1, place + 30 * np.eye(4)[0]) for place in drawn.places])
    assert near > far + 5
    assert (drawn.support >= 0).all()
