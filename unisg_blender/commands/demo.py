"""``unisg demo``: the main job end to end on shipped content, with pictures."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from tqdm import tqdm

from ..errors import DONE, MissingPackageError
from ..runtime.made_files import filling
from .argument_types import PATH, SEED
from .common import add_form, print_report
from .outputs import check_results

if TYPE_CHECKING:
    from ..generate import Generated, Generator
    from ..scene import SceneGraph

HELP = (
    "Build an operating room in Blender, read it as a scenegraph, export it as a dataset, load it as HeteroData, "
    "complete it with a trained model, start a second room from empty, and write files and pictures."
)
COMPLETION = {"Scalpel": 2, "Monitor": 1, "IV Pole": 1}
STEPS = ("build", "save", "read", "export", "load", "complete", "from empty", "pictures")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument("--out", type=PATH, default=Path("demo"), help="folder to write (default: demo)")
    parser.add_argument("--seed", type=SEED, default=7, help="which room (default: 7)")
    add_form(parser, "dual_quaternion")
    parser.add_argument("--model", type=PATH, help="a trained model instead of the shipped one")


def run(args: argparse.Namespace) -> int:
    """Write the demo's folder; the files of an earlier one are replaced when the new ones are complete."""
    check_results("--out", args.out)
    with filling(args.out) as work:
        with tqdm(total=len(STEPS), desc="demo", unit="step", disable=args.quiet, file=sys.stderr) as bar:
            report = _demo(args, work, bar)
        (work / "report.json").write_text(json.dumps(report, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    print_report(args, report, _lines(report, args.out))
    return DONE


def _demo(args: argparse.Namespace, out: Path, bar: tqdm) -> dict[str, Any]:
    from ..blender.blend_files import current_scene, new_scene, save_blend
    from ..blender.read.scene_reader import read_scene
    from ..dataset import write_dataset
    from ..generate import Generator
    from ..pretrained import default_generator
    from ..scene import SceneBuilder
    from ..worlds import operating_room

    clock = _Clock(bar)
    generator = Generator.load(args.model or default_generator())
    world = operating_room(args.seed)
    clock.step("build", lambda: new_scene(world))
    clock.step("save", lambda: save_blend(out / "before.blend"))
    graph = clock.step("read", lambda: read_scene(current_scene()))
    clock.step("export", lambda: write_dataset([graph], out / "dataset", args.form))
    data = clock.step("load", lambda: _load(out / "dataset"))
    completed = clock.step("complete", lambda: generator.add(graph, COMPLETION, seed=args.seed))
    counts = generator.sample_counts(np.random.default_rng(args.seed))
    empty = clock.step("from empty", lambda: generator.add(SceneBuilder("Room").build(), counts, seed=args.seed))
    clock.step("pictures", lambda: _pictures(out, graph, completed, empty))
    return {
        "software": _software(),
        "model": _model_record(generator),
        "before": _room_record(graph),
        "graph": data,
        "completed": _generated_record(completed),
        "from_empty": {"asked": counts, **_generated_record(empty)},
        "seconds": clock.seconds,
    }


class _Clock:
    """Times the steps and moves the progress bar."""

    def __init__(self, bar: tqdm) -> None:
        self._bar = bar
        self.seconds: dict[str, float] = {}

    def step(self, name: str, work: Callable[[], Any]) -> Any:
        """Do one step of the job with the bar told its name; its seconds are kept, its result returned."""
        self._bar.set_postfix_str(name)
        start = time.perf_counter()
        result = work()
        self.seconds[name] = round(time.perf_counter() - start, 3)
        self._bar.update()
        return result


def _load(dataset: Path) -> dict[str, Any]:
    """What stands in the graph that PyG sees."""
    try:
        import torch_geometric  # noqa: F401
    except ImportError:
        raise MissingPackageError("torch-geometric", "learn") from None
    from ..dataset import UniSGDataset

    data = UniSGDataset(dataset)[0]
    edges = {"-".join(kind): int(data[kind].edge_index.shape[1]) for kind in data.edge_types}
    return {"nodes": {kind: int(data[kind].num_nodes) for kind in data.node_types}, "edges": edges}


def _pictures(out: Path, before: SceneGraph, completed: Generated, empty: Generated) -> None:
    """Save and picture the rooms: before and after completing, and the one from empty."""
    from ..blender.blend_files import current_scene, new_scene, save_blend
    from ..blender.render.picture import render_picture
    from ..blender.write.scene_writer import write_rows

    def both_views(name: str) -> None:
        """Picture what is open."""
        render_picture(out / f"{name}_perspective.png")
        render_picture(out / f"{name}_top.png", view="top")

    both_views("before")
    write_rows(completed.scene, completed.rows, current_scene())
    save_blend(out / "after.blend")
    both_views("after")
    new_scene(empty.scene)
    save_blend(out / "from_empty.blend")
    both_views("from_empty")


def _software() -> dict[str, str]:
    from .. import __version__
    from ..blender.blend_files import BLENDER_VERSION

    return {"unisg_blender": __version__, "blender": BLENDER_VERSION}


def _model_record(generator: Generator) -> dict[str, Any]:
    contract = generator.contract
    return {"file": generator.model.path.name, "kind": contract.kind, "provenance": contract.provenance}


def _room_record(graph: SceneGraph) -> dict[str, Any]:
    """Objects and faults of a room, measured."""
    from ..metrics.scene_validity import measure_scene

    report = measure_scene(graph)
    return {
        "objects": int(report.counted.sum()),
        "colliding": int(report.colliding.sum()),
        "off_support": int(report.off_support.sum()),
        "outside": int(report.outside.sum()),
    }


def _generated_record(generated: Generated) -> dict[str, Any]:
    from ..metrics.scene_validity import measure_scene

    report, rows = measure_scene(generated.scene), generated.rows
    spent = sorted(placement.milliseconds for placement in generated.objects)
    return {
        "objects_added": generated.added,
        "refused": len(generated.refused),
        "colliding": int(report.colliding[rows].sum()),
        "off_support": int(report.off_support[rows].sum()),
        "outside": int(report.outside[rows].sum()),
        "milliseconds_per_object": round(spent[len(spent) // 2], 2) if spent else None,
        "objects": [placement.to_record() for placement in generated.objects],
    }


def _lines(report: dict[str, Any], out: Path) -> list[str]:
    before, completed, empty = report["before"], report["completed"], report["from_empty"]
    placed = ", ".join(f"{item['name']} on {item['support'] or 'the ground'}" for item in completed["objects"])
    return [
        f"{out}/before.blend: an operating room with {before['objects']} objects",
        f"{out}/dataset: the room as a dataset; as HeteroData: {report['graph']['nodes']}",
        f"{out}/after.blend: {completed['objects_added']} objects added ({placed});",
        f"  {completed['colliding']} collide, {completed['off_support']} float or sink, "
        f"{completed['milliseconds_per_object']} ms an object",
        f"{out}/from_empty.blend: a room of {empty['objects_added']} objects from nothing;",
        f"  {empty['colliding']} collide, {empty['off_support']} float or sink, {empty['refused']} found no place",
        f"{out}/*.png: pictures before and after; {out}/report.json: all numbers",
    ]
