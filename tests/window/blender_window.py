"""A real Blender in a window of a virtual screen: it runs Python, is clicked and typed into, and pictures are taken.

Needs Xvfb, xdotool and ImageMagick's ``import``. ``UNISG_BLENDER`` is the command that starts Blender; where it sees
another file system, ``UNISG_WINDOW_FOLDER=HERE:THERE`` is a folder that both see, and where.
"""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

PROGRAMS = ("Xvfb", "xdotool", "import")
SIZE = (1400, 900)
PATIENCE = 120.0
"""Seconds that one waits for something to happen."""

HELD = 0.5
"""Seconds before and after a click: a window that is drawn by the processor has a few frames a second."""

DRIVER = """
import bpy, json, os, sys, traceback
folder = sys.argv[-1]
bpy.context.preferences.view.show_splash = False

def obey():
    path = os.path.join(folder, "command.py")
    if os.path.exists(path):
        with open(path) as file:
            source = file.read()
        os.remove(path)
        names = {"bpy": bpy, "result": None}
        try:
            exec(source, names)
            answer = {"result": names["result"]}
        except Exception:
            answer = {"error": traceback.format_exc()}
        with open(os.path.join(folder, "answer.tmp"), "w") as file:
            json.dump(answer, file)
        os.replace(os.path.join(folder, "answer.tmp"), os.path.join(folder, "answer.json"))
    return 0.05

bpy.app.timers.register(obey, first_interval=0.5, persistent=True)
"""

IN_VIEWPORT = """
window = bpy.context.window_manager.windows[0]
area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
region = next(region for region in area.regions if region.type == "WINDOW")
with bpy.context.temp_override(window=window, area=area, region=region):
"""


DRAW = """
for window in bpy.context.window_manager.windows:
    with bpy.context.temp_override(window=window):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
"""
"""Draw all of it now: a machine that is busy takes seconds for it."""


def missing_tools() -> str:
    """What is not there that these tests need, "" if nothing is missing."""
    lacking = [name for name in PROGRAMS if not shutil.which(name)]
    if lacking:
        return f"{', '.join(lacking)} not found: apt-get install xvfb xdotool imagemagick"
    command = shlex.split(os.environ.get("UNISG_BLENDER", ""))
    if not command:
        return "UNISG_BLENDER names no Blender: use `make test-window BLENDER=/path/to/blender`"
    return "" if shutil.which(command[0]) else f"{command[0]} not found"


def window_folder(temporary: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder that Blender sees too, without anything installed there, and how it is called inside."""
    here, _, inside = os.environ.get("UNISG_WINDOW_FOLDER", "").partition(":")
    folder = Path(here or temporary.mktemp("window")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(folder / "resources", ignore_errors=True)
    return folder, inside or str(folder)


class BlenderWindow:
    """A Blender that runs."""

    def __init__(self, folder: Path, inside: str, display: str) -> None:
        self.folder, self.inside, self.screen = folder, inside, display

    @property
    def environment(self) -> dict[str, str]:
        return {**os.environ, "DISPLAY": self.screen, "BLENDER_USER_RESOURCES": f"{self.inside}/resources"}

    def run(self, source: str) -> Any:
        """Run Python inside; what it leaves in ``result`` comes back, an error fails the test."""
        answer = self.folder / "answer.json"
        answer.unlink(missing_ok=True)
        (self.folder / "command.tmp").write_text(source, encoding="utf-8")
        (self.folder / "command.tmp").rename(self.folder / "command.py")
        end = time.monotonic() + PATIENCE
        while not answer.exists():
            assert time.monotonic() < end, f"Blender does not answer: {source}"
            time.sleep(0.05)
        reply = json.loads(answer.read_text("utf-8"))
        assert "error" not in reply, reply.get("error")
        return reply["result"]

    def in_viewport(self, source: str) -> Any:
        """The same with the viewport as context."""
        return self.run(IN_VIEWPORT + "\n".join(f"    {line}" for line in source.splitlines()))

    def wait(self, condition: str) -> None:
        """Until an expression is true inside."""
        end = time.monotonic() + PATIENCE
        while not self.run(f"result = bool({condition})"):
            assert time.monotonic() < end, f"never true: {condition}"
            time.sleep(0.2)

    def move(self, x: int, y: int) -> None:
        """Move the mouse to a pixel of the window; twice, for Blender must see it come."""
        for off in (1, 0):
            self._x("xdotool", "mousemove", str(x + off), str(y))
            time.sleep(0.3)

    def click(self, button: int = 1, *, shift: bool = False) -> None:
        """Click where the mouse is; buttons 4 and 5 are the wheel. Shift is held until Blender has seen the click."""
        if shift:
            self._x("xdotool", "keydown", "shift")
            self.run("")
            time.sleep(HELD)
        self._x("xdotool", "click", str(button))
        time.sleep(HELD)
        if shift:
            self.run("")
            time.sleep(HELD)
            self._x("xdotool", "keyup", "shift")

    def key(self, name: str) -> None:
        """Press a key, such as "ctrl+z"."""
        self._x("xdotool", "key", name)
        time.sleep(0.5)

    def type(self, text: str) -> None:
        """Type a text, and Enter."""
        self._x("xdotool", "type", "--delay", "80", text)
        time.sleep(0.5)
        self.key("Return")

    def picture(self, name: str) -> np.ndarray:
        """What is on the screen, (H, W, 3) from 0 to 255; kept as NAME.png."""
        from PIL import Image

        self.run(DRAW)
        time.sleep(1.0)
        path = self.folder / f"{name}.png"
        self._x("import", "-window", "root", str(path))
        return np.asarray(Image.open(path).convert("RGB")).astype(np.int16)

    def _x(self, *command: str) -> None:
        subprocess.run(command, env=self.environment, check=True, capture_output=True, timeout=60)


@contextlib.contextmanager
def blender_window(folder: Path, inside: str, size: tuple[int, int] = SIZE) -> Iterator[BlenderWindow]:
    """A Blender in a window, with the preferences of ``folder/resources``; ``inside`` is the folder as it sees it."""
    (folder / "driver.py").write_text(DRIVER, encoding="utf-8")
    for name in ("command.py", "answer.json"):
        (folder / name).unlink(missing_ok=True)
    width, height = map(str, size)
    screen, display = _free_screen(size)
    window = BlenderWindow(folder, inside, display)
    try:
        command = [*shlex.split(os.environ["UNISG_BLENDER"]), "--window-geometry", "0", "0", width, height]
        command += ["--python", f"{inside}/driver.py", "--", inside]
        with (folder / "blender.log").open("w") as log:
            blender = subprocess.Popen(command, stdout=log, stderr=log, env=window.environment)
        try:
            window.wait("True")
            yield window
            window.run("bpy.app.timers.register(bpy.ops.wm.quit_blender, first_interval=0.2)")
            assert blender.wait(60) == 0, "Blender does not end in peace"
        finally:
            _end(blender)
    finally:
        _end(screen)


def _free_screen(size: tuple[int, int]) -> tuple[subprocess.Popen[bytes], str]:
    """A virtual screen that nobody else has, and its name."""
    reading, writing = os.pipe()
    pixels = f"{size[0]}x{size[1]}x24"
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", pixels, "-nolisten", "tcp"]
    screen = subprocess.Popen(command, pass_fds=[writing])
    os.close(writing)
    with os.fdopen(reading) as said:
        number = said.readline().strip()
    assert number, "Xvfb does not start"
    return screen, f":{number}"


def _end(process: subprocess.Popen[bytes]) -> None:
    if process.poll() is None:
        process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(10)


def build_zip(folder: Path, inside: str) -> None:
    """Build the extension for that Blender: ``folder/extension.zip``."""
    command = shlex.split(os.environ["UNISG_BLENDER"])
    say = "import bpy, sys; print('SAYS', *bpy.app.version, *sys.version_info[:2])"
    environment = {**os.environ, "BLENDER_USER_RESOURCES": f"{inside}/resources"}
    said = subprocess.run(
        [*command, "-b", "--python-expr", say], capture_output=True, text=True, env=environment, timeout=300
    ).stdout
    words = next((line.split()[1:] for line in said.splitlines() if line.startswith("SAYS")), None)
    if words is None:
        pytest.fail(f"Blender did not start: {said}")
    version, python = ".".join(words[:3]), ".".join(words[3:])
    root = Path(__file__).resolve().parents[2]
    build = ["--platform", "linux-x64", "--python", python, "--blender", version, "--out", str(folder / "zip")]
    subprocess.run([sys.executable, str(root / "packaging/build_extension.py"), *build], check=True, timeout=900)
    (zipped,) = (folder / "zip").glob("*.zip")
    shutil.move(zipped, folder / "extension.zip")


def install(folder: Path, inside: str) -> None:
    """Build the extension for that Blender, and install its zip from the command line."""
    build_zip(folder, inside)
    done = subprocess.run(
        [*shlex.split(os.environ["UNISG_BLENDER"]), "-b", "--command", "extension", "install-file", "-r",
         "user_default", "--enable", f"{inside}/extension.zip"], capture_output=True, text=True, timeout=300,
        env={**os.environ, "BLENDER_USER_RESOURCES": f"{inside}/resources"},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
