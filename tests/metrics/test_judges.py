"""Judges of scenes, on scenes about which the answer is known: what stays, where one gets, what can be opened."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.metrics.hand_made import Scene, box_mesh, table_mesh
from unisg_blender.cli import main
from unisg_blender.errors import MissingPackageError
from unisg_blender.formats.scene_files import write_scene_file
from unisg_blender.metrics.judges.judged_scene import judge_scene, ratio_interval, summary
from unisg_blender.metrics.judges.navigability import navigability
from unisg_blender.metrics.judges.opening_clearance import openings
from unisg_blender.metrics.judges.stability import simulated
from unisg_blender.scene import SceneGraph
from unisg_blender.spatial.bodies import convex_pieces, rigid_bodies


def walls(scene: Scene) -> None:
    scene.box("north", (6, 0.2, 2.5), (0, 2.1, 0), category="Wall")


def stays(graph: SceneGraph) -> dict[str, bool]:
    pytest.importorskip("mujoco", reason="MuJoCo, the extra 'judge', is not installed")
    found = simulated(graph)
    return dict(zip([graph.name[row] for row in found.rows], found.stays.tolist(), strict=True))


def test_what_stands_stays_and_what_floats_falls() -> None:
    scene = Scene()
    scene.box("table", None, (0, 0, 0), mesh=table_mesh(), category="Table")
    scene.box("cup", (0.1, 0.1, 0.1), (0.2, 0.1, 0.75))
    scene.box("floating", (0.1, 0.1, 0.1), (-0.2, 0.1, 0.85))
    scene.box("tipping", (0.6, 0.1, 0.1), (0.8, 0, 0.75))
    assert stays(scene.build()) == {"table": True, "cup": True, "floating": False, "tipping": False}


def test_a_thing_in_a_bowl_lies_in_it() -> None:
    pytest.importorskip("coacd", reason="CoACD, the extra 'judge', is not installed")
    scene = Scene()
    scene.box("bowl", None, (0, 0, 0), mesh=bowl_mesh(), category="Bowl")
    scene.box("ball", (0.05, 0.05, 0.05), (0.02, 0, 0.01), category="Ball", relation=("inside", "bowl"))
    assert stays(scene.build()) == {"bowl": True, "ball": True}


def bowl_mesh():
    """A box of 20 cm without a lid, its walls and bottom 1 cm thick, as one closed surface."""
    from unisg_blender.scene import mesh_from_faces

    def ring(half: float, z: float) -> list[tuple[float, float, float]]:
        return [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]

    points = [*ring(0.1, 0), *ring(0.1, 0.1), *ring(0.09, 0.1), *ring(0.09, 0.01)]
    faces = [[3, 2, 1, 0], [12, 13, 14, 15]]
    for low, high in ((0, 4), (4, 8), (8, 12)):
        faces += [[low + k, low + (k + 1) % 4, high + (k + 1) % 4, high + k] for k in range(4)]
    return mesh_from_faces("bowl", np.array(points), faces)


def test_what_hangs_is_carried_where_it_touches() -> None:
    scene = Scene()
    walls(scene)
    scene.box("picture", (0.5, 0.03, 0.4), (0, 1.985, 1.5), category="Picture", relation=("hangs_from", "north"))
    scene.box("lost", (0.5, 0.03, 0.4), (1, 1.5, 1.5), category="Picture", relation=("hangs_from", "north"))
    scene.box("pole", (0.4, 0.4, 1.5), (-1, 0, 0), category="IV Pole")
    scene.box("bag", (0.1, 0.1, 0.2), (-1, 0.26, 1.2), category="IV Bag", relation=("hangs_from", "pole"))
    graph = scene.build()
    bodies = {body.row if body.row < 0 else graph.name[body.row]: [graph.name[row] for row in body.objects]
              for body in rigid_bodies(graph)}  # fmt: skip
    assert bodies == {-1: ["floor", "north", "picture"], "pole": ["pole", "bag"], "lost": ["lost"]}


def test_what_stands_on_what_is_fixed_moves_and_what_touches_a_wall_alone_does_not() -> None:
    scene = Scene()
    walls(scene)
    scene.box("counter", (1, 0.5, 0.9), (0, 1, 0), category="")
    scene.box("cup", (0.1, 0.1, 0.1), (0, 1, 0.9), relation=("on_top_of", "counter"))
    scene.box("pot", (0.1, 0.1, 0.1), (0.3, 1, 0.9))
    scene.box("clock", (0.3, 0.03, 0.3), (0, 1.985, 1.5))
    graph = scene.build()
    bodies = rigid_bodies(graph, fixed=[graph.row_of_uid["counter"]])
    assert {graph.name[body.row] for body in bodies[1:]} == {"cup", "pot"}
    assert "clock" in [graph.name[row] for row in bodies[0].objects]


def test_what_is_fixed_is_as_firm_as_the_building() -> None:
    scene = Scene()
    scene.box("shelf", (0.5, 0.3, 0.02), (0, 0, 1.0))
    scene.box("cup", (0.1, 0.1, 0.1), (0, 0, 1.02))
    graph = scene.build()
    pytest.importorskip("mujoco", reason="MuJoCo, the extra 'judge', is not installed")
    found = simulated(graph, fixed=[graph.row_of_uid["shelf"]])
    assert (found.rows.tolist(), found.stays.tolist()) == ([graph.row_of_uid["cup"]], [True])


def test_pieces_are_the_parts_and_flat_ones_have_a_thickness() -> None:
    assert len(convex_pieces(table_mesh())) == 5
    (sheet,) = convex_pieces(box_mesh(((1, 1, 0), (0, 0, 0))))
    assert np.ptp(sheet, axis=0) == pytest.approx([1, 1, 1e-3])


@settings(deadline=None, max_examples=20)
@given(st.floats(-2.0, 2.0))
def test_a_wall_of_things_cuts_the_floor_in_two(x: float) -> None:
    scene = Scene()
    scene.box("row", (0.4, 4, 1), (x, 0, 0))
    left, right = x - 0.2 - 0.1 + 2.9, 2.9 - (x + 0.2 + 0.1)
    assert navigability(scene.build()) == pytest.approx(max(left, right) / (left + right), abs=0.02)


def test_a_gap_is_passed_by_who_is_narrow_enough_and_rugs_if_asked() -> None:
    scene = Scene()
    scene.box("row", (0.4, 3.5, 1), (0, -0.25, 0))
    assert navigability(scene.build()) == pytest.approx(1.0)
    assert navigability(scene.build(), width=0.6) == pytest.approx(0.5, abs=0.02)
    scene.box("rug", (0.4, 0.5, 0.02), (0, 1.75, 0), category="Rug")
    assert navigability(scene.build()) == pytest.approx(0.5, abs=0.02)
    assert navigability(scene.build(), step=0.12) == pytest.approx(1.0)


def test_what_is_before_a_door_is_told() -> None:
    scene = Scene()
    walls(scene)
    scene.box("door", (1.0, 0.1, 2.0), (0, 2.1, 0), category="Door", relation=("inside", "north"))
    scene.box("free", (0.5, 0.5, 0.5), (0.8, 1.5, 0))
    (side,) = openings(scene.build())
    assert (side.kind, side.before) == ("Door", ())
    scene.box("crate", (0.5, 0.5, 0.5), (0, 1.3, 0))
    graph = scene.build()
    (side,) = openings(graph)
    assert [graph.name[row] for row in side.before] == ["crate"]


def test_many_scenes_have_shares_and_intervals() -> None:
    scene = Scene()
    scene.box("row", (0.4, 4, 1), (0, 0, 0))
    open_floor = Scene().build()
    row = summary([judge_scene(each, ("navigability",)) for each in (scene.build(), open_floor)])
    assert row["navigability"] == pytest.approx(0.75, abs=0.01)
    assert (row["parted"], row["stable"], row["doors_clear"]) == (1, None, None)
    low, high = ratio_interval(np.array([[1, 2], [2, 2], [2, 2]]))
    assert 0.5 <= low <= 5 / 6 <= high <= 1.0


def test_the_command_line_asks_judges(tmp_path, capsys) -> None:
    scene = Scene()
    scene.box("row", (0.4, 4, 1), (0, 0, 0))
    write_scene_file(scene.build(), tmp_path / "room.json")
    words = ["evaluate", str(tmp_path / "room.json"), "--judge", "navigability,openings", "-q"]
    assert main([*words, "--json", "--out", str(tmp_path / "out")]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["summary"]["scenes"] == 1
    assert said["scenes"][0]["navigability"] == pytest.approx(0.5, abs=0.02)
    assert json.loads((tmp_path / "out" / "judged.json").read_text("utf8"))["summary"] == said["summary"]
    for wrong, told in (
        (["evaluate", str(tmp_path / "room.json"), "--judge", "beauty"], "there is no judge 'beauty'"),
        ([*words, "--data", "x"], "leave --data out"),
        (["evaluate", str(tmp_path / "none"), "--judge", "all"], "none"),
        (["evaluate", str(tmp_path / "room.json")], "give --data"),
    ):
        assert main(wrong) == 1
        assert told in capsys.readouterr().err


def test_without_the_simulator_one_line_says_what_to_install(monkeypatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingPackageError, match=r"unisg-blender\[judge\]"):
        simulated(Scene().build())


def test_an_empty_room_has_nothing_to_judge() -> None:
    judged = judge_scene(Scene().build(), ("navigability", "openings"))
    assert (judged.things, judged.free, judged.navigability, judged.doors) == (0, None, 1.0, 0)
