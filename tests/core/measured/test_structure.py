"""core.measured: a table of s, v, a comes back as the dwells and laws that it was made of; what is no law goes through its rows."""

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from measured_tables import LAWS, position
from mechanisms import levels
from sampled import spread

from core import project
from core.__main__ import main
from core.design import Design, Motion, NamedCurve, only
from core.measured import MotionFit, fit, layout, read_sheet, read_table
from core.measured.event import velocity_jumps
from core.motion import findings, program
from core.output.export import table as exported
from core.output.measured_text import fit_data, notes
from core.study import Study
from core.study.quantities import KINEMATICS

EXAMPLES = sorted((Path(__file__).parents[3] / "resources/examples").glob("*.toml"))
OF_THE_TABLE = [path for path in EXAMPLES if 'law = "optimal"' not in path.read_text("utf-8")]
"""Examples whose laws are told by their tables; an optimal law comes back as a table."""
SEEDED, MANY = 6, 1000


def driven(path: Path) -> list[Design]:
    """Each drive of an example that has a motion of its own, as a design."""
    whole = project.load(path)
    return [only(whole, i) for i, drive in enumerate(whole.drives) if drive.motion is not None]


def derivative(motion: Motion, angles: np.ndarray, order: int) -> np.ndarray:
    """By degrees, in the motion's unit."""
    compiled = program(motion)
    y = compiled.state(compiled.angles(np.deg2rad(np.mod(angles, 360.0)))).y[order]
    return np.asarray(y * np.deg2rad(1.0) ** order / motion.scale)


def kinematics(design: Design, rows: int) -> bytes:
    blocks = exported(Study(design, rows), KINEMATICS, ("motion",))
    assert blocks is not None
    return b"".join(blocks)


def fitted(text: str | bytes, motion_unit: str = "mm", speed: float | None = None, **how: object) -> MotionFit:
    sheet = read_sheet(text if isinstance(text, bytes) else text.encode(), "t.csv")
    return fit(read_table(sheet, layout(sheet, motion_unit=motion_unit, speed_rpm=speed), speed), **how)  # type: ignore[arg-type]


def written(
    motion: Motion, rows: int, digits: int = 17, orders: Sequence[int] = (0,), error: float = 0.0, seed: int = 0
) -> str:
    angles = 360.0 * np.arange(rows) / rows
    scatter = error * np.random.default_rng(seed).normal(size=rows)
    columns = [derivative(motion, angles, k) + (scatter if k == 0 else 0.0) for k in orders]
    heads = ("lift [mm]", "velocity [mm/deg]", "acceleration [mm/deg2]")
    lines = [",".join(["angle [deg]", *(heads[k] for k in orders)])]
    return "\n".join([*lines, *(",".join(f"{v:.{digits}g}" for v in row) for row in np.array([angles, *columns]).T)])


def rounded(motion: Motion, rows: int, step: float) -> str:
    angles = 360.0 * np.arange(rows) / rows
    values = np.round(position(motion, angles) / step) * step
    return "angle [deg],lift [mm]\n" + "".join(f"{a:.10g},{v:.6f}\n" for a, v in zip(angles, values, strict=True))


# -- exact tables -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "rows", [360, pytest.param(3600, marks=pytest.mark.fuzz), pytest.param(36_000, marks=pytest.mark.fuzz)]
)
@pytest.mark.parametrize("path", spread(OF_THE_TABLE, 1), ids=lambda path: path.stem)
def test_the_table_of_an_example_comes_back(path: Path, rows: int) -> None:
    """Every row to 1e-9 of its channel, between rows to 1e-5 of the acceleration, and the very laws."""
    for design in driven(path):
        motion, speed = design.drive.motion, design.speed_rpm
        found = fitted(kinematics(design, rows), motion.unit, speed)
        angles = 360.0 * np.arange(rows) / rows
        fine = np.arange(0.0, 360.0, 0.0917)
        for order in range(3):
            wanted = derivative(motion, angles, order)
            size = float(np.ptp(wanted) if order == 0 else np.abs(wanted).max())
            assert np.abs(derivative(found.motion, angles, order) - wanted).max() <= 1e-9 * size
            if order == 2:
                assert np.abs(derivative(found.motion, fine, 2) - derivative(motion, fine, 2)).max() <= 1e-5 * size
        same = {"c5": "cycloidal", "c6": "cycloidal", "h5": "simple-harmonic", "h6": "simple-harmonic"}
        laws = [same.get(segment.curve.law, segment.curve.law) for segment in motion.segments]
        assert [segment.curve.law for segment in found.motion.segments] == laws
        assert {f.code for f in findings(program(found.motion))} == {f.code for f in findings(program(motion))}


def test_the_lift_comes_back_as_five_segments(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (design,) = driven(next(path for path in EXAMPLES if path.stem == "transfer_lift"))
    table, target = tmp_path / "kinematics.csv", tmp_path / "lift.toml"
    table.write_bytes(kinematics(design, 360))
    project.save(design, target)
    assert main(["measured", str(table), "--into", str(target), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    segments = project.load(target).drive.motion.segments
    assert [s.curve for s in segments] == [
        NamedCurve(law) for law in ("dwell", "modified-sine", "dwell", "modified-sine", "dwell")
    ]
    assert [s.span_deg for s in segments] == pytest.approx([35.0, 41.5, 207.0, 41.5, 35.0], abs=1e-6)
    assert [s.rise for s in segments] == pytest.approx([0.0, -150.0, 0.0, 150.0, 0.0], abs=1e-9)
    assert [s["law"] for s in told["segments"]] == [s.curve.law for s in segments]
    assert [s["span_deg"] for s in told["segments"]] == pytest.approx([s.span_deg for s in segments], abs=1e-6)
    assert [s["start_deg"] for s in told["segments"]] == pytest.approx([0.0, 35.0, 76.5, 283.5, 325.0], abs=1e-6)
    by_law = {(s["law"], s["rise"] > 0.0): s for s in told["segments"]}
    assert by_law["modified-sine", False]["rows"] == [37, 78]
    assert by_law["modified-sine", True]["fit"]["max"] < 1e-9


@pytest.mark.parametrize("law", ["parabolic", "modified-trapezoid", "3-4-5"])
def test_without_laws_quintics_go_through_all_rows_and_a_jump_is_named(law: str) -> None:
    motion = levels(0.0, (60.0, 0.0, "dwell"), (100.0, 20.0, law), (60.0, 20.0, "dwell"), (140.0, 0.0, law))
    found = fitted(written(motion, 720, orders=(0, 1, 2)), laws=False)
    assert {s.law for s in found.segments} == {"dwell", "table"}
    for column in found.columns:
        assert np.abs(column.residuals).max() <= 1e-9 * np.abs(column.column.values).max()
    jumps = {round(jump.angle, 6) % 360.0 for jump in found.jumps}
    assert jumps == ({0.0, 60.0, 110.0, 160.0, 220.0, 290.0} if law == "parabolic" else set())


# -- columns that contradict each other -------------------------------------------------------------------


def test_a_velocity_that_is_no_derivative_is_named_with_its_rows_and_not_fitted() -> None:
    """At another speed of the shaft: the displacement alone makes the motion, and it is said which speed would fit."""
    (design,) = driven(next(path for path in EXAMPLES if path.stem == "tappet_knife"))
    found = fitted(kinematics(design, 360), speed=2.0 * design.speed_rpm)
    assert [gap.order for gap in found.contradicted] == [1, 2]
    assert found.contradicted[0].factor == pytest.approx(0.5, rel=1e-3)
    told = [note for note in notes(found) if " contradicts " in note]
    assert told[0].startswith(
        "column 3 (velocity_mm_s) contradicts column 2 (displacement_mm): overall it is 0.5 times"
    )
    assert "rows deviate by more than their errors, lines 4" in told[0]
    assert {s.law for s in found.segments} == {"dwell", "3-4-5"}


def test_of_columns_that_contradict_each_other_the_user_chooses(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A gauge of lift that reads twice too much beside a right velocity and acceleration."""
    lines = written(BENT_LIFT, 360, 9, (0, 1, 2)).splitlines()
    doubled = [f"{a},{2.0 * float(s):.9g},{rest}" for a, s, rest in (line.split(",", 2) for line in lines[1:])]
    table, made = tmp_path / "t.csv", tmp_path / "made.toml"
    table.write_text("\n".join([lines[0], *doubled]), "utf-8")

    def read(*words: str) -> dict[str, Any]:
        assert main(["measured", str(table), "--json", *words]) == 0
        answer: dict[str, Any] = json.loads(capsys.readouterr().out)
        return answer

    both = read()
    assert both["fit"]["stroke_mm"] == pytest.approx(18.0)
    assert "column 2 (lift [mm]) is trusted, column 3 (velocity [mm/deg]) is compared only" in " ".join(both["notes"])
    assert [c["compared_only"] for c in both["columns"]] == [False, True, True]
    chosen = read("--trust", "v", "--into", str(made), "--as", "motion")
    assert chosen["fit"]["stroke_mm"] == pytest.approx(9.0, abs=1e-3)
    assert [(c["quantity"], c["compared_only"]) for c in chosen["columns"]] == [
        ("velocity", False), ("displacement", True), ("acceleration", True),
    ]  # fmt: skip
    assert any("the motion is fitted to velocity, as chosen; compared only: column 2" in n for n in chosen["notes"])
    motion = project.load(made).drive.motion
    assert motion is not None
    at = np.arange(0.0, 360.0, 7.0)
    assert np.abs(derivative(motion, at, 0) - derivative(BENT_LIFT, at, 0)).max() < 1e-3
    laws = ["dwell", "4-5-6-7", "dwell", "3-4-5", "dwell"]
    assert [segment["law"] for segment in chosen["segments"]] == laws, "the dwells stand still"
    for words, said in (
        ("s,v", "times the derivative of the displacement: they contradict each other"),
        ("s,w", "trust 's,w'; allowed: one or more of s, v, a"),
    ):
        assert main(["measured", str(table), "--trust", words]) == 2
        told = capsys.readouterr().err
        assert said in told
        assert told.count("\n") == 1
    table.write_text("angle [deg],lift [mm]\n" + "".join(f"{a},{a % 7}\n" for a in range(360)), "utf-8")
    assert main(["measured", str(table), "--trust", "v"]) == 2
    assert "no column's header states velocity" in capsys.readouterr().err


def test_a_residual_above_a_stated_error_is_said() -> None:
    """A velocity that leaves the derivative and comes back by and by is no run of spoiled rows."""
    text = written(BENT_LIFT, 360, orders=(0, 1, 2)).splitlines()
    for line, off in enumerate((0.004, 0.008, 0.01, 0.008, 0.004), 99):
        cells = text[line].split(",")
        text[line] = ",".join([*cells[:2], repr(float(cells[2]) + off), cells[3]])
    found = fitted("\n".join(text), error={"displacement": 1e-6, "velocity": 1e-6, "acceleration": 1e-4})
    told = [note for note in notes(found) if "contradict the motion" in note and note.startswith("column 3")]
    assert len(told) == 1
    assert ", line 102 (100 deg); lines " in told[0]


BENT_LIFT = levels(
    0.0, (60.0, 0.0, "dwell"), (80.0, 9.0, "4-5-6-7"), (60.0, 9.0, "dwell"), (100.0, 0.0, "3-4-5"), (60.0, 0.0, "dwell")
)


# -- measured tables --------------------------------------------------------------------------------------


@pytest.mark.parametrize("laws", [True, False])
def test_a_lift_table_in_tenths_of_a_thou_has_a_dwell_that_does_not_move(laws: bool) -> None:
    """An engine's cam, a row a degree, in 1e-4 in: the base circle stands still, and the acceleration is that of the cam."""
    motion = levels(0.0, (110.0, 0.0, "dwell"), (66.25, 9.4, "4-5-6-7"), (73.75, 0.0, "4-5-6-7"), (110.0, 0.0, "dwell"))
    found = fitted(rounded(motion, 360, 25.4e-4), error=25.4e-4 / np.sqrt(12.0), laws=laws)
    still = np.concatenate((np.arange(0.0, 106.0, 0.25), np.arange(255.0, 360.0, 0.25)))
    for order in range(3):
        assert not derivative(found.motion, still, order).any()
    fine = np.arange(120.0, 240.0, 0.25)
    wanted = derivative(motion, fine, 2)
    off = np.abs(derivative(found.motion, fine, 2) - wanted).max() / np.abs(wanted).max()
    assert off < (0.01 if laws else 0.15)
    turns = np.count_nonzero(np.diff(np.sign(derivative(found.motion, fine, 3))))
    assert turns <= 7, "no ripple"
    assert {s.law for s in found.segments} == {"dwell", "4-5-6-7" if laws else "table"}


@pytest.mark.stress
def test_none_of_two_laws_is_named_where_both_fit() -> None:
    """At an error of half a percent cycloidal and Gutman's law cannot be told from their neighbours."""
    motion = levels(0.0, (90.0, 0.0, "dwell"), (60.0, 10.0, "gutman-1-3"), (90.0, 10.0, "dwell"), (120.0, 0.0, "3-4-5"))
    found = fitted(written(motion, 120, 6, error=0.05), error=0.05)
    several = [s for s in found.segments if s.ambiguous]
    assert several
    assert all(s.law == "table" and len(s.ambiguous) > 1 for s in several)
    data = fit_data(read_sheet(b"a,b\n0,1\n1,2\n", "t.csv"), found)
    assert any(set(s.get("fits_as_well", ())) >= {"gutman-1-3"} for s in data["segments"])


# -- seeded tables ----------------------------------------------------------------------------------------


def case(seed: int) -> tuple[Motion, str, float]:
    """Laws with random decimal spans and strokes, with noise or rounded, at less than 1e-4 of the stroke."""
    chance = np.random.default_rng(seed)
    rise, back, top = (round(float(chance.uniform(40.0, 110.0)), int(chance.integers(0, 4))) for _ in range(3))
    first = round(float(chance.uniform(10.0, 40.0)), 2)
    stroke = round(float(chance.uniform(5.0, 60.0)), 2)
    laws = [str(law) for law in chance.choice(LAWS, 2)]
    motion = levels(
        0.0, (first, 0.0, "dwell"), (rise, stroke, laws[0]), (top, stroke, "dwell"), (back, 0.0, laws[1]),
        (round(360.0 - first - rise - top - back, 6), 0.0, "dwell"),
    )  # fmt: skip
    rows = int(chance.choice([360, 720]))
    step = float(chance.choice([0.001, 25.4e-4]))
    if chance.random() < 0.5 and step / np.sqrt(12.0) < 1e-4 * stroke:
        return motion, rounded(motion, rows, step), step / np.sqrt(12.0)
    error = min(float(10.0 ** chance.uniform(-4.0, np.log10(0.005))), 9e-5 * stroke)
    return motion, written(motion, rows, 9, error=error, seed=seed), error


def judged(seeds: Sequence[int]) -> list[int]:
    """The seeds whose laws are not found; raises where a law is named wrongly, or a dwell moves."""
    missed = []
    for seed in seeds:
        motion, text, error = case(seed)
        found = fitted(text, error=error)
        wanted = [s.curve.law for s in motion.segments]
        names = [s.curve.law for s in found.motion.segments]
        assert set(names) <= {*wanted, "table"}, seed
        if names != wanted:
            missed.append(seed)
        else:
            assert [s.span_deg for s in found.motion.segments] == pytest.approx(
                [s.span_deg for s in motion.segments], abs=0.2
            ), seed
        assert found.stroke == pytest.approx(max(abs(s.rise) for s in motion.segments), abs=4.0 * error), seed
        starts = np.cumsum([0.0, *(s.span_deg for s in motion.segments)])
        for k, segment in enumerate(motion.segments):
            if segment.rise == 0.0:
                inner = np.linspace(starts[k] + 0.2 * segment.span_deg, starts[k + 1] - 0.2 * segment.span_deg, 50)
                assert not derivative(found.motion, inner, 1).any(), seed
    return missed


def test_laws_of_seeded_tables_are_recognised() -> None:
    assert len(judged(range(SEEDED))) <= 0.05 * SEEDED


@pytest.mark.fuzz
def test_laws_of_many_seeded_tables_are_recognised() -> None:
    first = int(os.environ.get("KINDYNA_FUZZ_SEED", "0"))
    assert len(judged(range(first, first + MANY))) <= 0.05 * MANY


def test_a_table_becomes_a_file_of_the_motion_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (design,) = driven(next(path for path in EXAMPLES if path.stem == "transfer_lift"))
    table, made = tmp_path / "kinematics.csv", tmp_path / "new.toml"
    table.write_bytes(kinematics(design, 180))
    read = ["measured", str(table), "--columns", "s=displacement_mm", "--speed", "20", "--into", str(made)]
    assert main([*read, "--as", "segment"]) == 2
    assert "--as segment: give --segment N" in capsys.readouterr().err
    assert not made.exists()
    assert main(read) == 0  # a design is the default
    plain = made.read_bytes()
    made.unlink()
    assert main([*read, "--as", "motion"]) == 0
    assert made.read_bytes() == plain
    found = project.load(made)
    assert found.drive.kind == "motion"
    assert found.speed_rpm == 20.0
    assert [each.curve.law for each in found.drive.motion.segments] == ["dwell", "modified-sine"] * 2 + ["dwell"]


# -- what the user makes of the segments ------------------------------------------------------------------

TWO_DWELLS = levels(
    0.0, (60.0, 0.0, "dwell"), (80.0, 9.0, "modified-sine"), (60.0, 9.0, "dwell"), (100.0, 0.0, "modified-sine"), (60.0, 0.0, "dwell")
)  # fmt: skip


@pytest.mark.parametrize(
    ("switches", "found"),
    spread(
        [
            ([(100.0, "table")], ["60 table 80", "140 dwell 60", "200 modified-sine 100", "300 dwell 120"]),
            ([(170.0, "table")], ["60 modified-sine 80", "140 table 60", "200 modified-sine 100", "300 dwell 120"]),
            ([(0.0, "table"), (100.0, "table")], ["140 dwell 60", "200 modified-sine 100", "300 table 200"]),
            ([(170.0, "table"), (100.0, "table")], ["60 table 140", "200 modified-sine 100", "300 dwell 120"]),
            ([(0.0, "table"), (100.0, "table"), (170.0, "table"), (250.0, "table")], []),
        ],
        2,
    ),
)
def test_segments_are_switched_and_tables_that_follow_on_each_other_are_one(
    switches: list[tuple[float, str]], found: list[str]
) -> None:
    fit = fitted(written(TWO_DWELLS, 360, digits=6), error=1e-5, switches=switches)
    assert [f"{each.start_deg:.0f} {each.law} {each.span_deg:.0f}" for each in fit.segments] == found
    assert fit.rms < 1.2e-5
    assert velocity_jumps(fit) == ()


@pytest.mark.stress
def test_a_stretch_that_wavers_is_made_a_dwell_and_a_stroke_another_law() -> None:
    angles = np.arange(0.0, 360.0)
    waver = np.where((angles > 150.0) & (angles < 190.0), 0.002 * np.sin(np.deg2rad(4.5 * (angles - 150.0))) ** 2, 0.0)
    values = position(TWO_DWELLS, angles) + waver
    text = "angle [deg],lift [mm]\n" + "".join(f"{a:g},{v:.6f}\n" for a, v in zip(angles, values, strict=True))
    natural = fitted(text, error=1e-5)
    assert [each.law for each in natural.segments] == [
        "modified-sine",
        "dwell",
        "table",
        "dwell",
        "modified-sine",
        "dwell",
    ]
    assert sum(each.span_deg for each in natural.segments) == pytest.approx(360.0), "none lies over another"
    fit = fitted(text, error=1e-5, switches=[(170.0, "dwell"), (250.0, "cycloidal")])
    assert [each.law for each in fit.segments] == ["modified-sine", "dwell", "cycloidal", "dwell"]
    assert velocity_jumps(fit) == ()


def test_what_a_segment_cannot_be_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "t.csv"
    path.write_text(written(TWO_DWELLS, 360, digits=6), "utf-8")
    for words, told in {
        "100=dwell": "segment at 100 deg: its ends differ by 9 mm; the ends of a dwell have one level",
        "170=cycloidal": "segment at 170 deg: it is a dwell, and cannot be cycloidal",
        "100=spiral": "allowed: DEG=KIND, KIND of table, dwell, constant-velocity",
    }.items():
        assert main(["measured", str(path), "--switch", words]) == 2
        assert told in capsys.readouterr().err
    assert main(["measured", str(path), "--switch", "100=table,250=cycloidal", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert [each["law"] for each in answer["segments"]] == ["dwell", "table", "dwell", "cycloidal", "dwell"]
