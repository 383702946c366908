"""What a reading process of an export does: it opens a file and writes its scenes as a shard of their own."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import islice
from pathlib import Path
from typing import Any

from ...formats.scene_files import AllScenes, load_blender, read_all_scenes
from ...runtime.atomic_files import write_named
from ...runtime.serving_process import Alive, load_function
from ...scene import SceneGraph
from ...words.category_mapping import apply_mapping
from ..assets.asset_collector import AssetCollector
from ..format.columns import Vocabulary, join
from ..format.encoding import Sample, encode_scenes
from ..format.shards import pack_shard
from ..told_categories import told_categories
from .file_checksums import checksums
from .realized_instances import realize_objects

ASSETS = "assets."
"""Starts the names of the arrays of a part that belong to its assets."""

NOT_KEPT = ("animation", "bones", "camera", "instances", "light", "properties", "recording")
CHUNK = 256
"""Scenes of a file that are in memory at a time."""

LONGEST_NOTE = 2000

Reader = Callable[[Path], tuple[list[SceneGraph], str, list[Path]]]
"""Opens a file: its scenes, in one line what they could not represent ("" for nothing), other files they come from."""


def read_file(request: dict[str, Any]) -> AllScenes:
    """All scenes of the file of a request, by the reader that it names, else by that of the file's kind."""
    path = Path(request["path"])
    if request["reader"]:
        read: Reader = load_function(request["reader"])
        graphs, note, others = read(path)
        return AllScenes(graphs, lambda: note, lambda: others)
    load_blender()  # a later file may need it
    return read_all_scenes(path, Path(request["assets"]) if request["assets"] else None)


def export(request: dict[str, Any], alive: Alive) -> dict[str, Any]:
    """Read a file and write its scenes as a shard of their own."""
    read = read_file(request)
    encoder = load_function(request["mesh_encoder"]) if request["mesh_encoder"] else None
    vocabulary, collector, columns = Vocabulary(), AssetCollector(), []
    scenes = entities = 0
    notes: dict[str, None] = {}
    waiting = iter(read.graphs)
    while chunk := list(islice(waiting, CHUNK)):
        graphs, lost = _prepared(chunk, request)
        notes |= dict.fromkeys(lost)
        samples = [Sample(graph, request["source"], request["label"]) for graph in graphs]
        columns.append(encode_scenes(samples, request["form"], vocabulary, encoder))
        for sample in samples:
            collector.add(sample.graph, request["source"])
        scenes, entities = scenes + len(samples), entities + sum(map(len, graphs))
        alive()
    note = "; ".join(filter(None, [read.note(), *notes]))
    note = note if len(note) <= LONGEST_NOTE else note[:LONGEST_NOTE] + " ..."
    answer: dict[str, Any] = {"status": "ok", "scenes": scenes, "not_represented": note, "part": None}
    answer |= {"beside": checksums(Path(request["path"]), read.beside()), "entities": entities}
    answer |= {key: value for key, value in (("format", read.format), ("licence", read.licence)) if value}
    if columns:
        arrays, index = collector.pack()
        whole = join(columns) if len(columns) > 1 else columns[0]
        whole |= {ASSETS + name: values for name, values in arrays.items()}
        data = pack_shard(whole, {"vocabulary": vocabulary.names, "assets": index, "answer": answer})
        answer["part"], _ = write_named(Path(request["parts"]), request["key"], ".safetensors", data)
    return answer


def _prepared(graphs: list[SceneGraph], request: dict[str, Any]) -> tuple[list[SceneGraph], list[str]]:
    """Scenes as they are to be encoded, and what is left out of them."""
    notes = []
    if request["mapping"]:
        graphs = [apply_mapping(graph, request["mapping"]) for graph in graphs]
    if request["instances"] == "realize":
        realized = [realize_objects(graph) for graph in graphs]
        graphs, notes = [graph for graph, _ in realized], [lost for _, lost in realized]
    if request["understand"] is not None:
        said = (request["mapping"] or {}).get("words")
        graphs = [told_categories(graph, request["understand"], said) for graph in graphs]
    return graphs, [*notes, _left_out(graphs)]


def _left_out(graphs: Iterable[SceneGraph]) -> str:
    """Components that a scenegraph has and a dataset does not."""
    found = {name for graph in graphs for name in graph.components if name in NOT_KEPT}
    return f"not kept in datasets: {', '.join(sorted(found))}" if found else ""
