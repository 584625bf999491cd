"""core.measured: a table of displacement, velocity and acceleration; what is not fitted is compared with the fitted motion."""

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


def test_the_largest_difference_of_each_quantity_beside_the_lift_is_found_at_its_row(awry: MotionFit) -> None:
    assert awry.table.layout.quantity == "displacement"
    velocity, acceleration = awry.differences()
    assert (velocity[0].quantity, acceleration[0].quantity) == ("velocity", "acceleration")
    assert velocity[1] < 1e-6 * np.abs(PER_DEGREE).max()
    assert velocity[2] == pytest.approx(np.abs(PER_DEGREE).max(), rel=1e-11)
    assert acceleration[1] == pytest.approx(OFF, rel=0.02)
    assert acceleration[3] == AWRY


def test_the_note_names_column_difference_unit_and_line(awry: MotionFit) -> None:
    (told,) = (note for note in notes(awry) if "motion's acceleration" in note)
    assert told.startswith("column 4 (a [mm/s2]) is compared, not fitted: ")
    assert "12.5 mm/s2 off" in told
    assert told.endswith(f"line {AWRY + 2} (100 deg)")


def test_a_column_without_a_unit_by_time_without_a_speed_or_of_text_is_left_alone() -> None:
    assert [each[0].quantity for each in fitted(text(PER_SECOND), None).differences()] == ["velocity"]
    assert [each[0].quantity for each in fitted(text(PER_SECOND, "angle [deg],s [mm],v,remark")).differences()] == []
    words = "\n".join([HEADER, *(f"{a},{s:.12g},none,{'x' if a else 0}" for a, s in zip(ANGLES, LIFT, strict=True))])
    assert [(each[0].quantity, each[3]) for each in fitted(words).differences()] == [("acceleration", 0)]


def test_the_command_tells_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "all.csv"
    path.write_text(text(PER_SECOND))
    assert main(["measured", str(path), "--error", "0", "--speed", str(RPM)]) == 0
    out = capsys.readouterr().out
    assert "column 3 (v [mm/deg]) is compared, not fitted" in out
    assert "column 4 (a [mm/s2]) is compared, not fitted" in out
