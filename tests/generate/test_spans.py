"""What reaches from wall to wall: learned from scenes, and held by a wall from which it does."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from tests.generate.rooms import at, box
from unisg_blender.dataset.assets.asset import shell_of
from unisg_blender.dataset.assets.asset_file import save_assets
from unisg_blender.generate.observe.contract import Contract
from unisg_blender.generate.observe.observed_scene import ObservedScene
from unisg_blender.generate.observe.placeable import Placeable, box_placeable
from unisg_blender.generate.observe.prior_tables import PriorTables
from unisg_blender.generate.observe.support_priors import learn_priors
from unisg_blender.generate.place.room_shell import add_shell
from unisg_blender.generate.place.scene_extension import Names, uid_maker
from unisg_blender.generate.place.shape_library import Library
from unisg_blender.generate.place.spanning_objects import fit_for, reached
from unisg_blender.generate.propose.trained_model import TrainedModel, assets_path
from unisg_blender.geometry.planar import turn
from unisg_blender.scene import Relation, SceneBuilder, SceneGraph, world_matrices
from unisg_blender.spatial.objects import scene_objects

VOCABULARY = ("Clock", "Floor", "Girder", "Wall")
WIDE, DEEP = 6.0, 8.0


def hall(yaw: float = 0.0, girder: bool = True, wide: float = WIDE, deep: float = DEEP) -> SceneGraph:
    """A room of 6 x 8 m: a girder high up along x, held by a wall at its end, and a clock on the same wall."""
    builder = SceneBuilder("Hall")
    floor = builder.add(
        "Floor", uid="floor", local=turn(yaw) @ at(0, 0, -0.1), mesh=box("Floor", wide, deep, 0.1), category="Floor"
    )
    for side in range(4):
        reach, length = (deep, wide) if side % 2 == 0 else (wide, deep)
        local = turn(side * np.pi / 2) @ at(0, reach / 2 + 0.05, 0.1)
        wall = builder.add(
            f"Wall.{side}", uid=f"wall{side}", parent=floor, local=local, mesh=box("Wall", length, 0.1, 3.0),
            category="Wall",
        )  # fmt: skip
        if side == 1:
            held = (Relation("hangs_from", "wall1"),)
            clock = at(0.5, -0.05 - 0.05, 1.8)
            builder.add("Clock", uid="clock", parent=wall, local=clock, mesh=box("Clock", 0.3, 0.1, 0.3),
                        category="Clock", relations=held)  # fmt: skip
            if girder:
                local = at(-1.0, -0.05 - wide / 2, 2.9, np.pi / 2)
                builder.add("Girder", uid="girder", parent=wall, local=local, mesh=box("Girder", wide, 0.1, 0.08),
                            category="Girder", relations=held)  # fmt: skip
    return builder.build()


def test_what_touches_two_walls_spans_and_what_hangs_on_one_does_not() -> None:
    assert learn_priors([scene_objects(hall(yaw), VOCABULARY) for yaw in (0.0, 0.7)], VOCABULARY).spanning == ["Girder"]


@pytest.mark.parametrize("yaw", [0.0, 0.4, -2.0])
@pytest.mark.parametrize(
    ("half", "held_by"),
    [
        ([WIDE / 2, 0.05, 0.04], {1, 3}),
        ([0.05, WIDE / 2, 0.04], {1, 3}),  # whichever side is its longer one
        ([DEEP / 2, 0.05, 0.04], {0, 2}),
        ([1.0, 0.05, 0.04], set()),
    ],
)
def test_holders_are_those_from_which_it_reaches_across(yaw: float, half: list[float], held_by: set[int]) -> None:
    graph = hall(yaw, girder=False)
    objects = scene_objects(graph, VOCABULARY)
    scene = ObservedScene.of(objects, world_matrices(graph)[objects.row])
    found = reached(scene, objects.category == VOCABULARY.index("Wall"), np.array(half))
    assert {graph.name[row] for row in objects.row[found]} == {f"Wall.{side}" for side in held_by}


def test_what_reaches_across_from_nowhere_may_be_held_by_any() -> None:
    graph = hall(girder=False)
    objects = scene_objects(graph, VOCABULARY)
    scene, walls = (
        ObservedScene.of(objects, world_matrices(graph)[objects.row]),
        objects.category == VOCABULARY.index("Wall"),
    )
    tables = PriorTables.of(learn_priors([scene_objects(hall(), VOCABULARY)], VOCABULARY), VOCABULARY)
    clock, girder = VOCABULARY.index("Clock"), VOCABULARY.index("Girder")
    assert fit_for(girder, np.array([1.0, 0.05, 0.04]), scene, walls, tables).sum() == 4
    assert fit_for(girder, np.array([WIDE / 2, 0.05, 0.04]), scene, walls, tables).sum() == 2
    assert fit_for(clock, np.array([WIDE / 2, 0.05, 0.04]), scene, walls, tables).sum() == 4


def library_of(folder: Path, lengths: Sequence[float], shells: Sequence[SceneGraph] = ()) -> Library:
    """Girders of some lengths, metres, and rooms."""
    girders = [box_placeable("Girder", np.array([length, 0.1, 0.08])).asset for length in lengths]
    save_assets(assets_path(folder / "girders.onnx"), girders + [shell for shell in map(shell_of, shells) if shell])
    priors = learn_priors([scene_objects(hall(), VOCABULARY)], VOCABULARY)
    return Library(TrainedModel(folder / "girders.onnx", Contract("anchors", VOCABULARY, priors)))


def test_of_several_shapes_one_that_fits_is_drawn(tmp_path: Path) -> None:
    lengths = (4.0, WIDE, 9.0)
    library, empty = library_of(tmp_path, lengths), hall(girder=False)

    def drawn(fits: Callable[[Placeable], bool] | None) -> set[float]:
        """The lengths of twenty shapes, metres."""
        rng = np.random.default_rng(0)
        return {
            round(2 * float(library.placeable(VOCABULARY.index("Girder"), empty, rng, fits).half.max()), 3)
            for _ in range(20)
        }

    assert drawn(None) == set(lengths)
    assert drawn(lambda placeable: abs(2 * placeable.half[0] - WIDE) < 0.1) == {WIDE}
    assert drawn(lambda placeable: False) == set(lengths)


@pytest.mark.parametrize(("length", "wide"), [(WIDE, {WIDE}), (WIDE + 1, {WIDE + 1}), (1.0, {WIDE, WIDE + 1})])
def test_a_new_room_is_one_that_a_shape_reaches_across(tmp_path: Path, length: float, wide: set[float]) -> None:
    halls = [hall(girder=False, wide=size, deep=9.5) for size in (WIDE, WIDE + 1)]
    library, nothing = library_of(tmp_path, [length], halls), SceneBuilder("Nothing").build()
    found = set()
    for seed in range(12):
        rng, counts = np.random.default_rng(seed), {"Floor": 1, "Wall": 4, "Girder": 1}
        made, _ = add_shell(nothing, counts, library, rng, Names(()), uid_maker(nothing, seed))
        found.add(round(float(np.ptp(made.meshes[made.mesh[made.row("Floor")]].points[:, 0])), 3))
    assert found == wide
