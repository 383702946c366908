"""The control of classification from few scenes: the position's channels, given twice."""

from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("torch_geometric")

from unisg_blender.experiments.paper.plan import DOUBLED_FORMS  # noqa: E402
from unisg_blender.learn.paper.classification import Scenes, doubled  # noqa: E402
from unisg_blender.poses import FORMS  # noqa: E402


def features(form: str, shift: float) -> torch.Tensor:
    """A pose turned about the vertical, at a place of its own, in a form, with stretch."""
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]]
    pose[:3, 3] = np.array([0.3, -1.2, 0.8]) * shift
    return torch.from_numpy(FORMS[form].encode(pose[None], stretch=True))


@pytest.mark.parametrize("form", DOUBLED_FORMS)
def test_what_stands_twice_is_the_position_and_nothing_else(form: str) -> None:
    none = torch.zeros(1, dtype=torch.int64)
    near, far = (doubled(Scenes({"trs": features(form, shift)}, {}, {}, none, none), form) for shift in (1.0, 2.0))
    width = features(form, 1.0).shape[1]
    added = [scenes.x["trs"][0, width:] for scenes in (near, far)]
    torch.testing.assert_close(added[1], 2 * added[0])
    assert float(added[0].abs().min()) > 0
    changed = (near.x["trs"][0, :width] - far.x["trs"][0, :width]).abs() > 1e-9
    assert int(changed.sum()) == len(added[0])
