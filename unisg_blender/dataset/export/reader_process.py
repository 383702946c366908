"""The process that opens files for an export: one request per line on stdin, one answer per line on stdout.

It is a process of its own because Blender may crash, hang or run out of memory
over a file: that costs this process and that file, nothing else.
"""

from __future__ import annotations

import errno
import faulthandler
import importlib
import json
import os
import queue
import shutil
import sys
import threading
from collections.abc import Callable, Iterable
from itertools import islice
from pathlib import Path
from typing import Any, TextIO

from ...errors import UniSGError
from ...formats.scene_files import AllScenes, load_blender, read_all_scenes
from ...runtime.atomic_files import DiskFullError, write_named
from ...runtime.process_end import end_process
from ...scene import SceneGraph
from ...words.category_mapping import apply_mapping
from ..assets.asset_collector import AssetCollector
from ..format.columns import Vocabulary, join
from ..format.encoding import Sample, encode_scenes
from ..format.shards import pack_shard
from ..told_categories import told_categories
from .file_checksums import checksums
from .realized_instances import realize_objects

MARK = "unisg-answer "
"""Starts every answer: what else a library prints to stdout is not ours."""

ALIVE = "alive"
"""Status of an answer that is none yet: the reading goes on."""

ASSETS = "assets."
"""Starts the names of the arrays of a part that belong to its assets."""

NOT_KEPT = ("animation", "bones", "camera", "instances", "light", "properties", "recording")
CHUNK = 256
"""Scenes of a file that are in memory at a time."""

IDLE = 60.0
GRACE = 30.0
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


def load_function(name: str) -> Callable[..., Any]:
    """The function behind "package.module:name".

    Raises
    ------
    UniSGError
        If there is none.
    """
    module, _, attribute = name.partition(":")
    try:
        return getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise UniSGError(f"{name!r} is no function (package.module:name): {error}") from None


def serve(memory: int, folder: str) -> None:
    """Answer requests until stdin ends or nothing is asked for a minute.

    ``memory`` limits it to so many bytes; ``folder`` is where it keeps temporary files, removed when stdin ends.
    """
    channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what Blender prints must not get between the answers
    if memory:
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    requests: queue.Queue[str] = queue.Queue()
    threading.Thread(target=_listen, args=(requests, folder), daemon=True).start()
    _answer(channel, {"status": "ready"})
    while True:
        try:
            request = json.loads(requests.get(timeout=IDLE))
        except queue.Empty:
            return
        limit = request["timeout"] + GRACE

        def alive(limit: float = limit) -> None:
            """Say that some scenes of a file of many are done: the time for the next ones begins."""
            faulthandler.dump_traceback_later(limit, exit=True)  # if nobody is left to end us
            _answer(channel, {"status": ALIVE})

        faulthandler.dump_traceback_later(limit, exit=True)
        _answer(channel, handle(request, alive))
        faulthandler.cancel_dump_traceback_later()


def _listen(requests: queue.Queue[str], folder: str) -> None:
    for line in sys.stdin:
        requests.put(line)
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(0)  # who asked us is gone: whatever we are doing is of no use


def _answer(channel: TextIO, record: dict[str, Any]) -> None:
    channel.write(MARK + json.dumps(record) + "\n")
    channel.flush()


def handle(request: dict[str, Any], alive: Callable[[], None] = lambda: None) -> dict[str, Any]:
    """Do what a request asks; every error becomes an answer. ``alive`` is called after some scenes of many."""
    try:
        return _export(request, alive)
    except DiskFullError as error:
        return {"status": "full", "reason": str(error)}
    except UniSGError as error:
        return {"status": "failed", "reason": str(error)}
    except MemoryError:
        return {"status": "failed", "reason": "out of memory", "tired": True}
    except Exception as error:
        if isinstance(error, OSError) and error.errno == errno.ENOMEM:
            return {"status": "failed", "reason": "out of memory", "tired": True}
        return {"status": "failed", "reason": f"{type(error).__name__}: {error}".splitlines()[0], "tired": True}


def _export(request: dict[str, Any], alive: Callable[[], None]) -> dict[str, Any]:
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


def main(memory: int, folder: str) -> None:
    """Serve, and end the process."""
    try:
        serve(memory, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    end_process(0)
