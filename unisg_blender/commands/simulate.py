"""``unisg simulate``: play a scene's lesson against its animation, a recording, a script, or a rehearsal."""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from collections.abc import Iterable
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tqdm import tqdm

from ..errors import DONE, MISUSE, UniSGError, did_you_mean
from ..runtime.atomic_files import read_plain
from ..runtime.file_endings import WRITABLE
from ..runtime.made_files import filling
from .argument_types import PATH, number
from .common import add_limit, add_scene, print_report, read_shown, shown_lines
from .outputs import check_file, check_results

if TYPE_CHECKING:
    from ..behaviour import Moment
    from ..scene import LessonNode, SceneGraph

HELP = (
    "Play the lesson of a scene: against the animation or recording in the file, a scripted motion (--motion), or a "
    "rehearsal that performs every action in its turn (--rehearse). Says which action was performed, when and why."
)
FILM_FRAMES = 60


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    add_scene(parser, meaning="a scene file with a lesson")
    source = parser.add_mutually_exclusive_group()
    source.add_argument(
        "--motion", metavar="JSON", type=PATH, help="a script of poses and inputs, by the objects' names"
    )
    source.add_argument(
        "--rehearse", action="store_true", help="do every action in its turn; says whether that is possible"
    )
    parser.add_argument("--lesson", metavar="NAME", help="which lesson, where the scene has several")
    parser.add_argument(
        "--rate", type=number(0.001, 1000), help="frames per second (default: 30, the file's own for an animation)"
    )
    parser.add_argument(
        "--types", metavar="PY", type=PATH, action="append", default=[],
        help="a Python file with action types of your own (it is run): see docs/behaviour.md",
    )  # fmt: skip
    parser.add_argument(
        "--record",
        metavar="FILE",
        type=PATH,
        help="write the scene with what was played as its recording",
    )
    parser.add_argument("--out", metavar="DIR", type=PATH, help="write timeline.json and timeline.png here")
    add_limit(parser, "lines of each kind: parts of the lesson, wrong steps")
    parser.add_argument("--render", action="store_true", help="with --out: write film.gif too (needs Blender)")


def run(args: argparse.Namespace) -> int:
    """Play, tell, and write what was asked for; the files are complete or not written at all."""
    if args.render and args.out is None:
        print("unisg simulate: --render needs --out DIR", file=sys.stderr)
        return MISUSE
    check_results("--out", args.out)
    check_file("--record", args.record, WRITABLE, [args.file])
    from ..behaviour import prepare, simulate, timeline_record
    from ..behaviour.fulfilment.custom_types import load_types
    from ..formats.scene_files import write_scene_file

    for path in args.types:
        load_types(path)
    graph, _ = read_shown(args, args.file, args.record)
    lesson = prepare(graph, _chosen(graph, args.lesson))
    take = Playthrough(lesson)
    played, script = _moments(args, graph, lesson)
    bar = tqdm(played, desc="simulate", unit="frame", disable=args.quiet, file=sys.stderr)
    timeline = simulate(lesson, bar, take.watch if args.render or args.record else None)
    record = timeline_record(timeline)
    with nullcontext() if args.out is None else filling(args.out) as work:
        if work is not None:
            _write(args, work, graph, record, take.frames, script)
        if args.record is not None:
            write_scene_file(take.recorded(timeline.events), args.record)
    print_report(args, record, _lines(args, record))
    return DONE


class Playthrough:
    """What a film and a recording need of every moment of a lesson that is played."""

    def __init__(self, lesson: Any) -> None:
        from ..behaviour import PoseRecorder

        self.lesson, self.recorder = lesson, PoseRecorder()
        self.frames: list[Any] = []
        self._inputs: list[Any] = []
        self._before: Moment | None = None
        self._leaves = [place for place, node in enumerate(lesson.outline.nodes) if node.kind == "action"]

    def watch(self, now: Moment, state: Any) -> None:
        """Take down a moment."""
        from ..behaviour.lesson.lesson_progress import STATUSES
        from ..behaviour.record.recorded_events import new_inputs
        from ..scene import local_matrices

        states = [(_name(self.lesson, place), STATUSES[state.status[place]]) for place in self._leaves]
        self.frames.append((now.time, now.world, states))
        graph = self.lesson.graph
        self.recorder.look(graph.uid, local_matrices(graph, now.world), now.time)
        self._inputs += new_inputs(self.lesson, self._before, now)
        self._before = now

    def recorded(self, events: Iterable[Any]) -> SceneGraph:
        """The scene with all of it as its recording."""
        from ..behaviour import with_events
        from ..scene.components import ANIMATION

        graph = self.recorder.recorded(self.lesson.graph)
        components = {name: found for name, found in graph.components.items() if name != ANIMATION}
        return with_events(graph.replace(components=components), events, self._inputs)


def _chosen(graph: SceneGraph, name: str | None) -> LessonNode | None:
    from ..behaviour import operations

    if name is None:
        return None
    found = [each for each in operations(graph) if name in (each.name, each.uid)]
    if not found:
        names = ", ".join(repr(each.name or each.uid) for each in operations(graph)) or "none"
        hint = did_you_mean(name, (each.name for each in operations(graph)))
        raise UniSGError(f"the scene has no lesson {name!r}{hint}; it has: {names}")
    return found[0]


def _moments(args: argparse.Namespace, graph: SceneGraph, lesson: Any) -> tuple[Iterable[Moment], str | None]:
    """The moments to play, and the script of a rehearsal as JSON."""
    from dataclasses import replace

    from ..behaviour import moments, motion_from_json, motion_to_json, recorded_motion, rehearse

    if args.rehearse:
        motion = rehearse(lesson, args.rate or 30.0)
        return list(moments(graph, motion)), motion_to_json(graph, motion)
    if args.motion is not None:
        try:
            motion = motion_from_json(graph, read_plain(args.motion).decode("utf-8"))
        except (OSError, UnicodeDecodeError) as error:
            raise UniSGError(f"cannot read {args.motion}: {getattr(error, 'strerror', None) or error}") from None
        return list(moments(graph, replace(motion, rate=args.rate or motion.rate))), None
    motion = recorded_motion(graph, args.rate or 30.0)
    if motion.tracks or motion.inputs:
        return list(moments(graph, motion)), None
    from ..formats.scene_files import opened_by_blender

    if opened_by_blender(args.file):
        from ..blender.authoring.stored_behaviour import has_animation, scene_moments
        from ..blender.blend_files import current_scene

        if has_animation(current_scene()):
            return scene_moments(current_scene(), graph), None
    raise UniSGError(f"nothing moves in {args.file}: give a --motion script, or let it --rehearse")


def _write(
    args: argparse.Namespace, folder: Path, graph: SceneGraph, record: dict[str, Any], frames: list[Any],
    script: str | None,
) -> None:  # fmt: skip
    from ..behaviour.playing.timeline_picture import draw_timeline

    (folder / "timeline.json").write_text(json.dumps(record, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    draw_timeline(record, folder / "timeline.png")
    if script is not None:
        (folder / "motion.json").write_text(script + "\n", encoding="utf-8")
    if args.render:
        _render(args, graph, folder / "film.gif", frames)


def _render(args: argparse.Namespace, graph: SceneGraph, path: Path, frames: list[Any]) -> None:
    from ..blender.blend_files import current_scene, new_scene
    from ..blender.render.film import write_film
    from ..formats.scene_files import opened_by_blender

    if not opened_by_blender(args.file):
        new_scene(graph)
    chosen = frames[:: max(1, -(-len(frames) // FILM_FRAMES))]
    leave_out = [name for name in graph.vocabulary if "ceiling" in name.casefold()]
    bar = partial(tqdm, desc="film", unit="picture", disable=args.quiet, file=sys.stderr)
    write_film(path, current_scene(), graph, chosen, leave_out=leave_out, speed=2.0, progress=bar)


def _name(lesson: Any, place: int) -> str:
    node, action = lesson.outline.nodes[place], lesson.checks.actions[lesson.task[place]]
    return node.name or action.name or action.type


def _lines(args: argparse.Namespace, record: dict[str, Any]) -> list[str]:
    width = min(shutil.get_terminal_size().columns, 160)
    nodes, wrong = [], []
    for node in record["nodes"][1:]:
        when = f"{node['done']:8.2f} s" if node["done"] is not None else f"{node['status']:>10}"
        why = f"  {node['why']}" if node["why"] else ""
        nodes.append(f"{when}  {'  ' * (node['depth'] - 1)}{node['name']}{why}"[:width])
    for event in record["events"]:
        if event["kind"] in ("out_of_order", "wrong_answer"):
            wrong.append(f"{event['time']:8.2f} s  ! {event['why']}"[:width])
    return [
        f"{record['operation']}: {'played to the end' if record['finished'] else 'not finished'}",
        *shown_lines(args, nodes, "parts of the lesson"),
        *shown_lines(args, wrong, "wrong steps"),
    ]
