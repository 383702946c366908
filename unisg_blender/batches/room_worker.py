"""What a process does for a batch: it makes some rooms and writes them as files, or as a part of a dataset."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..dataset.assets.asset_collector import AssetCollector
from ..dataset.export.reader_process import ASSETS
from ..dataset.format.columns import Columns, Vocabulary, join
from ..dataset.format.encoding import Sample, encode_scenes
from ..dataset.format.shards import pack_shard
from ..formats.scene_files import load_blender
from ..runtime.atomic_files import checksum_of, write_file, write_named
from ..runtime.serving_process import Alive, load_function
from .made_room import MadeRoom
from .room_files import write_room
from .task_records import named, task_records, used_memory


def make_rooms(request: Mapping[str, Any], alive: Alive) -> dict[str, Any]:
    """Make the rooms of a job (see :mod:`.batch_plan`) but those that are ``left_out``, each with the reason.

    Returns
    -------
    dict
        ``status`` "ok", ``records`` of all rooms, and ``part``: a file with the records, and for a dataset the scenes.
    """
    if request["format"] == "blend" or any(task["path"] for task in request["tasks"]):
        load_blender()  # before any USD, see there
    target: _Files | _Part = _Part(request) if request["format"] == "dataset" else _Files(request)
    records = task_records(request, alive, lambda task: _made(request, task, target))
    answer = {"status": "ok", "records": records, "tired": used_memory() > request["most_memory"]}
    return answer | {"part": target.finish(records)}


def _made(request: Mapping[str, Any], task: Mapping[str, Any], target: _Files | _Part) -> dict[str, Any]:
    """Make a room; what its record says."""
    room = load_function(request["maker"])(request["settings"], task)
    source = named(task)["source"]
    return {"scenes": 1, "entities": len(room.scene)} | room.record | target.add(room, task["room"], source)


class _Files:
    """Rooms as files of their own."""

    def __init__(self, request: Mapping[str, Any]) -> None:
        self.folder, self.ending = Path(request["folder"]), request["format"]
        self.part = Path(request["parts"], f"{request['key']}.json")
        self.files: dict[str, str] = {}

    def add(self, room: MadeRoom, name: str, source: str) -> dict[str, str]:
        """Write a room as the file of a name; returns what the report says of it."""
        path = self.folder / f"{name}.{self.ending}"
        write_room(room, path)
        self.files[path.name] = checksum_of(path)
        return {"file": path.name}

    def finish(self, records: list[dict[str, Any]]) -> str:
        """Write down what was made; there is no part beside the files."""
        write_file(self.part, json.dumps({"records": records, "files": self.files}))
        return ""


class _Part:
    """Rooms as a part of a dataset."""

    def __init__(self, request: Mapping[str, Any]) -> None:
        self.request = request
        self.encoder = load_function(request["mesh_encoder"]) if request["mesh_encoder"] else None
        self.vocabulary, self.assets, self.columns = Vocabulary(), AssetCollector(), list[Columns]()

    def add(self, room: MadeRoom, name: str, source: str) -> dict[str, str]:
        """Take a room in, as one of a source."""
        sample = Sample(room.scene, source, room.label)
        self.columns.append(encode_scenes([sample], self.request["form"], self.vocabulary, self.encoder))
        self.assets.add(room.scene, source)
        return {}

    def finish(self, records: list[dict[str, Any]]) -> str:
        """Write the part; returns its name, "" if it has no room."""
        if not self.columns:
            return ""
        arrays, index = self.assets.pack()
        whole = join(self.columns) | {ASSETS + name: values for name, values in arrays.items()}
        notes = {"vocabulary": self.vocabulary.names, "assets": index, "answer": {"records": records}}
        data = pack_shard(whole, notes)
        return write_named(Path(self.request["parts"]), self.request["key"], ".safetensors", data)[0]
