"""The whole benchmark, small: all tables and figures are written, and a second call makes nothing anew."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch_geometric")
pytest.importorskip("matplotlib")

from unisg_blender.cli import main
from unisg_blender.experiments.paper import paper_report as report
from unisg_blender.experiments.paper import plan, runs
from unisg_blender.experiments.paper.scale import field
from unisg_blender.learn.paper.experiment_scenes import Sizes, tumbled
from unisg_blender.learn.paper.poses import landmarks, poses_of_landmarks, random_signs
from unisg_blender.metrics.pose_errors import decoded
from unisg_blender.poses import FORMS
from unisg_blender.predict.object_pairs import candidate_pairs
from unisg_blender.scene import world_matrices
from unisg_blender.worlds import cubes

TINY = plan.PaperPlan(
    Sizes(augmented=4, tests=1, rooms=10, pairs=12, cubes=8),
    seeds=2, classification=1, few=1, topology=1, generation=1, links=1, steps=3, most_cubes=0,
)  # fmt: skip
FORMS_KEPT = ("sixd", "pga")


@pytest.fixture
def tiny(monkeypatch: pytest.MonkeyPatch) -> None:
    names = ("target, base case", "target, random sign", "in and out, parent-relative")
    kept = {name: plan.POSE_FACTORS[name] for name in (*names, "child seen from parent, two world poses")}
    factors = {name: (settings, FORMS_KEPT) for name, (settings, _) in kept.items()}
    monkeypatch.setattr(plan, "POSE_FACTORS", factors)
    monkeypatch.setattr(plan, "PAPER_FORMS", {"PGA": "pga"})
    monkeypatch.setattr("unisg_blender.experiments.paper.run_tables.PAPER_FORMS", {"PGA": "pga"})
    monkeypatch.setattr(plan, "NARROW_FORMS", FORMS_KEPT)
    monkeypatch.setattr(plan, "FEW_FORMS", ("sixd",))
    monkeypatch.setattr(report, "QUICK_PLAN", replace(TINY))


@pytest.mark.slow
def test_everything_is_written_and_a_second_call_goes_on(
    tiny: None, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["benchmark", "paper", "--quick", "--jobs", "1", "--out", str(tmp_path / "out"), "-q"]
    assert main([*words, "--tables-only"]) == 1
    assert main([*words, "--json"]) == 0
    first = json.loads(capsys.readouterr().out)
    assert first["trainings"]["done"] == first["trainings"]["planned"]
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"paper.json", "paper.png", "paper.svg", "paper_poses.png", "paper_tables.md"} <= names
    for table in (
        "classification_curves",
        "generation",
        "topology_unseen",
        "poses",
        "classification_few",
        "poses_runs",
    ):
        assert f"paper_{table}.csv" in names
    assert "±" in (tmp_path / "out" / "paper_tables.md").read_text()
    row = first["tables"]["poses"][0]
    assert row["seeds"] == 2
    assert row["mean_mse"] > 0
    assert row["r_squared_low"] <= row["r_squared"] <= row["r_squared_high"] <= 1
    with (tmp_path / "out" / "paper_poses_runs.csv").open() as file:
        single = [float(run["cm_median"]) for run in csv.DictReader(file) if run["setting"] == row["setting"]]
    assert np.mean(single[:2]) == pytest.approx(row["cm_median"], rel=1e-4)
    tested = [run for run in first["tables"]["tests"] if run["table"] == "poses"]
    assert {(run["form"], run["against"], run["pairs"]) for run in tested} == {("pga", "sixd", 2)}
    assert first["tables"]["topology_unseen"][2]["f1"] > 0.95  # the geometric rule

    def never(*task: object) -> None:
        raise AssertionError("a training was made twice")

    monkeypatch.setattr(runs, "_do", never)
    lost = next((tmp_path / "out" / "runs").glob("generation-*.json"))
    assert main([*words, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["tables"] == first["tables"]
    lost.unlink()
    assert main([*words, "--tables-only", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["tables"]["generation"][0]["runs"] == 1
    with pytest.raises(AssertionError, match="twice"):
        main(words)
    assert main(["benchmark", "paper", "--out", str(tmp_path / "out"), "-q"]) == 1  # made with --quick
    assert "--quick" in capsys.readouterr().err


def test_the_plan_counts_what_the_paper_counts() -> None:
    full = plan.PaperPlan()
    assert (full.sizes.augmented * 2, full.classification, full.seeds) == (100, 20, 10)
    assert (full.sizes.rooms, full.generation, full.sizes.pairs * 2, full.topology) == (1000, 100, 10_000, 100)
    assert len(plan.paper_runs(full)) == 3 * 10 * 5
    assert set(plan.PAPER_FORMS.values()) == {"trs_matrix", "cga_similarity", "pga", "axis_angle", "dual_quaternion"}
    everything = plan.all_runs(full)
    assert len({run.key for run in everything}) == len(everything)


def test_every_learning_rate_that_is_named_is_tried(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert {tuple(run.settings["rates"]) for run in plan.pose_runs(plan.PaperPlan(rates=(0.1, 1.0))).values()} == {
        (0.1, 1.0)
    }
    assert main(["benchmark", "paper", "--out", str(tmp_path / "out"), "--rates", "0.1", "-1"]) != 0
    assert not (tmp_path / "out").exists()


def test_landmarks_say_a_pose() -> None:
    rng = np.random.default_rng(0)
    poses = FORMS["axis_angle"].decode(rng.normal(size=(20, 7)))
    np.testing.assert_allclose(poses_of_landmarks(landmarks(poses)), poses, atol=1e-9)


@pytest.mark.parametrize("form", FORMS)
def test_both_signs_mean_the_same_pose(form: str) -> None:
    poses = FORMS["axis_angle"].decode(np.random.default_rng(0).normal(size=(50, 7)))
    features = FORMS[form].encode(poses)
    changed = random_signs(features, form, 1)
    np.testing.assert_allclose(decoded(changed, form), poses, atol=1e-8)
    double = form in ("axis_angle", "quaternion", "dual_quaternion") or form.startswith(("pga", "cga"))
    assert (np.abs(changed - features).max() > 0.1) == double


def test_a_tumbled_scene_keeps_its_inner_distances() -> None:
    graph = cubes(0, 8)
    for upright in (True, False):
        before, after = (world_matrices(item)[:, :3, 3] for item in (graph, tumbled(graph, 3, upright)))
        apart = [np.linalg.norm(points[:, None] - points, axis=-1) for points in (before, after)]
        np.testing.assert_allclose(apart[0], apart[1], atol=1e-9)
        assert np.allclose(before[:, 2], after[:, 2]) == upright


def test_a_field_of_cubes_has_each_upper_one_on_its_lower_one() -> None:
    boxes, upper = field(2300)
    lower = boxes.take(np.flatnonzero(upper) - 1)
    top = boxes.take(np.flatnonzero(upper))
    np.testing.assert_allclose(top.center[:, 2] - top.half[:, 2], lower.center[:, 2] + lower.half[:, 2], atol=1e-6)
    assert len(candidate_pairs(boxes, 4)) <= 4 * 2300


def test_an_unusable_folder_is_told_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    assert main(["benchmark", "paper", "--out", str(tmp_path / "file" / "out")]) == 1
    assert "cannot write" in capsys.readouterr().err
    assert (tmp_path / "file").read_text() == ""
