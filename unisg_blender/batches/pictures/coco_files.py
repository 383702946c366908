"""Labels of pictures as COCO files, instances and panoptic: http://cocodataset.org/#format-data."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.atomic_files import replacing
from ...scene.categories import STRUCTURE

INSTANCES, PANOPTIC = "instances.json", "panoptic.json"


def coco_categories(names: Iterable[str], known: Sequence[str] = ()) -> dict[str, int]:
    """A number from 1 on for each category: first those that are ``known``, in their order, then others by name."""
    numbers = {name: place for place, name in enumerate(known, start=1)}
    for name in sorted(set(names) - set(numbers)):
        numbers[name] = len(numbers) + 1
    return numbers


def write_coco(folder: Path, pictures: Sequence[str], known: Sequence[str] = ()) -> dict[str, int]:
    """Write both COCO files of a batch of pictures from its labels; returns the categories' numbers.

    Parameters
    ----------
    folder
        The batch's folder.
    pictures
        Their names, in order.
    known
        Categories that have the numbers from 1 on, see :func:`coco_categories`.
    """

    def labels() -> Iterator[dict[str, Any]]:
        """The labels of one picture after another."""
        for name in pictures:
            yield json.loads((folder / "labels" / f"{name}.json").read_text(encoding="utf-8"))

    numbers = coco_categories((item["category"] for label in labels() for item in label["objects"]), known)
    listed = [
        {"id": number, "name": name, "supercategory": _super(name), "isthing": int(name not in STRUCTURE)}
        for name, number in numbers.items()
    ]  # fmt: skip
    images = [_image(number, label) for number, label in enumerate(labels(), start=1)]
    count = iter(range(1, 2**53))

    def annotations(number: int, label: dict[str, Any]) -> list[dict[str, Any]]:
        """The annotations of a picture, each with its mask."""
        with np.load(folder / "truth" / f"{label['picture']}.npz") as truth:
            instances = truth["instance"]
        return [
            _of_object(item, numbers) | {
                "id": next(count), "image_id": number, "bbox": item["bbox"],
                "segmentation": run_lengths(instances == item["id"]),
            }
            for item in label["objects"]
        ]  # fmt: skip

    def segments(number: int, label: dict[str, Any]) -> list[dict[str, Any]]:
        """The segments of a picture."""
        found = [_of_object(item, numbers) | {"id": item["id"], "bbox": item["bbox"]} for item in label["objects"]]
        return [{"image_id": number, "file_name": f"{label['picture']}.png", "segments_info": found}]

    _write(folder / INSTANCES, images, listed, labels, annotations)
    _write(folder / PANOPTIC, images, listed, labels, segments)
    return numbers


def _image(number: int, label: dict[str, Any]) -> dict[str, Any]:
    file = f"{label['picture']}.png"
    return {"id": number, "file_name": file, "width": label["width"], "height": label["height"], "room": label["room"]}


def _of_object(item: dict[str, Any], numbers: dict[str, int]) -> dict[str, Any]:
    """What both files say of an object."""
    return {
        "category_id": numbers[item["category"]], "area": item["pixels"], "iscrowd": 0, "uid": item["uid"],
        "name": item["name"], "share_visible": item["share_visible"], "truncated": item["truncated"],
    }  # fmt: skip


def _super(name: str) -> str:
    return "structure" if name in STRUCTURE else "thing"


def _write(
    path: Path, images: list[dict[str, Any]], categories: list[dict[str, Any]],
    labels: Callable[[], Iterator[dict[str, Any]]],
    annotate: Callable[[int, dict[str, Any]], list[dict[str, Any]]],
) -> None:  # fmt: skip
    """Write a COCO file, never more than the annotations of one picture in memory."""
    with replacing(path) as unfinished, open(unfinished, "w", encoding="utf-8", newline="\n") as file:
        file.write(f'{{"images": {json.dumps(images)},\n"categories": {json.dumps(categories)},\n"annotations": [')
        first = True
        for number, label in enumerate(labels(), start=1):
            for record in annotate(number, label):
                file.write(("\n" if first else ",\n") + json.dumps(record))
                first = False
        file.write("\n]}\n")


def run_lengths(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """A mask (height, width) as COCO's compressed run lengths: column by column, the first run not of the mask.

    Each count, from the third on less the one two before, is written in groups of five bits, lowest first, with a sixth
    that says whether another follows, as characters from "0" on.
    """
    flat = mask.T.ravel()
    ends = np.flatnonzero(np.diff(flat)) + 1
    counts = np.diff(np.concatenate([[0], ends, [len(flat)]])).tolist()
    if len(flat) and flat[0]:
        counts = [0, *counts]
    text = []
    for place, count in enumerate(counts):
        rest = count - counts[place - 2] if place > 2 else count
        while True:
            bits, rest = rest & 31, rest >> 5
            more = rest != (-1 if bits & 16 else 0)
            text.append(chr((bits | 32 if more else bits) + 48))
            if not more:
                break
    return {"size": list(mask.shape), "counts": "".join(text)}
