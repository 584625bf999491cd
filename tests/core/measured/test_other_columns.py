"""core.measured: a table of displacement, velocity and acceleration; what is left of each is said apart."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mechanisms import levels
from sampled import spread

from core.__main__ import main
from core.measured import MotionFit, fit, layout, read_sheet, read_table
from core.motion import program
from core.output.measured_text import fit_data, notes

ANGLES = np.arange(0.0, 360.0)
RPM = 60.0
TURN = np.deg2rad(ANGLES)
LIFT, PER_DEGREE = 5.0 * (1.0 - np.cos(TURN)), 5.0 * np.sin(TURN) * np.pi / 180.0
PER_SECOND = 5.0 * np.cos(TURN) * (2.0 * np.pi * RPM / 60.0) ** 2
HEADER = "angle [deg],s [mm],v [mm/deg],a [mm/s2]"
AWRY, OFF = 100, 12.5  # row and its error [mm/s²]


def text(acceleration: np.ndarray, header: str = HEADER) -> str:
    rows = zip(ANGLES, LIFT, PER_DEGREE, acceleration, strict=True)
    return "\n".join([header, *(",".join(f"{cell:.12g}" for cell in row) for row in rows)])


def fitted(written: str, rpm: float | None = RPM) -> MotionFit:
    sheet = read_sheet(written.encode(), "all.csv")
    return fit(read_table(sheet, layout(sheet, speed_rpm=rpm), rpm), 0.0)


@pytest.fixture(scope="module")
def awry() -> MotionFit:
    return fitted(text(PER_SECOND + OFF * (np.arange(ANGLES.size) == AWRY)))


def test_a_row_whose_acceleration_is_off_is_named_with_its_column(awry: MotionFit) -> None:
    assert [each.column.quantity for each in awry.columns] == ["displacement", "velocity", "acceleration"]
    _, velocity, acceleration = awry.columns
    assert np.abs(velocity.residuals).max() < 1e-6 * np.abs(PER_DEGREE).max()
    assert acceleration.largest == AWRY
    assert acceleration.residuals[AWRY] == pytest.approx(OFF, rel=0.02)
    (told,) = (note for note in notes(awry) if note.startswith("column 4"))
    assert f": line {AWRY + 2}: wrong, " in told


LIFTED = levels(
    0.0, (60.0, 0.0, "dwell"), (80.0, 9.0, "modified-sine"), (60.0, 9.0, "dwell"), (100.0, 0.0, "modified-sine"), (60.0, 0.0, "dwell")
)  # fmt: skip
OFFSETS = {"v": 0.05, "a": 0.02}  # mm/deg, mm/deg²


@pytest.mark.parametrize("letter", spread(OFFSETS, 2))
@pytest.mark.parametrize(("first", "count"), [(100, 2), (243, 5), (352, 13), (133, 13)])
def test_a_run_of_spoiled_rows_is_named_and_the_laws_stay(letter: str, first: int, count: int) -> None:
    """Inside the strokes, over the end of one, and over cam angle 0; no other row is named."""
    compiled = program(LIFTED)
    y = compiled.state(compiled.angles(TURN)).y
    columns = np.array([y[k] * np.deg2rad(1.0) ** k / LIFTED.scale for k in range(3)])
    wrong = (first + np.arange(count)) % ANGLES.size
    columns["sva".index(letter), wrong] += OFFSETS[letter]
    rows = [f"{a:g},{s:.6f},{v:.6f},{b:.6f}" for a, s, v, b in zip(ANGLES, *columns, strict=True)]
    sheet = read_sheet("\n".join(["angle [deg],s [mm],v [mm/deg],a [mm/deg2]", *rows]).encode(), "all.csv")
    found = fit(read_table(sheet, layout(sheet)))
    assert [each.law for each in found.segments] == ["modified-sine", "dwell"] * 2
    data = fit_data(sheet, found)["spoiled"]
    assert sorted(each["line"] for each in data) == sorted((wrong + 2).tolist())
    for each in data:
        assert f"({letter} [" in each["column"]
        assert each["value"] - each["expected"] == pytest.approx(OFFSETS[letter], rel=1e-3)


def test_a_column_without_a_unit_by_time_without_a_speed_or_of_text_is_left_alone() -> None:
    def others(written: str, rpm: float | None = RPM) -> list[str]:
        return [each.column.quantity for each in fitted(written, rpm).columns[1:]]

    assert others(text(PER_SECOND), None) == ["velocity"]
    assert others(text(PER_SECOND, "angle [deg],s [mm],v,remark")) == []
    words = "\n".join([HEADER, *(f"{a},{s:.12g},none,{'x' if a else 0}" for a, s in zip(ANGLES, LIFT, strict=True))])
    assert others(words) == ["velocity", "acceleration"], "cells that are no number say nothing"


def test_the_command_says_of_every_column_what_is_left(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "all.csv"
    path.write_text(text(PER_SECOND), "utf-8")
    assert main(["measured", str(path), "--error", "0", "--speed", str(RPM)]) == 0
    out = capsys.readouterr().out
    assert "residual of velocity" in out
    assert "residual of acceleration" in out
    assert "are simple-harmonic within" in out


# -- columns that are not read, and cells that are no numbers ---------------------------------------------

COLUMNS = ["--columns", "s=2,v=3,a=4"]


def asked(path: Path, capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    assert main(["measured", str(path), "--json", *words]) == 0
    answer: dict[str, Any] = json.loads(capsys.readouterr().out)
    return answer


def test_columns_that_are_named_are_read_whatever_their_header_says(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without a unit they are by degrees, which is told; by time they want a speed, and are not left out in silence."""
    path, by_degrees = tmp_path / "all.csv", PER_SECOND / (6.0 * RPM) ** 2
    path.write_text(text(by_degrees, "angle [deg],one,two,three"), "utf-8")
    answer = asked(path, capsys, *COLUMNS)
    assert [each["unit"] for each in answer["columns"]] == ["mm", "mm/deg", "mm/deg2"]
    assert "column 3 (two) is assumed to be in mm/deg" in answer["notes"]
    path.write_text(text(PER_SECOND), "utf-8")
    answer = asked(path, capsys)
    assert [each["quantity"] for each in answer["columns"]] == ["displacement", "velocity"]
    assert any(note.startswith("column 4 (a [mm/s2]): rates by time; ") for note in answer["notes"])
    assert main(["measured", str(path), *COLUMNS]) == 2
    assert capsys.readouterr().err.endswith(
        "column 4 (a [mm/s2]): rates by time; the shaft's speed is required to read them\n"
    )


def test_a_cell_of_another_column_that_is_no_number_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, lines = tmp_path / "all.csv", text(PER_SECOND).splitlines()
    path.write_text("\n".join([*lines[:60], lines[60].rpartition(",")[0] + ",ERR", *lines[61:]]), "utf-8")
    words = ["--speed", f"{RPM:g}"]
    assert (
        "column 4 (a [mm/s2]), line 61: 'ERR' is no number; the cell is left out"
        in asked(path, capsys, *words)["notes"]
    )
    assert not any("ERR" in note for note in asked(path, capsys, *words, "--leave-out", "61")["notes"])


def test_a_table_of_ten_thousand_columns_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "wide.csv"
    path.write_text("\n".join(",".join(f"{k + 10000 * row}" for k in range(10000)) for row in range(8)), "utf-8")
    assert main(["measured", str(path)]) == 2
    assert capsys.readouterr().err == "wide.csv: 10000 columns; allowed: at most 1000, with a row for each cam angle\n"
