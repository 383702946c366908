"""Variety and candidates: nearer to the likeliest places or freer, and shapes that are given come first."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.cli import main
from unisg_blender.dataset.assets.asset import Asset, object_graph
from unisg_blender.errors import UniSGError
from unisg_blender.generate import Generator, Sampling
from unisg_blender.generate.observe.placeable import box_placeable
from unisg_blender.generate.place.growing_scene import GrowingScene, Target
from unisg_blender.generate.place.shape_library import Library
from unisg_blender.generate.pointing.ghosts import ghost_anywhere
from unisg_blender.generate.pointing.placing_room import PlacingRoom, Wanted
from unisg_blender.generate.propose.place_sampling import MOST_CANDIDATES
from unisg_blender.generate.propose.proposer import NOTHING_ELSE, Query
from unisg_blender.generate.rerolled_scene import reroll_rows
from unisg_blender.pretrained import shipped_generators
from unisg_blender.scene import SceneGraph
from unisg_blender.worlds import living_room

pytestmark = pytest.mark.slow


@cache
def generator() -> Generator:
    return Generator.load(next(path for path in shipped_generators() if path.stem == "living_room"))


@cache
def room() -> SceneGraph:
    return living_room(5)


def asked(sampling: Sampling) -> tuple[Query, tuple[int, int]]:
    """What is asked about a chair, and the floor."""
    scene = GrowingScene(generator().seen(room()), generator().contract)
    scene.sampling = sampling
    category = generator().categories.index("Chair")
    shape = Library(generator().model).placeable(category, room(), np.random.default_rng(0))
    floor = next(number for number, label in enumerate(scene.labels) if label.floor)
    return scene.query(Target(category, shape), np.arange(len(scene.labels)) == floor, {}), (floor, 0)


def likelihood(sampling: Sampling) -> float:
    """Mean log-density of proposals, by the model as it learned."""
    query, floor = asked(sampling)
    proposer, found = generator().proposer, []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        places = proposer.propose_on(query, 4, rng, floor, NOTHING_ELSE).places
        density, _ = proposer.density_on(query, places[:, :2], float(places[0, 2]), floor, np.random.default_rng(0))
        found.append(density.mean())
    return float(np.mean(found))


def test_less_variety_is_likelier_and_more_is_less_likely() -> None:
    little, usual, much = (likelihood(Sampling(variety, 256)) for variety in (0.2, 1.0, 3.0))
    assert little > usual + 0.3
    assert much < usual - 0.3


def test_more_candidates_find_likelier_places_where_those_are_wanted() -> None:
    assert likelihood(Sampling(0.0, 512)) > likelihood(Sampling(0.0, 8)) + 0.3


def test_what_is_usual_is_as_it_was() -> None:
    plain = generator().add(room(), {"Chair": 2}, seed=3)
    same = generator().add(room(), {"Chair": 2}, seed=3, sampling=Sampling())
    for one, other in zip(plain.objects, same.objects, strict=True):
        np.testing.assert_array_equal(one.world, other.world)


def test_supports_are_chosen_by_it_too() -> None:
    score = np.log([0.5, 0.3, 0.2])
    assert Sampling().tempered(score) is score
    np.testing.assert_allclose(np.exp(Sampling(0.5).tempered(score)), np.array([25, 9, 4]) / 38)
    np.testing.assert_allclose(np.exp(Sampling(0.0).tempered(score)), [1, 0, 0], atol=1e-12)


@pytest.mark.parametrize("given", [(-0.1, 0), (float("nan"), 0), (1.0, -1), (1.0, MOST_CANDIDATES + 1)])
def test_what_is_out_of_range_is_told(given: tuple[float, int]) -> None:
    with pytest.raises(UniSGError, match="must be"):
        Sampling(*given)


def test_rerolling_draws_by_it_too() -> None:
    row = next(row for row in range(len(room())) if room().category_name(row) == "Plant")
    (first,), (other,) = (reroll_rows(generator(), room(), [row], 1, sampling=Sampling(value)) for value in (0.0, 2.0))
    assert not np.allclose(other.world, first.world, atol=1e-3)


def test_anywhere_with_little_variety_is_the_best_place() -> None:
    placing = PlacingRoom.of(generator(), room(), Wanted("Chair"))
    best = placing.map.log_density[placing.map.fits].max()
    ghosts = [ghost_anywhere(placing, np.random.default_rng(seed), Sampling(0.0)) for seed in range(4)]
    for ghost in ghosts:
        assert ghost is not None
        at = np.linalg.norm(placing.map.places - ghost.place, axis=1).argmin()
        assert placing.map.log_density[at] > best - 0.1
    free = [ghost_anywhere(placing, np.random.default_rng(seed)) for seed in range(4)]
    assert len({tuple(ghost.place.round(2)) for ghost in free if ghost is not None}) > 1


def test_given_shapes_come_before_those_of_the_scene_and_of_the_model() -> None:
    given = box_placeable("Chair", np.array([0.4, 0.41, 0.42])).asset
    result = generator().add(room(), {"Chair": 2, "Plant": 1}, seed=1, shapes={"Chair": [given]})
    new = [result.scene.row_of_uid[item.uid] for item in result.objects if not item.refused]
    shape = {result.scene.category_name(row): object_graph(result.scene, row).key for row in new}
    assert shape["Chair"] == given.key
    assert shape["Plant"] != given.key
    again = generator().add(room(), {"Chair": 1}, seed=1)
    row = result.scene.row_of_uid.get(again.objects[0].uid)
    assert row is None or object_graph(again.scene, row).key != given.key, "the next call knows nothing of it"


def test_pointing_begins_with_given_shapes() -> None:
    given: Asset = box_placeable("Chair", np.array([0.4, 0.41, 0.42])).asset
    first = PlacingRoom.of(generator(), room(), Wanted("Chair", shapes=(given,)))
    second = PlacingRoom.of(generator(), room(), Wanted("Chair", 1, shapes=(given,)))
    assert first.target.placeable.asset.key == given.key
    assert second.target.placeable.asset.key != given.key
    assert first.shapes > 1


def test_the_command_line_has_both_and_refuses_nonsense(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["generate", "--model", "living_room", "--add", "Plant=1", "--seed", "1", "--out"]
    assert main([*words, str(tmp_path / "bad.json"), "--variety", "-1"]) == 1
    assert "variety" in capsys.readouterr().err
    assert main([*words, str(tmp_path / "rooms"), "--count", "2", "--variety", "-1"]) == 1
    assert not list(tmp_path.iterdir())
    assert main([*words, str(tmp_path / "rooms"), "--count", "2", "--variety", "0.5", "--candidates", "64"]) == 0
