"""What is printed while Blender works is kept out of our own output, whoever prints it and wherever to."""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path

import pytest

from unisg_blender.runtime.output_capture import captured_output, heard


def test_what_is_printed_is_caught_where_the_streams_are_no_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a notebook, where Python's streams go over a socket, while C prints into a file."""
    for name in ("stdout", "stderr"):
        monkeypatch.setattr(sys, name, io.StringIO())
    with captured_output() as lines:
        print("by Python")
        print("as an error", file=sys.stderr)
        os.write(1, b"by C\n")
    assert lines == ["by Python", "as an error", "by C"]
    print("after")
    assert (sys.stdout.getvalue(), sys.stderr.getvalue()) == ("after\n", "")  # type: ignore[attr-defined]


@pytest.mark.parametrize("notebook", [False, True])
def test_progress_is_heard(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, notebook: bool) -> None:
    with open(tmp_path / "words", "w") as words:
        kept = os.dup(2)
        try:
            os.dup2(words.fileno(), 2)
            stream = io.StringIO() if notebook else open(2, "w", closefd=False)  # noqa: SIM115
            monkeypatch.setattr(sys, "stderr", stream)
            with captured_output() as lines:
                print("noise", file=sys.stderr)
                heard(lambda done, total: print(f"{done} of {total}", file=sys.stderr))(1, 2)
                print("more noise", file=sys.stderr)
            stream.flush()
        finally:
            os.dup2(kept, 2)
            os.close(kept)
    told = stream.getvalue() if isinstance(stream, io.StringIO) else (tmp_path / "words").read_text()
    assert told == "1 of 2\n"
    assert lines == ["noise", "more noise"]
