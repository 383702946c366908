"""A form of one's own, as the documentation writes it, works wherever a form does."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from unisg_blender import cli
from unisg_blender.dataset import open_dataset, to_scenegraph, write_dataset
from unisg_blender.dataset.format.encoding import Sample
from unisg_blender.errors import UniSGError
from unisg_blender.poses import FORMS, Form, convert, forms, register_form
from unisg_blender.worlds import WORLDS

PAGE = Path(__file__).parents[2] / "docs" / "poses.md"
NAME = "two_rows"


@pytest.fixture(autouse=True)
def own_form() -> Iterator[None]:
    """The form of the page, forgotten afterwards."""
    example = next(
        code for code in re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL) if NAME in code
    )
    exec(example, {})
    yield
    forms._FORMS.pop(NAME)


def poses(count: int = 20) -> np.ndarray:
    """Random rigid matrices."""
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, :3, :3] = Rotation.random(count, random_state=3).as_matrix()
    matrices[:, :3, 3] = np.random.default_rng(3).normal(size=(count, 3))
    return matrices


def test_it_encodes_decodes_projects_and_converts() -> None:
    form, matrices = FORMS[NAME], poses()
    x = form.encode(matrices)
    np.testing.assert_array_equal(x[:, 3:], matrices[:, :2, :3].reshape(-1, 6))
    np.testing.assert_allclose(form.decode(x), matrices, atol=1e-12)
    np.testing.assert_allclose(form.project(x * np.r_[1, 1, 1, [3] * 6]), x, atol=1e-12)
    np.testing.assert_allclose(convert(convert(x, NAME, "pga"), "pga", NAME), x, atol=1e-12)
    scaled = matrices @ np.diag([2.0, 1.0, 0.5, 1.0])
    np.testing.assert_allclose(form.decode(form.encode(scaled, stretch=True), stretch=True), scaled, atol=1e-12)


def test_it_takes_tensors() -> None:
    torch = pytest.importorskip("torch")
    matrices = torch.tensor(poses(), requires_grad=True)
    x = FORMS[NAME].encode(matrices)
    np.testing.assert_allclose(x.detach().numpy(), FORMS[NAME].encode(poses()), atol=1e-12)
    x.sum().backward()
    assert matrices.grad is not None


def test_datasets_and_graphs_hold_it(tmp_path: Path) -> None:
    graph = WORLDS["cubes"](1)
    write_dataset([Sample(graph)], tmp_path / "data", form=NAME)
    scene = open_dataset(tmp_path / "data")[0]
    np.testing.assert_allclose(to_scenegraph(scene).local, graph.local, atol=1e-5)
    pytest.importorskip("torch_geometric")
    from unisg_blender.dataset import to_heterodata

    assert to_heterodata(graph, form=NAME)["trs"].x.shape == (len(graph), FORMS[NAME].width + 6)


def test_the_command_line_offers_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["export", "--help"]) == 0
    assert NAME in capsys.readouterr().out


@pytest.mark.parametrize("name", ["pga", ""])
def test_shipped_forms_stay_what_they_are(name: str) -> None:
    form = FORMS[NAME]
    with pytest.raises(UniSGError, match="cannot be the name of a form of your own"):
        register_form(Form(name, form.channels, form._encode, form._decode, form._project))
