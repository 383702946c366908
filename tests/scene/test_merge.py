"""One scenegraph out of several."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.scene import ActionData, Material, Mesh, SceneBuilder, SceneGraph, append, mesh_from_faces, table

RED, BLUE = Material("Paint", (1, 0, 0, 1)), Material("Paint", (0, 0, 1, 1))


def quad(*materials: str) -> Mesh:
    """A mesh with material slots."""
    plain = mesh_from_faces("Quad", np.eye(4, 3), [[0, 1, 2, 3]])
    return Mesh(plain.name, plain.points, plain.corners, plain.offsets, materials=materials)


def single(name: str, material: Material | None = None, mesh: Mesh | None = None, category: str = "") -> SceneGraph:
    """A scene of one entity; its uid is its name in lower case."""
    builder = SceneBuilder(materials={} if material is None else {material.name: material})
    builder.add(name, uid=name.lower(), mesh=mesh, category=category, actions=(ActionData(f"use {name}", "Use"),))
    return builder.build()


def test_parts_hang_under_what_they_are_said_to_hang_under() -> None:
    base, cup, spoon, lamp = (single(name, category=name) for name in ("Table", "Cup", "Spoon", "Lamp"))
    whole = append(base, [spoon, cup, lamp], ["cup", "table", ""])
    assert whole.name == ("Lamp", "Table", "Cup", "Spoon")
    assert whole.parent.tolist() == [-1, -1, 1, 2]
    assert [whole.category_name(row) for row in range(4)] == ["Lamp", "Table", "Cup", "Spoon"]
    assert [entity.uid for entity in whole["Table"].descendants] == ["cup", "spoon"]
    actions = whole.components["actions"]
    assert [(int(row), each.uid) for row, each in zip(actions.rows, actions.columns["data"], strict=True)] == [
        (0, "use Lamp"), (1, "use Table"), (2, "use Cup"), (3, "use Spoon")
    ]  # fmt: skip
    assert append(base, []) is base
    assert append(base, [cup]).parent.tolist() == [-1, -1]


def test_meshes_are_stored_once_and_other_materials_of_one_name_get_new_names() -> None:
    shared = quad("Paint")
    whole = append(
        single("A", RED, shared), [single("B", RED, shared), single("C", BLUE, quad("Paint")), single("D", BLUE)]
    )
    assert len(whole.meshes) == 2
    assert whole["A"].mesh is whole["B"].mesh is shared
    assert set(whole.materials) == {"Paint", "Paint.001"}
    assert whole["C"].mesh is not None
    assert whole.materials[whole["C"].mesh.materials[0]].base_color == BLUE.base_color


def test_tables_with_other_columns_are_left_out() -> None:
    base = single("A").with_component("size", table([0], width=[1]))
    whole = append(base, [single("B").with_component("size", table([0], height=[2])), single("C")])
    assert whole.components["size"].rows.tolist() == [0]
    assert list(whole.components["size"].columns) == ["width"]


def test_uids_that_are_given_twice_and_unknown_ones_are_refused() -> None:
    with pytest.raises(UniSGError, match="'a' more than once"):
        append(single("A"), [single("A")])
    with pytest.raises(KeyError):
        append(single("A"), [single("B")], ["z"])
    with pytest.raises(UniSGError, match="cycle"):
        append(single("A"), [single("B"), single("C")], ["c", "b"])
