"""``unisg generate`` for many rooms: variations of scenes, or whole rooms, each with its number for a seed."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..batches.batch_plan import BatchOptions, Task, plan_rooms
from ..batches.batch_report import REPORT
from ..batches.room_makers import GENERATED
from ..dataset import open_dataset
from ..errors import DONE, SOME_FAILED, UniSGError
from ..runtime.file_endings import WRITABLE, is_of
from .batch_options import batch_options, batch_reason, made_rooms, variation_words
from .common import noted, print_report, words_of
from .outputs import check_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..generate import Generator


def run_batch(args: argparse.Namespace) -> int:
    """Make the rooms, show progress and one line per room that failed; exit status 3 if any did."""
    from ..dataset.export.sources import find_sources
    from ..generate import Generator, Sampling
    from ..generate.counts import parse_counts
    from ..pretrained import find_generator
    from ..runtime.atomic_files import checksum_of
    from ..words import read_mapping

    if args.render is not None:
        raise UniSGError("--render is for one room: give a single --out file")
    if is_of(args.out, WRITABLE) and not args.out.is_dir():
        raise UniSGError(f"{batch_reason(args)} makes a folder of rooms: give --out a folder, not {args.out}")
    check_folder("--out", args.out)
    Sampling(args.variety, args.candidates)  # before anything is made
    model = find_generator(args.model)
    generator, words = Generator.load(model), words_of(args)
    scenes = find_sources(args.scene) if args.scene else []
    settings: dict[str, Any] = {
        "model": str(model.absolute()), "sha256": checksum_of(model),
        "add": None if args.add is None else generator.understood(parse_counts(args.add), words),
        "variation": variation_of(args, generator, words),
        "mapping": None if args.mapping is None else read_mapping(args.mapping),
        "assets": "" if args.assets is None else str(args.assets.absolute()),
        "how": {
            "bulk": args.bulk, "settle": not args.raw, "behaviour": not args.no_behaviour, "on": args.on,
                "beside": args.beside, "within": args.within, "words": words, "ways": not args.no_ways,
                "sampling": {"variety": args.variety, "candidates": args.candidates}},
    }  # fmt: skip
    tasks = plan_rooms(scenes, args.count or 1, args.seed or 0, model.stem)
    return make_and_report(args, tasks, batch_options(args, GENERATED, settings))


def variation_of(args: argparse.Namespace, generator: Generator, words: dict[str, str]) -> dict[str, Any] | None:
    """What varies, as a file says it, with what the options say in place of that; None where nothing is said."""
    from ..generate.variation.variation_file import read_record, variation_from
    from ..generate.variation.varied_room import MODEL, OWN, known_variation

    options = {
        name: [word.strip() for word in text.split(",")]
        for name, text in variation_words(args).items() if text is not None
    }  # fmt: skip
    if args.vary is None and not options:
        return None
    record = ({} if args.vary is None else read_record(args.vary)) | options
    known_variation(variation_from(record), generator, words)
    if "shapes" in record:
        record["shapes"] = [name if name in (MODEL, OWN) else _dataset_path(name) for name in record["shapes"]]
    return record


def _dataset_path(name: str) -> str:
    """The absolute path of a dataset; UniSGError if there is none."""
    open_dataset(name)
    return str(Path(name).absolute())


def make_and_report(args: argparse.Namespace, tasks: Sequence[Task], options: BatchOptions) -> int:
    """Make the rooms of a batch with progress, and say what became of them."""
    started = time.perf_counter()
    records = made_rooms(args, tasks, options)
    seconds = time.perf_counter() - started
    failed = sum(record["status"] == "failed" for record in records)
    report = {"out": str(args.out), "rooms": len(records), "failed": failed, "seconds": round(seconds, 3)}
    report |= {"format": options.format, "records": records}
    words = f", {failed} failed" if failed else ""
    line = f"{args.out}: {len(records)} rooms{words} in {seconds:.1f} s ({REPORT} says more)"
    print_report(args, report, [*noted(records), line])
    return SOME_FAILED if failed else DONE
