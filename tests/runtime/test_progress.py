"""The progress bar of batches."""

from __future__ import annotations

import io

from unisg_blender.runtime.progress import Progress


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def test_shows_count_failures_and_lines_above() -> None:
    terminal = Terminal()
    bar = Progress(0, "files", stream=terminal)
    bar.start(2)
    bar.write("a.blend: complete")
    bar.update(2, failed=1)
    bar.close()
    assert "a.blend: complete\n" in terminal.getvalue()
    last = terminal.getvalue().split("\r")[-1]
    assert "2/2" in last
    assert "failed=1" in last


def test_quiet_prints_nothing() -> None:
    silent = io.StringIO()
    bar = Progress(1, "files", quiet=True, stream=silent)
    bar.start(1)
    bar.update(1)
    bar.write("nothing")
    bar.close()
    assert silent.getvalue() == ""
