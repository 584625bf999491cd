"""core.measured: tables of every kind are read, wrong rows are named, and the curve misses what was measured by its error."""

import json
import math
import subprocess
import sys
import tracemalloc
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mechanisms import LIFT, PUSHER, levels
from references import EPS
from sampled import spread

from core import project
from core.__main__ import main
from core.design import Design, Motion, NamedCurve, Segment, SplineCurve
from core.design.curves import segment_shape
from core.errors import DesignError
from core.measured import (
    ALL_DETECTED,
    ColumnChoice,
    FitError,
    MeasuredTable,
    MotionFit,
    TableError,
    fit,
    guess_error,
    layout,
    read_sheet,
    read_table,
    value_units,
    with_measured_motion,
)
from core.measured.outliers import Outliers, outliers
from core.motion import program
from core.output.export import table as exported
from core.output.measured_text import fit_data, fit_text, notes, wrong_row_lines
from core.study import Study
from core.study.quantities import KINEMATICS

ROOT = Path(__file__).parents[3]
SPEED = 20.0
WAY = Motion(
    5.0,
    (
        Segment(90.0, 0.0),
        Segment(90.0, 30.0, NamedCurve("modified-sine")),
        Segment(90.0, 0.0),
        Segment(90.0, -30.0, NamedCurve("modified-sine")),
    ),
)
"""Dwell, rise, dwell, return: accelerations that join, jerks that jump."""
HEADERS = ("displacement [mm]", "velocity [mm/deg]", "acceleration [mm/deg2]")


def taken(
    text: str | bytes, wish: ColumnChoice = ALL_DETECTED, unit: str = "mm", speed: float | None = SPEED, **how: str
) -> MeasuredTable:
    """The table in a file of this content."""
    sheet = read_sheet(text if isinstance(text, bytes) else text.encode(), "t.csv", **how)
    return read_table(sheet, layout(sheet, wish, unit, speed), speed)


def spline(table: MeasuredTable, error: float | None = None, **how: Any) -> MotionFit:
    """The table as one spline over the turn, with nothing recognised in it."""
    return fit(table, error, laws=False, dwells=False, **how)


def moved(angles: np.ndarray, order: int = 0, motion: Motion = WAY) -> np.ndarray:
    """A motion's value or derivative by degrees at cam angles [deg]."""
    compiled = program(motion)
    y = compiled.state(compiled.angles(np.deg2rad(np.mod(angles, 360.0)))).y[order]
    return y * math.radians(1.0) ** order / motion.scale


def written(angles: np.ndarray, values: np.ndarray, header: str = HEADERS[0]) -> str:
    rows = zip(angles.tolist(), values.tolist(), strict=True)
    return f"angle [deg],{header}\n" + "".join(f"{a!r},{v!r}\n" for a, v in rows)


def noisy(rows: int, error: float, order: int = 0, seed: int = 1) -> MeasuredTable:
    angles = 360.0 * np.arange(rows) / rows
    scatter = np.random.default_rng(seed).normal(size=rows)
    return taken(written(angles, moved(angles, order) + error * scatter, HEADERS[order]))


# -- reading: what is detected ----------------------------------------------------------------------------

ANGLES = (0.0, 90.0, 180.0, 270.0)
VALUES = (0.5, 1.5, 2.5, 1.25)


@dataclass(frozen=True)
class Read:
    """A file, and what is to be found in it."""

    text: str
    delimiter: str = "comma"
    decimal: str = "point"
    header: int = 1
    angle_unit: str = "deg"
    unit: str = "mm"
    quantity: str = "displacement"
    encoding: str = "UTF-8"
    codec: str = "utf-8"
    columns: tuple[int, int] = (0, 1)
    guesses: int = 0
    motion_unit: str = "mm"
    by: float = 1.0  # the motion's unit per degree^k in one of the table's


def rows(mark: str, decimal: str = ".", angles: tuple[float, ...] = ANGLES, more: str = "") -> str:
    return "".join(f"{a:.12g}{mark}{v:.12g}{more}\n".replace(".", decimal) for a, v in zip(angles, VALUES, strict=True))


RADIANS = tuple(math.radians(a) for a in ANGLES)
SECONDS = tuple(a / (6.0 * SPEED) for a in ANGLES)
MILLISECONDS = tuple(1e3 * s for s in SECONDS)
TURNS = (0.0, 0.25, 0.5, 0.75)
PAIRS = tuple(zip(ANGLES, VALUES, strict=True))
DETECTED: dict[str, Read] = {
    "our own": Read("cam_angle_deg,displacement_mm\n" + rows(",")),
    "our own velocities": Read("cam_angle_deg,velocity_mm_s\n" + rows(","), unit="mm/s", quantity="velocity", by=1 / 120),
    "inches by radians": Read(
        "Angle [rad]; s [inch]\n" + rows(";", ",", RADIANS), "semicolon", "comma", angle_unit="rad", unit="in", by=25.4
    ),
    "Greek and tabs": Read("θ (°)\ts (mm)\n" + rows("\t"), "tab"),
    "time": Read("t [s],lift [mm]\n" + rows(",", angles=SECONDS), angle_unit="s", guesses=1),
    "milliseconds": Read(
        "time (ms);hub in cm\n" + rows(";", angles=MILLISECONDS), "semicolon", angle_unit="ms", unit="cm", by=10.0, guesses=1
    ),
    "turns": Read("revs [rev]  lift / µm\n" + rows(" ", angles=TURNS), "spaces", angle_unit="turns", unit="um", by=1e-3),
    "spaces": Read("angle   lift\ndeg     m\n" + rows("    "), "spaces", header=2, unit="m", by=1e3),
    "decimal comma and spaces": Read(rows(" ", ","), "spaces", "comma", header=0, guesses=4),
    "decimal comma and tabs": Read("Winkel [°]\tWeg [mm]\n" + rows("\t", ","), "tab", "comma"),
    "byte order mark": Read("\ufeffangle (deg),lift (mm)\n" + rows(",")),
    "UTF-16": Read("angle (deg);lift (mm)\n" + rows(";"), "semicolon", encoding="UTF-16", codec="utf-16"),
    "Korean": Read("캠각도(도),변위(㎜)\n" + rows(","), encoding="CP949", codec="cp949"),
    "Latin-1": Read(
        "Größe: Öl\nWinkel [°];Hub [µm]\n" + rows(";"), "semicolon", header=2, unit="um", by=1e-3,
        encoding="Latin-1", codec="latin-1",
    ),
    "spreadsheet": Read("sep=;\nangle [deg];lift [mm]\n" + rows(";", ","), "semicolon", "comma"),
    "comments": Read("# by Kim\n\n% 2024\n// angle [deg], lift [in]\n" + rows(",") + "\n# end\n", header=0, unit="in", by=25.4),
    "remarks behind": Read("angle [deg],lift [mm]\n" + rows(",", more=" # good")),
    "letters before": Read("Machine;3\nSpeed;20\nAngle;Lift\n" + rows(";"), "semicolon", header=3, guesses=2),
    "quoted": Read('"Angle, deg","Lift, mm"\n' + "".join(f'"{a}","{v}"\n' for a, v in PAIRS)),
    "no header": Read(rows(","), header=0, guesses=4),
    "no words": Read("a,b\n" + rows(","), guesses=4),
    "radians told by their range": Read("phi,y\n" + rows(",", angles=RADIANS), angle_unit="rad", guesses=2),
    "velocity": Read("φ [deg],v [m/s]\n" + rows(","), unit="m/s", quantity="velocity", by=1e3 / 120),
    "velocity by angle": Read("theta_deg,velocity_mm_per_rad\n" + rows(","), unit="mm/rad", quantity="velocity", by=math.radians(1)),
    "acceleration": Read("cam angle,acc. [mm/s²]\n" + rows(","), unit="mm/s2", quantity="acceleration", by=1 / 120**2, guesses=1),
    "accelerometer": Read("angle [°],a [g]\n" + rows(","), unit="g", quantity="acceleration", by=9806.65 / 120**2),
    "acceleration by angle": Read(
        "angle [°],s'' [mm/rad^2]\n" + rows(","), unit="mm/rad2", quantity="acceleration", by=math.radians(1) ** 2
    ),
    "swinging": Read("cam angle [deg],lift [rad]\n" + rows(","), unit="rad", motion_unit="deg", by=180 / math.pi),
    "swinging speed": Read(
        "cam angle [deg],ω [rad/s]\n" + rows(","), unit="rad/s", quantity="velocity", motion_unit="deg", by=180 / math.pi / 120
    ),
    "columns the other way": Read("lift [mm],angle [deg]\n" + "".join(f"{v},{a}\n" for a, v in PAIRS), columns=(1, 0)),
    "other columns between": Read(
        "n,temperature,angle [deg],force [N],lift [mm]\n" + "".join(f"3,20,{a},7,{v}\n" for a, v in PAIRS), columns=(2, 4)
    ),
    "thousands": Read("angle [deg];lift [mm]\n0;0.5\n90;1.5\n180;2.5\n270;1.25\n", "semicolon"),
    "line ends of a Macintosh": Read("angle [deg],lift [mm]\r" + rows(",").replace("\n", "\r")),
    "Fortran": Read("angle [deg] lift [mm]\n0.0D+00 5.0d-1\n9e1 1.5E0\n180. +2.5\n270 .125e+1\n", "spaces"),
}  # fmt: skip


@pytest.mark.stress
def test_many_rows_are_fitted_without_a_table_of_rows_by_knots() -> None:
    """8,000 rows that are exact, 720 knots: together 46 MB, several times over."""
    angles = np.arange(8000) * (360.0 / 8000)
    table = taken(written(angles, 10.0 * np.sin(np.deg2rad(angles))))
    tracemalloc.start()
    made = spline(table)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert (made.error, len(made.points)) == (0.0, 720)
    assert peak < 100e6
    assert np.abs(made.residuals).max() < 1e-9


@pytest.mark.parametrize("case", DETECTED)
def test_delimiter_header_columns_and_units_are_detected(case: str) -> None:
    wanted = DETECTED[case]
    text = wanted.text.replace("\n", "\r\n") if case == "our own" else wanted.text
    sheet = read_sheet(text.encode(wanted.codec), "t.csv")
    how = layout(sheet, ALL_DETECTED, wanted.motion_unit, SPEED)
    assert (sheet.delimiter, sheet.decimal, sheet.header) == (wanted.delimiter, wanted.decimal, wanted.header)
    assert sheet.encoding == wanted.encoding
    assert (how.angle_unit, how.unit.name, how.quantity) == (wanted.angle_unit, wanted.unit, wanted.quantity)
    assert (how.angle_column, how.value_column) == wanted.columns
    assert len(how.guesses) == wanted.guesses, how.guesses
    read = read_table(sheet, how, SPEED)
    assert read.angles == pytest.approx(ANGLES, rel=1e-11)
    assert read.values == pytest.approx(np.array(VALUES) * wanted.by, rel=1e-14)
    assert read.motion_unit == wanted.motion_unit


@pytest.mark.parametrize(
    ("cell", "decimal", "value"),
    [("1,234.5", "point", 1234.5), ("1,234,567", "point", 1234567.0), ("1.234,5", "comma", 1234.5),
     ("1\u202f234.5", "point", 1234.5), ("1'234,5", "comma", 1234.5), ("\u22124", "point", -4.0)],
)  # fmt: skip
def test_thousands_that_leave_no_doubt_are_read(cell: str, decimal: str, value: float) -> None:
    text = f"angle [deg];lift [mm]\n0;{cell}\n" + rows(";", "," if decimal == "comma" else ".", ANGLES)
    assert taken(text, decimal=decimal).values[0] == value


def test_what_is_said_of_a_table_counts_more_than_its_header() -> None:
    text = "time,angle [deg],x,v [mm/s]\n" + "".join(
        f"{i},{a},{v},{v}\n" for i, (a, v) in enumerate(zip(ANGLES, VALUES, strict=True))
    )
    for column in ("v [mm/s]", "V", "4"):
        read = taken(text, ColumnChoice(column=column))
        assert (read.layout.value_column, read.layout.quantity, read.unit) == (3, "velocity", "mm/s")
    assert taken(text, ColumnChoice(quantity="velocity")).layout.value_column == 3
    read = taken(
        text,
        ColumnChoice(angle_column="angle", angle_unit="rad", column="x", value_unit="in/deg2", quantity="acceleration"),
    )
    assert (read.layout.angle_column, read.layout.order, read.unit) == (1, 2, "in/deg2")
    assert read.angles == pytest.approx(np.mod(np.rad2deg(ANGLES), 360.0))
    assert read.values == pytest.approx(25.4 * np.array(VALUES))


def test_a_delimiter_that_is_said_is_used() -> None:
    text = "0,5 1,5\n90,5 2,5\n180,5 3,5\n270,5 2,5\n"
    assert taken(text).angles == pytest.approx([0.5, 90.5, 180.5, 270.5])
    with pytest.raises(TableError, match=r"line 1: '5 1' in column 2"):
        taken(text, delimiter="comma")


@pytest.mark.parametrize("motion_unit", ["mm", "deg"])
def test_every_unit_is_worth_what_its_name_says(motion_unit: str) -> None:
    base = (
        {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 0.001, "in": 25.4, "thou": 0.0254, "ft": 304.8, "1e-4in": 0.00254}
        if motion_unit == "mm"
        else {"deg": 1.0, "rad": 180 / math.pi}
    )
    per = {"deg": 1.0, "rad": 180 / math.pi, "s": 6.0 * SPEED}
    for order, quantity in enumerate(("displacement", "velocity", "acceleration")):
        for name in value_units(quantity, motion_unit):
            read = taken(rows(","), ColumnChoice(value_unit=name, quantity=quantity), motion_unit)
            length, _, by = name.removesuffix("2").partition("/")
            size = 9806.65 if name == "g" else base[length]
            each = 1.0 if order == 0 else per["s" if name == "g" else by] ** order
            assert read.size == pytest.approx(size / each, rel=1e-15), name


# -- reading: what is refused -----------------------------------------------------------------------------

GOOD = "angle [deg],lift [mm]\n" + rows(",")
WRONG: dict[str, tuple[str, list[tuple[int, str]]]] = {
    # the file, and each line that is wrong with what is said of it
    "text": (GOOD.replace("180,2.5", "180,2.S"), [(4, "'2.S' in column 2 (lift [mm]): required: a number with a decimal '.'")]),
    "nan": (GOOD.replace("180,2.5", "180,nan"), [(4, "'nan' in column 2")]),
    "nothing": (GOOD.replace("180,2.5", "180,"), [(4, "'180' has 1 column; 2 are required")]),
    "a decimal comma": (GOOD.replace("180,2.5", "180,2,5"), [(4, "'180,2,5' has 3 columns; 2 are required")]),
    "both cells": (
        GOOD.replace("180,2.5", "x,y"),
        [(4, "'x' in column 1 (angle [deg]): required: a number with a decimal '.'; 'y' in column 2")],
    ),
    "nothing before": (GOOD.replace("180,2.5", ",2.5"), [(4, "column 1 (angle [deg]) is empty")]),
    "too large": (GOOD.replace("180,2.5", "180,1e300"), [(4, "too large; allowed: at most 1e+12")]),
    "first row": (rows(",").replace("0,0.5", "0,O.5", 1), [(1, "'O.5' in column 2: required")]),
    "a footer": (GOOD + "End of data\n", [(6, "'End of data' has 1 column; 2 are required")]),
    "a thousand": (
        GOOD.replace(",", ";").replace("180;2.5", "180;2,500"),
        [(4, "thousands separator or decimal mark? required: a number without ','")],
    ),
    "a comma for the point": (GOOD.replace("180,2.5", "180;2,5"), [(4, "'180;2' in column 1")]),
    "nothing between": ("n;angle [deg];lift [mm]\n1;0;1\n2;90;2\n3;;\n4;270;2\n5;300;1\n", [(4, "'3' has 1 column; 3 are required")]),
    "out of order": (
        GOOD.replace("180,", "18,") + "280,1\n290,1\n",
        [(4, "angle 18 after 90 and before 270, where the angles rise; sort the rows, or correct this angle")],
    ),
    "too far": (GOOD.replace("90,", "900,") + "280,1\n290,1\n", [(3, "angle 900 after 0 and before 180, where the angles rise")]),
    "several": (
        GOOD.replace("90,1.5", "90,?").replace("180,2.5", "180").replace("270,", "abc,"),
        [(3, "'?' in column 2"), (4, "'180' has 1 column; 2 are required"), (5, "'abc' in column 1")],
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_wrong_rows_are_named_by_line_all_at_once(case: str) -> None:
    text, wanted = WRONG[case]
    with pytest.raises(TableError) as caught:
        taken(text)
    assert len(caught.value.faults) == len(wanted), caught.value.faults
    told = str(caught.value).splitlines()
    for (line, words), (got, *_), sentence in zip(wanted, caught.value.faults, told, strict=True):
        assert got == line
        assert sentence.startswith(f"t.csv, line {line}: ")
        assert words in sentence


@pytest.mark.parametrize(
    ("text", "words"),
    [("", "no row contains two numbers"), ("angle lift\nnone here\n", "no row contains two numbers"),
     ("1\n2\n3\n", "no row contains two numbers"),
     ("0,1\n180,2\n360,1\n", "2 different cam angles; at least 4 are required"), (b"PK\x03\x04rest", "a workbook, no text"),
     (b"1,2\0", "null bytes"), (b"\xff\xfe1", "no UTF-16 text"),
     ("angle [deg],arm [deg]\n" + rows(","), "measured in deg, but the follower slides: lengths are required")],
)  # fmt: skip
def test_what_is_no_table_is_refused_in_one_line(text: str | bytes, words: str) -> None:
    with pytest.raises(TableError) as caught:
        taken(text)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("wish", "words"),
    [(ColumnChoice(column="torque"), "column 'torque': no column has this name; columns: 1 angle [deg], 2 lift [mm]"),
     (ColumnChoice(column="3"), "no column has this name"), (ColumnChoice(column="1", angle_column="1"), "angle and value at once"),
     (ColumnChoice(value_unit="mm/s"), "unit 'mm/s' is no unit of displacement here; allowed: mm, cm, m, um, in"),
     (ColumnChoice(angle_unit="gon"), "unit 'gon' is no unit of an angle; allowed: deg, rad, turns, s, ms")],
)  # fmt: skip
def test_a_wish_that_cannot_be_met_names_what_there_is(wish: ColumnChoice, words: str) -> None:
    with pytest.raises(TableError) as caught:
        taken(GOOD, wish)
    assert words in str(caught.value)


def test_times_need_the_speed_of_the_shaft() -> None:
    for header in ("t [s],lift [mm]\n", "angle [deg],v [mm/s]\n"):
        with pytest.raises(TableError, match="the shaft's speed is required"):
            taken(header + rows(","), speed=None)
    assert taken("angle [deg],velocity\n" + rows(","), speed=None).unit == "mm/deg", "a guess that needs none"


# -- reading: rows as a whole -----------------------------------------------------------------------------

TURN = np.arange(0.0, 360.0, 5.0)


@pytest.mark.parametrize(
    ("angles", "told"),
    [
        (TURN, []),
        (TURN - 180.0, []),
        (TURN[::-1], ["the angles fall; the rows are sorted"]),
        (np.append(TURN, 360.0), ["line 74 is a full turn after line 2: the same cam angle again"]),
        (np.append(TURN, 20.0), ["1 row repeats a cam angle (as lines 6, 74): their mean is used"]),
        (
            np.append(TURN, TURN[::-1]),
            [
                "the angles rise and fall; the rows are sorted",
                "72 rows repeat a cam angle (as lines 2, 145): their mean is used",
            ],
        ),
        (np.arange(0.0, 1080.0, 5.0), ["the angles cover 2.986 turns, which are superposed"]),
        (np.random.default_rng(3).permutation(TURN), ["the angles rise and fall; the rows are sorted"]),
    ],
    ids=[
        "even",
        "from -180",
        "falling",
        "closed",
        "again",
        "there and back",
        "three turns",
        "shuffled",
    ],
)
def test_what_is_found_of_the_rows_is_told(angles: np.ndarray, told: list[str]) -> None:
    read = taken(written(angles, moved(angles)))
    assert list(read.notes) == told
    assert np.all((read.angles >= 0.0) & (read.angles < 360.0))
    assert list(read.lines) == list(range(2, angles.size + 2))
    assert np.abs(spline(read, 0.0).residuals).max() <= 1e-12, "whatever the order of the rows"


def test_a_gap_between_other_rows_is_bridged_and_told() -> None:
    angles = TURN[(TURN < 100.0) | (TURN > 200.0)]
    found = spline(taken(written(angles, moved(angles))), 0.0)
    assert "no rows from 95 to 205 deg; the spline bridges the gap" in notes(found)
    assert np.abs(found.residuals).max() <= 1e-12


# -- the fit ----------------------------------------------------------------------------------------------


def compared(found: MotionFit, order: int, wanted: Motion = WAY) -> float:
    """How far the motion is from another one, in the root mean square over the turn."""
    fine = np.arange(0.0, 360.0, 0.25)
    apart = moved(fine, order, found.motion) - moved(fine, order, wanted)
    return float(np.sqrt(np.mean((apart - (np.mean(apart) if order == 0 else 0.0)) ** 2)))


def size(order: int) -> float:
    return float(np.abs(moved(np.arange(0.0, 360.0, 0.25), order)).max())


@pytest.mark.parametrize(
    ("count", "error", "order"),
    spread(
        [
            (36, 0.2, 0),
            (180, 0.02, 0),
            (360, 0.02, 0),
            (720, 0.02, 0),
            (720, 5e-4, 0),
            (3600, 0.2, 0),
            (360, 1e-3, 1),
            (360, 5e-4, 2),
        ],
        2,
    ),
)
def test_a_noisy_table_gives_its_motion_back(count: int, error: float, order: int) -> None:
    """The rows are missed by their error, the motion by less, and its derivatives are still those of a motion."""
    table = noisy(count, error, order)
    found = spline(table, error)
    assert found.rms == pytest.approx(error, rel=1e-6)
    assert compared(found, order) < 0.8 * error, "nearer than the rows"
    for derivative, share in ((1, 0.05), (2, 0.15), (3, 0.3)):  # of the largest; its jerk jumps
        assert compared(found, derivative) < share * size(derivative), derivative
    assert found.left_out == ()
    assert len(found.points) <= 180
    assert isinstance(found.motion.segments[0].curve, SplineCurve)
    assert not program(found.motion).joins[0].jumps[:3].any()
    assert found.freedom < count
    if count > 36:
        assert found.waves > 1.0
        assert guess_error(table) == pytest.approx(error, rel=0.2)


@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("seed", range(3))
def test_lambda_weighs_rows_against_jerk_as_it_says(order: int, seed: int) -> None:
    """Where every row is a knot, the fifth derivative of the curve that minimises  Σ r²/n + λ ∫ s'''²  jumps there by
    -r/(nλ), Euler and Lagrange say, and nowhere else does anything jump; that of a table of velocities has its fourth
    derivative jump by r/(nλ)."""
    chance = np.random.default_rng(seed)
    angles = 6.0 * (np.arange(60) + chance.uniform(0.0, 0.6, 60))
    error = (0.05, 2e-3)[order]
    table = taken(written(angles, moved(angles, order) + error * chance.normal(size=60), HEADERS[order]))
    found = spline(table, error, keep_all=True)
    (segment,) = found.motion.segments
    pieces = segment_shape(segment, True, "").pieces
    starts = np.array([p.start for p in pieces])
    c4, c5 = (np.array([p.polynomial[k] for p in pieces]) for k in (4, 5))
    before = (120.0 * c5, 24.0 * c4 + 120.0 * c5 * np.diff(np.append(starts, 1.0)))[order]
    after = (120.0 * c5, 24.0 * c4)[order]
    jumps = (after - np.roll(before, 1)) / 360.0 ** (5 - order) * 60 * found.smoothing
    # a fifth difference of positions to the last digit, over the narrowest interval
    narrow = float(np.diff(angles).min())
    bound = 64 * EPS * 35.0 * 120.0 / narrow ** (5 - order) * 60 * found.smoothing
    assert bound < 1e-6 * error
    wanted = np.zeros(starts.size)
    at = [int(np.argmin(np.abs(360.0 * starts - angle))) for angle in angles]
    assert np.abs(360.0 * starts[at] - angles).max() < 1e-12
    wanted[at] = found.residuals * (-1.0, 1.0)[order]
    assert jumps == pytest.approx(wanted, abs=bound)


def waves(angles: np.ndarray, order: int) -> np.ndarray:
    """10 - 8 cos θ + 2 sin 3θ and its derivatives by degrees."""
    theta = np.deg2rad(angles)
    parts = (-8.0 * np.cos(theta + order * np.pi / 2), 2.0 * 3**order * np.sin(3.0 * theta + order * np.pi / 2))
    return (parts[0] + parts[1]) * math.radians(1.0) ** order + (10.0 if order == 0 else 0.0)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("uneven", [False, True])
def test_without_an_error_the_curve_goes_through_all_rows(order: int, uneven: bool) -> None:
    chance = np.random.default_rng(7)
    angles = np.sort(chance.uniform(0.0, 360.0, 90)) if uneven else np.arange(0.0, 360.0, 4.0)
    table = taken(written(angles, waves(angles, order), HEADERS[order]))
    found = spline(table, 0.0)
    assert np.abs(found.residuals).max() <= 64 * EPS * np.abs(table.values).max()
    assert len(found.points) == 90
    assert found.smoothing == 0.0
    fine = np.arange(0.0, 360.0, 0.5)
    for derivative in (0, 1, 2):
        apart = moved(fine, derivative, found.motion) - waves(fine, derivative)
        apart -= apart.mean() if derivative == 0 else 0.0  # where the follower stands the derivatives do not tell
        share = (1e-3 if uneven else 1e-4) * np.abs(waves(fine, derivative)).max()
        assert np.sqrt(np.mean(apart**2)) <= share, derivative


def test_a_curve_through_all_rows_keeps_to_them_between_too() -> None:
    """A spline of least jerk has no more ∫ jerk² than the motion, and meets it every h: so it is off by less than
    h^2.5/√2 times the root of that."""
    angles = np.arange(0.0, 360.0, 2.0)
    found = spline(taken(written(angles, moved(angles))), 0.0)
    fine = np.arange(0.0, 360.0, 0.1)
    jerk = moved(fine, 3)
    bound = 2.0**2.5 / math.sqrt(2.0) * math.sqrt(0.1 * float(jerk @ jerk))
    assert np.abs(moved(fine, 0, found.motion) - moved(fine)).max() < bound < 1.0


def test_our_own_table_reads_back_to_the_motion() -> None:
    for design in (LIFT, PUSHER):
        blocks = exported(Study(design, 360), KINEMATICS, ("motion",))
        assert blocks is not None
        text = b"".join(blocks)
        motion = design.drive.motion
        fine = np.arange(0.0, 360.0, 0.125)
        jerk = moved(fine, 3, motion)
        bound = 1.0 / math.sqrt(2.0) * math.sqrt(0.125 * float(jerk @ jerk))
        for column in ("displacement", "velocity", "acceleration"):
            table = taken(text, ColumnChoice(column=column), speed=design.shaft.speed_rpm)
            assert table.layout.guesses == ()
            lowest = float(moved(fine, 0, motion).min())
            found = spline(table, 0.0, lowest=lowest)
            apart = np.abs(moved(fine, 0, found.motion) - moved(fine, 0, motion)).max()
            assert apart < (bound if column == "displacement" else 5e-3 * found.stroke), column
            # the table's own rounding, eps of the position, is all that the rows are missed by
            assert np.abs(found.residuals).max() <= 1e-11 * np.abs(table.values / table.size).max(), column


def test_velocities_and_accelerations_have_their_offset_taken_off() -> None:
    """A drift of 0.002 mm/deg would leave the follower 0.72 mm higher after a turn."""
    angles = np.arange(0.0, 360.0, 3.0)
    for order, offset in ((1, 0.002), (2, 0.0003)):
        table = taken(written(angles, moved(angles, order) + offset, HEADERS[order]))
        for error in (0.0, 1e-4):
            found = spline(table, error)
            assert found.offset == pytest.approx(offset, abs=3e-6)
            assert found.stroke == pytest.approx(30.0, abs=0.3)
            assert found.lowest == 0.0
            gained = ("0.72 mm,", "0.108 mm/deg,")[order - 1]
            assert any(f"over a turn the table gains {gained}" in note for note in notes(found)), notes(found)
            assert any(
                "does not determine the position of the follower; its lowest position is 0 mm" in n
                for n in notes(found)
            )


@pytest.mark.parametrize("order", [0, 1])
def test_the_lowest_position_is_where_it_is_wanted(order: int) -> None:
    table = noisy(90, 0.001, order)
    usual, wanted = spline(table, 0.001), spline(table, 0.001, lowest=-7.0)
    assert usual.lowest == pytest.approx((5.0, 0.0)[order], abs=0.01)
    fine = np.arange(0.0, 360.0, 0.01)
    assert moved(fine, 0, wanted.motion).min() == pytest.approx(-7.0, abs=1e-6)
    assert wanted.motion.segments == usual.motion.segments
    assert wanted.rms == usual.rms


def test_a_typing_error_is_named_and_left_out() -> None:
    angles = np.arange(0.0, 360.0, 1.0)
    values = moved(angles) + 0.01 * np.random.default_rng(2).normal(size=360)
    values[[50, 51, 200]] += (1.0, -2.0, 0.09)
    table = taken(written(angles, values))
    found = spline(table, 0.01)
    assert found.left_out == found.outliers.wrong == (50, 51, 200)
    assert found.largest == 51
    assert found.rms == pytest.approx(0.01, rel=1e-6), "of the other rows"
    assert found.residuals[[50, 51, 200]] == pytest.approx([1.0, -2.0, 0.09], abs=0.02)
    assert compared(found, 0) < 0.01
    assert wrong_row_lines(found)[0].startswith("line 53 (51 deg): ")
    assert any(note.startswith("lines 52-53, 202: wrong, ") for note in notes(found))
    kept = spline(table, 0.01, keep_all=True)
    assert kept.left_out == ()
    assert kept.outliers == found.outliers
    assert compared(kept, 0) > 2 * compared(found, 0), "the curve bends to it"
    through = spline(table, 0.0)
    assert (through.left_out, through.outliers.wrong) == ((), (50, 51, 200))
    assert np.abs(through.residuals).max() < 1e-12


@pytest.mark.parametrize("law", spread(["parabolic", "simple-harmonic", "modified-trapezoid", "cycloidal"], 2))
@pytest.mark.parametrize("count", [24, 120, 720])
def test_a_coarse_table_of_any_law_holds_no_typing_errors(law: str, count: int) -> None:
    angles = 360.0 * (np.arange(count) + 0.3) / count
    motion = levels(0.0, (100.0, 0.0, "dwell"), (35.0, 20.0, law), (80.0, 20.0, "dwell"), (145.0, 0.0, law))
    table = taken(written(angles, moved(angles, 0, motion)))
    assert outliers(table, 0.0) == Outliers()
    assert outliers(table, 1e-4) == Outliers()


def test_a_finer_error_takes_more_points_and_a_coarser_one_fewer() -> None:
    table = noisy(720, 1e-6)
    found = [spline(table, error) for error in (0.5, 0.02, 1e-3, 3e-6)]
    assert [len(f.points) for f in found] == sorted(len(f.points) for f in found)
    assert len(found[0].points) <= 90 < 180 < len(found[-1].points)
    assert [f.freedom for f in found] == sorted(f.freedom for f in found)
    assert all(f.rms == pytest.approx(f.error, rel=1e-6) for f in found)
    assert found[0].waves < 1.0
    assert any("a smaller error would retain it" in note for note in notes(found[0]))


@pytest.mark.stress
def test_a_table_of_more_rows_than_points_is_followed_as_near_as_points_can() -> None:
    found = spline(noisy(1440, 1e-3), 0.0)
    assert 180 < len(found.points) < 1440
    assert 0.0 < found.rms < 2e-3
    assert any("the curve is the nearest one" in note for note in notes(found))


def test_an_error_as_large_as_the_motion_is_refused_with_its_range() -> None:
    table = noisy(90, 0.01)
    whole = float(np.std(table.values))
    with pytest.raises(FitError, match=rf"measuring error 50 mm: .*; allowed: 0 \.\.\. {whole:.5g} mm"):
        spline(table, 50.0)
    for wrong in (-1.0, math.nan, math.inf):
        with pytest.raises(FitError, match="allowed: 0 or more mm"):
            spline(table, wrong)


def test_rows_that_repeat_an_angle_and_disagree_are_told() -> None:
    angles = np.append(np.arange(0.0, 361.0, 5.0), 100.0)
    values = moved(angles)
    values[-2] += 0.5
    found = spline(taken(written(angles, values)), 0.01, keep_all=True)
    assert any(
        "the table does not close: a turn later, the deviation of line 74 is 0.5 mm" in note for note in notes(found)
    )
    assert found.rms == pytest.approx(0.5 / math.sqrt(2 * angles.size), rel=0.01)
    assert any("rows that repeat a cam angle leave 0.04" in note for note in notes(found))


def test_a_constant_table_is_a_dwell() -> None:
    for angles in (TURN, np.arange(0.0, 360.0, 0.25)):
        found = spline(taken(written(angles, np.full(angles.size, 3.0))), 0.01)
        assert (found.stroke, found.lowest, found.rms, len(found.points)) == (0.0, 3.0, 0.0, 4)


@pytest.mark.parametrize("decimals", [1, 2, 3])
def test_a_table_without_scatter_is_as_exact_as_its_last_digit(decimals: int) -> None:
    """Rounding alone: the √12th part of the last digit, or a little more where the rows are few."""
    angles = np.arange(0.0, 360.0, 1.0)
    text = "a,b\n" + "".join(f"{a:g},{v:.{decimals}f}\n" for a, v in zip(angles, waves(angles, 0), strict=True))
    rounding = 10.0**-decimals / math.sqrt(12.0)
    assert 0.999 * rounding <= guess_error(taken(text)) <= 1.2 * rounding
    text = "a,b\n" + "".join(
        f"{a:g},{1e3 * v:.{decimals}f}e-3\n" for a, v in zip(angles, waves(angles, 0), strict=True)
    )
    assert 0.999e-3 * rounding <= guess_error(taken(text)) <= 1.3e-3 * rounding, "the exponent counts"
    exact = np.arange(0.0, 360.0, 20.0)
    assert guess_error(taken(written(exact, waves(exact, 0)))) == 0.0, "too few to tell scatter from motion"


# -- what is told and kept --------------------------------------------------------------------------------


def test_the_design_needs_the_table_no_longer(tmp_path: Path) -> None:
    """Saved and opened again the motion is the same to the last bit; nothing of it is assumed any longer."""
    found = spline(noisy(360, 0.01), 0.01)
    design = with_measured_motion(
        Design(LIFT.name, LIFT.shaft, (LIFT.drive,), ("motion.segments[0].span_deg", "loads.friction")), found
    )
    project.save(design, tmp_path / "d.toml")
    again = project.load(tmp_path / "d.toml")
    assert again == design
    assert again.drive.motion == found.motion
    assert again.assumed == ("loads.friction",)
    swings = spline(taken("angle [deg],arm [deg]\n" + rows(","), unit="deg"), 0.0)
    with pytest.raises(DesignError, match="measured in deg"):
        with_measured_motion(LIFT, swings)


def test_the_smoothed_curve_is_what_the_window_draws() -> None:
    for order in (0, 1, 2):
        table = noisy(120, 0.001, order)
        found = spline(table, 0.001)
        assert found.curve(table.angles) == pytest.approx(table.values / table.size - found.residuals, abs=1e-12)


def test_text_and_data_tell_the_same() -> None:
    text = written(np.arange(0.0, 360.0, 4.0), moved(np.arange(0.0, 360.0, 4.0)))
    sheet = read_sheet(text.encode(), "lift.csv")
    found = spline(read_table(sheet, layout(sheet)), 0.02)
    told, data = fit_text(sheet, found), fit_data(sheet, found)
    assert data["table"]["value"] == {
        "column": 2,
        "name": "displacement [mm]",
        "unit": "mm",
        "quantity": "displacement",
    }
    assert data["fit"]["points"] == len(found.points) == 90
    assert [row["line"] for row in data["residuals"]] == list(range(2, 92))
    worst = max(data["residuals"], key=lambda row: abs(row["residual"]))
    assert data["fit"]["largest_residual"] == {"line": worst["line"], "value": worst["residual"]}
    for words in (
        "rows          90, 1 header line, UTF-8",
        "column 2 (displacement [mm]), in mm",
        "measuring error   0.02 mm",
        "rms residual      0.02 mm",
        f"line {worst['line']} ({worst['cam_angle_deg']:g} deg)",
        "stroke ",
    ):
        assert words in told


# -- the command ------------------------------------------------------------------------------------------


def lift_file(folder: Path) -> Path:
    path = folder / "lift.csv"
    table = noisy(180, 0.01)
    path.write_text(written(table.angles, table.values), encoding="utf-8")
    return path


def test_the_command_prints_the_fit_and_writes_it_into_a_design(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, design = lift_file(tmp_path), tmp_path / "design.toml"
    project.save(PUSHER, design)
    assert main(["measured", str(table), "--no-laws", "--no-dwells", "--error", "0.01"]) == 0
    assert project.load(design) == PUSHER, "nothing is written unasked"
    text = capsys.readouterr().out
    assert "rms residual      0.01 mm" in text
    assert (
        main(
            [
                "measured",
                str(table),
                "--no-laws",
                "--no-dwells",
                "--error",
                "0.01",
                "--lowest",
                "0",
                "--into",
                str(design),
                "--json",
            ]
        )
        == 0
    )
    told = json.loads(capsys.readouterr().out)
    motion = project.load(design).drive.motion
    assert len(motion.segments[0].curve.points) == told["fit"]["points"] == 180
    assert told["fit"]["rms_residual"] == pytest.approx(0.01)
    assert moved(np.arange(0.0, 360.0), 0, motion).min() == pytest.approx(0.0, abs=0.01)
    assert main(["check", str(design)]) == 0


def test_times_are_counted_by_the_designs_own_speed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, design = tmp_path / "t.txt", tmp_path / "design.toml"
    angles = np.arange(0.0, 360.0, 5.0)
    seconds = angles / (6.0 * PUSHER.shaft.speed_rpm)
    path.write_text(
        "t [s]\tlift [mm]\n"
        + "".join(f"{s!r}\t{v!r}\n" for s, v in zip(seconds.tolist(), moved(angles).tolist(), strict=True)),
        "utf-8",
    )
    project.save(PUSHER, design)
    assert main(["measured", str(path), "--no-laws", "--no-dwells", "--error", "0"]) == 2
    assert "the shaft's speed is required" in capsys.readouterr().err
    assert main(["measured", str(path), "--no-laws", "--no-dwells", "--error", "0", "--into", str(design)]) == 0
    assert moved(angles, 0, project.load(design).drive.motion) == pytest.approx(moved(angles), abs=1e-9)
    assert main(["measured", str(path), "--no-laws", "--no-dwells", "--error", "0", "--speed", "300"]) == 0
    assert "at 300 rpm" in capsys.readouterr().out
    assert main(["measured", str(path), "--no-laws", "--no-dwells", "--error", "0", "--speed", "7.5"]) == 2
    assert "no rows from 8.875 to 360 deg" in capsys.readouterr().err, "the times cover a fortieth of that turn"


def test_every_wrong_row_is_a_line_and_nothing_is_written(tmp_path: Path) -> None:
    """Run as a program: exit code 2, one line each on stderr, nothing on stdout."""
    path, design = lift_file(tmp_path), tmp_path / "design.toml"
    project.save(PUSHER, design)
    before = design.read_bytes()
    lines = path.read_text("utf-8").split("\n")
    lines[4], lines[9], lines[20] = "6.0,x", "16.0", "38.0,nan"
    path.write_text("\n".join(lines), "utf-8")
    words = [sys.executable, "-m", "core", "measured", path, "--error", "0.01", "--into", design]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, encoding="utf-8")
    assert (done.returncode, done.stdout) == (2, "")
    assert [line.partition(": ")[0] for line in done.stderr.splitlines()] == [
        f"lift.csv, line {n}" for n in (5, 10, 21)
    ]
    assert design.read_bytes() == before


@pytest.mark.parametrize(
    ("words", "phrase"),
    [(["--error", "-1"], "allowed: >= 0"), (["--error", "many"], "'many'"), (["--speed", "0"], "allowed: above 0"),
     (["--angle-unit", "gon"], "gon"), (["--quantity", "jerk"], "jerk"), (["--column", "z"], "no column has this name"),
     (["--value-unit", "mm/h"], "allowed: mm, cm, m, um, in"), (["--into", "nowhere.toml", "--segment", "1"], "no such file"),
     (["--delimiter", "dash"], "dash"), (["--error", "99"], "allowed: 0 ...")],
)  # fmt: skip
def test_wrong_words_are_refused_in_one_line(
    words: list[str], phrase: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["measured", str(lift_file(tmp_path)), *words]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert phrase in told.err
    assert told.err.count("\n") == 1


@pytest.mark.parametrize("name", ["missing.csv", "."])
def test_a_file_that_cannot_be_read_is_refused(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["measured", str(tmp_path / name)]) == 2
    assert "cannot be read" in capsys.readouterr().err


# -- faults of format, and what a file may hold -----------------------------------------------------------

THROUGHOUT = {
    "commas": ("1,5;3,25", "angle [deg];lift [mm]", ["--decimal", "point"], "'1,5' in column 1 (angle [deg])"),
    "a unit in every cell": ("1.5;3.25 mm", "angle [deg];lift [mm]", [], "'3.25 mm' in column 2"),
    "a column too few": ("1.5", "angle [deg];lift [mm]", [], "'1.5' has 1 column"),
}


@pytest.mark.parametrize("case", THROUGHOUT)
def test_one_fault_of_format_is_one_line(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong, header, words, first = THROUGHOUT[case]
    path = tmp_path / "t.csv"
    path.write_text("\n".join([header, "0;1", *[wrong] * 300, "300;2", "x;2"]), "utf-8")
    assert main(["measured", str(path), "--no-laws", "--no-dwells", *words]) == 2
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 2, told
    assert told[0].startswith("t.csv, line 3: ")
    assert first in told[0]
    assert told[0].endswith("; the same in 299 more rows, lines 4-302")
    assert told[1].startswith("t.csv, line 304: 'x' in column 1")


def test_times_that_repeat_few_angles_over_many_turns_are_fitted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A column of angles taken for seconds: 25 cam angles, at each of which forty rows differ."""
    angles = 0.36 * np.arange(1000)
    path = tmp_path / "t.csv"
    path.write_bytes(written(angles, moved(angles)).encode("utf-16"))
    assert (
        main(["measured", str(path), "--no-laws", "--no-dwells", "--angle-unit", "s", "--speed", "60", "--error", "0"])
        == 0
    )
    told = capsys.readouterr()
    assert "turns, which are superposed" in told.out
    assert told.err == ""


@pytest.mark.parametrize("unit", ["furlong", "kN", "mm²", "1/100mm"])
def test_a_unit_in_brackets_that_is_not_known_is_asked_about(
    unit: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"angle [deg];lift [{unit}]\n" + rows(";"), encoding="utf-8")
    assert main(["measured", str(path), "--no-laws", "--no-dwells"]) == 2
    assert f"column 2 (lift [{unit}]): unknown unit '{unit}'" in capsys.readouterr().err
    assert main(["measured", str(path), "--no-laws", "--no-dwells", "--value-unit", "mm"]) == 0


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("lift 1e-4 in", "1e-4in"),
        ("lift 0.0001 in", "1e-4in"),
        ("lift 0.01 mm", ""),
        ("Hub 1/100 mm", ""),
        ("lift 2 mm", "mm"),
    ],
)
def test_a_fraction_before_the_unit_counts_without_brackets_too(
    name: str, unit: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"angle [deg];{name}\n" + rows(";"), encoding="utf-8")
    assert main(["measured", str(path), "--no-laws", "--no-dwells"]) == (0 if unit else 2)
    told = capsys.readouterr()
    assert (f"({name}), in {unit}\n" if unit else "unknown unit '") in told.out + told.err


CONTROL = "\x9b31m\x1b[2J\x07\u202e"


@pytest.mark.parametrize("words", [[], ["--json"], ["--column", "3"], ["--angle-unit", "s"]])
def test_nothing_of_a_file_is_obeyed_by_the_terminal(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"a{CONTROL}.csv"
    path.write_text(f"angle {CONTROL} [deg];lift {CONTROL} [mm]\n" + rows(";"), encoding="utf-8")
    main(["measured", str(path), "--no-laws", "--no-dwells", *words])
    told = capsys.readouterr()
    assert "\\u009b31m" in told.out + told.err
    for text in (told.out, told.err):
        assert not any(c in text for c in CONTROL if not c.isalnum() and c != "[")
    if words == ["--json"]:
        assert CONTROL in json.loads(told.out)["table"]["value"]["name"]
