from __future__ import annotations

import json
from pathlib import Path

import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.scene import SceneBuilder, SceneGraph, table
from unisg_blender.words.category_mapping import apply_mapping, read_mapping, scene_label

TOML = """
[objects]
"chair*" = "Chair"
"*chair*" = "Seat"
"Scalpel.[0-9]*" = "Scalpel"

[collections]
"Instruments" = "Instrument"
"Ward *" = "Furniture"

[scenes]
"*/kitchens/*" = "kitchen"
"""


@pytest.fixture
def graph() -> SceneGraph:
    builder = SceneBuilder()
    builder.add("Armchair", uid="a")
    builder.add("Bone saw", uid="b")
    builder.add("Chair.001", uid="c", category="Throne")
    builder.add("Chair.002", uid="d")
    builder.add("Lamp", uid="e")
    builder.add("Scalpel.x", uid="f")
    scene = builder.build()
    rows = [scene.row(name) for name in ("Bone saw", "Lamp", "Armchair")]
    paths = [("Ward 3", "Instruments"), ("Ward 3", "Lights"), ("Instruments",)]
    return scene.with_component("collections", table(rows, path=paths))


@pytest.mark.parametrize("suffix", [".toml", ".json"])
def test_names_come_before_collections_and_the_first_pattern_counts(
    tmp_path: Path, graph: SceneGraph, suffix: str
) -> None:
    import tomllib

    path = tmp_path / f"mapping{suffix}"
    path.write_text(TOML if suffix == ".toml" else json.dumps(tomllib.loads(TOML)))
    mapped = apply_mapping(graph, read_mapping(path))
    found = {entity: mapped.category_name(mapped.row(entity)) for entity in graph.name}
    assert found == {
        "Armchair": "Seat",
        "Bone saw": "Instrument",
        "Chair.001": "Throne",  # what the file says itself stays
        "Chair.002": "Chair",
        "Lamp": "Furniture",
        "Scalpel.x": "",
    }
    assert mapped.vocabulary == ("Chair", "Furniture", "Instrument", "Seat", "Throne")
    assert scene_label("scans/kitchens/7.blend", read_mapping(path)) == "kitchen"
    assert scene_label("scans/kitchen.blend", read_mapping(path)) == ""


@pytest.mark.parametrize(
    "content", ["", "[objects", "{}", '{"objects": []}', '{"objects": {"a": 1}}', '{"names": {"a": "b"}}', "[1]"]
)
def test_bad_mappings_are_refused(tmp_path: Path, content: str) -> None:
    for suffix in (".json", ".toml"):
        (tmp_path / f"m{suffix}").write_text(content)
        with pytest.raises(UniSGError, match=r"mapping|must"):
            read_mapping(tmp_path / f"m{suffix}")


def test_a_missing_mapping_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UniSGError, match="cannot read the mapping"):
        read_mapping(tmp_path / "none.toml")
