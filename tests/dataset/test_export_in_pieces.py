"""A file of many scenes is read piece by piece: what is written is the same, and the clock begins anew with each."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from unisg_blender.dataset.export import reader_process
from unisg_blender.dataset.export.supervisor import SETTINGS, WORK, ReadPart, read_part
from unisg_blender.runtime.serving_process import handle


def exported(folder: Path, key: str) -> tuple[ReadPart, int]:
    """What is written of a file of five scenes, and how often it was said that the reading goes on."""
    job: dict[str, Any] = dict.fromkeys(SETTINGS, "") | {"mapping": None, "understand": None, "instances": "realize"}
    job |= {"path": str(folder / "five.obj"), "source": "five.obj", "form": "quaternion", "parts": str(folder)}
    said: list[int] = []
    answer = handle(job | {"reader": "fake_reader:read", "key": key, "work": WORK}, lambda: said.append(1))
    assert (answer["status"], answer["scenes"]) == ("ok", 5)
    return read_part(folder / answer["part"]), len(said)


def test_in_pieces_or_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    (tmp_path / "five.obj").write_text(json.dumps({"seed": 3, "scenes": 5}))
    whole, once = exported(tmp_path, "a" * 32)
    monkeypatch.setattr(reader_process, "CHUNK", 2)
    pieces, thrice = exported(tmp_path, "b" * 32)
    assert (once, thrice) == (1, 3)
    assert pieces.vocabulary == whole.vocabulary
    assert pieces.columns.keys() == whole.columns.keys()
    for name, values in whole.columns.items():
        np.testing.assert_array_equal(pieces.columns[name], values, err_msg=name)
