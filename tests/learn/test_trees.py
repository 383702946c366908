"""Trees: the file says what scikit-learn says, few rooms train them, and they are taken only where they help."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("torch")
pytest.importorskip("sklearn")

from tests.generate.rooms import room
from unisg_blender.dataset import open_dataset, write_dataset
from unisg_blender.errors import UniSGError
from unisg_blender.generate import Generator
from unisg_blender.generate.observe.contract import Contract
from unisg_blender.generate.observe.observed_scene import ObservedScene
from unisg_blender.generate.observe.prior_tables import PriorTables
from unisg_blender.generate.observe.room_walls import RoomWalls
from unisg_blender.generate.observe.seen_places import ABOVE, GAP, ROOM, WIDTH, SeenPlaces
from unisg_blender.generate.observe.support_priors import CategoryPriors, learn_priors
from unisg_blender.generate.propose.plain_proposals import PLAINEST, TriedRoom, plain_proposals
from unisg_blender.learn import job_list
from unisg_blender.learn.hyperparameters import Settings
from unisg_blender.learn.provenance import dataset_notes
from unisg_blender.learn.trees.completion_pictures import DRAWN, AskedAgain, Completion, completion_svg
from unisg_blender.learn.trees.fitting import NEVER, fit_trees, write_trees
from unisg_blender.learn.trees.held_out import GROUPS, POWERS, HeldOut, choices
from unisg_blender.learn.trees.training_report import report_lines, write_report
from unisg_blender.metrics.scene_validity import measure_scene
from unisg_blender.runtime.onnx_session import open_model
from unisg_blender.scene import SceneBuilder, SceneGraph, world_matrices
from unisg_blender.spatial.objects import scene_objects

NOTHING = CategoryPriors({}, {}, {}, [])


def observed(graph: SceneGraph) -> tuple[ObservedScene, PriorTables]:
    objects = scene_objects(graph, graph.vocabulary)
    tables = PriorTables.of(learn_priors([objects], graph.vocabulary), graph.vocabulary)
    return ObservedScene.of(objects, world_matrices(graph)[objects.row]), tables


def test_the_file_gives_the_log_odds_that_were_fitted(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(0, 1, (2000, 5)).astype(np.float32)
    trees = fit_trees(features, (features[:, 0] + features[:, 1] ** 2 > 1).astype(np.float32), 0)
    path = tmp_path / "trees.onnx"
    write_trees(trees, Contract("trees", ("a",), NOTHING).to_json(), path)
    model = open_model(path, "generate", (5,), "cgvae")
    score = model.run(["score"], features=features)[0][:, 0]
    share = trees.predict_proba(features)[:, 1].clip(NEVER, 1 - NEVER)
    assert 0.1 < share.mean() < 0.9
    np.testing.assert_allclose(score, np.log(share / (1 - share)), atol=1e-4)


@pytest.fixture(scope="module")
def few_rooms_model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from tests.generate.models import shared_dataset

    out = tmp_path_factory.mktemp("trees") / "model.onnx"
    job_list.train("cgvae", [open_dataset(shared_dataset())], out, Settings(quiet=True))
    return out


@pytest.mark.slow
def test_few_rooms_train_trees_that_furnish_a_room(few_rooms_model: Path) -> None:
    generator = Generator.load(few_rooms_model)
    assert generator.contract.kind == "trees"
    assert generator.contract.provenance["scenes_trained"] == 12
    scene = room(100)
    made = generator.add(scene, {"Cup": 2, "Lamp": 1}, seed=0)
    assert made.added == 3
    assert not measure_scene(made.scene).overlapping[made.rows].any()
    again = generator.add(scene, {"Cup": 2, "Lamp": 1}, seed=0)
    assert [item.name for item in again.objects] == [item.name for item in made.objects]
    np.testing.assert_array_equal(again.scene.local, made.scene.local)


@pytest.mark.slow
def test_what_was_measured_on_held_out_rooms_is_kept_and_decides(few_rooms_model: Path) -> None:
    contract = Generator.load(few_rooms_model).contract
    held_out = {record["group"]: record for record in contract.provenance["held_out"]}
    assert set(held_out) == set(GROUPS)
    assert all(record["taken"] <= record["plain"] for record in held_out.values() if record["objects"])
    assert set(contract.plain) | set(contract.sharpness) == set(contract.places)
    assert not set(contract.plain) & set(contract.sharpness)


def record(category: str, rooms: int, taken: float = 0.5) -> dict[str, object]:
    return {"category": category, "objects": 2 * rooms, "rooms": rooms, "plain": 1.0, "taken": taken}


def test_the_page_says_what_is_known_and_what_to_add(tmp_path: Path) -> None:
    seen = {"Lamp": 7, "Cat": 1, "Wall": 9}
    categories = [record("Bed", 30), record("<b>", 30, 2.0), *(record(name, rooms) for name, rooms in seen.items())]
    group = {"group": "floor", "objects": 9, "plain": 1.5, "taken": 0.75, "power": 1.0}
    source = {"scenes_trained": 30, "categories": categories, "held_out": [group], "notes": ["few"]}
    lines = report_lines(source, ("Wall",))
    assert [line for line in lines if line.startswith("known")] == [
        "known well: 1 (Bed)", "known hardly: 2 (<b>, Lamp)", "known not: 1 (Cat)",
    ]  # fmt: skip
    assert lines[-2:] == ["add 3 more rooms with a Lamp", "add 9 more rooms with a Cat"]
    page = write_report(source, ("Wall",), tmp_path / "room.onnx").read_text()
    assert "&lt;b&gt;" in page
    assert "<b>" not in page
    assert "Wall" not in page


def test_rooms_without_floors_or_walls_are_told_before_anything_is_trained(tmp_path: Path) -> None:
    builder = SceneBuilder("Bare")
    builder.add("Floor", uid="f", category="Floor")
    write_dataset([builder.build()] * 5, tmp_path / "bare")
    notes = dataset_notes(open_dataset(tmp_path / "bare"))
    assert [note for note in notes if '"Wall"' in note]
    assert not [note for note in notes if '"Floor"' in note]


@pytest.mark.slow
@pytest.mark.parametrize("damage", ["width", "plain", "sharpness", "far"])
def test_a_damaged_file_is_refused(few_rooms_model: Path, tmp_path: Path, damage: str) -> None:
    onnx = pytest.importorskip("onnx")
    model = onnx.load(few_rooms_model)
    record = json.loads(model.metadata_props[0].value)
    match damage:
        case "width":
            record["places"]["Cup"][0].append(1.0)
        case "far":
            record["places"]["Cup"][0][3] = 1e9
        case "plain":
            record["plain"] = {"Cup": 2.0}
        case "sharpness":
            record["sharpness"] = {"Cup": -1.0}
    model.metadata_props[0].value = json.dumps(record)
    onnx.save(model, tmp_path / "bad.onnx")
    with pytest.raises(UniSGError, match="damaged"):
        Generator.load(tmp_path / "bad.onnx")


@given(st.lists(st.tuples(st.sampled_from(GROUPS), st.floats(0.1, 9), st.floats(0.1, 9)), min_size=1, max_size=9))
def test_nothing_is_taken_that_is_worse_than_plain_places(found: list[tuple[str, float, float]]) -> None:
    chosen = choices([HeldOut(0, group, plain, np.full(len(POWERS), trees)) for group, plain, trees in found])
    for group, choice in chosen.items():
        mine = [(plain, trees) for other, plain, trees in found if other == group]
        if mine:
            plain, trees = np.mean(mine, axis=0)
            assert choice.taken == pytest.approx(min(plain, trees))
            assert (choice.power is None) == (trees >= plain)
        else:
            assert choice.power is None


@pytest.mark.parametrize(
    ("settings", "few"),
    [({}, True), ({"epochs": 3}, False), ({"paper": True}, False), ({"form": "quaternion"}, False)],
)
def test_who_asks_for_epochs_or_a_form_gets_a_network(settings: dict[str, object], few: bool) -> None:
    from tests.generate.models import shared_dataset

    assert job_list.takes_few(open_dataset(shared_dataset()), replace(Settings(), **settings)) is few  # type: ignore[arg-type]


def test_seen_places_come_back_where_they_were_and_survive_json() -> None:
    graph = room(3)
    scene, tables = observed(graph)
    places = SeenPlaces.of([scene], tables)
    record = json.loads(json.dumps(places.to_record(graph.vocabulary)))
    again = SeenPlaces.from_record(record, graph.vocabulary)
    for category, rows in again.places.items():
        np.testing.assert_array_equal(rows, places.places[category])
        assert rows.shape[1] == WIDTH
        mine = np.flatnonzero(scene.category == category)
        allowed = np.zeros(len(scene.category), bool)
        allowed[scene.support[mine[scene.support[mine] >= 0]]] = True
        rng = np.random.default_rng(0)
        tried = plain_proposals(TriedRoom.of(scene, tables), rows, scene.half[mine[0]], allowed, 40, rng, PLAINEST)
        off = np.linalg.norm(tried.places[:, None, :2] - scene.center[mine, :2], axis=2).min(axis=1)
        if len(np.unique(scene.support[mine])) == 1:
            assert off.max() < 2e-3


def test_a_room_is_left_out_of_what_is_tried_in_it() -> None:
    scenes = [observed(room(seed))[0] for seed in range(3)]
    tables = observed(room(0))[1]
    for rows in SeenPlaces.of(scenes, tables).without(1).places.values():
        assert set(rows[:, ROOM]) == {0, 2}


def test_walls_are_as_far_as_they_are_and_floors_stand_for_missing_ones() -> None:
    graph = room(0)
    scene, tables = observed(graph)
    floor = int(np.argmax(scene.half[:, :2].prod(axis=1)))
    place = np.array([[*scene.center[floor, :2], 0, 0.0]])
    bare = scene.part((scene.category < 0) | ~tables.structural[scene.category] | (np.arange(len(scene.half)) == floor))
    for seen in (scene, bare):
        gap, normal = RoomWalls.of(seen, tables).gaps(place, np.array([0.5, 0.25, 1]))
        expected = np.sort([*(scene.half[floor, 0] - 0.5,) * 2, *(scene.half[floor, 1] - 0.25,) * 2])
        np.testing.assert_allclose(np.sort(gap[0]), expected, atol=0.06)
        np.testing.assert_allclose(np.cos(4 * normal), 1, atol=1e-9)


def test_what_hangs_without_touching_anything_keeps_its_height() -> None:
    graph = room(0)
    scene, tables = observed(graph)
    lamp = graph.vocabulary.index("Lamp")
    rows = SeenPlaces.of([scene], tables).of_category(lamp)
    rows[:, 1], rows[:, ABOVE], rows[:, GAP] = -1, 1.7, 0.03
    none = np.zeros(len(scene.category), bool)
    tried = plain_proposals(
        TriedRoom.of(scene, tables), rows, np.array([0.1, 0.1, 0.1]), none, 30, np.random.default_rng(0)
    )
    np.testing.assert_allclose(tried.places[:, 2], scene.room.ground + 1.7)


@pytest.mark.slow
def test_the_page_shows_rooms_that_were_held_out(few_rooms_model: Path) -> None:
    page = few_rooms_model.with_suffix(".report.html").read_text()
    pictures = page.split("<svg")[1:]
    assert len(pictures) == 4  # of twelve rooms a third
    for picture in pictures:
        dashed = picture.count("stroke-dasharray")
        assert 1 <= dashed <= 5
        assert picture.count("fill-opacity") == DRAWN * dashed


def test_names_on_pictures_are_text() -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    asked = AskedAgain("<script>", square + 0.2, square[None] + 0.3)
    picture = completion_svg(Completion(square[None] * 4, np.array([True]), (asked,)))
    assert "&lt;script&gt;" in picture
    assert "<script>" not in picture
