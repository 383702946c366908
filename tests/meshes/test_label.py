from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.errors import UniSGError
from unisg_blender.meshes.normalise import size_channels
from unisg_blender.predict.category_model import LabelModel
from unisg_blender.predict.category_proposals import accept, beside, propose_categories
from unisg_blender.predict.name_evidence import name_scores, words
from unisg_blender.scene import Mesh, SceneBuilder, SceneGraph
from unisg_blender.usd.pxr_library import missing_pxr

from .shapes import box, sphere

LEXICON = [{"chair": 1.0}, {"lamp": 1.0, "desk": 0.5}, {"desk": 1.0}]


def at(x: float, y: float, z: float, linear: np.ndarray | None = None) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    if linear is not None:
        matrix[:3, :3] = linear
    return matrix


def scene_of(*objects: tuple[str, Mesh, np.ndarray, str]) -> SceneGraph:
    builder = SceneBuilder()
    for number, (name, mesh, local, category) in enumerate(objects):
        builder.add(name, uid=f"u{number}", mesh=mesh, local=local, category=category)
    return builder.build()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("BarStool_02.001", ["bar", "stool"]),
        ("IVPole", ["iv", "pole"]),
        ("wall-flat-tv", ["wall", "flat", "tv"]),
        ("Cube.034", []),
        ("SM_Chair", ["chair"]),
        ("", []),
    ],
)
def test_words_of_names(name: str, expected: list[str]) -> None:
    assert words(name) == expected


def test_the_last_word_says_what_it_is() -> None:
    assert np.argmax(name_scores("desk lamp", LEXICON)) == 1
    assert np.argmax(name_scores("lamp desk", LEXICON)) == 2
    assert np.argmax(name_scores("Chairs.003", LEXICON)) == 0
    assert not name_scores("Cube.001", LEXICON).any()


@pytest.mark.slow
@settings(max_examples=200, deadline=None)
@given(st.text(max_size=60))
def test_any_name_has_scores_between_0_and_1(name: str) -> None:
    scores = name_scores(name, LEXICON)
    assert scores.shape == (3,)
    assert ((scores >= 0) & (scores <= 1)).all()


def test_size_channels_ignore_quarter_turns() -> None:
    assert np.array_equal(size_channels(np.array([[1.0, 2, 3]])), size_channels(np.array([[2.0, 1, 3]])))
    assert np.isfinite(size_channels(np.zeros((1, 3)))).all()


def test_proposals_for_what_has_no_category() -> None:
    graph = scene_of(
        ("Sofa.001", box((2, 0.9, 0.8)), at(0, 0, 0), ""),
        ("Thing", sphere(200, 0.1), at(3, 0, 0), ""),
        ("Known", box(), at(0, 3, 0), "Box"),
    )
    found = propose_categories(graph)
    assert {proposal.name for proposal in found} == {"Sofa.001", "Thing"}
    sofa = next(proposal for proposal in found if proposal.name == "Sofa.001")
    assert sofa.best == "Sofa"
    assert sofa.uid == "u0"
    for proposal in found:
        values = [value for _, value in proposal.categories]
        assert len(values) == 3
        assert values == sorted(values, reverse=True)
        assert 0 < sum(values) <= 1 + 1e-9
    assert len(propose_categories(graph, rows=range(3), best=1)[0].categories) == 1


def test_heading_and_how_the_mesh_is_stored_change_little() -> None:
    c, s = np.cos(0.7), np.sin(0.7)
    yaw = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    upright = box((0.5, 0.5, 1.8))
    lying = box((0.5, 1.8, 0.5))  # Y up, stood up by the object's rotation, in centimetres
    stand = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    graph = scene_of(
        ("a", upright, at(0, 0, 0), ""), ("b", upright, at(50, 0, 0, yaw), ""), ("c", lying, at(0, 50, 0, stand), "")
    )
    first, turned, stored = (dict(p.categories) for p in propose_categories(graph, use=("shape",), best=200))
    assert max(abs(first[name] - turned[name]) for name in first) < 1e-6
    assert max(abs(first[name] - stored[name]) for name in first) < 0.35
    assert max(first, key=first.get) in sorted(stored, key=stored.get)[-3:]


def test_accepting_sets_categories_from_a_confidence_on() -> None:
    graph = scene_of(("Sofa", box((2, 0.9, 0.8)), at(0, 0, 0), ""), ("Known", box(), at(9, 0, 0), "Box"))
    proposals = propose_categories(graph)
    done = accept(graph, proposals)
    assert done["Sofa"].category == proposals[0].best
    assert done["Known"].category == "Box"
    assert accept(graph, proposals, 1.1)["Sofa"].category == ""


def test_meshes_without_points_and_empties_have_no_proposal() -> None:
    builder = SceneBuilder()
    builder.add("Empty", uid="e")
    builder.add(
        "Nothing", uid="n", mesh=Mesh("n", np.zeros((0, 3), np.float32), np.zeros(0, np.int32), np.zeros(1, np.int32))
    )
    builder.add(
        "Cloud", uid="c", mesh=Mesh("c", np.eye(3, dtype=np.float32), np.zeros(0, np.int32), np.zeros(1, np.int32))
    )
    found = propose_categories(builder.build())
    assert [proposal.name for proposal in found] == ["Cloud"]
    assert propose_categories(SceneBuilder().build()) == []


def test_zero_scale_gives_finite_confidences() -> None:
    graph = scene_of(
        ("Flat", box(), at(0, 0, 0, np.diag([1.0, 1, 0])), ""), ("Gone", box(), at(0, 0, 0, np.zeros((3, 3))), "")
    )
    for proposal in propose_categories(graph):
        assert np.isfinite([value for _, value in proposal.categories]).all()


def test_beside_leaves_out_far_and_huge_things() -> None:
    graph = scene_of(
        ("a", box(), at(0, 0, 0), ""), ("b", box(), at(1.5, 0, 0), ""), ("far", box(), at(30, 0, 0), ""),
        ("floor", box((40, 40, 0.1)), at(0, 0, 0), ""),
    )  # fmt: skip
    first, second = beside(graph)
    assert {(graph.name[i], graph.name[j]) for i, j in zip(first, second, strict=True)} == {("a", "b"), ("b", "a")}


def test_model_file_round_trip(tmp_path: Path) -> None:
    model = LabelModel.load()
    model.save(tmp_path / "labels.safetensors")
    back = LabelModel.load(tmp_path / "labels.safetensors")
    assert back.vocabulary == model.vocabulary
    assert np.array_equal(back.vectors, model.vectors)
    assert back.temperature == model.temperature
    assert back.lexicon == model.lexicon


def test_unusable_model_files(tmp_path: Path) -> None:
    from safetensors.numpy import save_file

    path = tmp_path / "labels.safetensors"
    with pytest.raises(UniSGError, match="no such model"):
        LabelModel.load(path)
    path.write_bytes(b"nothing")
    with pytest.raises(UniSGError, match="damaged"):
        LabelModel.load(path)
    save_file({"weights": np.zeros(3, np.float32)}, path)
    with pytest.raises(UniSGError, match="train it again"):
        LabelModel.load(path)


def test_verb_prints_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    if missing_pxr():
        pytest.skip(missing_pxr())
    from unisg_blender.cli import main
    from unisg_blender.usd import read_usd, write_usd

    write_usd(scene_of(("Sofa", box((2, 0.9, 0.8)), at(0, 0, 0), "")), tmp_path / "in.usda")
    out = tmp_path / "out.usda"
    assert main(["label", str(tmp_path / "in.usda"), "--json", "--out", str(out), "--threshold", "0"]) == 0
    (report,) = json.loads(capsys.readouterr().out)["files"]
    assert report["accepted"] == 1
    best = report["proposals"][0]["categories"][0]["category"]
    assert best in [read_usd(out).category_name(row) for row in range(len(read_usd(out)))]


@pytest.mark.parametrize(
    "words",
    [["missing.usda"], ["in.usda", "--use", "smell"], ["in.usda", "--out", "x.txt"]],
)
def test_verb_refuses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str]) -> None:
    from unisg_blender.cli import main

    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.usda").write_text("#usda 1.0\n")
    assert main(["label", *words]) == 1
    assert {path.name for path in tmp_path.iterdir()} == {"in.usda"}
