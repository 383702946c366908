"""Action types of a user's own: by name, from a file, checked, rehearsed and told when they are missing."""

from __future__ import annotations

import json
from pathlib import Path
from shutil import copy

import numpy as np
import pytest

from unisg_blender.behaviour import add_type, check_scene, load_types, prepare, rehearse, remove_type
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.scene import ActionData, LessonNode, SceneBuilder, Thresholds
from unisg_blender.usd import write_usd

FILE = Path(__file__).parents[2] / "examples" / "own_action_type.py"


@pytest.fixture(autouse=True)
def forgotten():
    yield
    for name in ("Lift", "Near"):
        remove_type(name)


@pytest.fixture
def types(tmp_path):
    return copy(FILE, tmp_path / "my_types.py")


def scene(kind="Lift", reference=None):
    action = ActionData("up", kind, "Lift the cup", ("cup",), reference=reference, thresholds=Thresholds(0.4, hold=0.5))
    stage = LessonNode("stage", "s", "Stage", children=(LessonNode("action", "n", action="up"),))
    lesson = LessonNode("operation", "o", "Tea", children=(LessonNode("lesson", "l", "Lesson", children=(stage,)),))
    builder = SceneBuilder()
    builder.add("Cup", uid="cup", actions=(action,))
    builder.add("Tea", uid="tea", lsa=lesson)
    return builder.build()


def test_simulate_knows_the_types_of_a_file(types, tmp_path, capsys):
    write_usd(scene(), tmp_path / "tea.usda")
    assert main(["simulate", "-q", str(tmp_path / "tea.usda"), "--rehearse"]) == 1
    text = "Stage 'Stage' has the action 'Lift the cup' of the unknown type 'Lift': load the file that defines it"
    assert text in capsys.readouterr().err
    assert main(["simulate", "-q", "--json", str(tmp_path / "tea.usda"), "--rehearse", "--types", str(types)]) == 0
    assert json.loads(capsys.readouterr().out)["finished"]


def test_a_type_without_a_gesture_is_tried_like_an_insert(types):
    def near(batch, moment):
        return np.linalg.norm(moment.world[batch.target, :3, 3] - (1, 0, 0), axis=1) < batch.distance

    add_type("Near", near)
    reference = np.eye(4)
    reference[0, 3] = 1
    rehearse(prepare(scene("Near", tuple(reference.ravel()))))
    with pytest.raises(UniSGError, match="give its type a gesture"):
        rehearse(prepare(scene("Near")))


def test_unknown_types_are_problems_until_they_are_loaded(types):
    assert any("unknown type 'Lift'" in problem.message for problem in check_scene(scene()))
    assert load_types(types) == ("Lift",)
    assert check_scene(scene()) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "no file"),
        ("1 / 0", "cannot be run: ZeroDivisionError"),
        ("x = 1", "needs a dictionary CONDITIONS"),
        ("CONDITIONS = {'Lift': 3}", "needs a dictionary CONDITIONS"),
        ("CONDITIONS = {'Insert': print}", "choose another"),
    ],
)
def test_files_without_types_are_refused(tmp_path, text, message):
    path = tmp_path / "types.py"
    if text is not None:
        path.write_text(text)
    with pytest.raises(UniSGError, match=message):
        load_types(path)
