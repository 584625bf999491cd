"""core.measured.outliers: in tables of a smooth lift every wrong run is named and no right row is, or the table is refused."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from measured_tables import LAWS, WrongTable, position, wrong_table
from mechanisms import levels
from sampled import spread

from core.__main__ import main
from core.design import Motion
from core.measured import FitError, MeasuredTable, fit, layout, read_sheet, read_table
from core.measured.outliers import Outliers, outliers
from core.output.measured_text import notes

SEEDED, MANY = 5, 1000
MOST_REFUSED = 0.02  # of the tables
LIFT = levels(
    0.0, (60.0, 0.0, "dwell"), (80.0, 9.0, "cycloidal"), (60.0, 9.0, "dwell"), (100.0, 0.0, "modified-sine"), (60.0, 0.0, "dwell")
)  # fmt: skip
ERROR = 0.01


def read(text: str) -> MeasuredTable:
    sheet = read_sheet(text.encode(), "lift.csv", "comma", "point")
    return read_table(sheet, layout(sheet))


def lift(rows: int = 360, motion: Motion = LIFT, error: float = ERROR) -> tuple[np.ndarray, np.ndarray]:
    """Cam angles [deg] and measured values [mm]."""
    angles = 360.0 * np.arange(rows) / rows
    return angles, position(motion, angles) + error * np.random.default_rng(4).normal(size=rows)


def written(angles: np.ndarray, values: np.ndarray) -> str:
    rows = zip(angles.tolist(), values.tolist(), strict=True)
    return "angle [deg],lift [mm]\n" + "".join(f"{a!r},{v!r}\n" for a, v in rows)


# -- wrong runs in seeded tables --------------------------------------------------------------------------


def faults(table: WrongTable, found: Outliers) -> list[str]:
    """What an answer has wrong: right rows named, runs and rows missed."""
    if found.undecided:
        return []
    named, open_rows = set(found.wrong), set(found.possible)
    told = [f"right rows named: {sorted(named - set(np.flatnonzero(table.wrong).tolist()))}"]
    clear = set(np.flatnonzero(table.beyond_doubt()).tolist())
    told.append(f"rows missed: {sorted(clear - named - open_rows)}")
    told += [
        f"run missed: {rows}" for rows in table.runs if clear & set(rows.tolist()) and not named & set(rows.tolist())
    ]
    return [line for line in told if not line.endswith("[]")]


def judged(seeds: Sequence[int]) -> tuple[dict[int, list[str]], int]:
    """The seeds at fault with what is, and how many tables are refused."""
    wrong, refused = {}, 0
    for seed in seeds:
        table = wrong_table(seed)
        found = outliers(read(table.text(table.values)), table.error)
        refused += bool(found.undecided)
        told = faults(table, found)
        clean = outliers(read(table.text(table.right)), table.error) if seed % 5 == 0 else Outliers()
        if told or clean != Outliers():
            wrong[seed] = [*table.shapes, *told, str(clean)]
    return wrong, refused


def test_every_wrong_run_is_named_and_no_right_row_is() -> None:
    wrong, refused = judged(range(SEEDED))
    assert wrong == {}
    assert refused <= max(2.0, MOST_REFUSED * SEEDED)


@pytest.mark.stress
def test_every_wrong_run_of_a_thousand_tables_is_named_and_no_right_row_is() -> None:
    wrong, refused = judged(range(MANY))
    assert wrong == {}
    assert refused <= MOST_REFUSED * MANY


@pytest.mark.parametrize("seed", [67, 1472])
def test_right_rows_between_two_wrong_places_are_not_named(seed: int) -> None:
    """Thirteen rows between spikes, nine between a held value and a zero: one run of 15 would explain both places."""
    table = wrong_table(seed)
    assert faults(table, outliers(read(table.text(table.values)), table.error)) == []


def test_two_zeros_side_by_side_are_named_and_the_stroke_is_right(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    angles, values = lift()
    values[[100, 101]] = 0.0
    (tmp_path / "lift.csv").write_text(written(angles, values), "utf-8")
    assert main(["measured", str(tmp_path / "lift.csv"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["suspects"] == told["left_out"] == [102, 103]
    assert told["fit"]["stroke_mm"] == pytest.approx(9.0, abs=0.02)
    assert main(["measured", str(tmp_path / "lift.csv"), "--error", str(ERROR)]) == 0
    assert "lines 102-103: wrong, no smooth curve joins them" in capsys.readouterr().out


@pytest.mark.parametrize("rows", spread([48, 120, 3600], 1))
def test_tables_of_other_lengths_have_their_wrong_runs_named(rows: int) -> None:
    angles, values = lift(rows)
    start, length = rows // 4, 1 if rows < 100 else rows // 60
    wrong = tuple(range(start, start + min(length, 15)))
    values[list(wrong)] += 2.0
    assert outliers(read(written(angles, values)), ERROR).wrong == wrong


def test_rows_in_any_order_and_turns_laid_over_each_other_are_judged_too() -> None:
    angles, values = lift()
    values[50:53] = 7.0
    order = np.random.default_rng(1).permutation(360)
    found = outliers(read(written(angles[order], values[order])), ERROR)
    assert sorted(order[list(found.wrong)].tolist()) == [50, 51, 52]
    twice = np.concatenate((angles, angles + 360.0))
    both = np.concatenate((values, lift()[1]))
    assert outliers(read(written(twice, both)), ERROR).wrong == (50, 51, 52)


@pytest.mark.parametrize("rows", [24, 120, 360])
@pytest.mark.parametrize("law", spread([*LAWS, "constant-velocity", "double-harmonic"], 5))
def test_the_joins_of_a_law_are_no_wrong_rows(law: str, rows: int) -> None:
    motion = levels(0.0, (100.0, 0.0, "dwell"), (35.0, 20.0, law), (80.0, 20.0, "dwell"), (145.0, 0.0, law))
    angles = 360.0 * (np.arange(rows) + 0.3) / rows
    for error in (0.0, 1e-4):
        assert outliers(read(written(angles, position(motion, angles))), error) == Outliers()


# -- where the data cannot tell ---------------------------------------------------------------------------

STEPS = {
    "a third of the turn": (slice(120, 240), 0.5, "lines 1"),
    "twenty rows": (slice(120, 140), 0.5, "lines 1"),
    "a drift over the turn": (slice(0, 360), np.arange(360) / 1200.0, "lines 2"),
}


@pytest.mark.parametrize("rows", [360, 361])
def test_a_table_that_does_not_come_back_says_so(rows: int) -> None:
    """A step of 100 mm a turn, with the row that ends it or without."""
    angles = np.arange(float(rows))
    table = read(written(angles, 100.0 * (angles / 360.0 - np.sin(2.0 * np.pi * angles / 360.0) / (2.0 * np.pi))))
    end = rf"line {rows + 1}, where the turn ends, is 100 mm from line 2, where it starts: a measured motion must"
    with pytest.raises(FitError, match=end):
        fit(table, ERROR)


@pytest.mark.parametrize("case", spread(STEPS, 1))
def test_a_step_with_no_wrong_side_is_refused(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    where, by, lines = STEPS[case]
    angles, values = lift()
    values[where] += by
    table = read(written(angles, values))
    with pytest.raises(
        FitError,
        match=f"^{lines}.*: they contradict each other, and it cannot be decided which of them are wrong.*; correct",
    ):
        fit(table, ERROR)
    (tmp_path / "lift.csv").write_text(written(angles, values), "utf-8")
    assert main(["measured", str(tmp_path / "lift.csv"), "--error", str(ERROR)]) == 2
    told = capsys.readouterr()
    assert (told.out, told.err.count("\n")) == ("", 1)


@pytest.mark.stress
def test_both_readings_of_two_steps_are_shown_and_either_can_be_chosen(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The rows between them or all others, the fewest first; nothing is chosen until their lines are left out."""
    angles, values = lift()
    values[120:140] += 0.5
    path = tmp_path / "lift.csv"
    path.write_text(written(angles, values), "utf-8")
    assert main(["measured", str(path), "--error", str(ERROR)]) == 2
    assert "wrong: lines 122-141 (20 rows) or lines 2-121, 142-361 (340 rows) may be" in capsys.readouterr().err
    assert main(["measured", str(path), "--error", str(ERROR), "--leave-out", "122-141", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["fit"]["stroke_mm"] == pytest.approx(9.0, abs=0.02)
    assert main(["measured", str(path), "--error", str(ERROR), "--keep-all", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["readings"] == [[*range(122, 142)], [*range(2, 122), *range(142, 362)]]


@pytest.mark.parametrize("first", [42, 75])
def test_a_run_one_row_longer_than_is_tested_is_refused_whole(
    first: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of 180 rows runs of 7 are tested: where two rows of eight were named, the motion came to many strokes."""
    angles, values = lift(180, error=0.001)
    values[first : first + 8] = 0.0
    path = tmp_path / "lift.csv"
    path.write_text(written(angles, values), "utf-8")
    assert main(["measured", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"lines {first + 2}-{first + 9}: they contradict each other")
    assert told.count("\n") == 1


@pytest.mark.stress
def test_a_step_with_no_wrong_side_is_fitted_with_the_others_where_all_are_kept() -> None:
    where, by, _ = STEPS["twenty rows"]
    angles, values = lift()
    values[where] += by
    table = read(written(angles, values))
    for found in (fit(table, ERROR, keep_all=True), fit(table, 0.0)):
        assert (found.left_out, found.outliers.wrong) == ((), ())
        assert any("they contradict each other" in note and "fitted with the others" in note for note in notes(found))
    assert fit(table, 0.2).left_out == (), "a larger error covers it"


def test_a_value_held_into_a_dwell_may_be_the_dwell_and_is_refused() -> None:
    """The last rows of a slow return stand 0.15 mm high until the dwell: a stop there and a fall would look the same."""
    motion = levels(
        0.0, (120.0, 0.0, "dwell"), (90.0, 6.0, "modified-sine"), (60.0, 6.0, "dwell"), (90.0, 0.0, "cycloidal")
    )
    angles = np.arange(0.0, 360.0)
    values = np.round(position(motion, angles), 2)
    values[344:359] = values[344]
    with pytest.raises(FitError, match="it cannot be decided which of them are wrong"):
        fit(read(written(angles, values)), 0.005)


def test_rows_off_by_less_than_the_error_are_not_judged() -> None:
    angles, values = lift()
    values[100:115] += 0.5 * ERROR
    assert outliers(read(written(angles, values)), ERROR) == Outliers()
    values[100:115] += 0.5
    assert outliers(read(written(angles, values)), ERROR).wrong == tuple(range(100, 115))


def test_rows_that_may_belong_to_a_wrong_run_are_left_out_and_told_apart() -> None:
    """A value held where the lift begins: the first of these rows are hardly off."""
    angles, values = lift()
    values[63:78] = values[62]
    found = fit(read(written(angles, values)), ERROR)
    assert set(found.outliers.wrong) <= set(range(63, 78))
    assert found.outliers.possible
    assert found.left_out == tuple(sorted(found.outliers.wrong + found.outliers.possible))
    assert any("possibly wrong too" in note for note in notes(found))
