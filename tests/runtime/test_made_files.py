"""Only what was made here is replaced or removed; a marker says what was."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from unisg_blender import __version__
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.formats import write_scene_file
from unisg_blender.runtime.made_files import MARKER, check_made, filling, made_in, mark_made, own_folder
from unisg_blender.worlds import cubes


def contents(folder: Path) -> dict[str, str]:
    """The visible files of a folder."""
    found = (path for path in folder.rglob("*") if path.is_file() and path.name != MARKER)
    return {path.relative_to(folder).as_posix(): path.read_text() for path in found}


def fill(folder: Path, text: str) -> None:
    """Results as a verb writes them."""
    with filling(folder) as draft:
        (draft / "table.csv").write_text(text)
        (draft / "rooms").mkdir()
        (draft / "rooms" / text).write_text(text)


def fail_halfway(folder: Path) -> None:
    """Work that ends with a part of it done."""
    (folder / "table.csv").write_text("half")
    raise RuntimeError


def test_a_folder_is_filled_at_once_and_keeps_what_is_not_ours(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with pytest.raises(RuntimeError), filling(out) as draft:
        fail_halfway(draft)
    assert not out.exists()
    fill(out, "old")
    (out / "mine").write_text("mine")
    fill(out, "new")
    assert contents(out) == {"mine": "mine", "table.csv": "new", "rooms/new": "new"}


@pytest.mark.parametrize("theirs", ["table.csv", "rooms/thesis"])
def test_what_was_there_before_is_not_replaced(tmp_path: Path, theirs: str) -> None:
    (tmp_path / theirs).parent.mkdir(exist_ok=True)
    (tmp_path / theirs).write_text("years of work")
    with pytest.raises(UniSGError, match="not made by unisg"):
        fill(tmp_path, "new")
    assert contents(tmp_path) == {theirs: "years of work"}


def test_the_marker_has_name_and_version_and_all_that_was_made(tmp_path: Path) -> None:
    mark_made(tmp_path, ["b"])
    mark_made(tmp_path, ["a"])
    assert json.loads((tmp_path / MARKER).read_text()) == {"unisg_blender": __version__, "made": ["a", "b"]}
    (tmp_path / "c").touch()
    check_made(tmp_path, ["a", "b"])
    with pytest.raises(UniSGError, match="c was not made"):
        check_made(tmp_path, ["a", "c"])


@pytest.mark.parametrize(
    "marker", ["", "[]", "{}", '{"unisg_blender": 3, "made": []}', '{"unisg_blender": "1"}', "[" * 9999]
)
def test_another_marker_marks_nothing(tmp_path: Path, marker: str) -> None:
    (tmp_path / MARKER).write_text(marker)
    assert made_in(tmp_path) is None


def test_a_folder_in_which_nothing_was_made_is_taken_away(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), own_folder("--out", tmp_path / "out"):
        (tmp_path / "missing").read_text()
    assert not (tmp_path / "out").exists()
    with pytest.raises(RuntimeError), own_folder("--out", tmp_path / "out"):
        fail_halfway(tmp_path / "out")
    with own_folder("--out", tmp_path / "out"):
        pass
    assert contents(tmp_path) == {"out/table.csv": "half"}


@pytest.mark.parametrize("marker", [None, "{}", '{"software": {}, "completed": 1, "from_empty": 2}'])
@pytest.mark.parametrize(
    "words", [["demo"], ["benchmark", "poses"], ["benchmark", "paper"], ["simulate", "s.json"], ["inspect", "s.json"]]
)
def test_verbs_leave_the_folders_of_others_alone(
    tmp_path: Path, words: list[str], marker: str | None, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "thesis"
    folder.mkdir()
    (folder / "report.json").write_text(marker or "chapter one")
    before = contents(tmp_path)
    option = "--figures" if words[0] == "inspect" else "--out"
    assert main([*words, option, str(folder), "-q"]) == 1
    assert f"holds files that unisg has not made: give {option}" in capsys.readouterr().err
    assert contents(tmp_path) == before


def test_a_world_overwrites_only_its_own_scenes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_scene_file(cubes(0), tmp_path / "cubes-00001.json")
    mine = contents(tmp_path)

    def words(seed: str) -> list[str]:
        """The command line."""
        return ["world", "cubes", "--format", "json", "--out", str(tmp_path), "--seed", seed, "--overwrite", "-q"]

    assert main(words("1")) == 1
    assert "cubes-00001.json was not made by unisg" in capsys.readouterr().err
    assert contents(tmp_path) == mine
    assert main(words("2")) == main(words("2")) == 0
