"""What stands in a scene by itself is a component for other tools, its parts are none; the scene is an assembly."""

from __future__ import annotations

from pathlib import Path

from tests.generate.rooms import room
from unisg_blender.scene import SceneBuilder
from unisg_blender.usd import write_usd


def kinds(path: Path) -> dict[str, str]:
    from pxr import Usd

    stage = Usd.Stage.Open(str(path))
    return {str(prim.GetPath()): prim.GetMetadata("kind") or "" for prim in stage.Traverse()}


def test_roots_are_components_and_nothing_else(tmp_path: Path) -> None:
    builder = SceneBuilder("two")
    above = builder.add("Table", uid="t")
    builder.add("Cup", uid="c", parent=above)
    builder.add("Lamp", uid="l")
    write_usd(builder.build(), tmp_path / "two.usda")
    found = kinds(tmp_path / "two.usda")
    ends = {path.rsplit("/", 1)[-1]: (path, kind) for path, kind in found.items()}
    assert ends["Table"][1] == ends["Lamp"][1] == "component"
    assert ends["Cup"][1] == ""
    scene = ends["Table"][0].rsplit("/", 1)[0]
    assert found[scene] in ("assembly", "group")


def test_a_component_has_no_component_below_it(tmp_path: Path) -> None:
    write_usd(room(0), tmp_path / "room.usda")
    found = kinds(tmp_path / "room.usda")
    components = [path for path, kind in found.items() if kind == "component"]
    assert components
    assert not any(other.startswith(f"{path}/") for path in components for other in components)
