from __future__ import annotations

import pytest

from unisg_blender.runtime.read_report import Loss, ReadReport
from unisg_blender.runtime.wording import first_lines, grouped, some_of


def test_lists_are_cut_short_and_say_so() -> None:
    assert some_of("abc") == "a, b, c"
    assert some_of("abcde") == "a, b, c and 2 more"


@pytest.mark.parametrize(("limit", "expected"), [(0, ["a", "b", "c"]), (3, ["a", "b", "c"]), (1, ["a", "... and 2 x"])])
def test_lines_beyond_the_limit_are_counted(limit: int, expected: list[str]) -> None:
    assert first_lines(["a", "b", "c"], limit, "x") == expected


def test_notes_are_grouped_by_kind_with_their_details() -> None:
    notes = [(f"Crate.{number}", f"settings: Colour, Depth {number % 2}") for number in range(500)]
    notes += [("Lamp", "no light"), ("", "text blocks"), ("Lamp", "no light")]
    assert grouped(notes) == [
        "settings: Colour, Depth 0, Depth 1 (500 objects: Crate.0, Crate.1, Crate.2 and 497 more)",
        "Lamp: no light",
        "text blocks",
    ]


def test_a_report_holds_everything_and_tells_it_shortly() -> None:
    report, other = ReadReport(), ReadReport()
    for number in range(500):
        report.add(f"Crate.{number}", "textures are not read")
        other.add(f"Crate.{number}", f"damage {number}")
    report.extend(other)
    assert len(list(report)) == len(report) == 1000
    assert len(report.lines()) == 501
    assert report.summary(most=1) == "textures are not read (500 objects); and 500 more kinds of loss"


def test_a_warning_names_the_first_only() -> None:
    loss = Loss("textures are not read", [f"/Crate{number}" for number in range(9)])
    assert str(loss) == "textures are not read: /Crate0, /Crate1, /Crate2 and 6 more"
    assert len(loss.names) == 9
