"""What a scenegraph refuses to hold, and what it computes once."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from typing import Any

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.scene import (
    ActionData,
    SceneBuilder,
    SceneGraph,
    Table,
    box_mesh,
    mesh_from_faces,
    table,
    world_matrices,
)

EYES = np.tile(np.eye(4), (3, 1, 1))


def small(**changes: Any) -> SceneGraph:
    """Three entities, one under the other two, with a mesh, categories and a component."""
    columns: dict[str, Any] = {
        "name": ("Table", "Cup", "Lamp"), "uid": ("t", "c", "l"), "type": np.zeros(3, np.int8),
        "parent": np.array([-1, 0, -1], np.int32), "category": np.array([1, 0, -1], np.int32),
        "vocabulary": ("Cup", "Table"), "local": EYES.copy(), "mesh": np.array([-1, 0, 0], np.int32),
        "meshes": (mesh_from_faces("Quad", np.eye(4, 3), [[0, 1, 2, 3]]),),
        "components": {"relations": table([1], kind=["on_top_of"], target=["t"])},
    }  # fmt: skip
    return SceneGraph(**columns | changes)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"uid": ("t", "c")}, "'uid' has 2 entries for 3 names"),
        ({"local": EYES[:, :3, :3]}, r"'local' must be floating \(3, 4, 4\), not float64 \(3, 3, 3\)"),
        ({"local": EYES[:2]}, r"'local' must be floating \(3, 4, 4\), not float64 \(2, 4, 4\)"),
        ({"mesh": np.zeros(4, np.int32)}, r"'mesh' must be integer \(3,\), not int32 \(4,\)"),
        ({"parent": np.zeros(3)}, r"'parent' must be integer \(3,\), not float64 \(3,\)"),
        ({"type": ("MESH", "MESH", "EMPTY")}, r"'type' must be integer \(3,\), not <U5 \(3,\)"),
    ],
)
def test_columns_that_do_not_belong_together_are_refused_at_once(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(UniSGError, match=says):
        small(**changes)
    with pytest.raises(UniSGError, match=says):
        small().replace(**changes)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"uid": ("t", "c", "t")}, "'uid' has 't' more than once"),
        ({"parent": np.array([-1, 2, -1])}, "'parent' has 2 in row 1: parents must come first"),
        ({"parent": np.array([1, 0, -1])}, "'parent' has 1 in row 0: parents must come first"),
        ({"parent": np.array([-1, -2, -1])}, "'parent' has -2 in row 1: it goes from -1 to 2"),
        ({"category": np.array([0, 2, -1])}, "'category' has 2 in row 1: it goes from -1 to 1"),
        ({"mesh": np.array([-1, 0, 1])}, "'mesh' has 1 in row 2: it goes from -1 to 0"),
        ({"meshes": ()}, "'mesh' has 0 in row 1: it goes from -1 to -1"),
        ({"type": np.array([0, 0, 17])}, "'type' has 17 in row 2: it goes from 0 to 16"),
        ({"components": {"events": table([3], time=np.zeros(1))}}, "'events' must have ascending rows from 0 to 2"),
        ({"components": {"x": Table(np.array([1, 0]), {})}}, "'x' must have ascending rows"),
    ],
)
def test_columns_that_hold_nonsense_do_not_validate(changes: dict[str, Any], says: str) -> None:
    graph = small(**changes)
    with pytest.raises(UniSGError, match=says):
        graph.validate()


def test_what_is_sound_validates_to_itself() -> None:
    assert small().validate() is not None
    empty = SceneBuilder().build()
    assert empty.validate() is empty


def test_a_component_whose_columns_differ_in_length_is_refused() -> None:
    with pytest.raises(UniSGError, match="'kind' of a component has 2 entries, not 1"):
        Table(np.zeros(1, np.int32), {"kind": np.zeros(2)})


def test_the_builder_takes_a_place_instead_of_a_matrix() -> None:
    builder = SceneBuilder()
    builder.add("Cup", uid="c", local=(1, 2, 3), mesh=box_mesh("Cup", (0.2, 0.4, 0.6), bottom=-0.5))
    scene = builder.build()
    np.testing.assert_array_equal(scene.local[0], [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])
    np.testing.assert_allclose(scene.meshes[0].bounds, [[-0.1, -0.2, -0.3], [0.1, 0.2, 0.3]])
    np.testing.assert_allclose(box_mesh("Cup", (0.2, 0.4, 0.6)).bounds, [[-0.1, -0.2, 0], [0.1, 0.2, 0.6]])


def test_the_builder_refuses_what_is_no_matrix() -> None:
    with pytest.raises(UniSGError, match=r"'Cup' must have the shape \(4, 4\), not \(3, 3\)"):
        SceneBuilder().add("Cup", uid="c", local=np.eye(3))
    builder = SceneBuilder()
    builder.add("Cup", uid="c", parent=4)
    with pytest.raises(UniSGError, match="parent is not in the scene"):
        builder.build()


def test_world_matrices_are_computed_once_and_cannot_be_changed() -> None:
    graph = small()
    assert graph.world is world_matrices(graph)
    with pytest.raises(ValueError, match="read-only"):
        graph.world[0, 0, 3] = 1
    with pytest.raises(FrozenInstanceError):
        graph.world = EYES  # type: ignore[misc]
    shifted = EYES.copy()
    shifted[0, 0, 3] = 5
    assert graph.replace(local=shifted).world[:, 0, 3].tolist() == [5, 5, 0]
    assert graph.world[:, 0, 3].tolist() == [0, 0, 0]


def test_info_counts_what_each_entity_has() -> None:
    actions = table([1, 1], data=[ActionData("a", "Use"), ActionData("b", "Use")])
    graph = small().with_component("actions", actions)
    assert graph.info.tolist() == [[1, 1, 0, 0], [0, 1, 1, 2], [0, 1, 1, 0]]
    assert small().info[:, 3].tolist() == [0, 0, 0]


def test_entities_are_views_on_rows() -> None:
    graph = small()
    table_entity, cup = graph["Table"], graph[1]
    assert (cup.name, cup.uid, cup.type, cup.category) == ("Cup", "c", "MESH", "Cup")
    assert (cup.parent, table_entity.parent, graph[-1].name) == (table_entity, None, "Lamp")
    assert table_entity.children == table_entity.descendants == (cup,)
    assert (cup.mesh, table_entity.mesh, cup.actions) == (graph.meshes[0], None, ())
    assert (cup.component("relations")["target"].tolist(), cup.component("nothing")) == (["t"], {})
    for seen, column in ((cup.world, graph.world), (cup.info, graph.info), (cup.local, graph.local)):
        assert np.shares_memory(seen, column)  # views: nothing is computed anew
        np.testing.assert_array_equal(seen, column[1])
    with pytest.raises(KeyError, match="no entity is named 'Bottle'"):
        graph["Bottle"]


@pytest.mark.parametrize("size", [1, 2, 3, 4, 7])
def test_faces_all_alike_are_fans_like_others(size: int) -> None:
    faces = np.arange(3 * size).reshape(3, size)
    points = np.zeros((3 * size + 3, 3))
    alike, mixed = (mesh_from_faces("Faces", points, some) for some in (faces, [*faces, [0, 1, 2]]))
    fans = [(face[0], face[step], face[step + 1]) for face in faces.tolist() for step in range(1, size - 1)]
    assert alike.triangles.tolist() == [list(fan) for fan in fans]
    assert mixed.triangles.tolist() == [*alike.triangles.tolist(), [0, 1, 2]]
    assert alike.triangles.dtype == np.int32
