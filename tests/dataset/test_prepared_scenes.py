"""What a reading process makes of scenes before they are encoded, as the request says; what is left out is told."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.dataset.conftest import box
from unisg_blender.dataset.export.reader_process import _prepared
from unisg_blender.scene import SceneBuilder, SceneGraph, Table
from unisg_blender.words import read_mapping

PLAIN: dict[str, Any] = {"mapping": None, "instances": "keep", "understand": None}


def hall() -> SceneGraph:
    """A ground, and an empty that shows a chair twice."""
    chair = SceneBuilder("chair")
    chair.add("Chair 1", uid="c", mesh=box("chair", (0.4, 0.4, 0.9)))
    builder = SceneBuilder("hall")
    builder.add("Ground", uid="g", mesh=box("ground", (6.0, 5.0, 0.1)))
    builder.add("Chairs", uid="e")
    graph, prototype = builder.build(), chair.build()
    places = np.tile(np.eye(4), (2, 1, 1))
    places[1, :3, 3] = 2, 0, 0
    rows = np.full(2, graph.row("Chairs"), np.int32)
    shown = np.empty(2, object)
    shown[:] = [prototype, prototype]
    source = np.array(["COLLECTION"] * 2, object)
    table = Table(rows, {"prototype": shown, "matrix": places, "source": source})
    return graph.replace(components={**graph.components, "instances": table})


def test_instances_become_objects_only_where_that_is_asked_for() -> None:
    (kept,), notes = _prepared([hall()], PLAIN)
    assert len(kept) == 2
    assert any("instances" in note for note in notes)
    (realized,), notes = _prepared([hall()], PLAIN | {"instances": "realize"})
    assert sum(realized.mesh >= 0) == 3
    assert not any("instances" in note for note in notes)


def test_names_give_categories_where_a_mapping_or_understanding_is_asked_for(tmp_path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "names.toml").write_text('[objects]\n"Ground" = "Floor"\n')
    mapping = read_mapping(tmp_path / "names.toml")
    (mapped,), _ = _prepared([hall()], PLAIN | {"mapping": mapping})
    assert [mapped.category_name(row) for row in range(2)].count("Floor") == 1
    (plain,), _ = _prepared([hall()], PLAIN)
    assert not any(plain.category_name(row) for row in range(2))
    asked = PLAIN | {"instances": "realize", "understand": ["Chair", "Floor"]}
    (told,), _ = _prepared([hall()], asked)
    assert "Chair" in {told.category_name(row) for row in range(len(told))}
