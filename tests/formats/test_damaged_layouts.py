"""Layouts and worlds with damages by seed: each gives a scene or one line, and no warning."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.formats import test_layouts as plain
from tests.formats import test_layouts_of_rooms as rooms
from tests.formats import test_procthor_houses as houses
from tests.formats import test_simulators as simulators
from tests.formats.reading import write
from tests.hostile_files import damaged
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import read_scene_file

SEEDS = 12
SOUND = {
    "house.json": json.dumps(houses.house()),
    "internscenes.json": json.dumps(plain.internscenes()),
    "tdw.json": json.dumps(plain.tdw()),
    "state.json": json.dumps(rooms.scene_state()),
    "sage.json": json.dumps(rooms.sage()),
    "front.json": json.dumps(rooms.front3d()),
    "room.world": simulators.WORLD,
    "robot.urdf": simulators.URDF,
    "model.xml": simulators.MJCF,
    "part.dae": simulators.DAE.format(up="Y_UP"),
}


@pytest.mark.parametrize("name", SOUND)
def test_damaged_files_are_scenes_or_one_line(tmp_path: Path, name: str) -> None:
    write(tmp_path / "asset-database.json", houses.ASSETS)
    write(tmp_path / "models_core.json", plain.models())
    refusals = []
    for seed in range(SEEDS):
        data = damaged(SOUND[name].encode(), True, np.random.default_rng([seed, len(name)]))
        (tmp_path / name).write_bytes(data)
        try:
            read_scene_file(tmp_path / name)
        except UniSGError as error:
            refusals.append(str(error))
    assert refusals
    assert not any("\n" in told for told in refusals)
