"""``unisg evaluate --judge``: scenes of any kind before judges that are not ours."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import DONE, SOME_FAILED, UniSGError, one_line
from ..runtime.progress import Progress
from ..words import apply_mapping, read_mapping

if TYPE_CHECKING:
    from ..metrics.judges.judged_scene import JudgedScene

OTHERS = ("data", "training")
"""Options of ``unisg evaluate`` that judges have no use for."""


def judges_of(text: str) -> list[str]:
    """The judges that a list names; "all" for all."""
    from ..metrics.judges.judged_scene import JUDGES

    names = [*JUDGES] if text == "all" else [name.strip() for name in text.split(",")]
    if unknown := [name for name in names if name not in JUDGES]:
        raise UniSGError(f"there is no judge {unknown[0]!r}: give all, or some of {','.join(JUDGES)}")
    return names


def run_judges(args: argparse.Namespace) -> int:
    """Judge each scene; a line for all, and for each in which something is wrong. Exit status 3 if some failed."""
    from ..experiments.reports import write_results
    from ..metrics.judges.judged_scene import STABILITY, judge_scene, summary
    from ..metrics.judges.stability import require_mujoco

    judges = judges_of(args.judge)
    if given := [name for name in OTHERS if getattr(args, name) is not None]:
        raise UniSGError(f"--judge looks at the scenes alone: leave --{given[0]} out")
    if not args.model.exists():
        raise UniSGError(f"there is no file or folder {args.model}: check the path")
    if STABILITY in judges:
        require_mujoco()
    judged: list[tuple[str, JudgedScene]] = []
    failed, bar = [], Progress(0, "scenes judged", args.quiet)
    try:
        for name, graph, problem in _scenes(args):
            if graph is None:
                failed.append(f"{name}: {problem}")
            else:
                judged.append((name, judge_scene(graph, judges)))
                bar.update(len(judged))
            if len(judged) == args.scenes:
                break
    finally:
        bar.close()
    if not judged:
        raise UniSGError(f"no scene could be judged; {failed[0]}" if failed else f"{args.model} holds no scene")
    row = summary([scene for _, scene in judged])
    report: dict[str, Any] = {"judges": judges, "summary": row, "failed": failed}
    report["scenes"] = [{"scene": name, **asdict(scene)} for name, scene in judged]
    if args.out is not None:
        write_results(args.out / "judged.json", report)
    print(json.dumps(report, ensure_ascii=False) if args.json else "\n".join(_lines(row, judged, failed)))
    return SOME_FAILED if failed else DONE


def _scenes(args: argparse.Namespace) -> Any:
    """Name and scene of all that the inputs hold, or None with what is wrong."""
    from ..formats.scene_files import read_all_scenes
    from .given_scenes import is_dataset, scene_files

    mapping = None if args.mapping is None else read_mapping(args.mapping)
    for given in (args.model, *args.also):
        if is_dataset(given):
            raise UniSGError(f"{given} is a dataset, which has no meshes to be judged: give the scene files")
        for path in scene_files(Path(given)):
            try:
                for graph in read_all_scenes(path, args.assets).graphs:
                    yield f"{path} {graph.title}", graph if mapping is None else apply_mapping(graph, mapping), ""
            except UniSGError as problem:
                yield str(path), None, one_line(problem)


def _lines(row: dict[str, Any], judged: list[tuple[str, JudgedScene]], failed: list[str]) -> list[str]:
    lines = [f"{name}: falls: {', '.join(scene.falling)}" for name, scene in judged if scene.falling]
    lines += [
        f"{name}: {scene.navigability:.2f} of the free floor can be reached"
        for name, scene in judged if scene.navigability is not None and scene.navigability < 0.9
    ]  # fmt: skip
    lines += [f"{each} (left out)" for each in failed]
    told = [f"{row['scenes']} scenes, {row['things']} things"]
    for name, words in (
        ("stable", "{free} free things: {stable} stay"), ("navigability", "navigability {navigability}"),
        ("doors_clear", "{doors} doors: {doors_clear} clear"),
        ("windows_clear", "{windows} windows: {windows_clear} clear"),
    ):  # fmt: skip
        if row[name] is not None:
            low, high = row[f"{name}_interval"]
            said = {key: f"{value:.3f}" if isinstance(value, float) else value for key, value in row.items()}
            told.append(f"{words.format(**said)} [{low:.3f}, {high:.3f}]")
    return [*lines, "; ".join(told)]
