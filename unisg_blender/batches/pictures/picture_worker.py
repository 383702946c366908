"""What a process does for a batch of pictures: it opens scenes, takes their pictures, and writes what these show."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...dataset.export.realized_instances import realize_objects
from ...dataset.format.columns import Columns, Vocabulary, join
from ...dataset.format.encoding import Sample, encode_scenes
from ...dataset.format.reader import open_dataset
from ...dataset.format.shards import pack_shard
from ...dataset.scenes_with_shapes import ShapedScenes
from ...formats.scene_files import load_blender, read_scene_file
from ...geometry.arrays import Bools
from ...runtime.atomic_files import checksum_of, replacing, write_file, write_named
from ...runtime.file_endings import is_of
from ...runtime.serving_process import Alive
from ...scene import SceneGraph
from ...words import apply_mapping
from ..task_records import task_records, used_memory
from .panoptic_image import write_panoptic
from .picture_labels import LabelledScene, labelled
from .view_choice import ChosenView, choose_views

if TYPE_CHECKING:
    from ...blender.render.photograph import Photographer
    from ...blender.render.truth import TruthStage

FOLDERS = {"pictures": ".png", "panoptic": ".png", "truth": ".npz", "labels": ".json"}
"""Folders of a batch of pictures, and the endings of the files in them: one of each for a picture."""


def make_pictures(request: Mapping[str, Any], alive: Alive) -> dict[str, Any]:
    """Take the pictures of the scenes of a job; the answer is that of :func:`..room_worker.make_rooms`."""
    load_blender()
    batch = _Pictures(request)
    records = task_records(request, alive, batch.take)
    tired = used_memory() > request["most_memory"]
    return {"status": "ok", "records": records, "tired": tired, "part": batch.finish(records)}


@lru_cache(maxsize=2)
def _shaped(path: str, sha256: str) -> ShapedScenes:
    """The scenes of a dataset, as long as it is that one."""
    return ShapedScenes(open_dataset(path))


class _Pictures:
    """Pictures of some scenes, and the scenegraphs of what they show."""

    def __init__(self, request: Mapping[str, Any]) -> None:
        self.settings, self.form = request["settings"], request["form"]
        self.threads = request["threads"]
        self.folder, self.parts, self.key = Path(request["folder"]), Path(request["parts"]), request["key"]
        self.vocabulary, self.columns = Vocabulary(), list[Columns]()
        self.files: dict[str, str] = {}

    def take(self, task: Mapping[str, Any]) -> dict[str, Any]:
        """Take all pictures of a scene; returns what the report says of it."""
        from ...blender.blend_files import current_scene
        from ...blender.render.photograph import Photographer
        from ...blender.render.truth import truth_stage

        source, shown = self._opened(task)
        graph = labelled(source)
        rng = np.random.default_rng([task["seed"], 2])
        size = self.settings["size"]
        views = choose_views(graph, self.settings["views"], (size[0], size[1]), rng, source)
        scene = LabelledScene.of(graph, shown)
        photographer = Photographer(current_scene(), self.settings["engine"], self.settings["samples"], self.threads)
        names, objects = [], 0
        with truth_stage(graph, shown, self.threads) as stage:
            for number, chosen in enumerate(views):
                names.append(f"{task['room']}-{number:02d}")
                objects += self._one(names[-1], task, scene, chosen, stage, photographer)
        note = {"note": photographer.note} if photographer.note else {}
        return {"entities": len(graph), "pictures": names, "objects": objects, "scenes": len(names), **note}

    def _opened(self, task: Mapping[str, Any]) -> tuple[SceneGraph, Bools]:
        """Open a scene in Blender as it is rendered: its scenegraph, and which rows are shown."""
        from ...blender import SUFFIXES, open_file, read_scene
        from ...blender.blend_files import current_scene, new_scene
        from ...blender.render.photograph import rendered_rows, show_as_rendered

        path, assets = Path(task["path"]), self.settings["assets"]
        if "scene" in task:
            new_scene(_shaped(task["path"], task["sha256"]).scene(task["scene"]))
        elif is_of(path, SUFFIXES) and not is_of(path, (".usd", ".usda", ".usdc", ".usdz")):
            open_file(path)
        else:
            new_scene(read_scene_file(path, assets=Path(assets) if assets else None)[0])
        show_as_rendered(current_scene())
        graph = read_scene(current_scene(), geometry="evaluated")
        if self.settings["mapping"] is not None:
            graph = apply_mapping(graph, self.settings["mapping"])
        graph = realize_objects(graph)[0]
        return graph, rendered_rows(graph, current_scene())

    def _one(
        self, name: str, task: Mapping[str, Any], scene: LabelledScene, chosen: ChosenView, stage: TruthStage,
        photographer: Photographer,
    ) -> int:  # fmt: skip
        """Take one picture and write all that belongs to it; returns how many objects it shows."""
        truth = stage.render(chosen.view, chosen.hidden)
        instances = scene.instances(truth.row)
        labels = scene.labels(chosen.view, instances)
        record = {"picture": name, "room": task["room"], "scene": Path(task["path"]).name, **chosen.view.to_record()}
        hidden = [scene.graph.uid[row] for row in np.flatnonzero(chosen.hidden).tolist()]
        photographer.take(chosen.view, self._file("pictures", name), hidden)
        write_panoptic(self._file("panoptic", name), instances)
        with replacing(self._file("truth", name)) as path:
            np.savez_compressed(path, instance=instances, depth=truth.depth, normal=truth.normal.astype(np.float16))
        write_file(self._file("labels", name), json.dumps(record | {"objects": labels}, indent=1) + "\n")
        for kind in FOLDERS:
            self.files[f"{kind}/{name}{FOLDERS[kind]}"] = checksum_of(self._file(kind, name))
        sample = Sample(scene.seen_graph(instances), name)
        self.columns.append(encode_scenes([sample], self.form, self.vocabulary))
        return len(labels)

    def _file(self, kind: str, name: str) -> Path:
        return self.folder / kind / f"{name}{FOLDERS[kind]}"

    def finish(self, records: list[dict[str, Any]]) -> str:
        """Write down what was made; returns the name of the part with the scenegraphs, "" if there are none."""
        part = ""
        if self.columns:
            notes = {"vocabulary": self.vocabulary.names, "assets": {"assets": []}, "answer": {"records": records}}
            data = pack_shard(join(self.columns), notes)
            part = write_named(self.parts, f"graphs-{self.key}", ".safetensors", data)[0]
        made = {"records": records, "files": self.files, "part": part}
        write_file(self.parts / f"{self.key}.json", json.dumps(made))
        return part
