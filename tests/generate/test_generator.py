"""Generating: existing objects stay as they are, new ones are well placed, same seed same result, bad input is told."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.generate.models import shared_model
from tests.generate.rooms import at, box, room
from unisg_blender.dataset.assets.asset import object_graph
from unisg_blender.errors import UniSGError
from unisg_blender.generate import Generator
from unisg_blender.generate.observe.observed_scene import ObservedScene
from unisg_blender.generate.observe.placeable import Placeable
from unisg_blender.generate.propose.anchor_proposer import DRAWN, AnchorProposer
from unisg_blender.generate.propose.proposer import NOTHING_ELSE, Proposals, Proposer, Query, SupportChoice
from unisg_blender.metrics.scene_validity import measure_scene
from unisg_blender.scene import SceneBuilder, SceneGraph, world_matrices
from unisg_blender.spatial.objects import scene_objects

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def generator(model_file: Path) -> Generator:
    return Generator.load(model_file)


def assert_unchanged(before: SceneGraph, after: SceneGraph) -> None:
    worlds, old = world_matrices(after), world_matrices(before)
    for row, uid in enumerate(before.uid):
        place = after.row_of_uid[uid]
        assert after.name[place] == before.name[row]
        assert after.category_name(place) == before.category_name(row)
        np.testing.assert_array_equal(after.local[place], before.local[row])
        np.testing.assert_array_equal(worlds[place], old[row])
        assert after[place].mesh is before[row].mesh
        assert after[place].actions == before[row].actions
        above, own = after.parent[place], before.parent[row]
        assert (after.uid[above] if above >= 0 else "") == (before.uid[own] if own >= 0 else "")


@pytest.mark.parametrize("bulk", [False, True])
def test_an_existing_scene_is_extended_and_not_changed(generator: Generator, bulk: bool) -> None:
    scene = room(100)
    result = generator.add(scene, {"Cup": 3, "Table": 1, "Lamp": 1}, seed=1, bulk=bulk)
    assert_unchanged(scene, result.scene)
    assert result.added + len(result.refused) == 5
    assert len(result.scene) == len(scene) + result.added == len(scene) + len(result.rows)
    assert len(set(result.scene.uid)) == len(result.scene)
    for placement in result.objects:
        if not placement.refused:
            row = result.scene.row_of_uid[placement.uid]
            np.testing.assert_allclose(world_matrices(result.scene)[row], placement.world, atol=1e-9)
            assert result.scene.category_name(row) == placement.category
            assert placement.collision == 0


def cups_on_a_table(count: int) -> tuple[AnchorProposer, Query, Proposals]:
    """The proposer, what it is asked about a cup in a room, and its proposals on the table."""
    graph, generator = room(100), Generator.load(shared_model("anchors"))
    objects = scene_objects(graph, generator.categories)
    scene = ObservedScene.of(objects, world_matrices(graph)[objects.row])
    proposer, placeable = generator.proposer, Placeable(object_graph(graph, graph.row("Cup.0")))
    assert isinstance(proposer, AnchorProposer)
    table = int(np.flatnonzero(scene.category == generator.categories.index("Table"))[0])
    cup = generator.categories.index("Cup")
    query = Query(scene, cup, placeable, np.ones(len(scene.category), bool), {})
    return proposer, query, proposer.propose_on(query, count, np.random.default_rng(0), (table, 0), NOTHING_ELSE)


def test_proposals_are_where_the_density_is_high() -> None:
    proposer, query, drawn = cups_on_a_table(12)
    table = int(drawn.support[0])
    near = [proposer.log_density(query, table, place) for place in drawn.places]
    far = [proposer.log_density(query, table, place + 30 * np.eye(4)[0]) for place in drawn.places]
    assert np.mean(near) > np.mean(far) + 5
    assert near[0] == proposer.log_density(query, table, drawn.places[0])


def test_the_critic_chooses_among_the_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[np.ndarray] = []

    def prefer_right(self: AnchorProposer, inputs: object, view: object, places: np.ndarray) -> np.ndarray:
        seen.append(places)
        return np.where(places[:, 0] > np.median(places[:, 0]), 0.0, -1e6)

    monkeypatch.setattr(AnchorProposer, "_ratios", prefer_right)
    *_, drawn = cups_on_a_table(8)
    assert len(seen[0]) == DRAWN
    assert drawn.places[:, 0].min() > np.median(seen[0][:, 0])
    assert {*drawn.places[:, 0]} <= {*seen[0][:, 0]}


@pytest.mark.parametrize(("before", "whole"), [(0, True), (2, False)])
def test_what_is_put_on_an_empty_table_is_all_that_it_will_hold(
    monkeypatch: pytest.MonkeyPatch, before: int, whole: bool
) -> None:
    generator, seen, original = Generator.load(shared_model("anchors")), [], AnchorProposer.propose_on

    def watched(self: AnchorProposer, *given: Any) -> Proposals:
        """Keep what is asked."""
        seen.append(given[4])
        return original(self, *given)

    monkeypatch.setattr(AnchorProposer, "propose_on", watched)
    result = generator.add(room(5, cups=before), {"Cup": 3}, seed=1)
    assert result.added == 3
    assert [row.whole for row in seen[:3]] == [whole] * 3
    assert [sum(row.counts.values()) for row in seen[:3]] == [2, 1, 0]


@pytest.mark.parametrize(("counts", "whole"), [({"Table": 1}, False), ({"Table": 1, "Cup": 2, "Lamp": 1}, True)])
def test_a_floor_for_less_than_a_room_may_get_more_another_time(
    monkeypatch: pytest.MonkeyPatch, counts: dict[str, int], whole: bool
) -> None:
    seen, original = [], AnchorProposer.choose

    def watched(self: AnchorProposer, *given: Any) -> SupportChoice:
        """Keep what is asked."""
        seen.append(given[2])
        return original(self, *given)

    monkeypatch.setattr(AnchorProposer, "choose", watched)
    generator = Generator.load(shared_model("anchors"))
    result = generator.add(SceneBuilder("Nothing").build(), {"Floor": 1, "Wall": 4, **counts}, seed=1)
    assert not result.refused
    assert seen[0] == whole


def test_settled_things_stand_touch_nothing_and_stay_inside(generator: Generator) -> None:
    for seed in range(3):
        result = generator.add(room(200 + seed), {"Cup": 4, "Table": 2}, seed=seed)
        report = measure_scene(result.scene)
        assert result.added > 0
        assert not report.faults[result.rows].any()


def test_same_seed_same_result_and_another_seed_another(generator: Generator) -> None:
    scene = room(300)
    one, two, other = (generator.add(scene, {"Cup": 2, "Table": 1}, seed=seed) for seed in (5, 5, 6))
    assert one.scene.uid == two.scene.uid
    np.testing.assert_array_equal(one.scene.local, two.scene.local)
    assert one.scene.local.shape != other.scene.local.shape or not np.allclose(one.scene.local, other.scene.local)
    assert set(one.scene.uid) != set(other.scene.uid)


def test_a_room_from_nothing_begins_with_a_shell(generator: Generator) -> None:
    result = generator.add(SceneBuilder("Empty").build(), {"Floor": 1, "Wall": 4, "Table": 1, "Cup": 2}, seed=2)
    names = [result.scene.category_name(row) for row in range(len(result.scene))]
    assert names.count("Floor") == 1
    assert names.count("Wall") == 4
    assert names.count("Table") == 1
    assert result.scene["Wall"].parent is not None


def test_counts_of_a_typical_room_are_those_of_a_training_scene(generator: Generator) -> None:
    counts = generator.sample_counts(np.random.default_rng(0))
    assert counts == {"Cup": 2, "Floor": 1, "Lamp": 1, "Table": 1, "Wall": 4}


def test_relations_come_along_and_actions_of_other_scenes_do_not(generator: Generator) -> None:
    scene = room(400)
    result = generator.add(scene, {"Cup": 1}, seed=0, behaviour=False)
    cup = result.scene[int(result.rows[0])]
    assert not cup.actions
    relation = cup.component("relations")
    assert relation["kind"].tolist() == ["on_top_of"]
    assert cup.parent is not None
    assert relation["target"].tolist() == [cup.parent.uid]


def test_a_full_table_refuses_honestly(generator: Generator) -> None:
    builder = SceneBuilder("Tiny")
    floor = builder.add("Floor", uid="f", local=at(0, 0, -0.1), mesh=box("Floor", 1, 1, 0.1), category="Floor")
    builder.add("Table", uid="t", parent=floor, local=at(0, 0, 0.1), mesh=box("Table", 0.9, 0.9, 0.8), category="Table")
    scene = builder.build()
    result = generator.add(scene, {"Table": 3}, seed=0)
    assert len(result.refused) == 3
    assert all("no free place" in placement.note for placement in result.refused)
    assert len(result.scene) == len(scene)


def test_without_its_usual_support_a_thing_stands_on_the_floor_or_is_refused(generator: Generator) -> None:
    builder = SceneBuilder("Bare")
    builder.add("Floor", uid="f", local=at(0, 0, -0.1), mesh=box("Floor", 4, 4, 0.1), category="Floor")
    result = generator.add(builder.build(), {"Cup": 1, "Lamp": 1}, seed=0)
    cup = next(placement for placement in result.objects if placement.category == "Cup")
    lamp = next(placement for placement in result.objects if placement.category == "Lamp")
    assert cup.support == "Floor"
    assert "Table" in cup.note
    assert lamp.refused
    assert "Wall" in lamp.note


@pytest.mark.parametrize(
    ("counts", "text"),
    [
        ({"Cpu": 1}, "did you mean 'Cup'"),
        ({"Excavator": 1}, "Cup, Floor, Lamp, Table, Wall"),
        ({"Cup": 0}, "from 1 on"),
        ({"Cup": -2}, "from 1 on"),
        ({"Cup": True}, "from 1 on"),
        ({"Cup": 100_000_000}, "100000000 objects are too many"),
        ({"Cup": 60_000, "Table": 60_000}, "120000 objects are too many for one call: add at most 100000"),
        ({}, "nothing to add"),
    ],
)
def test_bad_requests_are_told_in_one_line(generator: Generator, counts: dict[str, int], text: str) -> None:
    with pytest.raises(UniSGError, match=text) as error:
        generator.add(room(1), counts)
    assert "\n" not in str(error.value)


def test_bad_model_files_are_told_in_one_line(tmp_path: Path) -> None:
    onnx = pytest.importorskip("onnx")
    from onnx import TensorProto, helper

    nonsense = tmp_path / "nonsense.onnx"
    nonsense.write_bytes(b"this is no model")
    graph = helper.make_graph(
        [helper.make_node("Identity", ["x"], ["y"])], "g",
        [helper.make_tensor_value_info("x", TensorProto.FLOAT, [1])],
        [helper.make_tensor_value_info("y", TensorProto.FLOAT, [1])],
    )  # fmt: skip
    foreign = tmp_path / "foreign.onnx"
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=9)
    onnx.save(model, foreign)
    newer = tmp_path / "newer.onnx"
    entry = model.metadata_props.add()
    entry.key, entry.value = "unisg", '{"contract": 99, "task": "generate"}'
    onnx.save(model, newer)
    broken = tmp_path / "broken.onnx"
    model.metadata_props[0].value = '{"contract": 1, "task": "generate", "kind": "cgvae"}'
    onnx.save(model, broken)
    other = tmp_path / "other.onnx"
    model.metadata_props[0].value = '{"contract": 1, "task": "classify"}'
    onnx.save(model, other)
    for path, text in (
        (tmp_path / "missing.onnx", "there is no model"),
        (nonsense, "no ONNX model"),
        (foreign, "no UniSG metadata"),
        (newer, "contract 99"),
        (broken, "damaged"),
        (other, "classify"),
    ):
        with pytest.raises(UniSGError, match=text) as error:
            Generator.load(path)
        assert "\n" not in str(error.value)


def test_a_model_of_weights_that_are_no_numbers_is_told(model_file: Path, tmp_path: Path) -> None:
    onnx = pytest.importorskip("onnx")
    from onnx import numpy_helper

    model = onnx.load(model_file)
    for tensor in model.graph.initializer:
        values = numpy_helper.to_array(tensor)
        if values.dtype.kind == "f":
            tensor.CopyFrom(numpy_helper.from_array(np.full_like(values, np.nan), tensor.name))
    onnx.save(model, tmp_path / "nan.onnx")
    for options in ({}, {"settle": False}, {"bulk": True}):
        with pytest.raises(UniSGError, match=r"nan\.onnx gives no finite numbers"):
            Generator.load(tmp_path / "nan.onnx").add(room(1), {"Cup": 1}, seed=0, **options)


def test_places_that_are_no_numbers_are_refused_whoever_proposes_them(model_file: Path) -> None:
    class Lost(Proposer):
        def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
            return Proposals(np.zeros(count, np.int64), np.full((count, 4), np.nan))

    generator = Generator(Generator.load(model_file).model, Lost())
    with pytest.raises(UniSGError, match="places that are no finite numbers"):
        generator.add(room(1), {"Cup": 1}, seed=0, settle=False)


def test_models_open_no_other_files_and_run_no_foreign_operators(tmp_path: Path) -> None:
    onnx = pytest.importorskip("onnx")
    from onnx import TensorProto, helper, numpy_helper

    shape = [helper.make_tensor_value_info("x", TensorProto.FLOAT, [4])]
    answer = [helper.make_tensor_value_info("y", TensorProto.FLOAT, [4])]
    weights = numpy_helper.from_array(np.ones(4, np.float32), "w")
    outside = helper.make_model(
        helper.make_graph([helper.make_node("Add", ["x", "w"], ["y"])], "g", shape, answer, [weights]), ir_version=9
    )
    kept = {"save_as_external_data": True, "location": "weights.bin", "size_threshold": 0, "convert_attribute": True}
    onnx.save(outside, tmp_path / "outside.onnx", **kept)
    assert (tmp_path / "weights.bin").is_file()
    foreign = helper.make_model(
        helper.make_graph([helper.make_node("Launch", ["x"], ["y"], domain="custom")], "g", shape, answer),
        opset_imports=[helper.make_opsetid("", 18), helper.make_opsetid("custom", 1)], ir_version=9,
    )  # fmt: skip
    onnx.save(foreign, tmp_path / "foreign.onnx")
    with pytest.raises(UniSGError, match="weights in other files"):
        Generator.load(tmp_path / "outside.onnx")
    with pytest.raises(UniSGError, match="no ONNX model that can be run"):
        Generator.load(tmp_path / "foreign.onnx")


def test_generating_loads_neither_torch_nor_blender(model_file: Path) -> None:
    code = (
        "import sys\n"
        "from unisg_blender.generate import Generator\n"
        "from unisg_blender.scene import SceneBuilder\n"
        "generator = Generator.load(sys.argv[1])\n"
        "generator.add(SceneBuilder('Empty').build(), {'Floor': 1, 'Table': 1, 'Cup': 1}, seed=0)\n"
        "print(sorted({'torch', 'bpy', 'torch_geometric', 'onnx', 'sklearn'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, model_file], capture_output=True, text=True, timeout=120, check=True
    )
    assert done.stdout.strip() == "[]"
