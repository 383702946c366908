"""Whether a thing is in a room without a ceiling is told of every room, also of the first."""

from __future__ import annotations

import numpy as np
import pytest

from tests.spatial.built_rooms import DOOR, SQUARE, room
from tests.spatial.built_rooms import scene as built
from unisg_blender.generate.check.scene_check import SceneShapes
from unisg_blender.spatial.structure.recognise import recognise_structure


@pytest.mark.parametrize("roof", [True, False])
def test_a_room_is_open_where_it_has_no_ceiling(roof: bool) -> None:
    graph = built(room(SQUARE, roof=roof, holes=(DOOR,)))
    (found,) = recognise_structure(graph).rooms
    inside = np.array([[[*found.inner_point, found.floor + 1.0]]])
    assert SceneShapes.of(graph).roofless(inside) is not roof
    assert not SceneShapes.of(graph).roofless(inside + 50.0)
