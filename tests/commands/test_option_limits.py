"""What an option may be is said before any work begins: numbers, and files and folders to write."""

from __future__ import annotations

import argparse
import importlib
import os
from functools import partial
from pathlib import Path

import pytest

from unisg_blender.cli import VERBS, main
from unisg_blender.commands import argument_types, outputs
from unisg_blender.errors import UniSGError
from unisg_blender.generate.counts import MOST_OBJECTS, parse_counts


def actions(verb: str) -> list[argparse.Action]:
    parser = argparse.ArgumentParser()
    importlib.import_module(f"unisg_blender.commands.{verb}").add_arguments(parser)
    return parser._actions


@pytest.mark.parametrize("verb", VERBS)
def test_every_number_has_limits(verb: str) -> None:
    for action in actions(verb):
        assert action.type not in (int, float), action.option_strings
        if isinstance(action.type, partial):
            for text in ("nan", "inf", "-inf", "", "x", "1e999", "9" * 5000, "-" + "9" * 5000, "\ud800"):
                with pytest.raises(argparse.ArgumentTypeError, match="must be a"):
                    action.type(text)


@pytest.mark.parametrize("verb", VERBS)
def test_no_file_has_an_empty_name(verb: str) -> None:
    for action in actions(verb):
        assert action.type is not Path, action.option_strings
        if action.type in (argument_types.PATH, argument_types.named):
            for text in ("", " "):
                with pytest.raises(argparse.ArgumentTypeError, match="must be the name of a file or folder"):
                    action.type(text)  # type: ignore[operator]


@pytest.mark.parametrize(
    ("words", "option"),
    [
        (["world", "cubes", "--out", "x", "--count", "0"], "--count"),
        (["world", "cubes", "--out", "x", "--count", "-3"], "--count"),
        (["world", "cubes", "--out", "x", "--jobs", "0"], "--jobs"),
        (["world", "cubes", "--out", "x", "--seed", "-1"], "--seed"),
        (["export", "x", "--out", "x", "--timeout", "0"], "--timeout"),
        (["export", "x", "--out", "x", "--timeout", "inf"], "--timeout"),
        (["export", "x", "--out", "x", "--memory", "-1"], "--memory"),
        (["export", "x", "--out", "x", "--memory", "nan"], "--memory"),
        (["relations", "x", "--heading", "nan"], "--heading"),
        (["generate", "--out", "x.json", "--seed", "1" * 5000], "--seed"),
        (["label", "x.json", "--threshold", "1.5"], "--threshold"),
    ],
)
def test_a_number_out_of_its_limits_cannot_be_used(
    capsys: pytest.CaptureFixture[str], words: list[str], option: str
) -> None:
    assert main(words) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert f"argument {option}: must be a" in line
    assert len(line) < 200


def test_how_many_objects_can_be_added_has_a_limit() -> None:
    assert parse_counts(f"Cup={MOST_OBJECTS}") == {"Cup": MOST_OBJECTS}
    for text in (f"Cup={MOST_OBJECTS},Plate", f"Cup={MOST_OBJECTS + 1}", "Cup=100000000", "Cup=" + "9" * 5000):
        with pytest.raises(UniSGError, match=f"at most {MOST_OBJECTS} objects"):
            parse_counts(text)


FILES = {
    "convert": ["convert", "missing.json", "OUT"],
    "generate": ["generate", "--scene", "missing.json", "--out", "OUT"],
    "relations": ["relations", "missing.json", "--out", "OUT"],
    "label": ["label", "missing.json", "--out", "OUT"],
    "simulate": ["simulate", "missing.json", "--record", "OUT"],
}
FOLDERS = {
    "simulate": ["simulate", "missing.json", "--rehearse", "--out", "OUT"],
    "inspect": ["inspect", "missing", "--figures", "OUT"],
    "world": ["world", "cubes", "--out", "OUT"],
    "export": ["export", "missing.json", "--out", "OUT"],
    "evaluate": ["evaluate", "missing.onnx", "--data", "missing", "--out", "OUT"],
    "benchmark": ["benchmark", "poses", "--out", "OUT"],
    "demo": ["demo", "--out", "OUT"],
    "train": ["train", "topology", "--data", "missing", "--out", "m.onnx", "--logs", "OUT"],
}


def refused(words: list[str], out: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The line that a verb says when it cannot write there."""
    assert main([str(out) if word == "OUT" else word for word in words]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "cannot write" in error
    return error


@pytest.mark.parametrize("verb", FILES)
def test_a_file_that_cannot_be_written_is_told_before_the_work(
    verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "missing.json").write_text("{}")
    (tmp_path / "folder.json").mkdir()
    assert "there is no folder" in refused(FILES[verb], tmp_path / "no" / "a.json", capsys)
    assert "it is no file" in refused(FILES[verb], tmp_path / "folder.json", capsys)
    assert "is read, or written" in refused(FILES[verb], tmp_path / "folder.json" / ".." / "missing.json", capsys)
    assert "takes .blend" in refused(FILES[verb], tmp_path / "a.doc", capsys)
    assert "name too long" in refused(FILES[verb], tmp_path / ("a" * 245 + ".json"), capsys)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.json")
        assert "it is no file" in refused(FILES[verb], tmp_path / "pipe.json", capsys)
    assert {path.name for path in tmp_path.iterdir()} <= {"missing.json", "folder.json", "pipe.json"}


@pytest.mark.parametrize("verb", FOLDERS)
def test_a_folder_that_cannot_be_written_is_told_before_the_work(
    verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "thesis.txt").write_text("mine")
    assert "it is no folder" in refused(FOLDERS[verb], tmp_path / "thesis.txt", capsys)
    refused(FOLDERS[verb], tmp_path / "thesis.txt" / "below", capsys)
    assert "name too long" in refused(FOLDERS[verb], tmp_path / "new" / ("a" * 300), capsys)
    for name in ("fuller.blend", "picture.png"):
        assert "that names a file" in refused(FOLDERS[verb], tmp_path / name, capsys)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_a_folder_that_is_tried_is_taken_away_again(tmp_path: Path) -> None:
    outputs.check_folder("--out", tmp_path / "a" / "b")
    outputs.check_file("--out", tmp_path / "a.json", (".json",))
    assert not list(tmp_path.iterdir())


def test_a_scene_is_not_written_without_its_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    blender = pytest.importorskip("unisg_blender.blender")

    def fails(*_: object, **__: object) -> None:
        raise UniSGError("no picture today")

    monkeypatch.setattr(blender, "render_picture", fails)
    words = ["generate", "--add", "Tray", "--render", str(tmp_path / "a.png"), "--out"]
    for name in ("a.json", "a.blend"):
        assert main([*words, str(tmp_path / name)]) == 1
        assert "no picture today" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
