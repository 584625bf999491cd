"""The commands ``laws`` and ``blend``: what is printed, what comes into a design, what is refused."""

import csv
import json
import math
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from blends import Motion as Blend
from blends import check_joins
from mechanisms import LIFT, PUSHER, with_drive

from core import project
from core.__main__ import main
from core.blend import GOALS, Request, best, blend
from core.blend.best import with_blend, with_blend_as_motion, with_blend_between
from core.design import Design, Motion, Segment, faults, with_assumed
from core.errors import DesignError
from core.laws import LAWS, find_law
from core.motion import program

ROOT = Path(__file__).parents[3]
PICKER = ("--type", "DRRD", "--stroke", "20", "--start", "30", "--end", "330")
# Yang Fig. 4, with the spans that his equations have (his solver stopped short of them)
PICKER_SPANS = (18.8468353936, 169.621518543, 14.8022699040, 96.7293761598)
PRINTED_SPANS = (18.846, 169.613, 14.801, 96.740)
COEFFICIENTS = {
    "2-3 (cubic)": "2-3", "3-4-5": "3-4-5", "4-5-6-7": "4-5-6-7", "5-6-7-8-9": "5-6-7-8-9",
    "parabolic (constant acc)": "parabolic", "simple harmonic": "simple-harmonic", "Gutman 1-3": "gutman-1-3",
    "cycloidal (inclined sine / Bestehorn)": "cycloidal", "Freudenstein 1-3": "freudenstein-1-3",
    "Freudenstein 1-3-5": "freudenstein-1-3-5", "modified sine (SCCA)": "modified-sine",
    "modified trapezoid (SCCA)": "modified-trapezoid", "modified sine + CV 20% (SCCA; MCV/MSC)": "mcv20",
    "modified sine + CV 33% (SCCA; MCV/MSC)": "mcv33", "modified sine + CV 50% (SCCA; MCV/MSC)": "mcv50",
    "modified sine + CV 67% (SCCA; MCV/MSC)": "mcv66", "KM C1 (half cycloid, accel)": "c1",
    "KM H1 (half harmonic, accel)": "h1", "KM P1 eighth-degree": "p1", "double harmonic (rise, DRRD)": "double-harmonic",
}  # fmt: skip


class Run:
    """What a command printed and returned."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *words: str | Path) -> tuple[int, str, str]:
        code = main([str(word) for word in words])
        told = self._capsys.readouterr()
        return code, told.out, told.err

    def text(self, *words: str | Path) -> str:
        code, out, err = self(*words)
        assert (code, err) == (0, "")
        return out

    def json(self, *words: str | Path) -> Any:
        return json.loads(self.text(*words, "--json"))

    def refused(self, *words: str | Path) -> str:
        """The one line of a refusal."""
        code, out, err = self(*words)
        assert (code, out) == (2, "")
        assert err.endswith("\n")
        assert len(err.splitlines()) == 1
        return err.strip()


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    return Run(capsys)


def outside(*words: str | Path) -> subprocess.CompletedProcess[str]:
    """The command as its own process."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    command = [sys.executable, "-m", "core", *map(str, words)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, encoding="utf-8")


def settings(**wanted: float) -> list[str]:
    return [word for name, value in wanted.items() for word in ("--set", f"{name}={value:g}")]


def spans(rows: Sequence[dict[str, Any]]) -> list[float]:
    return [row["span_deg"] for row in rows]


# -- laws -------------------------------------------------------------------------------------------------


def test_the_laws_are_printed_with_exactly_these_keys(run: Run) -> None:
    rows = run.json("laws")
    assert [row["law"] for row in rows] == list(LAWS)
    assert all(list(row) == ["law", "cv", "ca", "cj", "cm"] for row in rows)
    numbers = [row[key] for row in rows for key in ("cv", "ca", "cj", "cm")]
    assert all(value is None or (math.isfinite(value) and value >= 0.0) for value in numbers)
    assert {row["law"] for row in rows if None in row.values()} == {"parabolic"}, "whose acceleration jumps inside"


def test_every_coefficient_is_the_published_one(run: Run) -> None:
    told = {row["law"]: row for row in run.json("laws")}
    published = list(
        csv.DictReader((Path(__file__).parents[1] / "laws" / "law_coefficients.csv").read_text("utf-8").splitlines())
    )
    assert {row["law"] for row in published} == set(COEFFICIENTS)
    for row in published:
        mine = told[COEFFICIENTS[row["law"]]]
        for column, key in (("Cv", "cv"), ("Ca", "ca"), ("Cj", "cj"), ("Cm=max|va|", "cm")):
            if row[column] == "inf":
                assert mine[key] is None
                continue
            # half a unit of the last printed digit; the table's P1 comes from rounded coefficients
            half = 2e-4 if "P1" in row["law"] else 0.51 * 10.0 ** -len(row[column].partition(".")[2])
            assert abs(mine[key] - float(row[column])) <= half, (row["law"], column)


def test_the_laws_as_text(run: Run) -> None:
    lines = run.text("laws").splitlines()
    assert lines[0].split() == ["law", "velocity", "acceleration", "jerk", "torque"]
    assert [line.split()[0] for line in lines[1:]] == list(LAWS)
    rows = {line.split()[0]: line for line in lines}
    assert rows["modified-sine"].split() == ["modified-sine", "1.760", "5.528", "69.47", "5.458"]
    assert rows["parabolic"].split()[3] == "infinite"
    jumping = {slug for slug, line in rows.items() if line.endswith("acceleration jumps at an end")}
    ends = {slug: law(np.array([0.0, 1.0]))[2] for slug, law in LAWS.items()}
    assert jumping == {slug for slug, a in ends.items() if np.abs(a).max() > 1e-9}


# -- blend ------------------------------------------------------------------------------------------------


def test_the_card_picker_is_printed_as_yang_does(run: Run) -> None:
    lines = run.text("blend", *PICKER, "--constant-velocity", *settings(h1=1, h3=1)).splitlines()
    assert lines[0] == "sequence C1-CV1-H2-P2"
    table = [line.split() for line in lines[3:7]]
    assert [row[0] for row in table] == ["C1", "CV1", "H2", "P2"]
    numbers = np.array([[float(word) for word in row[1:]] for row in table])
    heights, b, first, last, low, high = numbers.T
    assert heights.tolist() == [1.0, 18.0, 1.0, 20.0]
    assert b == pytest.approx(PICKER_SPANS, abs=6e-7)
    assert b == pytest.approx(PRINTED_SPANS, abs=0.02)
    assert first == pytest.approx([30.0, 48.8468354, 218.468354, 233.270624], abs=1e-6)
    assert last == pytest.approx([*first[1:], 330.0], abs=1e-6)
    assert low.tolist() == [0.0, 1.0, 19.0, 20.0]
    assert high.tolist() == [1.0, 19.0, 20.0, 0.0]
    assert "peak velocity of the rise 0.106118611 mm/deg" in lines


def test_the_card_picker_as_json(run: Run) -> None:
    rows = run.json("blend", *PICKER, "--constant-velocity", *settings(h1=1, h3=1))
    assert all(list(row) == ["curve", "start_deg", "span_deg", "start_mm", "rise_mm"] for row in rows)
    assert [row["curve"] for row in rows] == ["C1", "CV1", "H2", "P2"]
    assert spans(rows) == pytest.approx(PICKER_SPANS, abs=1e-9)
    assert [row["rise_mm"] for row in rows] == pytest.approx([1.0, 18.0, 1.0, -20.0], abs=1e-12)
    assert [row["start_mm"] for row in rows] == pytest.approx([0.0, 1.0, 19.0, 20.0], abs=1e-12)
    assert rows[0]["start_deg"] == 30.0
    for row, after in pairwise(rows):
        assert after["start_deg"] == pytest.approx(row["start_deg"] + row["span_deg"], abs=1e-12)


def test_yangs_text_asks_for_the_peak_at_250_degrees(run: Run) -> None:
    rows = run.json("blend", *PICKER, "--constant-velocity", *settings(h1=1, peak=250))
    assert spans(rows) == pytest.approx([20.632304, 190.118963, 9.248733, 80.0], abs=1e-6)
    assert rows[3]["start_deg"] == pytest.approx(250.0, abs=1e-9)


@pytest.mark.parametrize(
    ("words", "curves"),
    [
        (["--type", "DRD"], "C5"),
        (["--type", "DRD", *settings(h1=5)], "C1-C2"),
        (["--type", "DRD", "--constant-velocity", *settings(h1=2, vcv=0.1)], "C1-CV1-C2"),
        (["--type", "DRD-return"], "C6"),
        (["--type", "DRD-return", *settings(h1=5)], "C3-C4"),
        (["--type", "DRD-return", "--constant-velocity", *settings(h1=2, length=100)], "C3-CV2-C4"),
        (["--type", "DRRD"], "P1-P2"),
        (["--type", "DRRD", *settings(h3=4)], "C1-H2-P2"),
        (["--type", "DRRD", *settings(h4=4)], "P1-H3-C4"),
        (["--type", "DRRD", "--constant-velocity", "return", *settings(h4=1, h6=1)], "P1-H3-CV2-C4"),
        (["--type", "DRRD", "--constant-velocity", "both", *settings(h2=15, vcv=0.16)], "C1-CV1-H2-H3-CV2-C4"),
        (["--type", "RRR"], "H5-H6"),
        (["--type", "RRR", *settings(h1=6)], "H1-H2-H3-H4"),
        (["--type", "RRR", "--constant-velocity", *settings(length=60)], "H1-CV1-H2-H6"),
        (["--type", "RRR", "--constant-velocity", "both", *settings(h2=8, h1=5)], "H1-CV1-H2-H3-CV2-H4"),
    ],
)
def test_every_type_of_motion(words: list[str], curves: str, run: Run) -> None:
    rows = run.json("blend", "--stroke", "20", "--start", "30", "--end", "330", *words)
    assert "-".join(row["curve"] for row in rows) == curves
    assert math.fsum(spans(rows)) == pytest.approx(300.0, abs=1e-9)
    ups = math.fsum(row["rise_mm"] for row in rows if row["rise_mm"] > 0.0)
    assert ups == pytest.approx(0.0 if words[1] == "DRD-return" else 20.0, abs=1e-12)
    assert min(row["start_mm"] + min(row["rise_mm"], 0.0) for row in rows) == pytest.approx(0.0, abs=1e-12)
    heights = tuple(abs(row["rise_mm"]) for row in rows)
    check_joins(Blend(tuple(curves.split("-")), heights, tuple(spans(rows)), 30.0), words[1] == "RRR")


def test_plain_constant_velocity_is_that_of_the_rise(run: Run) -> None:
    plain = run.json("blend", *PICKER, *settings(h1=1, h3=1), "--constant-velocity")
    assert plain == run.json("blend", *PICKER, *settings(h1=1, h3=1), "--constant-velocity", "rise")


def test_every_setting_has_its_value_in_the_answer(run: Run) -> None:
    """Read off the printed curves: heights, speeds, lengths, places."""
    five = ("--sequence", "C1-CV1-H2-H3-C4", "--constant-velocity")
    rows = run.json("blend", *PICKER, *five, *settings(h2=12, h4=3, vcv2=0.2))
    assert rows[1]["rise_mm"] == pytest.approx(12.0, abs=1e-9)
    assert rows[3]["rise_mm"] == pytest.approx(-3.0, abs=1e-9)
    assert 2.0 * abs(rows[4]["rise_mm"]) / rows[4]["span_deg"] == pytest.approx(0.2, abs=1e-10)
    rows = run.json("blend", *PICKER, *five, *settings(h6=15, length=90, peak=200))
    assert rows[4]["rise_mm"] == pytest.approx(-15.0, abs=1e-9)
    assert rows[1]["span_deg"] == pytest.approx(90.0, abs=1e-8)
    assert rows[3]["start_deg"] == pytest.approx(200.0, abs=1e-8)
    rows = run.json("blend", *PICKER, "--constant-velocity", *settings(vcv=0.11, acceleration=0.05))
    assert rows[1]["rise_mm"] / rows[1]["span_deg"] == pytest.approx(0.11, abs=1e-10)
    largest = max(
        np.pi * 0.11**2 / (4.0 * rows[0]["rise_mm"]),
        0.11**2 / rows[2]["rise_mm"],
        216.0 / 41.0 * 20.0 / rows[3]["span_deg"] ** 2,
    )
    assert largest == pytest.approx(0.05, rel=1e-9)
    rows = run.json("blend", *PICKER, "--constant-velocity", "return", *settings(h5=16, h6=2))
    assert [abs(row["rise_mm"]) for row in rows[1:]] == pytest.approx([2.0, 16.0, 2.0], abs=1e-9)


def test_the_return_may_differ_from_the_rise(run: Run) -> None:
    rows = run.json("blend", *PICKER, "--return-stroke", "15", "--constant-velocity", *settings(h1=1, h3=1))
    assert [row["rise_mm"] for row in rows] == pytest.approx([1.0, 18.0, 1.0, -15.0], abs=1e-12)
    assert rows[0]["start_mm"] == 0.0


@pytest.mark.parametrize("goal", GOALS)
def test_the_best_is_the_solvers_and_better_than_its_neighbours(goal: str, run: Run) -> None:
    rows = run.json(
        "blend",
        "--type",
        "DRD",
        "--stroke",
        "20",
        "--start",
        "0",
        "--end",
        "180",
        "--best",
        goal,
        "--constant-velocity",
        *settings(length=60),
    )
    wanted = Request("DRD", 20.0, 0.0, 180.0, "rise", {"length": 60.0})
    assert spans(rows) == pytest.approx([s.span_deg for s in best(wanted, goal).segments], abs=1e-12)
    assert rows[1]["span_deg"] >= 60.0 * (1.0 - 1e-9)

    def cost(curves: Sequence[tuple[float, float]]) -> float:
        which, power, root = {"acceleration": (np.pi, 1, 2), "jerk": (np.pi**2, 1, 3), "torque": (4.0810, 2, 3)}[goal]
        return max(which * h**power / b**root for h, b in (curves[0], curves[2]))

    mine = cost([(row["rise_mm"], row["span_deg"]) for row in rows])
    for h1 in np.linspace(0.5, 9.5, 19):
        # all with the same length: v = 2 h/(β + length)
        speed = 2.0 * 20.0 / (180.0 + 60.0)
        h2 = 60.0 * speed
        h3 = 20.0 - h2 - h1
        if h3 > 0.0:
            other = cost([(h1, 2.0 * h1 / speed), (h2, 60.0), (h3, 2.0 * h3 / speed)])
            assert mine <= other * (1.0 + 1e-9)


def test_a_swinging_follower_has_its_own_keys(run: Run) -> None:
    """``start_deg`` is the cam angle, whatever the unit of the motion."""
    rows = run.json("blend", *PICKER, "--unit", "deg", "--constant-velocity", *settings(h1=1, h3=1))
    assert all(list(row) == ["curve", "start_deg", "span_deg", "level_deg", "rise_deg"] for row in rows)
    assert rows[0]["start_deg"] == 30.0
    assert [row["level_deg"] for row in rows] == pytest.approx([0.0, 1.0, 19.0, 20.0], abs=1e-12)
    assert "peak acceleration 0.0112611597 deg/deg^2" in run.text(
        "blend", *PICKER, "--unit", "deg", "--constant-velocity", *settings(h1=1, h3=1)
    )


def test_text_and_numbers_from_outside() -> None:
    done = outside("blend", *PICKER, "--constant-velocity", "--set", "h1=1", "--set", "h3=1", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert spans(json.loads(done.stdout)) == pytest.approx(PICKER_SPANS, abs=1e-9)


# -- what is refused --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "phrases"),
    [
        (["--constant-velocity", *settings(h1=1, h3=19.5)], ["h3 = 19.5", "h1 = 1", "feasible: 0 < h3 <= 19 mm"]),
        (["--constant-velocity", *settings(h1=1, vcv=0.05)], ["vcv = 0.05 mm/deg", "feasible: 0.07 < vcv <= 0.255294"]),
        (["--constant-velocity", *settings(h1=1, length=280)], ["length = 280 deg", "0 <= length < 271.428571 deg"]),
        (["--constant-velocity", *settings(h1=1, peak=140)], ["peak = 140 deg", "154.738885 <= peak < 330 deg"]),
        (["--constant-velocity", *settings(h1=1)], ["settings given: h1", "C1-CV1-H2-P2 requires 2 settings"]),
        (["--constant-velocity", *settings(h9=1)], ["h9", "h1 | h2"]),
        (["--constant-velocity", *settings(h1=-1, h3=1)], ["h1 = -1", "allowed: > 0 mm"]),
        (["--constant-velocity", "--best", "acceleration"], ["no constant velocity left"]),
        (["--return-stroke", "-3"], ["'-3': return stroke", "allowed: 1e-09 ... 1e+09"]),
        (["--sequence", "C1-C2"], ["'C1-C2'", "P1-P2 | C1-H2-P2"]),
    ],
)  # fmt: skip
def test_a_wish_that_cannot_be_fulfilled_is_one_line_with_its_range(
    words: list[str], phrases: list[str], run: Run, tmp_path: Path
) -> None:
    design = tmp_path / "design.toml"
    project.save(PUSHER, design)
    before = design.read_bytes()
    line = run.refused("blend", *PICKER, *words, "--into", design)
    for phrase in phrases:
        assert phrase in line
    assert design.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["design.toml"]


@pytest.mark.parametrize("end", [1e-6, -1e-6])
def test_the_range_that_is_named_is_right(end: float, run: Run) -> None:
    """A little inside of what a refusal tells is answered, a little outside is not."""
    line = run.refused("blend", *PICKER, "--constant-velocity", *settings(h1=1, vcv=0.5))
    low, high = (float(word) for word in line.partition("feasible: ")[2].split() if word[0].isdigit())
    for edge, inwards in ((low, 1.0), (high, -1.0)):
        code, _, _ = run(
            "blend",
            *PICKER,
            "--constant-velocity",
            "--set",
            "h1=1",
            "--set",
            f"vcv={edge * (1.0 + inwards * end):.17g}",
        )
        assert code == (0 if end > 0.0 else 2)


def test_a_precision_point_is_passed(run: Run) -> None:
    rows = run.json("blend", *PICKER, "--constant-velocity", *settings(h1=1), "--point", "180=12.5")
    row = next(r for r in rows if r["start_deg"] <= 180.0 < r["start_deg"] + r["span_deg"])
    assert row["curve"] == "CV1"
    assert row["start_mm"] + row["rise_mm"] * (180.0 - row["start_deg"]) / row["span_deg"] == pytest.approx(
        12.5, abs=1e-9
    )
    line = run.refused("blend", *PICKER, "--constant-velocity", *settings(h1=1), "--point", "180=25")
    assert line.startswith("point at 180 deg = 25 mm is not feasible with h1 = 1; feasible: ")
    assert "'180': must be ANGLE=DISPLACEMENT" in run.refused("blend", *PICKER, "--point", "180")


def test_a_setting_has_one_value(run: Run) -> None:
    words = ("blend", "--type", "DRD", "--stroke", "20", "--start", "30", "--end", "130")
    line = run.refused(*words, *settings(h1=5), *settings(h1=6))
    assert line == "h1 = 5, h1 = 6: a setting has one value; give one"
    assert run.json(*words, *settings(h1=5), *settings(h1=5)) == run.json(*words, *settings(h1=5))


@pytest.mark.parametrize(
    "words",
    [
        ["--type", "DDR"], ["--constant-velocity", "sometimes"], ["--best", "beauty"], ["--set", "h1"],
        ["--set", "h1=one"], ["--stroke", "x"], ["--unit", "inch"],
    ],
)  # fmt: skip
def test_words_that_make_no_sense_are_one_line(words: list[str], run: Run) -> None:
    line = run.refused("blend", *PICKER, *words)
    assert words[0] in line


@pytest.mark.parametrize(
    ("start", "end", "stroke"), [("330", "30", "20"), ("-5", "90", "20"), ("30", "400", "20"), ("30", "90", "0")]
)
def test_angles_and_stroke_out_of_range(start: str, end: str, stroke: str, run: Run) -> None:
    line = run.refused("blend", "--type", "DRD", f"--stroke={stroke}", f"--start={start}", f"--end={end}")
    assert "allowed: " in line


# -- into a design ----------------------------------------------------------------------------------------


def check_whole(design: Design, path: Path) -> Motion:
    """The file holds this design, whole."""
    assert project.load(path) == design
    assert faults(design) == []
    return design.drive.motion


def jumps(motion: Motion) -> list[bool]:
    """Whether s, v or a jumps at the joins in order."""
    return [bool(join.jumps[:3].any()) for join in program(motion).joins]


def test_a_whole_motion_takes_the_turn(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "picker.toml"
    project.save(with_assumed(with_assumed(PUSHER, "motion.segments[1].law", True), "loads.preload_n", True), path)
    printed = run.text("blend", *PICKER, "--constant-velocity", *settings(h1=1, h3=1), "--into", path)
    assert printed.startswith("sequence C1-CV1-H2-P2\n"), "it is printed, too"
    motion = check_whole(project.load(path), path)
    assert [s.curve.law for s in motion.segments] == ["dwell", "c1", "cv1", "h2", "p2", "dwell"]
    assert [s.span_deg for s in motion.segments] == pytest.approx([30.0, *PICKER_SPANS, 30.0], abs=1e-9)
    assert [s.rise for s in motion.segments] == pytest.approx([0.0, 1.0, 18.0, 1.0, -20.0, 0.0], abs=1e-12)
    assert motion.start == 0.0
    assert not any(jumps(motion))
    design = project.load(path)
    assert design.assumed == ("loads.preload_n",), "a motion that was made is not assumed"
    assert design.drive.mechanism == PUSHER.drive.mechanism
    made = path.read_bytes()
    line = run.refused("blend", *PICKER, "--constant-velocity", *settings(h1=1, h3=25), "--into", path)
    assert "feasible: 0 < h3 <= 19 mm" in line
    assert path.read_bytes() == made


def test_a_blend_over_360_degrees_leaves_no_dwell(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "rrr.toml"
    project.save(PUSHER, path)
    run.text("blend", "--type", "RRR", "--stroke", "20", "--start", "0", "--end", "360", "--into", path)
    motion = check_whole(project.load(path), path)
    assert [s.curve.law for s in motion.segments] == ["h5", "h6"]
    assert not any(jumps(motion))


def test_a_missing_or_broken_design_is_refused(run: Run, tmp_path: Path) -> None:
    wanted = [*PICKER, "--constant-velocity", *settings(h1=1, h3=1)]
    assert "missing.toml" in run.refused("blend", *wanted, "--into", tmp_path / "missing.toml")
    broken = tmp_path / "broken.toml"
    broken.write_text("format = 1\nname = [", "utf-8")
    assert "broken.toml" in run.refused("blend", *wanted, "--into", broken)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["broken.toml"]


def test_another_unit_than_the_designs_is_refused(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "pusher.toml"
    project.save(PUSHER, path)
    for kind in ("DRRD", "DRD"):
        line = run.refused(
            "blend", "--type", kind, "--stroke", "20", "--start", "30", "--end", "60", "--unit", "deg", "--into", path
        )
        assert "not the unit of this design's motion; allowed: mm" in line
    assert project.load(path) == PUSHER


def drd(**more: Any) -> Request:
    return Request("DRD", **{"stroke": 150.0, "start": 283.5, "end": 325.0, **more})


def test_a_rise_alone_takes_the_place_of_the_rise(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "lift.toml"
    marks = ("motion.segments[3].law", "motion.segments[4].span_deg")
    project.save(replace(LIFT, assumed=marks), path)
    run.text(
        "blend",
        "--type",
        "DRD",
        "--stroke",
        "150",
        "--start",
        "283.5",
        "--end",
        "325",
        "--constant-velocity",
        *settings(h1=30, h3=40),
        "--into",
        path,
    )
    motion = check_whole(project.load(path), path)
    assert motion.start == 150.0
    assert [s.curve.law for s in motion.segments] == ["dwell", "modified-sine", "dwell", "c1", "cv1", "c2", "dwell"]
    assert motion.segments[:3] == LIFT.drive.motion.segments[:3]
    assert [s.rise for s in motion.segments[3:6]] == pytest.approx([30.0, 80.0, 40.0], abs=1e-9)
    assert math.fsum(s.span_deg for s in motion.segments[3:6]) == pytest.approx(41.5, abs=1e-9)
    assert not any(jumps(motion))
    assert project.load(path).assumed == ("motion.segments[6].span_deg",), "of what was there before"


def test_what_moves_otherwise_in_the_design_is_told(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "lift.toml"
    project.save(LIFT, path)
    words = ("blend", "--type", "DRD", "--start", "283.5", "--end", "325", "--into", path)
    assert "in the design" not in run.text(*words, "--stroke", "150"), "the rest stays"
    told = run.text(*words, "--stroke", "120").splitlines()[-1]
    changed = project.load(path).drive.motion.segments[1]
    assert (changed.curve.law, changed.rise) == ("modified-sine", -120.0)
    assert told.startswith("in the design segment 2, modified-sine, changes to close the turn: \u2212120 mm")
    rows = run.json(*words, "--stroke", "90")
    assert [row["rise_mm"] for row in rows] == [90.0], "nothing but the curves as JSON"


def test_dwells_are_cut_where_a_blend_begins_and_ends() -> None:
    made = with_blend_between(LIFT, blend(drd(start=250.0, end=330.0))).drive.motion
    assert [s.curve.law for s in made.segments] == ["dwell", "modified-sine", "dwell", "c5", "dwell"]
    assert [s.span_deg for s in made.segments] == [35.0, 41.5, 173.5, 80.0, 30.0]
    inside = blend(Request("DRRD", 20.0, 100.0, 200.0))
    made = with_blend_between(LIFT, inside).drive.motion
    assert [s.curve.law for s in made.segments][2:6] == ["dwell", "p1", "p2", "dwell"]
    assert [s.span_deg for s in made.segments] == pytest.approx([35.0, 41.5, 23.5, 50.0, 50.0, 83.5, 41.5, 35.0])
    assert not any(jumps(made))


def test_another_stroke_is_brought_back_by_the_next_segment_that_moves() -> None:
    made = with_blend_between(LIFT, blend(drd(stroke=120.0))).drive.motion
    assert [s.rise for s in made.segments] == [0.0, -120.0, 0.0, 120.0, 0.0]
    assert [s.curve.law for s in made.segments] == ["dwell", "modified-sine", "dwell", "c5", "dwell"]


def test_a_segment_that_moves_is_not_cut() -> None:
    for start, end in ((300.0, 325.0), (283.5, 300.0), (60.0, 340.0)):
        with pytest.raises(DesignError, match=r"moves, and would be split.*a join, or an angle in a dwell"):
            with_blend_between(LIFT, blend(drd(start=start, end=end)))


STANDING = with_drive(PUSHER, motion=Motion(0.0, (Segment(360.0, 0.0),)))


@pytest.mark.parametrize(
    ("kind", "start", "end", "laws", "spans_deg", "first"),
    [
        ("DRD", 30.0, 120.0, ["dwell", "c5", "dwell", "c6", "dwell"], [30.0, 90.0, 120.0, 90.0, 30.0], 0.0),
        ("DRD", 30.0, 180.0, ["dwell", "c5", "c6", "dwell"], [30.0, 150.0, 150.0, 30.0], 0.0),
        ("DRD", 30.0, 300.0, ["dwell", "c5", "c6"], [30.0, 270.0, 60.0], 0.0),
        ("DRD", 90.0, 360.0, ["c6", "c5"], [90.0, 270.0], 20.0),
        ("DRD-return", 30.0, 120.0, ["dwell", "c6", "dwell", "c5", "dwell"], [30.0, 90.0, 120.0, 90.0, 30.0], 20.0),
    ],
)
def test_a_rise_into_a_motion_that_stands_still_comes_back_mirrored(
    kind: str, start: float, end: float, laws: list[str], spans_deg: list[float], first: float
) -> None:
    made = with_blend(STANDING, blend(Request(kind, 20.0, start, end)))
    assert faults(made) == []
    motion = made.drive.motion
    assert [s.curve.law for s in motion.segments] == laws
    assert [s.span_deg for s in motion.segments] == pytest.approx(spans_deg, abs=1e-9)
    assert motion.start == first, "the lowest level is 0"
    assert not any(jumps(motion))


def test_the_way_back_of_several_curves_is_smooth_too() -> None:
    wish = Request("DRD", 20.0, 30.0, 250.0, "rise", {"h1": 2.0, "h3": 7.0})
    motion = with_blend(STANDING, blend(wish)).drive.motion
    assert [s.curve.law for s in motion.segments] == ["dwell", "c1", "cv1", "c2", "c3", "cv2", "c4"]
    assert [s.rise for s in motion.segments[4:]] == pytest.approx([-7.0, -11.0, -2.0], abs=1e-9)
    assert not any(jumps(motion))


def test_no_way_back_is_left_of_a_whole_turn() -> None:
    with pytest.raises(DesignError, match="leaves no angle for the return"):
        with_blend(STANDING, blend(Request("DRD", 20.0, 0.0, 360.0)))


def test_a_rise_alone_is_no_whole_turn() -> None:
    with pytest.raises(DesignError, match=r"rises add up to 20 mm.*DRRD \| RRR"):
        with_blend_as_motion(STANDING, blend(Request("DRD", 20.0, 30.0, 120.0)))


def test_every_law_of_a_blend_is_one_of_the_table() -> None:
    for wish in (Request("DRRD", 20.0, 30.0, 330.0), Request("RRR", 20.0, 0.0, 360.0)):
        assert all(find_law(s.curve.law) is not None for s in blend(wish).segments)


@pytest.mark.parametrize(
    ("sequence", "type_words", "settings"),
    [
        ("C1-CV1-C2", ["--type", "DRD", "--constant-velocity"], ["h1=5", "h3=5"]),
        ("c3-c4", ["--type", "DRD-return"], ["h4=5"]),
        ("C1-H2-P2", ["--type", "DRRD"], ["h1=12"]),
        ("H1-H2-H3-H4", ["--type", "RRR"], ["h1=8"]),
    ],
)
def test_a_sequence_says_its_type_itself(
    sequence: str, type_words: list[str], settings: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--sequence", sequence, "--stroke", "20", "--start", "30", "--end", "330"]
    words += [word for setting in settings for word in ("--set", setting)]
    code = main(["blend", *words])
    alone = capsys.readouterr()
    assert code == main(["blend", *type_words, *words])
    assert capsys.readouterr() == alone
    assert alone.out.startswith(f"sequence {sequence.upper()}\n")


@pytest.mark.parametrize(
    ("sequence", "told"),
    [
        ("C1-H1", "H1 cannot follow C1: velocity would jump from rising to rest; allowed after C1: C2 | H2 | CV1"),
        ("C1-X2", "X2: unknown curve"),
    ],
)
def test_a_sequence_whose_curves_do_not_join_is_refused_in_one_line(
    sequence: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["blend", "--sequence", sequence, "--stroke", "20", "--start", "30", "--end", "330"]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
