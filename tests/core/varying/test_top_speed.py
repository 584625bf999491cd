"""The greatest speed within limits: a goal that is a varied field, and the search for the top speed."""

import json
import threading
from dataclasses import replace
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from outlined import clearance, slides

from core.__main__ import main
from core.design import Design, NamedCurve, Segment, distances, edited, get, put, with_drive
from core.errors import KindynaError
from core.numerics.lazy import Cancelled, cancellable
from core.process import resources
from core.project import load, loads, save
from core.study import Study, findings_of, many
from core.varying import (
    Goal,
    StudyFile,
    StudyLimit,
    VariedField,
    find_top_speed,
    load_study,
    optimise,
    save_study,
    study_of,
    top_speed_study,
)

SPEED = "shaft.speed_rpm"
STROKE, RATE, PRELOAD, MASS, LEAST = 8.0, 18.0, 140.0, 0.12, 20.0  # mm, N/mm, N, kg, N


def example(name: str) -> Design:
    return load(resources() / "examples" / f"{name}.toml")


def flat_follower() -> Design:
    """A flat tappet that rises and returns by a half cosine each, over 180 deg, without friction."""
    design = example("tappet_flat")
    rise, back = (Segment(180.0, sign * STROKE, NamedCurve("simple-harmonic")) for sign in (1.0, -1.0))
    motion = replace(design.drive.motion, segments=(rise, back))
    design = replace(with_drive(design, motion=motion), assumed=())
    for path in ("loads.friction", "loads.contact_friction"):
        design = put(design, path, 0.0)
    return design


def top_speed_of_flat_follower(least: float) -> float:
    """Speed [rpm] at which the contact force is ``least`` [N] at the top.

    With s = h (1 - cos θ)/2 the force m ω² s'' + c s + P + m g is linear in cos θ: F = c h + P + m g - m ω² h/2 at the top.
    """
    force = RATE * STROKE + PRELOAD + MASS * 9.80665 - least
    return sqrt(2.0 * force / (MASS * STROKE * 1e-3)) * 30.0 / pi


def speed_study(design: Design, *vary: VariedField, minimise: bool = False, **limits: tuple[str, float]) -> StudyFile:
    """Study whose goal is the speed; a limit is a column with a statistic and a bound, least for "min"."""
    rows = tuple(
        StudyLimit(name, of, **{"min" if of == "min" else "max": bound}) for name, (of, bound) in limits.items()
    )
    return StudyFile(design="", vary=vary, limits=rows, goals=(Goal(field=SPEED, minimise=minimise),))


@pytest.mark.parametrize("least", [0.0, LEAST])
def test_the_top_speed_of_a_flat_follower_by_contact_force_is_that_of_the_closed_form(least: float) -> None:
    design, exact = flat_follower(), top_speed_of_flat_follower(least)
    rows = (VariedField(SPEED, 120.0, 12000.0), VariedField("cam.base_radius_mm", 20.0, 30.0))
    found = optimise(study_of(speed_study(design, *rows, contact_force_n=("min", least)), design), starts=2)
    assert found.is_feasible
    assert found.before == {SPEED: 1200.0}
    assert found.goals[SPEED] == found.answer[SPEED] == get(found.design, SPEED)
    assert exact * (1.0 - 2e-6) <= found.answer[SPEED] <= exact
    assert found.binding[0].limit == "contact_force_n_min"
    # 1 % of the limit, of 0 that of the largest force so far: so much more of c h + P + m g - F, half of it in the speed
    force = RATE * STROKE + PRELOAD + MASS * 9.80665
    largest = force - 0.5 * MASS * STROKE * 1e-3 * (1200.0 * pi / 30.0) ** 2
    per_percent = 0.01 * (least or largest) * exact / (2.0 * (force - least))
    assert found.binding[0].per_percent == pytest.approx(per_percent, rel=1e-4)


@pytest.mark.stress
def test_a_goal_that_is_a_field_is_minimised_too_and_traded_for_a_quantity() -> None:
    """The lowest speed is its bound; of speed and contact force each point of the front is faster or presses less."""
    design = flat_follower()
    rows = (VariedField(SPEED, 600.0, 2400.0),)
    slow = optimise(study_of(speed_study(design, *rows, minimise=True, contact_force_n=("min", LEAST)), design))
    assert slow.answer == {SPEED: 600.0}
    study = speed_study(design, VariedField(SPEED, 600.0, 12000.0), contact_force_n=("min", LEAST))
    both = replace(study, goals=(*study.goals, Goal("contact_force_n", "max")))
    front = optimise(study_of(both, design)).front
    points = [(point[SPEED], point["contact_force_n_max"]) for point in front]
    assert len(points) > 5
    assert sorted(points) == sorted(points, key=lambda point: point[1])


STUDY = """\
design = "tappet.toml"

[[vary]]
field = "shaft.speed_rpm"
low = 120.0
high = 12000.0

[[vary]]
field = "motion.segments[0].law"
choices = ["simple-harmonic", "cycloidal"]

[[limits]]
quantity = "contact_force_n"
of = "min"
min = 20.0

[[goals]]
field = "shaft.speed_rpm"
minimise = false
"""


def test_a_file_with_such_a_goal_is_optimised_written_and_read_back(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save(flat_follower(), tmp_path / "tappet.toml")
    path = tmp_path / "study.toml"
    path.write_text(STUDY, "utf-8")
    assert main(["optimise", str(path), "--into", str(tmp_path / "fast.toml"), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["goal"] == data["answer"][SPEED] == get(load(tmp_path / "fast.toml"), SPEED)
    assert data["before"] == 1200.0
    exact = top_speed_of_flat_follower(LEAST)
    assert exact * (1.0 - 2e-6) <= data["goal"] <= exact
    assert main(["optimise", str(path), "--round", "--json"]) == 0
    rounded = json.loads(capsys.readouterr().out)
    assert rounded["goal"] == rounded["answer"][SPEED] == float(f"{exact - 5.0:.3g}")
    study = load_study(path)
    save_study(study.file, tmp_path / "again.toml")
    assert load_study(tmp_path / "again.toml").file == study.file
    assert 'field = "shaft.speed_rpm"\nminimise = false\n' in (tmp_path / "again.toml").read_text("utf-8")


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        ('field = "cam.base_radius_mm"', "goals[0].field = 'cam.base_radius_mm': is not varied"),
        ('field = "motion.segments[0].law"', "goals[0].field = 'motion.segments[0].law': is a word"),
        ('field = "shaft.speed_rpm"\nquantity = "radius_mm"\nof = "max"', "cannot be combined with a quantity"),
        ("minimise = true", "goals[0].quantity: missing"),
    ],
)
def test_a_goal_that_no_study_can_have_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], goal: str, words: str
) -> None:
    save(flat_follower(), tmp_path / "tappet.toml")
    path = tmp_path / "study.toml"
    path.write_text(STUDY.partition("[[goals]]")[0] + f"[[goals]]\n{goal}\n", "utf-8")
    assert main(["optimise", str(path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert words in error


# -- find top-speed -----------------------------------------------------------------------------------------------


def found(capsys: pytest.CaptureFixture[str], *arguments: str) -> Any:
    assert main(["find", *arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_command_finds_the_closed_form_and_says_what_holds_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, limit = tmp_path / "tappet.toml", "loads.least_contact_force_n_min=20.0"
    save(flat_follower(), path)
    bounds = f"{SPEED}=100.0:20000.0"
    data = found(
        capsys, str(path), "top-speed", "--vary", bounds, "--limit", limit, "--into", str(tmp_path / "fast.toml")
    )
    exact = top_speed_of_flat_follower(LEAST)
    assert exact * (1.0 - 2e-6) <= data["answer"][SPEED] <= exact
    assert list(data["answer"]) == [SPEED]
    assert data["binding"][0]["limit"] == "contact_force_n_min"
    assert data["curve_of"] == SPEED
    assert data["curve"][-1][1] == pytest.approx(exact, rel=1e-6)
    assert [point[0] for point in data["curve"]] == list(range(1, len(data["curve"]) + 1))
    assert data["reached"]["contact_force_n:min"] == pytest.approx(LEAST, rel=1e-6)
    assert data["limits"]["contact_force_n:min"] == LEAST
    assert get(load(tmp_path / "fast.toml"), SPEED) == data["answer"][SPEED]
    assert main(["check", str(tmp_path / "fast.toml")]) == 0


def test_a_span_shares_with_the_return_but_not_with_the_process_window() -> None:
    """Rise and return get 120 deg each, whatever they had: the acceleration at the top, -(π/β)² h/2, is then least in both."""
    parts = ((120.0, 0.0, "dwell"), (90.0, STROKE, "simple-harmonic"), (150.0, -STROKE, "simple-harmonic"))
    segments = tuple(Segment(span, rise, NamedCurve(law), fixed=not rise) for span, rise, law in parts)
    design = flat_follower()
    design = with_drive(design, motion=replace(design.drive.motion, segments=segments))
    span = VariedField("motion.segments[1].span_deg", 60.0, 200.0)
    solution = find_top_speed(design, {"loads.least_contact_force_n_min": LEAST}, (span,))
    exact = top_speed_of_flat_follower(LEAST) * 120.0 / 180.0
    assert exact * (1.0 - 2e-6) <= solution.answer[SPEED] <= exact
    assert [s.span_deg for s in solution.machine.drive.motion.segments] == pytest.approx([120.0] * 3, abs=1e-3)
    assert [s.fixed for s in solution.machine.drive.motion.segments] == [True, False, False]
    assert solution.present[SPEED] == 1200.0


def test_the_ready_fields_leave_process_windows_and_the_first_phase() -> None:
    unit = example("transfer_unit")
    rows = {row.field for row in top_speed_study(unit).vary}
    assert {SPEED, "drives[1].phase_deg", "drives[2].phase_deg"} < rows
    assert "drives[0].phase_deg" not in rows
    assert "drives[2].motion.segments[2].span_deg" not in rows, "the longest dwell makes up for the others"
    unit = edited(unit, "drives[2].motion.segments[1].fixed", True)
    fixed = {row.field for row in top_speed_study(unit).vary}
    assert rows - fixed == {"drives[2].motion.segments[1].span_deg"}
    lift = top_speed_study(edited(example("transfer_lift"), "motion.segments[1].fixed", True))
    assert [row.field for row in lift.vary] == [SPEED, "motion.segments[3].span_deg", "motion.segments[3].law"]
    assert (lift.vary[0].low, lift.vary[0].high) == (2.0, 200.0)


ORDERED = (
    "drives[2].motion.segments[1].span_deg=30.0:60.0",
    "drives[2].motion.segments[3].span_deg=30.0:60.0",
    "drives[2].phase_deg=-20.0:20.0",
)


@pytest.mark.stress
def test_several_drives_keep_their_sequence_and_their_own_limits(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of the transfer unit the lift alone changes: both its strokes lengthen until conditions of the sequence hold them."""
    path, fast = resources() / "examples" / "transfer_unit.toml", tmp_path / "fast.toml"
    vary = [word for row in ORDERED for word in ("--vary", row)]
    data = found(
        capsys, str(path), "top-speed", *vary, "--limit", "drives[2].contact_force_n=60000.0", "--into", str(fast)
    )
    unit, machine = load(path), load(fast)
    assert get(machine, SPEED) > 1.5 * get(unit, SPEED)
    assert all(row.kept for row in distances(machine))
    names = [row["limit"] for row in data["binding"]]
    assert "drives[2].contact_force_n_abs" in names
    assert any(name.startswith("timing[") for name in names)
    gains = [row["per_percent"] for row in data["binding"]]
    assert gains == sorted(gains, reverse=True)
    assert data["reached"]["drives[2].contact_force_n:abs"] == pytest.approx(60000.0, rel=1e-6)
    before = {finding.code for finding in findings_of(Study(unit))}
    assert all(f.code in before or f.severity == "note" for f in findings_of(Study(machine)))
    # 1 % more of the limit allows what the multiplier says
    more = find_top_speed(unit, {"drives[2].contact_force_n": 60006.0}, rows_of(ORDERED)).answer[SPEED]
    (held,) = (row for row in data["binding"] if row["limit"] == "drives[2].contact_force_n_abs")
    assert more - data["answer"][SPEED] == pytest.approx(0.01 * held["per_percent"], rel=0.02)


def rows_of(texts: tuple[str, ...]) -> tuple[VariedField, ...]:
    parts = ((text.partition("=")[0], *map(float, text.partition("=")[2].split(":"))) for text in texts)
    return tuple(VariedField(path, low, high) for path, low, high in parts)


@pytest.mark.parametrize(
    ("name", "arguments", "words"),
    [
        ("groove", (), "nothing bounds the speed up to 1800 rpm"),
        ("four_bar", (), "nothing bounds the speed"),
        ("transfer_lift", ("--limit", "contact_forse_n=5.0"), "did you mean 'contact_force_n'"),
        ("transfer_lift", ("--limit", "drive_torque_nm:most=5.0"), "drive_torque_nm:most"),
        ("transfer_lift", ("--limit", f"{SPEED}_max=1.0"), "bounds are reversed"),
        ("transfer_lift", ("--vary", "motion.segments[1].law=1.0:2.0"), "requires words"),
        ("transfer_unit", ("--drive", "Lift"), "top-speed belongs to the whole shaft"),
        ("transfer_lift", ("--vary", f"{SPEED}=100:50"), "bounds are reversed"),
        ("transfer_lift", ("--vary", SPEED), "must be PATH=LOW:HIGH"),
    ],
)
def test_what_has_no_top_speed_is_one_line(
    name: str, arguments: tuple[str, ...], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = resources() / "examples" / f"{name}.toml"
    assert main(["find", str(path), "top-speed", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert words in error


def test_limits_that_no_speed_keeps_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    path = resources() / "examples" / "transfer_lift.toml"
    arguments = ["--vary", f"{SPEED}=10.0:100.0", "--limit", "contact_force_n=100.0"]
    assert main(["find", str(path), "top-speed", *arguments]) == 2
    assert "contact_force_n:abs = " in capsys.readouterr().err
    assert main(["find", str(path), "base-radius", "--vary", f"{SPEED}=10.0:100.0"]) == 2
    assert "--vary: base-radius varies its own field" in capsys.readouterr().err


def test_the_search_stops_where_it_is_cancelled() -> None:
    flag = threading.Event()
    with cancellable(flag), pytest.raises(Cancelled):
        find_top_speed(example("transfer_lift"), {}, notify=lambda count: flag.set())


@pytest.mark.stress
def test_the_transfer_unit_runs_faster_within_every_limit() -> None:
    """All its ready fields; of 10 000 neighbours none keeps the limits at 1 % more speed."""
    unit = example("transfer_unit")
    study = study_of(top_speed_study(unit), unit)
    solution = find_top_speed(unit, {})
    assert solution.answer[SPEED] > 5.0 * get(unit, SPEED)
    assert len(solution.binding) > 2
    assert all(row.kept for row in distances(solution.machine))
    before = {finding.code for finding in findings_of(Study(unit))}
    assert all(f.code in before or f.severity == "note" for f in findings_of(Study(solution.machine)))
    rng = np.random.default_rng(0)
    rows = [row for row in study.file.vary if row.field != SPEED]
    low, high = (np.array([getattr(row, end) for row in rows])[:, None] for end in ("low", "high"))
    answer = np.array([solution.answer[row.field] for row in rows])[:, None]
    reach = 10.0 ** rng.uniform(-6.0, -1.0, 10_000)
    near = np.clip(answer + (high - low) * reach * rng.normal(size=(len(rows), 10_000)), low, high)
    values = dict(zip((row.field for row in rows), near, strict=True)) | {
        SPEED: np.full(10_000, 1.01 * solution.answer[SPEED])
    }
    figures = many(solution.machine, values, [row.key for row in study.quantities])
    keeps = figures.reason == ""
    for limit in study.file.limits:
        value = figures.value[limit.key]
        keeps &= (value >= limit.min) if limit.max is None else (value <= limit.max)
    for k in np.flatnonzero(keeps).tolist():
        from core.varying import with_values

        machine = with_values(solution.machine, {path: float(row[k]) for path, row in values.items()})
        assert not all(row.kept for row in distances(machine)), "faster, within every limit"


def test_a_design_without_such_a_field_is_refused() -> None:
    with pytest.raises(KindynaError, match="the design has no speed"):
        find_top_speed(replace(example("transfer_lift"), shaft=None), {})
    with pytest.raises(KindynaError, match="no number or word of this design"):
        find_top_speed(example("transfer_lift"), {}, (VariedField("follower.nothing_mm", 1.0, 2.0),))


def test_stated_clearances_are_limits_too() -> None:
    limits = {limit.key: limit.min for limit in top_speed_study(example("transfer_unit_outlines")).limits}
    assert limits["feed_arm__lift_arm_mm:min"] == 20.0
    assert "lift_arm__clamp_follower_mm:min" not in limits, "only a finding where they meet"


@pytest.mark.stress
def test_a_clearance_holds_the_speed_and_is_named() -> None:
    """The right slide would take more time for its strokes, until the left one, which comes after it, is too near."""
    design = loads(slides(0.0, 60.0, 40.0) + clearance("left.follower", "right.follower", 15.0))
    rows = tuple(VariedField(f"drives[1].motion.segments[{i}].span_deg", 60.0, 170.0) for i in (0, 2))
    force = {"drives[1].contact_force_n:abs": 180.0}
    solution = find_top_speed(design, force, rows)
    clearances = Study(solution.machine).clearances
    (pair,) = clearances.pairs
    assert clearances.least(pair).value * 1e3 >= 15.0
    assert {limit for limit, _ in solution.binding} == {
        "left_follower__right_follower_mm_min",
        "drives[1].contact_force_n_abs",
    }
    free = find_top_speed(replace(design, clearances=()), force, rows)
    assert free.answer[SPEED] > 1.2 * solution.answer[SPEED]
