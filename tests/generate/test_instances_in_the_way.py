"""What instances show is in the way, holds things and makes rooms, and stays an instance."""

from __future__ import annotations

import numpy as np
import pytest

from tests.spatial.built_rooms import SQUARE, box, mesh, room
from unisg_blender.generate import Generator
from unisg_blender.generate.check.settled_scene import settle_rows
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.scene import table as table_of
from unisg_blender.scene.components import INSTANCES
from unisg_blender.spatial.part_boxes import part_boxes


@pytest.fixture(scope="module")
def generator() -> Generator:
    return Generator.load(find_generator("living_room"))


def shown_by_instances(instanced: dict, objects: dict) -> SceneGraph:
    """Some objects as they are, others each as an instance of a scenegraph that an empty has."""
    builder = SceneBuilder("Built")
    for name, part in objects.items():
        builder.add(name, uid=name, mesh=mesh(part))
    for name in instanced:
        builder.add(name, uid=name)
    graph = builder.build()
    prototypes = []
    for name, part in instanced.items():
        inner = SceneBuilder(f"{name} collection")
        inner.add(f"{name} mesh", uid=f"{name} mesh", mesh=mesh(part))
        prototypes.append(inner.build())
    column = np.empty(len(prototypes), object)
    column[:] = prototypes
    rows = [graph.row_of_uid[name] for name in instanced]
    matrices = np.tile(np.eye(4), (len(rows), 1, 1))
    return graph.with_component(
        INSTANCES, table_of(rows, prototype=column, matrix=matrices, source=["COLLECTION"] * len(rows))
    )


def test_a_lamp_that_is_an_instance_is_an_obstacle(generator: Generator) -> None:
    """All of the room but a strip is taken up by instances: what is placed stands in that strip."""
    graph = shown_by_instances({"block": box((0, 0, 0), (3.4, 4, 2))}, room(SQUARE, 0.1))
    made = generator.add(graph, {"Chair": 2, "Plant": 1}, 1, behaviour=False)
    assert made.added >= 2
    boxes = part_boxes(made.scene)
    new = np.isin(boxes.owner, made.rows)
    assert (boxes.boxes.center[new, 0] > 3.4).all()
    assert set(graph.uid) <= set(made.scene.uid)
    assert len(made.scene) == len(graph) + len(made.rows)
    held = made.scene.components[INSTANCES]
    assert [made.scene.uid[row] for row in held.rows] == ["block"]


def test_a_room_of_instances_is_a_room(generator: Generator) -> None:
    walls = room(SQUARE, 0.1)
    graph = shown_by_instances(walls, {"crate": box((1, 1, 0), (1.4, 1.4, 0.4))})
    assert generator.read(graph).has_room
    made = generator.add(graph, {"Floor": 1, "Chair": 1}, 2, behaviour=False)
    assert [item.note for item in made.refused] == ["there is a room already"]
    (chair,) = (item for item in made.objects if not item.refused)
    assert chair.world is not None
    assert chair.world[2, 3] == pytest.approx(0, abs=0.02)


def test_what_settles_on_an_instance_rests_on_it() -> None:
    objects = room(SQUARE, 0.1) | {"pot": box((2, 2, 1.5), (2.2, 2.2, 1.7))}
    graph = shown_by_instances({"table": box((1.5, 1.5, 0), (2.5, 2.5, 0.7))}, objects)
    (item,) = settle_rows(graph, [graph.row_of_uid["pot"]])
    assert not item.note
    assert graph.uid[item.row] == "pot"
    assert item.world[2, 3] == pytest.approx(-0.8, abs=1e-3)
