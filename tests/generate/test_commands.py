"""The verbs ``generate`` and ``evaluate``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.generate.counts import parse_counts

pytestmark = pytest.mark.slow


def test_a_room_is_written_as_json(model_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "room.json"
    words = ["generate", "--model", str(model_file), "--add", "Floor=1,Wall=4,Table", "--out", str(out), "--seed", "1"]
    assert main([*words, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["added"], report["refused"]) == (6, 0)
    entities = json.loads(out.read_text())["entities"]
    assert [entity["category"] for entity in entities].count("Wall") == 4
    assert {entity["name"] for entity in entities} == {item["name"] for item in report["objects"]}


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--add", "Cpu=1"], "did you mean 'Cup'"),
        (["--add", "Cup=many"], "must look like"),
        (["--add", "Cup=1", "--scene", "missing.blend"], "there is no such file"),
    ],
)
def test_bad_input_writes_nothing(
    model_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], text: str
) -> None:
    out = tmp_path / "room.json"
    assert main(["generate", "--model", str(model_file), "--out", str(out), *words]) == 1
    assert text in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_unknown_endings_and_folders_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", "--out", str(tmp_path / "room.doc")]) == 1
    assert main(["generate", "--out", str(tmp_path / "missing" / "room.json")]) == 1
    assert capsys.readouterr().err.count("\n") == 2


def test_the_table_has_the_model_beside_real_rooms_and_baselines(
    model_file: Path, dataset_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("torch")  # the judges that tell rooms apart are trained
    words = ["evaluate", str(model_file), "--data", str(dataset_folder), "--training", str(dataset_folder)]
    assert main([*words, "--scenes", "3", "--quick", "--jobs", "1", "--json", "-q"]) == 0
    rows = {row["name"]: row["values"] for row in json.loads(capsys.readouterr().out)["rows"]}
    real = rows["real rooms"]
    assert real["colliding"] == real["off_support"] == real["outside"] == 0
    assert real["diversity"] == 1
    assert rows["model, settled"]["colliding"] == 0
    assert 0 <= rows["model, settled"]["behaviour"] <= 1
    assert all("behaviour" not in values for name, values in rows.items() if name != "model, settled")
    assert rows["category mean, raw"]["overlapping"] > 0
    assert rows["nearest training room copied"]["refused"] == 0


def test_counts_are_read_from_words() -> None:
    assert parse_counts("Room 101=1, Box2, 3D Printer") == {"Room 101": 1, "Box2": 1, "3D Printer": 1}
    assert parse_counts("Scalpel=2, IV Pole, Monitor=1") == {"Scalpel": 2, "IV Pole": 1, "Monitor": 1}
    for text in ("", "=2", "Cup=", "Cup=1.5", "Cup=-1", "Cup=1,,Table", "Cup:2", "Cup 2", "2 Cup", "Cup x2", "Cup * 2"):
        with pytest.raises(UniSGError):
            parse_counts(text)
