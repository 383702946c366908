"""Numbers of meshes, categories and relations mean nothing: what is first of them counts like every other."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

with contextlib.suppress(ImportError):
    import bpy  # noqa: F401

from tests.generate.rooms import room
from unisg_blender.dataset import open_dataset, to_scenegraph, write_dataset
from unisg_blender.dataset.assets.asset_collector import AssetCollector
from unisg_blender.dataset.scenes_with_shapes import scenes_with_shapes
from unisg_blender.generate.behaviour.action_kinds import Kind
from unisg_blender.generate.behaviour.new_actions import make_action
from unisg_blender.generate.check.scene_check import check_scene
from unisg_blender.generate.observe.support_priors import learn_priors
from unisg_blender.metrics.layout_distances import layout_of
from unisg_blender.metrics.layout_features import scene_features
from unisg_blender.metrics.scene_validity import measure_scene
from unisg_blender.predict.things_as_one import things_as_one
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.spatial import find_relations
from unisg_blender.spatial.floor_plan import room_outline
from unisg_blender.spatial.objects import scene_objects
from unisg_blender.spatial.part_boxes import part_boxes
from unisg_blender.spatial.structure.recognise import look_alike, recognise_structure
from unisg_blender.worlds import living_room, operating_room

SCENES = {"small": room(1), "living room": living_room(4), "operating room": operating_room(2)}


def renumbered(graph: SceneGraph, shift: int) -> SceneGraph:
    """The same scene, its meshes and its categories in another order."""
    meshes, names = len(graph.meshes), len(graph.vocabulary)
    mesh_order, name_order = np.roll(np.arange(meshes), shift), np.roll(np.arange(names), shift)
    number = np.append(np.argsort(mesh_order), -1)
    kind = np.append(np.argsort(name_order), -1)
    return graph.replace(
        meshes=tuple(graph.meshes[k] for k in mesh_order), mesh=number[graph.mesh].astype(graph.mesh.dtype),
        vocabulary=tuple(graph.vocabulary[k] for k in name_order),
        category=kind[graph.category].astype(graph.category.dtype),
    )  # fmt: skip


def uncategorised(graph: SceneGraph) -> SceneGraph:
    return graph.replace(vocabulary=(), category=graph.category * 0 - 1)


def shapes(graph: SceneGraph) -> list[Any]:
    """By entity: category, and the places of its mesh's points."""
    found = []
    for row in range(len(graph)):
        points = graph.meshes[graph.mesh[row]].points @ graph.world[row, :3, :3].T if graph.mesh[row] >= 0 else None
        found.append(
            (graph.name[row], graph.category_name(row), None if points is None else np.round(points, 4).tolist())
        )
    return found


def objects(graph: SceneGraph) -> list[Any]:
    known = sorted(graph.vocabulary)
    found = scene_objects(graph, known)
    arrays = [
        found.row,
        found.category,
        found.support,
        found.center,
        found.half,
        found.yaw,
        found.owner,
        found.parts.center,
    ]
    return [np.round(each, 6).tolist() for each in arrays]


def assets(graph: SceneGraph) -> list[Any]:
    collector = AssetCollector()
    collector.add(graph, "here")
    _, index = collector.pack()
    keyed = [(record["category"], record["faces"]) for record in index["assets"]]
    return [sorted(keyed), sorted(collector.parts), sorted(collector.outlines), len(collector.shells)]


def priors(graph: SceneGraph) -> Any:
    known = sorted(graph.vocabulary)
    found = learn_priors([scene_objects(graph, known)], known)
    return [found.supports, found.sizes if hasattr(found, "sizes") else None, found.overlaps]


def validity(graph: SceneGraph) -> list[Any]:
    report = measure_scene(graph)
    return [np.asarray(getattr(report, name)).tolist() for name in ("counted", "colliding", "off_support", "outside")]


def structure(graph: SceneGraph) -> list[Any]:
    found = recognise_structure(graph)
    parts = {row: kinds for row, kinds in found.parts.items()}
    return [[round(each.area, 4) for each in found.rooms], parts, len(found.surfaces), found.notes]


FUNCTIONS: dict[str, Callable[[SceneGraph], Any]] = {
    "relations": lambda graph: sorted(find_relations(graph)),
    "objects": objects,
    "outline": lambda graph: room_outline(graph).tolist(),
    "parts": lambda graph: [part_boxes(graph).of(row).center.round(6).tolist() for row in range(len(graph))],
    "validity": validity,
    "check": lambda graph: check_scene(graph).summary,
    "layout": lambda graph: np.sort(layout_of(graph, tuple(sorted(graph.vocabulary))), axis=0).tolist(),
    "features": lambda graph: scene_features(
        graph, tuple(sorted(graph.vocabulary)), np.random.default_rng(0)
    ).scene.tolist(),
    "assets": assets,
    "priors": priors,
    "structure": structure,
    "as one": lambda graph: shapes(things_as_one(uncategorised(graph))),
}


@pytest.mark.parametrize("scene", ["small", "living room", pytest.param("operating room", marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_numbers_mean_nothing(name: str, scene: str) -> None:
    graph, function = SCENES[scene], FUNCTIONS[name]
    expected = function(graph)
    for shift in (1, 3):
        assert function(renumbered(graph, shift)) == expected


@pytest.mark.parametrize("scene", SCENES)
def test_scenes_look_alike_by_what_has_a_category_not_by_its_number(scene: str) -> None:
    graph = SCENES[scene]
    renamed = graph.replace(vocabulary=tuple(f"{name}?" for name in graph.vocabulary))
    assert look_alike(graph, graph.replace(title="another"))
    assert not look_alike(graph, renamed)  # what was building is none
    first = graph.category == int(np.flatnonzero(np.bincount(graph.category[graph.category >= 0]))[0])
    bare = graph.replace(category=np.where(first, -1, graph.category).astype(graph.category.dtype))
    assert not look_alike(graph, bare)
    assert not look_alike(bare, graph)


@pytest.mark.parametrize("scene", SCENES)
def test_datasets_bring_back_what_went_in_whatever_its_numbers(scene: str, tmp_path: Path) -> None:
    graph = SCENES[scene]
    for shift in range(3):
        write_dataset([renumbered(graph, shift)], tmp_path / str(shift))
        dataset = open_dataset(tmp_path / str(shift))
        (again,) = map(to_scenegraph, dataset)
        assert [again.category_name(row) for row in range(len(again))] == [
            graph.category_name(row) for row in range(len(graph))
        ]
        np.testing.assert_allclose(again.world, graph.world, atol=1e-5)
        (shaped,) = scenes_with_shapes(dataset)
        for row in range(len(graph)):
            assert (shaped.mesh[row] >= 0) == (graph.mesh[row] >= 0)
            if graph.mesh[row] >= 0:
                own = graph.meshes[graph.mesh[row]]
                np.testing.assert_allclose(shaped.meshes[shaped.mesh[row]].bounds, own.bounds, atol=1e-5)


def test_the_first_row_takes_part_like_every_other() -> None:
    """A lesson, a relation, a role may be of the first entity of a scene, whose number is 0."""
    kind = Kind(
        "Use", "Use {target}", "", "", ({"Table": 1}, {"Cup": 1}, {"Lamp": 1}), {}, 1.0, 1, 0.0, {"distance": 0.2}
    )
    builder = SceneBuilder("three")
    for name in ("Alpha", "Beta", "Gamma"):
        builder.add(name, uid=name.lower(), mesh=SCENES["small"].meshes[0])
    graph = builder.build()
    for slots in itertools.permutations(range(3)):
        action = make_action(kind, graph, slots, "new")
        assert action is not None
        names = [graph.uid[row] for row in slots]
        assert [*action.targets, *action.tools, action.frame] == names
        assert dict(action.names) == {uid: uid.title() for uid in names}
        assert action.name == f"Use {names[0].title()}"
    nobody = make_action(kind, graph, (0, -1, -1), "new")
    assert nobody is not None
    assert (nobody.targets, nobody.tools, nobody.frame) == (("alpha",), (), "")
    assert dict(nobody.names) == {"alpha": "Alpha"}


@pytest.mark.parametrize("first", [True, False])
def test_the_outlines_of_floors_are_kept_whichever_mesh_is_theirs(first: bool) -> None:
    graph = SCENES["living room"]
    floor = next(row for row in range(len(graph)) if graph.category_name(row) == "Floor")
    shifted = renumbered(graph, -int(graph.mesh[floor]) + (0 if first else 1))
    assert (shifted.mesh[floor] == 0) == first
    collector = AssetCollector()
    for _ in range(2):
        collector.add(shifted, "here")
    assert list(collector.outlines) == [graph.meshes[graph.mesh[floor]].checksum]
