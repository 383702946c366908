"""What is building is told by where it is, whatever it is called and however it looks."""

from __future__ import annotations

from tests.spatial.built_rooms import DOOR, SQUARE, joined, mesh, room, scene, table
from unisg_blender.predict.category_proposals import propose_categories
from unisg_blender.scene import SceneBuilder


def best(graph, **options) -> dict[str, str]:
    return {found.name: found.best for found in propose_categories(graph, **options)}


def test_a_floor_plane_and_walls_by_hand() -> None:
    parts = room(SQUARE, 0.0, roof=True, holes=(DOOR,))
    builder = SceneBuilder("Built")
    words = {"ground": "Plane", "top": "Plane.001"}
    for number, (name, part) in enumerate(parts.items()):
        builder.add(words.get(name, f"Cube.{number:03d}"), uid=name, mesh=mesh(part))
    builder.add("Thing", uid="Thing", mesh=mesh(table(2.0, 2.0, 0.0)))
    graph = builder.build()
    found = best(graph)
    assert found["Plane"] == "Floor"
    assert found["Plane.001"] == "Ceiling"
    assert [kind for name, kind in found.items() if name.startswith("Cube")] == ["Wall"] * 4
    assert found["Thing"] not in ("Floor", "Wall", "Ceiling")
    walls = [name for name in found if name.startswith("Cube")]
    by_shape = best(graph, use=("shape",))
    assert any(by_shape[name] != "Wall" for name in walls)  # which the shape alone does not tell


def test_chances_sum_up_and_the_best_few_are_named() -> None:
    graph = scene(room(SQUARE, 0.1))
    for count in (1, 3):
        for found in propose_categories(graph, best=count):
            assert len(found.categories) == count
            assert len({name for name, _ in found.categories}) == count
            assert sum(chance for _, chance in found.categories) <= 1 + 1e-9


def test_a_house_of_one_mesh_is_judged_as_before() -> None:
    graph = scene({"house": joined(list(room(SQUARE, 0.1, roof=True).values()))})
    assert propose_categories(graph) == propose_categories(graph, use=("shape", "name", "neighbours"))
