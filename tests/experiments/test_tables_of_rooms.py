"""From measurements to the numbers of a table: shares, medians, intervals, paired tests; told by hand."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import wilcoxon

pytest.importorskip("sklearn")
pytest.importorskip("torch")

from unisg_blender.experiments.rooms import own_rooms
from unisg_blender.experiments.rooms.benchmark_columns import Measured, TableRow, row_of
from unisg_blender.experiments.rooms.completion import Completed
from unisg_blender.experiments.rooms.generation_report import _values, table
from unisg_blender.experiments.rooms.own_rooms import BOOTSTRAP, MODEL, TRUTH, OwnRoomsRun
from unisg_blender.experiments.rooms.place_scores import SCORES
from unisg_blender.experiments.rooms.room_measures import COUNTS, joined, split_ragged
from unisg_blender.metrics.two_sample_test import LEVELS, NOISES

KEYS = [f"{level} {noise}" for level in LEVELS for noise in NOISES]
SCENES = 12


def measured(shift: float = 0.0, judged: bool = True, completed: bool = True) -> Measured:
    rng = np.random.default_rng(0)
    counts = np.column_stack([np.full(SCENES, n) for n in (10, 1, 2, 3, 4, 20, 5)]).astype(float)
    counts[0, 1] = 7
    completion = np.full((SCENES, 7), np.nan)
    if completed:
        completion[:, :6] = rng.random((SCENES, 6)) + shift
        completion[3, 0] = np.nan
    found = {"counts": counts, "milliseconds": np.arange(SCENES, dtype=float), "completion": completion}
    right = {key: np.tile([1.0, 0.0, 1.0, 1.0], 6) for key in KEYS} if judged else {}
    return Measured(found, right, np.linspace(0.1, 1.2, SCENES) + shift, 0.6 + shift, 0.8)


def test_a_line_has_the_shares_and_middles_of_its_seeds() -> None:
    assert COUNTS[:1] == ("objects",)
    one, two, real = measured(0.0), measured(0.5), measured(0.2)
    both = [one, two]
    row = row_of("mine", both, real, both)
    values = row.values
    assert (row.name, row.seeds, row.scenes, row.objects) == ("mine", 2, SCENES, 240)
    assert values["colliding"] == pytest.approx((7 + 11) / 120)
    assert values["overlapping"] == pytest.approx(0.2)
    assert values["outside"] == pytest.approx(0.4)
    assert values["refused"] == pytest.approx(0.25)
    assert values["milliseconds"] == pytest.approx(np.median(np.arange(SCENES)))
    assert values["c2st_objects_0.03"] == pytest.approx(0.75)
    assert values["diversity"] == pytest.approx((0.6 + 1.1) / 2 / 0.8)
    assert values["behaviour"] == pytest.approx(0.8)
    column = one.found["completion"]
    assert values["completion_cm"] == pytest.approx(np.nanmedian(column[:, 0]) + 0.25)
    assert values["parent_same"] == pytest.approx(column[:, Completed.FIELDS.index("same_support")].mean() + 0.25)
    assert np.isnan(values["nll"])
    assert row.spread["completion_cm"] == pytest.approx(np.std([0, 0.5], ddof=1))
    assert "p_model_better" not in values
    limit = np.quantile(real.nearest, 0.05)
    assert values["novelty"] == pytest.approx(np.mean([(each.nearest > limit).mean() for each in (one, two)]))
    low, high = row.interval["colliding"]
    assert 0.1 <= low < values["colliding"] < high < 0.3
    assert row.interval["overlapping"] == pytest.approx((0.2, 0.2))
    assert row.interval["completion_cm"][0] < values["completion_cm"] < row.interval["completion_cm"][1]
    assert row.interval["c2st_objects_0.03"] == pytest.approx((0.5, 1.0), abs=0.3)


def test_who_is_nearer_is_tested_in_pairs() -> None:
    ours, theirs = measured(0.0), measured(0.5)
    p = row_of("theirs", [theirs], measured(0.2), [ours]).values["p_model_better"]
    errors = [np.delete(each.found["completion"][:, 0], 3) for each in (ours, theirs)]
    assert p == pytest.approx(wilcoxon(errors[0], errors[1], alternative="less").pvalue)
    more = row_of("theirs", [theirs], measured(0.2), [ours, ours]).values["p_model_better"]
    assert more == pytest.approx(p)
    worse = row_of("theirs", [ours], measured(0.2), [theirs]).values["p_model_better"]
    assert worse > 0.9


def test_rows_of_different_rooms_are_not_paired() -> None:
    """A model that knows nothing in a room leaves it out, so its errors are of other rooms than those beside them."""
    ours, theirs = measured(0.0), measured(0.5)
    fewer = replace(ours, found={name: rows[1:] for name, rows in ours.found.items()})
    for mine, other in (([fewer], [theirs]), ([ours], [fewer]), ([fewer, fewer], [theirs])):
        assert "p_model_better" not in row_of("theirs", other, measured(0.2), mine).values


def test_what_does_not_apply_is_left_out() -> None:
    bare = measured(judged=False, completed=False)
    bare = Measured(bare.found | {"milliseconds": np.full(SCENES, np.nan)}, {}, np.zeros(SCENES), 0.6)
    bare.found["counts"][:, COUNTS.index("asked")] = 0
    row = row_of("bare", [bare], measured(0.2), [measured()])
    record = row.to_record()
    for name in ("refused", "milliseconds", "novelty", "behaviour", "completion_cm", "nll"):
        assert name not in record["values"]
    assert "novelty" not in row.values
    assert set(record["interval"]) == {"colliding", "overlapping", "off_support", "outside"}
    assert record["spread"] == {}


def test_the_table_has_percent_and_spreads() -> None:
    values = {"colliding": 0.1234, "p_model_better": 0.01, "diversity": 1.0}
    spread = {"colliding": 0.011, "diversity": 0.001, "p_model_better": 0.5}
    row = TableRow("mine", 2, 3, 40, values, spread, {"colliding": (0.1, 0.2)})
    other = TableRow("real", 1, 3, 40, {"colliding": 0.0})
    head, _, first, second = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in table([row, other]).splitlines()
    ]
    assert head == ["", "seeds x scenes", "collide %", "diversity", "p (model better)"]
    assert first == ["mine", "2 x 3", "12.3 ± 1.1", "1.00", "0.0100"]
    assert second == ["real", "1 x 3", "0.0", "", ""]
    lines = list(_values(row))
    assert lines[0] == {"row": "mine", "seeds": 2, "scenes": 3, "objects": 40, "value": "colliding", "mean": 0.1234,
                        "spread": 0.011, "low": 0.1, "high": 0.2}  # fmt: skip
    assert (lines[1]["low"], lines[1]["high"]) == ("", "")


def test_lots_of_rooms_are_joined_with_their_numbers() -> None:
    lot = {"counts": np.zeros((3, 7)), "scene": np.ones((3, 2)), "objects": np.array([[0, 5.0], [2, 6], [2, 7]])}
    both = joined([lot, lot])
    assert [part[:, 0].tolist() for part in split_ragged(both["objects"], 6)] == [[5], [], [6, 7], [5], [], [6, 7]]
    assert len(both["counts"]) == 6


def run(kind: str, seed: int) -> OwnRoomsRun:
    groups = ["floor", "floor", "hung", "on things"] * 5
    items: list[Any] = [
        SimpleNamespace(group=group, room=k // 4, category="ab"[k % 2]) for k, group in enumerate(groups)
    ]
    return OwnRoomsRun(kind, seed, [], items)


def scores(factor: float, seed: int) -> np.ndarray:
    found = np.random.default_rng(seed).uniform(1, 2, (20, len(SCORES))) * factor
    found[2::4, SCORES.index("facing")] = np.nan
    return found


def test_lines_of_own_rooms_are_means_by_group_and_shares_of_the_bootstrap() -> None:
    base = scores(1.0, 1)
    lines = list(own_rooms._lines(run("kitchen", 3), {BOOTSTRAP: base, MODEL: base * 0.8}))
    assert [(line["way"], line["group"], line["things"]) for line in lines] == [
        (way, group, count) for way in (BOOTSTRAP, MODEL)
        for group, count in (("floor", 10), ("hung", 5), ("on things", 5), ("all", 20))
    ]  # fmt: skip
    assert {line["share"] for line in lines[:4]} == {1.0}
    assert {line["share"] for line in lines[4:]} == {0.8}
    mine = lines[4]
    rows = np.isin(np.arange(20) % 4, (0, 1))
    assert mine["metres"] == pytest.approx(0.8 * base[rows, SCORES.index("metres")].mean(), abs=1e-4)
    assert lines[5]["facing"] == ""
    assert (mine["rooms"], mine["seed"]) == ("kitchen", 3)


def test_the_summary_has_intervals_over_rooms_and_paired_tests() -> None:
    base, truth = scores(1.0, 1), scores(0.5, 2)
    truth[:, 0] = np.nan
    found = [(run(kind, seed), {BOOTSTRAP: base, MODEL: base * 0.8 + 0.01 * scores(1, 3), TRUTH: truth})
             for kind, seed in (("bath", 0), ("kitchen", 1))]  # fmt: skip
    lines = list(own_rooms._summary(found))
    every = {(line["rooms"], line["way"], line["group"]): line for line in lines}
    assert len(lines) == 3 * 3 * 4 == len(every)
    assert every["every", MODEL, "all"]["things"] == 40
    assert every["bath", MODEL, "hung"]["things"] == 5
    line = every["every", MODEL, "all"]
    assert line["low"] <= line["share"] <= line["high"]
    assert 0.8 < line["share"] < 0.85
    assert line["p_ours_nearer"] == ""
    other = every["bath", BOOTSTRAP, "floor"]
    ours = found[0][1][MODEL]
    rows = np.isin(np.arange(20) % 4, (0, 1))
    expected = wilcoxon(ours[rows, 0], base[rows, 0], alternative="less").pvalue
    assert other["p_ours_nearer"] == pytest.approx(expected, rel=0.06)
    assert (other["low"], other["share"], other["high"]) == (1.0, 1.0, 1.0)
    alone = every["kitchen", TRUTH, "all"]
    assert (alone["share"], alone["low"], alone["p_ours_nearer"], alone["energy"]) == ("", "", "", "")


def test_categories_have_the_energies_of_both_ways(tmp_path: Any) -> None:
    base = scores(1.0, 1)
    lines = list(own_rooms._categories([(run("bath", 0), {BOOTSTRAP: base, MODEL: base * 0.5})]))
    assert [(line["category"], line["things"]) for line in lines] == [("a", 10), ("b", 10)]
    assert lines[0][BOOTSTRAP] == pytest.approx(base[::2, 0].mean(), abs=1e-4)
    assert lines[1][MODEL] == pytest.approx(base[1::2, 0].mean() / 2, abs=1e-4)
    own_rooms._write(tmp_path / "x.csv", lines)
    assert [row["things"] for row in csv.DictReader(io.StringIO((tmp_path / "x.csv").read_text()))] == ["10", "10"]
