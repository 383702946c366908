from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.cli import main
from unisg_blender.dataset import open_dataset
from unisg_blender.dataset.dataset_description import printable
from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset, export_steps
from unisg_blender.errors import MISUSE, SOME_FAILED, UNUSABLE_INPUT, UniSGError

pytestmark = pytest.mark.slow

HERE = Path(__file__).parent
OPTIONS = ExportOptions(reader="fake_reader:read", timeout=60)
Contents = dict[str, bytes]


def contents(folder: Path) -> Contents:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(autouse=True)
def _fake_reader(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(HERE), prepend=os.pathsep)


@pytest.fixture
def put(tmp_path: Path) -> Callable[..., Path]:
    def write(name: str, **order: object) -> Path:
        path = tmp_path / "in" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(order))
        return path

    return write


def test_scenes_stand_in_the_order_of_their_files(tmp_path: Path, put: Callable[..., Path]) -> None:
    put("b/2.obj", seed=5, scenes=2)
    put("a/9.obj", seed=1, note="hair is not read")
    put("a/10.obj", seed=2)
    put("a/.hidden.obj", seed=3)
    put("a/notes.txt", seed=3)
    put("empty.obj", seed=4, scenes=0)
    records = export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS)
    names = [Path(record["source"]).relative_to(tmp_path / "in").as_posix() for record in records]
    assert names == ["a/10.obj", "a/9.obj", "b/2.obj", "empty.obj"]
    assert [record["scenes"] for record in records] == [1, 1, 2, 0]
    assert records[1]["not_represented"] == "hair is not read"
    dataset = open_dataset(tmp_path / "ds")
    assert [scene.title for scene in dataset] == ["2-0", "1-0", "5-0", "5-1"]
    assert dataset[2].source == records[2]["source"]
    assert dataset.files() == records
    named = [dataset.manifest["shards"][0], dataset.manifest["assets"], dataset.manifest["files"]]
    assert sorted(contents(tmp_path / "ds")) == sorted(["manifest.json", *(entry["file"] for entry in named)])


def test_inputs_may_be_globs_and_overlap(tmp_path: Path, put: Callable[..., Path]) -> None:
    put("a/1.obj", seed=1)
    odd = put("a/2.xyz", seed=2)
    put("b/3.obj", seed=3)
    inputs = [f"{tmp_path}/in/**/*.obj", tmp_path / "in" / "a", odd]
    records = export_dataset(inputs, tmp_path / "ds", OPTIONS)
    assert [Path(record["source"]).name for record in records] == ["1.obj", "2.xyz", "3.obj"]


def test_the_number_of_jobs_changes_nothing(tmp_path: Path, put: Callable[..., Path]) -> None:
    for number in range(12):
        put(f"{number}.obj", seed=number, seconds=0.02 * (number % 3))
    for jobs in (1, 3):
        export_dataset([tmp_path / "in"], tmp_path / f"ds{jobs}", OPTIONS, jobs=jobs)
    assert contents(tmp_path / "ds1") == contents(tmp_path / "ds3")


@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_any_executor_does(tmp_path: Path, put: Callable[..., Path], kind: str) -> None:
    for number in range(4):
        put(f"{number}.obj", seed=number)
    put("crash.obj", seed=9, trouble="crash")
    export_dataset([tmp_path / "in"], tmp_path / "own", OPTIONS, jobs=2)
    pools = {"threads": ThreadPoolExecutor(2), "processes": ProcessPoolExecutor(2, mp_context=get_context("spawn"))}
    with pools[kind] as pool:
        export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS, executor=pool)
    assert contents(tmp_path / "ds") == contents(tmp_path / "own")


def test_dask_does(tmp_path: Path, put: Callable[..., Path]) -> None:
    distributed = pytest.importorskip("distributed")
    for number in range(4):
        put(f"{number}.obj", seed=number)
    export_dataset([tmp_path / "in"], tmp_path / "own", OPTIONS, jobs=1)
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS, executor=client.get_executor(pure=False))
    assert contents(tmp_path / "ds") == contents(tmp_path / "own")


@pytest.mark.parametrize(
    ("trouble", "reason"),
    [
        ("crash", "crashed with SIGSEGV"),
        ("exit", "ended with status 7"),
        ("bug", "ZeroDivisionError: in the reader"),
        ("hang", "not done after 5 s"),
        ("memory", "out of memory"),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="limits and signals of POSIX")
def test_trouble_costs_only_the_file(tmp_path: Path, put: Callable[..., Path], trouble: str, reason: str) -> None:
    for number in range(3):
        put(f"{number}.obj", seed=number)
    put("1-bad.obj", seed=0, trouble=trouble, seconds=60 if trouble == "hang" else 0)
    options = ExportOptions(
        reader=OPTIONS.reader, timeout=5 if trouble == "hang" else 60, memory=4 * 2**30 if trouble == "memory" else 0
    )
    records = export_dataset([tmp_path / "in"], tmp_path / "ds", options, jobs=1)
    assert [record["status"] for record in records] == ["ok", "failed", "ok", "ok"]
    assert reason in records[1]["reason"]
    assert [scene.title for scene in open_dataset(tmp_path / "ds")] == ["0-0", "1-0", "2-0"]


def test_an_unreadable_file_costs_only_itself(tmp_path: Path, put: Callable[..., Path]) -> None:
    put("1.obj", seed=1)
    (tmp_path / "in" / "2.obj").symlink_to("2.obj")  # a loop: cannot be opened, not even by root
    put("3.obj", seed=3)
    records = export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS)
    assert [record["status"] for record in records] == ["ok", "failed", "ok"]
    assert "cannot be read" in records[1]["reason"]


@pytest.mark.skipif(sys.platform != "linux", reason="names that others do not allow")
def test_names_of_files_may_be_anything(tmp_path: Path, put: Callable[..., Path]) -> None:
    odd = ["a\nb.obj", "c d'\".obj", "ü \U0001f600.obj", "\udcff.obj"]
    for number, name in enumerate(odd):
        put(name, seed=number)
    (tmp_path / "in" / "z.obj").symlink_to("a\nb.obj")
    (tmp_path / "link").symlink_to("in")
    inputs = [tmp_path / "in", tmp_path / "link", tmp_path / "in" / odd[0]]
    export_dataset(inputs, tmp_path / "in" / "ds", OPTIONS)  # among the files themselves
    dataset = open_dataset(tmp_path / "in" / "ds")
    assert [Path(scene.source).name for scene in dataset] == sorted(odd)
    again = export_dataset(inputs, tmp_path / "in" / "ds", OPTIONS, resume=True)
    assert again == dataset.files()
    assert [printable(name) for name in odd] == ["a\\nb.obj", "c d'\".obj", "ü \U0001f600.obj", "\\udcff.obj"]


@pytest.mark.skipif(sys.platform != "linux", reason="counts open files in /proc")
def test_more_files_than_a_process_may_open(tmp_path: Path, put: Callable[..., Path]) -> None:
    resource = pytest.importorskip("resource")
    for number in range(70):
        put(f"{number}.obj", seed=number)
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (len(os.listdir("/proc/self/fd")) + 50, limits[1]))
    try:
        export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS, jobs=1)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)
    assert len(open_dataset(tmp_path / "ds")) == 70


def test_when_nothing_can_be_read_nothing_is_written(tmp_path: Path, put: Callable[..., Path]) -> None:
    put("1.obj", seed=1, trouble="bug")
    with pytest.raises(UniSGError, match="none of 1 files"):
        export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS)
    put("1.obj", seed=1, scenes=0)
    with pytest.raises(UniSGError, match="no object"):
        export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS)
    assert not (tmp_path / "ds").exists()


def test_missing_inputs_are_refused(tmp_path: Path) -> None:
    for item in (tmp_path / "none.blend", tmp_path / "*.blend", tmp_path):
        with pytest.raises(UniSGError):
            export_dataset([item], tmp_path / "ds", OPTIONS)
    assert not (tmp_path / "ds").exists()


def test_mapping_and_folders_label(tmp_path: Path, put: Callable[..., Path]) -> None:
    put("ward/1.obj", seed=1)
    put("kitchen/2.obj", seed=1)
    options = ExportOptions(
        reader=OPTIONS.reader,
        mapping={"scenes": {"*/ward/*": "hospital"}},
        folder_labels=True,
        mesh_encoder="fake_reader:encode",
    )
    export_dataset([tmp_path / "in"], tmp_path / "ds", options)
    dataset = open_dataset(tmp_path / "ds")
    assert [scene.label for scene in dataset] == ["kitchen", "hospital"]
    assert dataset[0]["mesh.feature"].tolist() == [[3.0] * 4]


def test_names_are_numbered_as_another_dataset_does(tmp_path: Path, put: Callable[..., Path]) -> None:
    put("1.obj", seed=1)
    names = {"categories": ("Zebra", "Table"), "relations": ("beside",)}
    options = ExportOptions(reader=OPTIONS.reader, vocabulary=names)
    export_dataset([tmp_path / "in"], tmp_path / "ds", options)
    put("2.obj", seed=2)
    export_dataset([tmp_path / "in"], tmp_path / "ds", options, resume=True)
    dataset = open_dataset(tmp_path / "ds")
    assert dataset.categories[:2] == ("Zebra", "Table")
    assert dataset.vocabulary["relations"][0] == "beside"
    assert "Zebra" not in dataset.category_counts
    assert len(dataset) == 2


def read_again(folder: Path) -> list[str]:
    """Names of the files that a resumed export reads."""
    steps = export_steps([folder / "in"], folder / "ds", OPTIONS, resume=True)
    found = [record for record, _ in steps if record is not None and record["status"] == "ok"]
    return sorted(Path(record["source"]).name for record in found)


def test_resume_updates_a_dataset(tmp_path: Path, put: Callable[..., Path]) -> None:
    for number in range(5):
        put(f"{number}.obj", seed=number, scenes=1 + number % 2)
    put("5.obj", seed=5, trouble="bug")
    export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS)
    put("1.obj", seed=11)
    put("2b.obj", seed=12)
    put("5.obj", seed=5)
    (tmp_path / "in" / "3.obj").unlink()
    assert read_again(tmp_path) == ["1.obj", "2b.obj", "5.obj"]
    export_dataset([tmp_path / "in"], tmp_path / "fresh", OPTIONS)
    updated, fresh = open_dataset(tmp_path / "ds"), open_dataset(tmp_path / "fresh")
    assert updated.manifest | {"assets": 0} == fresh.manifest | {"assets": 0}  # by name, so by content, too
    for folder in (updated, fresh):
        folder.check()
        sources = {record["source"] for record in folder.assets().index["assets"]}
        assert sources <= {record["source"] for record in folder.files()}
    assert updated.assets().shapes("parts").keys() == fresh.assets().shapes("parts").keys()


def test_resume_with_more_files_gives_what_a_fresh_export_gives(tmp_path: Path, put: Callable[..., Path]) -> None:
    for number in (1, 3, 4, 6):
        put(f"{number}.obj", seed=number, scenes=2)
    put("5.obj", seed=5, trouble="bug")
    export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS)
    for number in (0, 2, 5, 7):
        put(f"{number}.obj", seed=number)
    export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS, resume=True)
    export_dataset([tmp_path / "in"], tmp_path / "fresh", OPTIONS)
    assert contents(tmp_path / "ds") == contents(tmp_path / "fresh")


def test_resume_reads_again_what_files_beside_have_changed(tmp_path: Path, put: Callable[..., Path]) -> None:
    put("1.obj", seed=1, beside=["lib/shared.bin", "missing.bin"])
    put("2.obj", seed=2, beside=["lib/shared.bin"])
    put("3.obj", seed=3)
    library = tmp_path / "in" / "lib" / "shared.bin"
    library.parent.mkdir()
    library.write_text("one")
    records = export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS)
    assert [list(record["beside"]) for record in records] == [["lib/shared.bin", "missing.bin"], ["lib/shared.bin"], []]
    assert records[0]["beside"]["missing.bin"] is None

    assert read_again(tmp_path) == []
    (tmp_path / "in" / "missing.bin").write_text("found")
    assert read_again(tmp_path) == ["1.obj"]
    library.write_text("two")
    assert read_again(tmp_path) == ["1.obj", "2.obj"]
    library.unlink()
    assert read_again(tmp_path) == ["1.obj", "2.obj"]
    assert read_again(tmp_path) == []


def test_another_form_is_read_anew(tmp_path: Path, put: Callable[..., Path]) -> None:
    put("1.obj", seed=1)
    export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS)
    options = ExportOptions("pga", reader=OPTIONS.reader)
    with pytest.raises(UniSGError, match="holds a dataset already"):
        export_dataset([tmp_path / "in"], tmp_path / "ds", options)
    export_dataset([tmp_path / "in"], tmp_path / "ds", options, resume=True)
    assert open_dataset(tmp_path / "ds")[0].features.shape[1] == 22


def test_large_exports_go_in_windows(tmp_path: Path, put: Callable[..., Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("unisg_blender.runtime.job_pool.WINDOW", 3)
    for number in range(20):
        put(f"{number:02}.obj", seed=number)
    export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS, jobs=2)
    titles = [scene.title for scene in open_dataset(tmp_path / "ds")]
    assert titles == [f"{number}-0" for number in range(20)]


def test_children_that_retired_are_replaced(
    tmp_path: Path, put: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    from unisg_blender.dataset.export.supervisor import export_file
    from unisg_blender.runtime import asked_process

    put("1.obj", seed=1)
    put("2.obj", seed=2)
    monkeypatch.setattr(asked_process, "REQUESTS_PER_CHILD", 1)
    records = export_dataset([tmp_path / "in"], tmp_path / "ds", OPTIONS, jobs=1)
    assert [record["status"] for record in records] == ["ok", "ok"]
    monkeypatch.setattr(asked_process, "REQUESTS_PER_CHILD", 200)
    job = {"source": "s", "path": str(tmp_path / "in" / "1.obj"), "parts": str(tmp_path), "known": "", "timeout": 60}
    job |= {
        "memory": 0,
        "label": "",
        "form": "quaternion",
        "mapping": None,
        "understand": None,
        "software": "",
        "mesh_encoder": "",
        "assets": "",
    }
    job |= {"beside": {}, "instances": "keep"}
    try:
        assert export_file(job | {"reader": "fake_reader:read"})["status"] == "ok"
        child = asked_process._idle[0].queue[0]
        with open(os.devnull, "w") as nowhere:  # it sees the end of its requests, and ends by itself
            os.dup2(nowhere.fileno(), child._process.stdin.fileno())
        child._process.wait(timeout=30)
        assert export_file(job | {"reader": "fake_reader:read", "source": "t"})["status"] == "ok"
    finally:
        asked_process.close_children()


def test_command_line(
    tmp_path: Path, put: Callable[..., Path], capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        ExportOptions.__init__, "__defaults__", (*ExportOptions.__init__.__defaults__[:-1], OPTIONS.reader)
    )
    put("1.obj", seed=1, note="hair is not read")
    put("2.obj", seed=2)
    words = ["export", str(tmp_path / "in"), "--out", str(tmp_path / "ds"), "--jobs", "1"]
    assert main(words) == 0
    shown = capfd.readouterr()
    assert "1.obj: not represented: hair is not read" in shown.err
    assert "2/2" in shown.err
    assert "files/s" in shown.err
    assert "2 scenes with 7 entities from 2 files" in shown.out
    assert main(words) == UNUSABLE_INPUT
    assert "holds a dataset already" in capfd.readouterr().err
    put("3.obj", seed=3, trouble="bug")
    assert main([*words, "--resume", "--json", "-q"]) == SOME_FAILED
    shown = capfd.readouterr()
    assert shown.err == ""
    report = json.loads(shown.out)
    assert (report["files"], report["failed"], report["scenes"]) == (3, 1, 2)
    assert main(["export", str(tmp_path / "in"), "--out", "x", "--form", "euler"]) == MISUSE
    assert main(["export", str(tmp_path / "in"), "--out", "x", "--jobs", "0"]) == UNUSABLE_INPUT
    unreachable = ["--scheduler", "tcp://127.0.0.1:1"]
    assert main(["export", str(tmp_path / "in"), "--out", str(tmp_path / "y"), *unreachable]) == UNUSABLE_INPUT
    assert not (tmp_path / "y").exists()


def test_features_do_not_depend_on_the_neighbours(tmp_path: Path, put: Callable[..., Path]) -> None:
    for number in range(6):
        put(f"{number}.obj", seed=number)
    export_dataset([tmp_path / "in"], tmp_path / "all", OPTIONS)
    export_dataset([tmp_path / "in" / "4.obj"], tmp_path / "one", OPTIONS)
    together, alone = open_dataset(tmp_path / "all")[4], open_dataset(tmp_path / "one")[0]
    assert np.array_equal(together.features, alone.features)
