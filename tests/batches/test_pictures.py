"""Pictures with labels: cameras, run lengths, numbers as colours, categories, views, and COCO files that agree."""

from __future__ import annotations

import json
import runpy
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from unisg_blender.batches import BatchOptions, make_batch, plan_rooms
from unisg_blender.batches.pictures.coco_files import coco_categories, run_lengths
from unisg_blender.batches.pictures.contact_sheet import mask_colours
from unisg_blender.batches.pictures.panoptic_image import write_panoptic
from unisg_blender.batches.pictures.picture_labels import labelled
from unisg_blender.batches.pictures.silhouette import silhouette
from unisg_blender.batches.room_makers import WORLD
from unisg_blender.cli import main
from unisg_blender.commands.render import picture_size
from unisg_blender.dataset import open_dataset
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import write_scene_file
from unisg_blender.geometry.camera_view import looking
from unisg_blender.scene import SceneBuilder
from unisg_blender.worlds import cubes

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "examples" / "pictures_and_graphs.py"
CUBES = {"world": "cubes", "function": ""}
VIEW = looking("x", np.array([3.0, 0, 1]), np.zeros(3), (64, 48), 1.0)


def decoded(record: dict[str, Any]) -> np.ndarray[Any, Any]:
    """A mask out of COCO's compressed run lengths, as its C code reads them."""
    counts: list[int] = []
    text, place = record["counts"], 0
    while place < len(text):
        value, shift = 0, 0
        while True:
            char = ord(text[place]) - 48
            value |= (char & 31) << shift
            place, shift = place + 1, shift + 5
            if not char & 32:
                break
        if char & 16:
            value |= -1 << shift
        counts.append(value + counts[-2] if len(counts) > 2 else value)
    flat = np.repeat(np.arange(len(counts)) % 2, counts).astype(bool)
    height, width = record["size"]
    return flat.reshape(width, height).T


@given(mask=arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.booleans()))
def test_run_lengths_come_back(mask: np.ndarray[Any, Any]) -> None:
    assert (decoded(run_lengths(mask)) == mask).all()


def test_run_lengths_of_large_masks() -> None:
    mask = np.zeros((700, 900), bool)
    mask[100:600, 3:890] = True
    assert (decoded(run_lengths(mask)) == mask).all()
    assert (decoded(run_lengths(~mask)) == ~mask).all()


def test_numbers_beyond_16_bits_are_colours(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    numbers = np.array([[0, 1, 255], [256, 65535, 70000]], np.int32)
    write_panoptic(tmp_path / "x.png", numbers)
    read = np.array(image.open(tmp_path / "x.png")).astype(int)
    assert (read @ [1, 256, 65536] == numbers).all()


@given(
    st.tuples(*[st.floats(-5, 5)] * 3), st.tuples(*[st.floats(-5, 5)] * 3), st.tuples(*[st.floats(-3, 3)] * 3),
)  # fmt: skip
def test_both_conventions_say_the_same(
    place: tuple[float, ...], target: tuple[float, ...], point: tuple[float, ...]
) -> None:
    eye, to, there = np.array(place), np.array(target), np.array(point)
    if np.linalg.norm(eye - to) < 1e-3:
        return
    view = looking("x", eye, to, (64, 48), 1.0)
    pixel, depth = view.project(to[None])
    np.testing.assert_allclose(pixel[0], (32, 24), atol=1e-5)
    np.testing.assert_allclose(depth[0], np.linalg.norm(eye - to), rtol=1e-9)
    own = np.linalg.inv(view.world) @ [*there, 1]  # Blender: -Z forward, +Y up
    pixels, depths = view.project(there[None])
    np.testing.assert_allclose(depths[0], -own[2], atol=1e-9)
    if depths[0] > 0.1:
        seen = view.intrinsics @ (view.extrinsics @ [*there, 1])[:3]
        np.testing.assert_allclose(pixels[0], seen[:2] / seen[2], atol=1e-6)
        np.testing.assert_allclose(pixels[0] - (32, 24), view.focal * np.array([own[0], -own[1]]) / -own[2], atol=1e-6)


def test_a_silhouette_goes_on_beyond_the_picture() -> None:
    view = replace(VIEW, world=np.diag([1.0, 1, 1, 1]), focal=10.0, center=(32, 24))  # looks down the -Z axis
    square = np.array([[[-1, -1, -1], [1, -1, -1], [1, 1, -1]], [[-1, -1, -1], [1, 1, -1], [-1, 1, -1]]], float)
    found = silhouette(view, square)
    assert found is not None
    assert (found.area, found.box, found.truncated) == (400, (22, 14, 20, 20), False)
    shifted = silhouette(view, square + np.array([3.0, 0, 0]))
    assert shifted is not None
    assert (shifted.area, shifted.truncated) == (400, True)
    large = silhouette(view, square * [20, 20, 1])
    assert large is not None
    assert large.area == pytest.approx(160_000, rel=0.05)
    assert silhouette(view, square * [1, 1, -1]) is None


def test_copies_are_of_one_category_and_nothing_vanishes() -> None:
    builder = SceneBuilder("Kitchen")
    mesh = cubes(0).meshes[0]
    for number, name in enumerate(("Qwxzt", "Qwxzt.001", "Qwxzt.012", "Chair.003")):
        place = np.diag([0.1, 0.1, 0.1, 1])  # too small for a floor
        place[:3, 3] = number, 0, 1
        builder.add(name, uid=name, mesh=mesh, local=place)
    graph = labelled(builder.build())
    assert {graph.name[row]: graph.category_name(row) for row in range(len(graph))} == {
        "Qwxzt": "Qwxzt", "Qwxzt.001": "Qwxzt", "Qwxzt.012": "Qwxzt", "Chair.003": "Chair",
    }  # fmt: skip


def test_numbers_of_categories_are_stable_and_0_is_none() -> None:
    assert coco_categories(["Wall", "Chair", "Chair"]) == {"Chair": 1, "Wall": 2}
    assert coco_categories(["Wall", "Apple"], ["Chair", "Wall"]) == {"Chair": 1, "Wall": 2, "Apple": 3}


@pytest.mark.parametrize("text", ["0", "12x", "axb", "99999", "-3", ""])
def test_sizes_that_are_none(text: str) -> None:
    with pytest.raises(UniSGError, match="--size must be pixels"):
        picture_size(text)
    assert picture_size("640x480") == [640, 480]


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Pictures of two rooms of cubes and of a damaged file."""
    pytest.importorskip("bpy")
    folder = tmp_path_factory.mktemp("rendered")
    for seed in (1, 2):
        write_scene_file(cubes(seed), folder / f"cubes{seed}.usda")
    (folder / "damaged.usda").write_text("#usda 1.0\n(")
    files = sorted(folder.glob("*.usda"))
    tasks = plan_rooms(files, 1, 0, "")
    views = {"dollhouse": 1, "turntable": 1}
    made = {"views": views, "size": [64, 48], "engine": "cycles", "samples": 1, "mapping": None, "assets": ""}
    options = BatchOptions("", made, "pictures", here=True)
    for out in ("out", "again"):
        records = make_batch(tasks, folder / out, options)
        assert [record["status"] for record in records] == ["ok", "ok", "failed"]
    assert make_batch(tasks[:2], folder / "out", options, resume=True) == records[:2]
    return folder


@pytest.mark.slow
def test_coco_files_agree(rendered: Path) -> None:
    out = rendered / "out"
    instances, panoptic = (json.loads((out / name).read_text()) for name in ("instances.json", "panoptic.json"))
    assert [image["file_name"] for image in instances["images"]] == [
        path.name for path in sorted(out.glob("pictures/*"))
    ]
    assert len(instances["images"]) == len(panoptic["annotations"]) == 4
    names = {category["id"]: category["name"] for category in instances["categories"]}
    assert min(names) == 1
    assert "Cube" in names.values()
    numbers = [annotation["id"] for annotation in instances["annotations"]]
    assert len(set(numbers)) == len(numbers) > 20
    for annotation in instances["annotations"]:
        mask = decoded(annotation["segmentation"])
        lines, columns = np.nonzero(mask)
        x, y = columns.min(), lines.min()
        assert annotation["area"] == mask.sum()
        assert annotation["bbox"] == [x, y, columns.max() - x + 1, lines.max() - y + 1]
        assert 0 < annotation["share_visible"] <= 1
        assert annotation["category_id"] in names
    for image, segment in zip(instances["images"], panoptic["annotations"], strict=True):
        mine = [each for each in instances["annotations"] if each["image_id"] == image["id"]]
        whole = sum(decoded(each["segmentation"]).astype(int) for each in mine)
        assert whole.max() == 1  # nothing overlaps
        assert sum(each["area"] for each in segment["segments_info"]) == whole.sum()


@pytest.mark.slow
def test_pycocotools_reads_them(rendered: Path) -> None:
    coco = pytest.importorskip("pycocotools.coco").COCO(str(rendered / "out" / "instances.json"))
    assert coco.anns
    for annotation in coco.anns.values():
        lines, columns = np.nonzero(mask := coco.annToMask(annotation))
        x, y = int(columns.min()), int(lines.min())
        assert mask.sum() == annotation["area"]
        assert annotation["bbox"] == [x, y, columns.max() - x + 1, lines.max() - y + 1]


@pytest.mark.slow
def test_graphs_are_of_what_pictures_show(rendered: Path) -> None:
    out = rendered / "out"
    graphs = open_dataset(out / "graphs")
    assert len(graphs) == 4
    for scene in graphs:
        label = json.loads((out / "labels" / f"{scene.source}.json").read_text())
        assert {item["uid"] for item in label["objects"]} <= set(scene.strings("entity.uid"))
        with np.load(out / "truth" / f"{scene.source}.npz") as truth:
            assert set(np.unique(truth["instance"])) - {0} == {item["id"] for item in label["objects"]}
            assert (np.isfinite(truth["depth"]) == (truth["instance"] > 0)).all()


@pytest.mark.slow
def test_pictures_and_graphs_together(rendered: Path) -> None:
    pytest.importorskip("torch_geometric")
    pytest.importorskip("PIL")
    from unisg_blender.dataset import PictureDataset

    data = PictureDataset(rendered / "out")
    assert len(data) == 4
    item = data[1]
    assert item["picture"].shape == (3, 48, 64)
    assert item["instance"].shape == item["depth"].shape == (48, 64)
    assert item["graph"]["entity"].num_nodes >= len(item["instance"].unique()) - 1
    assert item["picture"].float().std() > 5
    assert sorted(item["number"][item["number"] > 0].tolist()) == [each for each in item["instance"].unique() if each]
    names, graph = data.graphs.vocabulary["categories"], item["graph"]["entity"]
    labels = json.loads((rendered / "out" / "labels" / f"{item['name']}.json").read_text())["objects"]
    told = {label["id"]: label["category"] for label in labels}
    for number, category in zip(item["number"].tolist(), graph.category.tolist(), strict=True):
        assert not number or names[category] == told[number]


@pytest.mark.slow
def test_the_same_pictures_again(rendered: Path) -> None:
    one, two = (
        {path.relative_to(rendered / out): path.read_bytes() for path in (rendered / out).rglob("*") if path.is_file()}
        for out in ("out", "again")
    )
    assert len(one) > 16
    assert one == two


@pytest.mark.slow
def test_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("bpy")
    write_scene_file(cubes(1), tmp_path / "x.usda")
    scene, out = str(tmp_path / "x.usda"), str(tmp_path / "out")
    assert main(["render", scene, "--out", out, "--size", "0"]) == 1
    assert main(["render", str(tmp_path / "none.blend"), "--out", out]) == 1
    assert main(["render", scene, "--out", out, "--views", "Elephant=1", "-q"]) == 1
    assert main(["render", scene, "--out", out, "--views", "eye=x", "-q"]) == 1
    assert len(capsys.readouterr().err.splitlines()) == 4
    assert not list((tmp_path / "out").glob("[!.]*/*")) if (tmp_path / "out").exists() else True


@pytest.mark.slow
def test_scenes_of_a_dataset_are_rendered_and_drawn_on_a_sheet(tmp_path: Path) -> None:
    make_batch(plan_rooms([], 2, 0, "cubes"), tmp_path / "rooms", BatchOptions(WORLD, CUBES, "dataset"), jobs=1)
    words = ["render", str(tmp_path / "rooms"), "--out", str(tmp_path / "out"), "--views", "turntable=1", "-q"]
    words += ["--size", "64x48", "--engine", "workbench", "--jobs", "1", "--sheet", str(tmp_path / "sheet.png")]
    assert main(words) == 0
    names = sorted(path.stem for path in (tmp_path / "out" / "pictures").iterdir())
    assert names == ["rooms-00000-00", "rooms-00001-00"]
    for number, scene in enumerate(open_dataset(tmp_path / "rooms")):
        labels = json.loads((tmp_path / "out" / "labels" / f"{names[number]}.json").read_text())
        assert {each["uid"] for each in labels["objects"]} <= set(scene.strings("entity.uid"))
        assert labels["objects"]
    assert (tmp_path / "sheet.png").read_bytes()[:4] == b"\x89PNG"


def test_masks_of_neighbours_have_other_colours() -> None:
    colours = mask_colours(np.arange(60, dtype=np.int32)[None])[0].astype(int)
    assert (colours[0] == 255).all()
    assert np.abs(np.diff(colours[1:], axis=0)).sum(axis=1).min() > 50


@pytest.mark.slow
def test_the_example_learns_from_pictures_and_graphs(
    rendered: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("torch_geometric")
    monkeypatch.setattr(sys, "argv", [str(EXAMPLE), str(rendered / "out"), "--rounds", "2"])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    assert "it tells right" in capsys.readouterr().out
