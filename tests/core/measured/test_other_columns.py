"""core.measured: a table of displacement, velocity and acceleration; what is left of each is said apart."""

from pathlib import Path

import numpy as np
import pytest

from core.__main__ import main
from core.measured import MotionFit, fit, layout, read_sheet, read_table
from core.output.measured_text import notes

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


def test_a_column_without_a_unit_by_time_without_a_speed_or_of_text_is_left_alone() -> None:
    def others(written: str, rpm: float | None = RPM) -> list[str]:
        return [each.column.quantity for each in fitted(written, rpm).columns[1:]]

    assert others(text(PER_SECOND), None) == ["velocity"]
    assert others(text(PER_SECOND, "angle [deg],s [mm],v,remark")) == []
    words = "\n".join([HEADER, *(f"{a},{s:.12g},none,{'x' if a else 0}" for a, s in zip(ANGLES, LIFT, strict=True))])
    assert others(words) == ["velocity", "acceleration"], "cells that are no number say nothing"


def test_the_command_says_of_every_column_what_is_left(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "all.csv"
    path.write_text(text(PER_SECOND))
    assert main(["measured", str(path), "--error", "0", "--speed", str(RPM)]) == 0
    out = capsys.readouterr().out
    assert "residual of velocity" in out
    assert "residual of acceleration" in out
    assert "are simple-harmonic within" in out
