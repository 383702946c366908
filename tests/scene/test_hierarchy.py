"""World matrices, subtrees and cutting out rows."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from unisg_blender.scene import SceneBuilder, SceneGraph, children, subtree, table, take, world_matrices
from unisg_blender.scene.realize_instances import realize


@st.composite
def scenes(draw) -> SceneGraph:
    """Random forests with any affine matrices."""
    builder = SceneBuilder()
    rng = np.random.default_rng(draw(st.integers(0, 2**16)))
    for number in range(draw(st.integers(1, 12))):
        local = np.eye(4)
        local[:3] += rng.normal(size=(3, 4))
        parent = draw(st.integers(-1, number - 1))
        builder.add(draw(st.sampled_from("abc")), uid=str(number), parent=parent, local=local)
    return builder.build()


@given(scenes())
def test_world_matrices_are_products_up_to_the_root(graph: SceneGraph) -> None:
    world = world_matrices(graph)
    for row in range(len(graph)):
        expected, above = graph.local[row], graph.parent[row]
        while above >= 0:
            expected, above = graph.local[above] @ expected, graph.parent[above]
        np.testing.assert_allclose(world[row], expected, rtol=1e-9, atol=1e-9)


@given(scenes())
def test_subtrees_are_runs_of_rows(graph: SceneGraph) -> None:
    assert (graph.parent < np.arange(len(graph))).all()
    for row in range(len(graph)):
        found = subtree(graph, row)
        assert found.tolist() == list(range(row, row + len(found)))
        assert set(children(graph, row)) <= set(found)


@given(scenes(), st.data())
def test_rows_that_are_cut_out_stay_where_they_stand(graph: SceneGraph, data: st.DataObject) -> None:
    rows = np.array(sorted(data.draw(st.sets(st.integers(0, len(graph) - 1), min_size=1))))
    part = take(graph, rows)
    np.testing.assert_allclose(world_matrices(part), world_matrices(graph)[rows], rtol=1e-6, atol=1e-6)
    assert part.uid == tuple(graph.uid[row] for row in rows)


def test_constrained_entities_carry_what_hangs_under_them() -> None:
    builder = SceneBuilder()
    root = builder.add("Root", uid="r")
    builder.add("Child", uid="c", parent=root)
    graph = builder.build()
    moved = np.eye(4)
    moved[0, 3] = 5
    graph = graph.with_component("world", table([0], matrix=moved[None]))
    assert world_matrices(graph)[:, 0, 3].tolist() == [5, 5]


def test_instances_of_instances_become_entities() -> None:
    shift = np.eye(4)
    shift[0, 3] = 1
    inner = SceneBuilder()
    inner.add("Leaf", uid="leaf", category="Leaf", local=shift)
    middle = SceneBuilder()
    middle.add("Twig", uid="twig", local=shift)
    prototypes = np.empty(2, object)
    prototypes[:] = [inner.build()] * 2
    twig = middle.build().with_component(
        "instances", table([0, 0], prototype=prototypes, matrix=np.stack([np.eye(4), shift]), source=["COLLECTION"] * 2)
    )
    outer = SceneBuilder()
    outer.add("Tree", uid="tree", category="Tree", local=shift)
    graph = outer.build().with_component(
        "instances", table([0], prototype=[twig], matrix=shift[None], source=["COLLECTION"])
    )
    whole = realize(graph)
    assert whole.name == ("Tree", "Twig", "Leaf", "Leaf")
    assert whole.vocabulary == ("Leaf", "Tree")
    assert world_matrices(whole)[:, 0, 3].tolist() == [1, 3, 4, 5]
    assert len(set(whole.uid)) == 4
    assert realize(whole) is whole
