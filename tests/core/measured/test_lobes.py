"""core.measured: a lobe listed in any of its usual forms is cut right, or refused; rows of many digits are met to their last."""

import json
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import scipy.optimize
from lobe_tables import POWERS, lobe, lobe_table
from measured_tables import position
from mechanisms import levels

from core import project
from core.__main__ import main
from core.design import Motion

MANY = 300
FINE = np.arange(0.0, 360.0, 0.25)
NAMED = (
    "constant-velocity", "parabolic", "simple-harmonic", "cycloidal", "modified-sine", "modified-trapezoid", "mcv50", "2-3", "3-4-5",
    "4-5-6-7", "5-6-7-8-9", "freudenstein-1-3", "gutman-1-3",
)  # fmt: skip


def read(folder: Path, text: str, *words: str) -> tuple[Motion, dict]:
    """The motion that the command makes of a table, and what it prints."""
    target = folder / "motion.toml"
    target.unlink(missing_ok=True)
    (folder / "table.csv").write_text(text, "utf-8")
    out = folder / "out.json"
    with out.open("w", encoding="utf-8") as stream, pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.stdout", stream)
        code = main(["measured", str(folder / "table.csv"), "--into", str(target), "--as", "motion", "--json", *words])
    assert code == 0
    motion = project.load(target).drive.motion
    assert motion is not None
    return motion, json.loads(out.read_text("utf-8"))


def refused(folder: Path, capsys: pytest.CaptureFixture[str], text: str, *words: str) -> str:
    """The one line with which the command refuses a table."""
    (folder / "table.csv").write_text(text, "utf-8")
    assert main(["measured", str(folder / "table.csv"), *words]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.count("\n") == 1
    return told.err


def listed(angles: np.ndarray, values: np.ndarray, decimals: int, header: str = "angle [deg],lift [mm]") -> str:
    return f"{header}\n" + "".join(f"{a:.10g},{v:.{decimals}f}\n" for a, v in zip(angles, values, strict=True))


# -- lobes ------------------------------------------------------------------------------------------------


def proved(seeds: Sequence[int], folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The whole turn, not only where there are rows, within the bound of the residuals; half a lobe by --mirror alone."""
    wrong = []
    for seed in seeds:
        case = lobe_table(seed)
        words = (*case.words, "--mirror") if case.half else case.words
        if case.half:
            assert "--mirror" in refused(folder, capsys, case.text, *case.words), (seed, case.about)
        motion, _ = read(folder, case.text, *words)
        off = np.abs(position(motion, FINE) - case.lift(FINE)).max()
        if off > max(10.0 * case.error, 1e-3 * case.height):
            wrong.append((seed, case.about, off))
    assert wrong == []


def test_a_lobe_listed_in_any_form_is_cut_right(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    proved((1, 9, 16, 28), tmp_path, capsys)


@pytest.mark.stress
def test_three_hundred_lobes_are_cut_right(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = int(os.environ.get("KINDYNA_FUZZ_SEED", "0"))
    proved(range(first, first + MANY), tmp_path, capsys)


@pytest.mark.parametrize(
    "angles",
    [
        np.arange(-140.0, 141.0),
        np.arange(0.0, 281.0),
        np.arange(-290.0, -9.0),
        np.mod(np.arange(-140.0, 141.0), 360.0),
        np.arange(140.0, -141.0, -1.0),
    ],
    ids=["about the peak", "from 0", "negative", "degree wheel", "falling"],
)
def test_a_lobe_without_its_base_circle_stands_still_where_no_rows_are(angles: np.ndarray, tmp_path: Path) -> None:
    flank = levels(0.0, (140.0, 25.0, "modified-sine"), (140.0, 0.0, "modified-sine"), (80.0, 0.0, "dwell"))
    _, told = read(tmp_path, listed(angles, position(flank, np.arange(0.0, 281.0)), 5))
    laws = [segment["law"] for segment in told["segments"] if segment["span_deg"] > 1e-3]
    assert sorted(laws) in (["dwell", *["modified-sine"] * 2], ["dwell"] * 2 + ["modified-sine"] * 2)
    spans = [segment["span_deg"] for segment in told["segments"] if segment["law"] == "dwell"]
    assert sum(spans) == pytest.approx(80.0, abs=0.02)
    assert "no rows from" in " ".join(told["notes"])


SINE = levels(0.0, (40.0, 0.0, "dwell"), (140.0, 25.0, "modified-sine"), (140.0, 0.0, "3-4-5"), (40.0, 0.0, "dwell"))


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (np.arange(0.0, 181.0), ["lines 2, 182", "from 180 to 360 deg", "differ by 25 mm", "--mirror"]),
        (np.arange(180.0, 321.0), ["from 320 to 180 deg", "differ by 25 mm", "--mirror"]),
        (np.arange(-80.0, 1.0) + 180.0, ["--mirror"]),
        (np.arange(0.0, 351.0), []),  # the base circle is not listed to its end
        (np.arange(0.0, 357.0), []),
        (np.arange(100.0, 257.5, 0.5), ["--mirror"]),
    ],
    ids=["to the peak", "from the peak", "of the flank", "ten degrees", "four degrees", "cut off above the base"],
)
def test_rows_that_leave_the_turn_open_are_refused_unless_they_are_level(
    rows: np.ndarray, words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = listed(rows, position(SINE, rows), 5)
    if words:
        told = refused(tmp_path, capsys, text)
        assert all(word in told for word in words), told
    else:
        motion, _ = read(tmp_path, text)
        assert np.abs(position(motion, FINE) - position(SINE, FINE)).max() <= 5e-5


def test_half_a_lobe_of_velocities_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = np.arange(0.0, 181.0)
    speed = (position(SINE, rows + 1e-4) - position(SINE, rows - 1e-4)) / 2e-4
    text = listed(rows, speed, 7, "angle [deg],velocity [mm/deg]")
    assert "the rows do not cover the turn" in refused(tmp_path, capsys, text)
    assert "allowed: displacements" in refused(tmp_path, capsys, text, "--mirror")


def test_a_whole_lobe_is_not_mirrored(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = np.arange(0.0, 321.0)
    told = refused(tmp_path, capsys, listed(rows, position(SINE, rows), 5), "--mirror")
    assert "line 182 has the largest lift and is neither the first nor the last row" in told


def test_velocities_are_reflected_with_the_other_sign(tmp_path: Path) -> None:
    rows = np.arange(40.0, 181.0)
    speed = (position(SINE, rows + 1e-4) - position(SINE, rows - 1e-4)) / 2e-4
    lines = zip(rows, position(SINE, rows), speed, strict=True)
    text = "angle [deg],lift [mm],velocity [mm/deg]\n" + "".join(f"{a:g},{s:.6f},{v:.6f}\n" for a, s, v in lines)
    motion, told = read(tmp_path, text, "--mirror")
    assert [segment["law"] for segment in told["segments"]] == ["dwell", "modified-sine", "modified-sine", "dwell"]
    assert position(motion, FINE) == pytest.approx(position(SINE, 180.0 - np.abs(FINE - 180.0)), abs=1e-5)


def test_rows_that_no_motion_comes_near_are_refused_with_angle_and_size(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Waves shorter than the points of a spline."""
    rows = np.arange(0.0, 360.0, 0.1)
    text = listed(rows, np.sin(np.deg2rad(rows)) + 0.01 * np.sin(np.deg2rad(500.0 * rows)), 6)
    told = refused(tmp_path, capsys, text, "--error", "0", "--no-laws", "--no-dwells")
    size = float(told.partition("the rows are ")[2].split()[0])
    assert told.startswith("at ")
    assert 0.005 < size < 0.015
    assert "allowed: at most 0.002" in told


# -- rows of many digits ----------------------------------------------------------------------------------


def joins_between_rows(seeds: Sequence[int], folder: Path) -> None:
    """Laws whose ends are between two rows, those of flat ends first; with a dwell at the top or without."""
    for seed in seeds:
        chance = np.random.default_rng(seed)
        laws = [str(chance.choice(NAMED if seed % 2 else ("3-4-5", "4-5-6-7", "5-6-7-8-9"))) for _ in range(2)]
        spans = [round(float(chance.uniform(40.0, 120.0)), 3) for _ in range(2)]
        first, top = (round(float(chance.uniform(5.0, 40.0)), 3) for _ in range(2))
        stroke, decimals = round(float(chance.uniform(3.0, 60.0)), 3), int(chance.choice([7, 7, 8, 9]))
        steps = [(first, 0.0, "dwell"), (spans[0], stroke, laws[0]), (top, stroke, "dwell"), (spans[1], 0.0, laws[1])]
        steps = [step for step in steps if step[:1] != (top,) or chance.random() < 0.6]
        steps.append((360.0 - sum(step[0] for step in steps), 0.0, "dwell"))
        rows = np.arange(0.0, 360.0, float(chance.choice([0.5, 1.0])))
        _, told = read(folder, listed(rows, position(levels(0.0, *steps), rows), decimals), "--error", "0")
        assert [segment["law"] for segment in told["segments"]] == [law for *_, law in steps], seed
        starts = [segment["start_deg"] for segment in told["segments"]]
        assert starts == pytest.approx(np.cumsum([0.0, *(step[0] for step in steps[:-1])]), abs=0.02), seed
        assert max(abs(row["residual"]) for row in told["residuals"]) <= 2.0 * 10.0**-decimals, seed


def test_laws_and_joins_between_rows_of_seven_decimals_are_right(tmp_path: Path) -> None:
    joins_between_rows((0, 1, 2, 5), tmp_path)


@pytest.mark.stress
def test_many_laws_and_joins_between_rows_are_right(tmp_path: Path) -> None:
    joins_between_rows(range(120), tmp_path)


@pytest.mark.parametrize(
    "seed", [0, pytest.param(1, marks=pytest.mark.stress), pytest.param(2, marks=pytest.mark.stress)]
)
def test_a_lobe_that_is_no_law_is_met_to_the_last_digits(seed: int, tmp_path: Path) -> None:
    chance = np.random.default_rng(seed)
    flanks = float(chance.uniform(45.0, 120.0)), float(chance.uniform(45.0, 120.0))
    rows = np.arange(0.0, 360.0, 0.5)
    _, told = read(tmp_path, listed(rows, lobe(None, POWERS[seed], flanks, 20.0, rows - 180.0), 7), "--error", "0")
    assert [segment["law"] for segment in told["segments"]] == ["dwell", "table", "dwell"]
    assert max(abs(row["residual"]) for row in told["residuals"]) <= 2e-7


def test_a_named_law_is_no_scca_that_equals_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The rocker with a shoe, 3,600 rows of eight decimals."""
    example = Path(__file__).parents[3] / "resources/examples/rocker_shoe.toml"
    design = project.load(example)
    motion = design.drive.motion
    assert motion is not None
    target, rows = tmp_path / "rocker.toml", np.arange(0.0, 360.0, 0.1)
    project.save(design, target)
    (tmp_path / "t.csv").write_text(listed(rows, position(motion, rows), 8, "cam angle [deg],lift [deg]"), "utf-8")
    assert (
        main(["measured", str(tmp_path / "t.csv"), "--into", str(target), "--angle-column", "1", "--column", "2"]) == 0
    )
    made = project.load(target).drive.motion
    assert made is not None
    assert [s.curve.law for s in made.segments] == ["dwell", "modified-sine", "dwell", "modified-sine"]


@pytest.mark.stress
def test_of_a_long_exact_table_laws_are_tried_on_few_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes, solve = [], scipy.optimize.least_squares

    def counted(*args, **kwargs):
        result = solve(*args, **kwargs)
        sizes.append(result.fun.size)
        return result

    monkeypatch.setattr(scipy.optimize, "least_squares", counted)
    rows = np.arange(0.0, 360.0, 0.05)
    turn = np.deg2rad(rows)
    text = listed(rows, 10.0 + 3.0 * np.sin(turn) + 1.1 * np.sin(2.0 * turn + 0.3) + 0.4 * np.cos(5.0 * turn), 14)
    _, told = read(tmp_path, text, "--error", "0")
    assert told["segments"] == []
    assert sizes
    assert max(sizes) <= 200
