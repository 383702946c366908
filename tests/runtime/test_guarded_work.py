"""What crashes or hangs over a file costs one line; everything else of a process is as if there were no guard."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="a process cannot be divided here")
LONG = 60.0
"""Seconds within which all ends, on a busy machine too; what hangs here does for ever."""

BEGIN = """
import ctypes, os, signal, sys, time
from pathlib import Path
from unisg_blender.runtime import guarded_work
from unisg_blender.runtime.process_end import stop_when_asked
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # nohup has it ignored
lock = ctypes.create_string_buffer(64)
def within_a_library():  # for ever, while no Python runs in any thread
    [ctypes.PyDLL(None).pthread_mutex_lock(lock) for _ in range(2)]
guarded_work.PATIENCE = {patience}
def work():
    stop_when_asked()
    {work}
    sys.exit(0)
guarded_work.run_guarded(work, "unisg try")
"""


def start(work: str, patience: float = 100.0, **options) -> subprocess.Popen[str]:
    """A guarded process that does what some lines of Python say."""
    code = BEGIN.format(patience=patience, work=work.replace("\n", "\n    "))
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
    return subprocess.Popen([sys.executable, "-c", code], text=True, **pipes)


def end(process: subprocess.Popen[str]) -> tuple[int, str, str]:
    """Status, output and errors of a process."""
    output, errors = process.communicate(timeout=LONG)
    return process.returncode, output, errors


def over(file: Path, what: str) -> str:
    return f"with guarded_work.reading(Path({str(file)!r})):\n    {what}"


@pytest.mark.parametrize("status", [0, 1, 2, 3, 130])
def test_the_status_is_that_of_the_work(status: int) -> None:
    done = end(start(f"print('said'); print('told', file=sys.stderr); sys.exit({status})"))
    assert done == (status, "said\n", "told\n")


@pytest.mark.parametrize(("name", "library"), [("a.usdc", "USD"), ("a.usdz", "USD"), ("a.blend", "Blender")])
def test_a_crash_over_a_file_is_one_line_and_unusable_input(tmp_path: Path, name: str, library: str) -> None:
    status, output, errors = end(start(over(tmp_path / name, "os.kill(os.getpid(), signal.SIGSEGV)")))
    assert (status, output) == (1, "")
    why = f"{library} crashed with SIGSEGV while reading it; is it damaged?"
    assert errors == f"unisg try: cannot read {tmp_path / name}: {why}\n"


def test_a_crash_elsewhere_is_told_and_keeps_its_number(tmp_path: Path) -> None:
    status, _, errors = end(start(over(tmp_path, "pass") + "\nos.abort()"))
    assert (status, errors) == (128 + signal.SIGABRT, "unisg try: the process crashed with SIGABRT\n")


def test_a_hang_over_a_file_is_ended_and_told(tmp_path: Path) -> None:
    status, _, errors = end(start(over(tmp_path / "a.blend", "within_a_library()"), patience=1.0))
    assert status == 1
    assert errors.startswith(f"unisg try: cannot read {tmp_path / 'a.blend'}: nothing came of it within 1 s;")
    assert len(errors.splitlines()) == 1


@pytest.mark.slow
def test_a_larger_file_has_longer(tmp_path: Path) -> None:
    (tmp_path / "a.blend").write_bytes(bytes(2_000_000))
    status, _, errors = end(start(over(tmp_path / "a.blend", "within_a_library()"), patience=0.5))
    assert status == 1
    assert "within 2 s;" in errors  # 0.5 and one for each megabyte


@pytest.mark.slow
def test_reading_that_goes_on_is_not_ended(tmp_path: Path) -> None:
    goes_on = "[(time.sleep(1.1), guarded_work.still_reading()) for _ in range(3)]"
    assert end(start(over(tmp_path / "a.usda", goes_on), patience=2.5)) == (0, "", "")


@pytest.mark.slow
def test_a_large_part_of_a_small_file_has_the_time_of_its_own_size(tmp_path: Path) -> None:
    (tmp_path / "wall.dae").write_bytes(bytes(3_000_000))
    part = f"guarded_work.reading_part(Path({str(tmp_path / 'wall.dae')!r})); time.sleep(2)"
    assert end(start(over(tmp_path / "room.urdf", part), patience=0.5)) == (0, "", "")


@pytest.mark.slow
def test_many_parts_have_each_its_own_time(tmp_path: Path) -> None:
    part = f"guarded_work.reading_part(Path({str(tmp_path / 'cup.stl')!r})), time.sleep(0.6)"
    all_parts = f"[({part}) for _ in range(4)]"
    assert end(start(over(tmp_path / "room.urdf", all_parts), patience=1.5)) == (0, "", "")


@pytest.mark.slow
def test_the_scene_that_is_open_has_longer(tmp_path: Path) -> None:
    longer = "guarded_work.still_reading(100); time.sleep(2)"
    assert end(start(over(tmp_path / "a.blend", longer), patience=0.5)) == (0, "", "")


@pytest.mark.slow
def test_nothing_is_ended_after_the_reading(tmp_path: Path) -> None:
    assert end(start(over(tmp_path / "a.usda", "pass") + "\ntime.sleep(2)", patience=0.5)) == (0, "", "")


@pytest.mark.slow
def test_a_user_can_wait_longer(tmp_path: Path) -> None:
    waits = over(tmp_path / "a.usda", "time.sleep(2)")
    assert end(start(waits, patience=0.5, env=os.environ | {"UNISG_READING_SECONDS": "50"})) == (0, "", "")


@pytest.mark.slow
@pytest.mark.parametrize("value", ["soon", "-1", "nan", "inf", ""])
def test_senseless_seconds_are_refused(tmp_path: Path, value: str) -> None:
    command = [sys.executable, "-m", "unisg_blender", "inspect", str(tmp_path / "a.usda")]
    (tmp_path / "a.usda").write_text("#usda 1.0\n")
    environment = os.environ | {"UNISG_READING_SECONDS": value}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=LONG, check=False)
    assert done.returncode == 1
    assert f"UNISG_READING_SECONDS is {value!r}: it takes seconds" in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_reaches_the_work(number: int) -> None:
    waits = "try:\n    print('ready', flush=True); time.sleep(1000)\nexcept KeyboardInterrupt:\n    sys.exit(77)"
    process = start(waits)
    assert process.stdout is not None
    process.stdout.readline()
    process.send_signal(number)
    assert end(process)[0] == 77


@pytest.mark.slow
def test_a_signal_that_a_library_does_not_answer_ends_it_soon(tmp_path: Path) -> None:
    process = start(over(tmp_path / "a.blend", "print('ready', flush=True); within_a_library()"))
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(0.5)  # it is within the library by then: before, Python would answer
    process.send_signal(signal.SIGINT)
    assert end(process)[::2] == (130, "unisg try: stopped\n")


def test_a_signal_from_a_terminal_counts_once() -> None:
    """It is sent to both processes, and passed on by the one to the other."""
    cleans = "try:\n    print('ready', flush=True); time.sleep(1000)\nexcept KeyboardInterrupt:\n"
    cleans += "    time.sleep(0.5)\n    print('clean')"
    process = start(cleans, start_new_session=True)
    assert process.stdout is not None
    process.stdout.readline()
    os.killpg(process.pid, signal.SIGINT)
    assert end(process) == (0, "clean\n", "")


def test_the_work_ends_with_its_guard() -> None:
    process = start("print(os.getpid(), flush=True); time.sleep(1000)")
    assert process.stdout is not None
    number = int(process.stdout.readline())
    process.kill()
    begin = time.monotonic()
    while _is_alive(number) and time.monotonic() - begin < LONG:
        time.sleep(0.05)
    assert not _is_alive(number)
    process.communicate()


def _is_alive(number: int) -> bool:
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{number}/stat")
    return not (state.exists() and state.read_text().rsplit(")", 1)[1].split()[0] == "Z")


def test_the_work_has_the_terminal() -> None:
    pty = pytest.importorskip("pty")
    ours, theirs = pty.openpty()
    with open(theirs, "r+b", buffering=0) as terminal:
        status = start(
            "sys.exit(40 + sys.stdin.isatty() + sys.stdout.isatty() + sys.stderr.isatty())",
            stdin=terminal, stdout=terminal, stderr=terminal,
        ).wait(LONG)  # fmt: skip
    os.close(ours)
    assert status == 43


def test_without_a_guard_nothing_is_watched(tmp_path: Path) -> None:
    from unisg_blender.runtime import guarded_work

    with guarded_work.reading(tmp_path / "a.usda"):
        guarded_work.still_reading()
