"""``generate`` says how foreign a scene is before it adds anything, and ``--mapping`` changes what words mean."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from tests.words.foreign_scenes import kitchen
from unisg_blender.formats import write_scene_file

Run = Callable[..., tuple[str, str]]


def test_the_command_line_tells_it_first(tmp_path: Path, run: Run) -> None:
    write_scene_file(kitchen(), tmp_path / "k.json")
    words = ("generate", "--model", "living_room", "--scene", tmp_path / "k.json", "--out", tmp_path / "o.json")
    told = run(*words, "--add", "Plate=1", "--seed", 1)[0].splitlines()
    assert told[0] == "2 of 6 things in the scene are known to the model; it looks like a kitchen"
    assert "Table -> Dining Table; it may be Coffee Table or Side Table" in told[1]
    assert "Refrigerator" in told[2]
    (tmp_path / "m.toml").write_text('[words]\nTable = "Coffee Table"\n')
    record = json.loads(run(*words, "--add", "Plate=1", "--seed", 1, "--json", "--mapping", tmp_path / "m.toml")[0])
    assert {"uid": "Table", "said": "Table", "category": "Coffee Table", "how": "mapped"} in record["scene"][
        "understood"
    ]
    assert "looks like a kitchen" in run(*words, status=1)[1]


def test_inspect_lists_what_a_model_understands(tmp_path: Path, run: Run) -> None:
    write_scene_file(kitchen(), tmp_path / "k.json")
    lines = run("inspect", tmp_path / "k.json", "--words", "living_room")[0].splitlines()
    assert lines[0].startswith("2 of 6 things")
    assert "Stuhl_03 -> Chair" in lines
    assert "Refrigerator: not known" in lines
    record = json.loads(run("inspect", tmp_path / "k.json", "--words", "living_room", "--json")[0])
    assert (record["things"], record["known"], record["kind"]) == (6, 2, "kitchen")
