"""The shipped networks on scenes with known answers, the verbs that ask them, and what is no model."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.metrics.hand_made import Scene, box_mesh, table_mesh
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.geometry.boxes import Boxes
from unisg_blender.predict.familiarity import Familiarity
from unisg_blender.predict.object_pairs import candidate_pairs, pair_features
from unisg_blender.predict.prediction_session import load_network
from unisg_blender.predict.scene_kind import SceneModel
from unisg_blender.predict.support_prediction import TopologyModel, with_supports
from unisg_blender.scene import SceneBuilder, SceneGraph, world_matrices
from unisg_blender.scene.properties import relations_of
from unisg_blender.spatial import find_objects
from unisg_blender.worlds import cubes, living_room, operating_room


@pytest.fixture
def stack() -> SceneGraph:
    """Two cubes on one another, a third beside them; the floor under all."""
    scene = Scene()
    scene.box("below", (0.3, 0.3, 0.3), (0, 0, 0))
    scene.box("above", (0.2, 0.2, 0.2), (0.02, 0.01, 0.3, 0.4))
    scene.box("beside", (0.3, 0.3, 0.3), (0.305, 0, 0))
    return scene.build()


def boxes(count: int, seed: int = 0) -> Boxes:
    rng = np.random.default_rng(seed)
    axes = Rotation.random(count, random_state=seed).as_matrix()
    return Boxes(rng.uniform(-3, 3, (count, 3)), axes, rng.uniform(0.05, 0.3, (count, 3)), np.ones(count, bool))


def test_boxes_of_things_follow_their_own_axes(stack: SceneGraph) -> None:
    objects = find_objects(stack, empty=False)
    rows, found = objects.rows, objects.oriented
    place = rows.tolist().index(stack.row("above"))
    np.testing.assert_allclose(np.sort(found.half[place]), [0.1, 0.1, 0.1], atol=1e-6)
    np.testing.assert_allclose(found.center[place], [0.02, 0.01, 0.4], atol=1e-6)


def test_near_things_and_large_ones_are_candidates(stack: SceneGraph) -> None:
    objects = find_objects(stack, empty=False)
    rows, found = objects.rows, objects.oriented
    pairs = {(int(rows[a]), int(rows[b])) for a, b in candidate_pairs(found, 1)}
    floor, above, below = (stack.row(name) for name in ("floor", "above", "below"))
    assert {(above, below), (below, floor), (floor, below)} <= pairs
    many = candidate_pairs(boxes(500), 6)
    assert len(many) <= 500 * 6
    assert (many[:, 0] != many[:, 1]).all()
    assert len(candidate_pairs(boxes(1))) == 0


def test_what_a_pair_looks_like_does_not_depend_on_where_it_is() -> None:
    some, pairs = boxes(20), np.array([[0, 1], [5, 9], [3, 2]])
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    moved = Boxes(some.center @ quarter.T + [40, -7, 3], quarter @ some.axes, some.half, some.solid)
    before, after = pair_features(some, pairs), pair_features(moved, pairs)
    assert np.abs(np.delete(before - after, [-3, -2], axis=1)).max() < 1e-4
    np.testing.assert_allclose(after[:, [-3, -2]], before[:, [-2, -3]], atol=1e-4)  # x and y change places
    order = np.random.default_rng(0).permutation(20)
    place = np.argsort(order)
    np.testing.assert_array_equal(pair_features(some.take(order), place[pairs]), before)


def test_a_stack_is_seen(stack: SceneGraph) -> None:
    found = {(stack.name[a], stack.name[b]) for a, _, b, _ in TopologyModel().find(stack)}
    assert ("above", "below") in found
    assert ("below", "above") not in found
    assert not {("beside", "below"), ("below", "beside"), ("above", "beside")} & found
    assert ("below", "floor") in found


def test_unseen_cubes_are_told_well() -> None:
    model, right, wrong, missed = TopologyModel(), 0, 0, 0
    for seed in range(900, 904):
        graph = cubes(seed, 30)
        truth = {(row, target) for row in range(len(graph)) for target in _targets(graph, row)}
        found = {(a, b) for a, _, b, _ in model.find(graph)}
        right, wrong, missed = right + len(found & truth), wrong + len(found - truth), missed + len(truth - found)
    assert 2 * right / (2 * right + wrong + missed) > 0.9


def _targets(graph: SceneGraph, row: int) -> list[int]:
    return [graph.row_of_uid[item.target] for item in relations_of(graph, row) if item.kind == "on_top_of"]


def test_predicted_relations_replace_those_of_their_kind() -> None:
    scene = Scene()
    table = scene.box("table", None, (0, 0, 0), mesh=table_mesh(), relation=("on_top_of", "floor"))
    scene.box("cup", (0.1, 0.1, 0.1), (0, 0, 0.75), parent=table, relation=("belongs_to", "table"))
    graph = with_supports(scene.build(), [(2, "on_top_of", 1, 0.9)])
    assert [(item.kind, item.target) for item in relations_of(graph, 2)] == [
        ("belongs_to", "table"),
        ("on_top_of", "table"),
    ]
    assert not relations_of(graph, 1)


@pytest.mark.parametrize(("make", "kind"), [(operating_room, "operating-room"), (living_room, "living-room")])
def test_unseen_rooms_are_told_apart_however_they_are_turned(make, kind: str) -> None:
    model = SceneModel()
    for seed in (700, 701):
        graph = make(seed)
        found = model.classify(graph)
        assert sum(found.chances.values()) == pytest.approx(1)
        assert found.kind == found.nearest == kind
        assert found.known == found.objects > 9
        turn = np.eye(4)
        turn[:2, :2] = [[0, -1], [1, 0]]
        local = graph.local.copy()
        local[graph.parent < 0] = turn @ local[graph.parent < 0]
        assert model.classify(graph.replace(local=local)).kind == kind


def test_what_is_like_nothing_learned_from_is_none_of_these(stack: SceneGraph) -> None:
    found = SceneModel().classify(stack)
    assert found.foreign
    assert found.kind == ""
    assert found.distance > 2
    assert found.lines[0] == "none of these (1 of 4 objects known)"


def test_categories_that_are_not_known_are_foreign_and_none_at_all_say_nothing() -> None:
    model, room = SceneModel(), living_room(seed=701)
    strange = room.replace(vocabulary=tuple(f"kind {number}" for number in range(len(room.vocabulary))))
    found = model.classify(strange)
    assert found.foreign
    assert (found.known, found.nearest) == (0, "living-room")
    bare = room.replace(category=np.full(len(room), -1), vocabulary=())
    assert model.classify(bare).kind == "living-room"


def test_familiarity_is_measured_in_distances_of_held_out_scenes() -> None:
    seen, held_out = np.array([[0, 0], [4, 0]], np.float32), np.array([[0, 1], [4, 2]], np.float32)
    like = Familiarity.learned(seen, held_out, {"Cup"}, [0.8, 1.0])
    assert like.distance(np.array([0, 3], np.float32)) == pytest.approx(1.5)
    again = Familiarity.from_record(json.loads(json.dumps(like.to_record())))
    assert (again.reach, again.categories, again.share) == (2.0, {"Cup"}, 0.8)
    for change in ({"embeddings": []}, {"embeddings": [[1.0], [1.0, 2.0]]}, {"reach": float("nan")}):
        with pytest.raises(UniSGError):
            Familiarity.from_record(like.to_record() | change)
    assert again.is_foreign(2.1, 5, 5, 5)
    assert not again.is_foreign(1.9, 2, 5, 5)
    assert again.is_foreign(1.9, 1, 5, 5)
    assert not again.is_foreign(1.9, 0, 0, 5)


def test_the_verbs(stack: SceneGraph, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("bpy")
    from unisg_blender.usd import read_usd, write_usd

    path, out = tmp_path / "stack.usda", tmp_path / "out.usda"
    write_usd(stack, path)
    assert main(["relations", str(path), "--model", "--json", "--out", str(out)]) == 0
    records = json.loads(capsys.readouterr().out)["relations"]
    assert ("above", "below") in {(entry["subject"], entry["target"]) for entry in records}
    assert all(0 < entry["chance"] <= 1 for entry in records)
    again = read_usd(out)
    assert _targets(again, again.row("above")) == [again.row("below")]
    assert main(["relations", str(path), "--model", "--kind", "beside"]) == 1
    assert main(["classify", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["kind"] is None
    assert found["nearest"] in found["chances"]
    assert found["objects"] == 4
    assert main(["classify", str(path)]) == 0
    assert capsys.readouterr().out.startswith("none of these (1 of 4 objects known")


def test_what_is_no_such_model_is_told(tmp_path: Path) -> None:
    (tmp_path / "x.onnx").write_bytes(b"no model")
    with pytest.raises(UniSGError, match="no ONNX model"):
        load_network("topology", tmp_path / "x.onnx")
    with pytest.raises(UniSGError, match="there is no model"):
        load_network("topology", tmp_path / "y.onnx")
    with pytest.raises(UniSGError, match="is a model for 'classifier'"):
        TopologyModel(load_network("classifier").path)
    with pytest.raises(UniSGError, match="no objects"):
        SceneModel().classify(SceneBuilder().build())


def test_a_bent_scene_still_has_finite_features() -> None:
    scene = Scene()
    scene.box("flat", (0.2, 0.2, 0.2), (0, 0, 0), mesh=box_mesh(((0.2, 0.2, 0.0), (0, 0, 0))))
    graph = scene.build()
    local = graph.local.copy()
    local[1, :3, 0] = 0  # a zero scale
    found = find_objects(graph.replace(local=local), empty=False).oriented
    assert np.isfinite(pair_features(found, candidate_pairs(found))).all()
    assert len(world_matrices(graph)) == len(graph)
