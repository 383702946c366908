"""A word that nothing has is answered with the nearest one that there is."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from unisg_blender.dataset import write_dataset
from unisg_blender.errors import UniSGError, did_you_mean
from unisg_blender.formats import write_scene_file
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder
from unisg_blender.worlds import cubes

Run = Callable[..., tuple[str, str]]


@pytest.mark.parametrize(
    ("word", "guess"), [("scalpell", "Scalpel"), ("MAYO STAND", "Mayo Stand"), ("xyz", ""), ("", ""), ("calendar", "")]
)
def test_the_nearest_name_is_guessed(word: str, guess: str) -> None:
    expected = f" (did you mean {guess!r}?)" if guess else ""
    assert did_you_mean(word, ("Mayo Stand", "Scalpel")) == expected


@pytest.mark.parametrize(
    ("words", "guess"),
    [
        (["inspekt", "x.json"], "inspect"),
        (["relations", "x.json", "--kind", "on_top"], "on_top_of"),
        (["relations", "x.json", "--limits", "3"], "--limit"),
        (["generate", "--out", "x.json", "--besides=Cup"], "--beside"),
        (["world", "operating-rom", "--out", "x"], "operating-room"),
        (["train", "clasifier", "--data", "x", "--out", "y.onnx"], "classifier"),
        (["export", "x", "--out", "y", "--form", "dual_quaternions"], "dual_quaternion"),
    ],
)
def test_verbs_options_and_choices(run: Run, words: list[str], guess: str) -> None:
    assert run(*words, status=2)[1].endswith(f" (did you mean {guess!r}?)\n")


def test_an_option_that_is_like_no_other_is_refused_without_a_guess(run: Run) -> None:
    assert "did you mean" not in run("inspect", "x.json", "--zzzzzz", status=2)[1]


def test_models() -> None:
    with pytest.raises(UniSGError, match=r"no model 'operating-rom' \(did you mean 'operating_room'\?\)"):
        find_generator("operating-rom")
    assert find_generator("living-room").name == "living_room.onnx"
    assert find_generator("missing.onnx") == Path("missing.onnx")


def test_models_to_evaluate(tmp_path: Path, run: Run) -> None:
    write_dataset([cubes(seed=1)], tmp_path / "data")
    words = ("evaluate", "--data", tmp_path / "data")
    assert "(did you mean 'living_room'?)" in run(*words, "living-rom", status=1)[1]
    assert "no category of things that living-room knows" in run(*words, "living-room", status=1)[1]


def test_objects_of_a_scene(tmp_path: Path, run: Run) -> None:
    write_scene_file(cubes(seed=1), tmp_path / "cubes.json")
    words = ("generate", "--scene", tmp_path / "cubes.json", "--add", "Scalpel", "--out", tmp_path / "out.json")
    assert "(did you mean 'Floor'?)" in run(*words, "--on", "Flor", status=1)[1]
    builder = SceneBuilder()
    builder.add("Operating Table", uid="a")
    with pytest.raises(KeyError, match="did you mean 'Operating Table'"):
        builder.build()["Operating Tabel"]
