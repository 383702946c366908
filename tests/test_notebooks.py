"""The notebooks run from their first cell to the last, and say what they hold."""

from __future__ import annotations

import base64
import importlib.util

import pytest

pytest.importorskip("nbclient")
pytest.importorskip("matplotlib")

from run_notebooks import FOLDER, differences, executed, read

NAMES = sorted(path.stem for path in FOLDER.glob("*.ipynb"))
NEEDS = {
    "equivariance": ("torch",),
    "geometric_algebra": ("clifford",),
    "motion": ("bpy",),
    "operating_room": ("bpy",),
    "prediction": ("bpy", "torch_geometric"),
}


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_says_what_it_holds(name: str) -> None:
    for package in NEEDS.get(name, ()):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"needs {package}")
    assert differences(read(FOLDER / f"{name}.ipynb"), executed(FOLDER / f"{name}.ipynb")) == []


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_has_its_pictures(name: str) -> None:
    """Each opens with what its reader will be able to do, and is as it was after its last run."""
    notebook = read(FOLDER / f"{name}.ipynb")
    assert "At the end you can" in notebook.cells[0].source
    drawn = [
        base64.b64decode(output.data["image/png"])
        for cell in notebook.cells if cell.cell_type == "code"
        for output in cell.outputs if "image/png" in output.get("data", {})
    ]  # fmt: skip
    assert len(drawn) >= 3
    assert all(len(picture) > 5000 for picture in drawn)


def test_another_word_and_a_missing_picture_are_noticed() -> None:
    held = read(FOLDER / "pose_forms.ipynb")
    for spoiled in ("words", "picture"):
        ran = read(FOLDER / "pose_forms.ipynb")
        outputs = next(
            cell.outputs for cell in ran.cells
            if cell.cell_type == "code" and any(("data" in each) == (spoiled == "picture") for each in cell.outputs)
        )  # fmt: skip
        if spoiled == "words":
            outputs[0].text = outputs[0].text.replace("1", "2", 1)
        else:
            outputs.clear()
        assert differences(held, ran)
    assert not differences(held, read(FOLDER / "pose_forms.ipynb"))
