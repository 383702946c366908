"""Proposals that make sense: words in all languages, things of several meshes, and "I do not know"."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.meshes.shapes import box, sphere
from unisg_blender.predict import LabelModel, propose_categories
from unisg_blender.predict.calibration import calibrated, setting_evidence
from unisg_blender.predict.things_as_one import things_as_one
from unisg_blender.scene import SceneBuilder, SceneGraph

TRUST = LabelModel.load().trust
TOP, SIDE = box((1.4, 0.8, 0.05), (0, 0, 0.7)), box((0.05, 0.8, 0.7))


def one(name: str, mesh=None, use=("shape", "name", "neighbours", "structure")) -> dict[str, float]:
    builder = SceneBuilder("one")
    builder.add(name, uid="u", mesh=box((0.45, 0.4, 0.55)) if mesh is None else mesh)
    (found,) = propose_categories(builder.build(), use=use)
    return dict(found.categories)


def table(own: str, parts: tuple[str, ...] = ("Cube.001", "Cube.002", "Cube.003")) -> SceneGraph:
    """A top and two boards on its ends, under an entity without a mesh."""
    builder = SceneBuilder("parts")
    whole = builder.add(own, uid="whole")
    shapes = (box((1.4, 0.8, 0.05), (0, 0, 0.7)), box((0.05, 0.8, 0.7)), box((0.05, 0.8, 0.7), (1.35, 0, 0)))
    for name, mesh in zip(parts, shapes, strict=True):
        builder.add(name, uid=name, parent=whole, mesh=mesh)
    return builder.build()


def test_a_nightstand_is_no_cabinet() -> None:
    found = one("Nightstand")
    assert next(iter(found)) == "Nightstand"
    assert found.get("Cabinet", 0) < 0.1


@pytest.mark.parametrize(
    ("name", "category"), [("Stuhl_2", "Chair"), ("沙发", "Sofa"), ("SM_Lampadaire", "Floor Lamp")]
)
def test_words_of_other_languages(name: str, category: str) -> None:
    found = one(name)
    assert next(iter(found)) == category
    assert found[category] > 0.9


def test_what_the_user_says_of_a_word_counts_first() -> None:
    builder = SceneBuilder("one")
    builder.add("Klotz_3", uid="u", mesh=box((0.45, 0.4, 0.55)))
    (found,) = propose_categories(builder.build(), words={"Klotz": "Throne"})
    assert found.best == "Throne"
    assert found.known


def test_a_broader_term_leaves_the_choice_to_the_shape() -> None:
    found = one("Table", box((1.1, 0.6, 0.4)))
    assert next(iter(found)) == "Coffee Table"
    assert all("Table" in name or name == "Desk" for name in found)


def test_what_is_like_nothing_known_is_not_known() -> None:
    rng = np.random.default_rng(1)
    spikes = sphere(200, 1.0)
    points = spikes.points * rng.uniform(0.3, 4, (len(spikes.points), 1))
    builder = SceneBuilder("odd")
    builder.add("Object_7", uid="u", mesh=type(spikes)("m", points.astype(np.float32), spikes.corners, spikes.offsets))
    (found,) = propose_categories(builder.build())
    assert not found.known
    assert sum(value for _, value in found.categories) < 1


def test_building_is_never_proposed_by_its_looks() -> None:
    for mesh in (box((4, 0.1, 2.5)), box((6, 6, 0.1))):
        assert not {"Floor", "Wall", "Ceiling"} & set(one("Object", mesh, ("shape", "name", "neighbours")))


def test_a_table_of_three_meshes_is_judged_as_one() -> None:
    graph = table("Object_12")
    found = propose_categories(graph)
    assert [proposal.uid for proposal in found] == ["whole"]
    assert any("Table" in name or name == "Desk" for name, _ in found[0].categories)
    joined = things_as_one(graph)
    row = graph.name.index("Object_12")
    assert (joined.mesh >= 0).sum() == 1
    np.testing.assert_allclose(joined.meshes[joined.mesh[row]].bounds, [[0, 0, 0], [1.4, 0.8, 0.75]], atol=1e-6)


@pytest.mark.parametrize("parts", [("Chair.1", "Chair.2", "Chair.3"), ("Cube", "Vase", "Cube.2")])
def test_several_things_stay_several(parts: tuple[str, ...]) -> None:
    graph = table("Chairs", parts)
    assert things_as_one(graph) is graph


def test_copies_share_a_mesh_and_what_is_built_is_no_part() -> None:
    builder = SceneBuilder("copies")
    for number in range(2):
        whole = builder.add(f"Object_{number}", uid=f"w{number}", local=np.diag([1.0, 1, 1, 1]))
        for part, mesh in enumerate((TOP, SIDE)):
            builder.add(f"Cube.{number}{part}", uid=f"p{number}{part}", parent=whole, mesh=mesh)
    graph = builder.build()
    joined = things_as_one(graph)
    rows = [joined.name.index(f"Object_{number}") for number in range(2)]
    assert joined.mesh[rows[0]] == joined.mesh[rows[1]] >= 0
    assert things_as_one(graph, set(range(len(graph)))) is graph


def test_what_lies_apart_stays_apart() -> None:
    builder = SceneBuilder("apart")
    whole = builder.add("group", uid="g")
    for number in range(2):
        builder.add(f"Cube.{number}", uid=f"c{number}", parent=whole, mesh=box((0.2, 0.2, 0.2), (number, 0, 0)))
    graph = builder.build()
    assert things_as_one(graph) is graph


@given(st.integers(0, 1000), st.integers(2, 6))
def test_calibrated_chances_are_chances_and_keep_the_best(seed: int, kinds: int) -> None:
    rng = np.random.default_rng(seed)
    scores, apart = rng.normal(0, 3, (4, kinds)), rng.uniform(0, 2, (4, kinds))
    found = calibrated(scores, apart, TRUST)
    assert ((found >= 0) & (found <= 1)).all()
    assert (found.sum(axis=1) <= 1 + 1e-9).all()
    assert (found.argmax(axis=1) == scores.argmax(axis=1)).all()


def test_a_room_of_one_kind_makes_things_of_the_other_unlikely() -> None:
    names = ("Sofa", "Scalpel", "Box")
    settings = {"living room": ("Sofa",), "operating room": ("Scalpel",)}
    scores = np.array([[5.0, 0, 0], [4, 0, 0], [0, 0, 0]])
    evidence = setting_evidence(scores, [], names, settings)
    assert evidence[1] < -1.5
    assert evidence[0] == pytest.approx(0)
    assert evidence[2] == 0
    assert not setting_evidence(scores[:1], [], names, settings).any()  # one thing is no room
    assert setting_evidence(scores[2:], ["Scalpel", "Scalpel"], names, settings)[0] < -1.5
