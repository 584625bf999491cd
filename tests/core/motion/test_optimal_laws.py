"""Laws made to measure: against closed forms, a programme from outside, the elastic follower, and neighbours."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mechanisms import with_loads
from scipy.integrate import quad
from scipy.optimize import linprog

from core.__main__ import main
from core.design import (
    CurveBound,
    CurveLimits,
    Design,
    Motion,
    NamedCurve,
    OptimalCurve,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    SplineCurve,
    SplinePoint,
    edited,
    mirrored,
    part_faults,
    with_drive,
)
from core.design.curves import segment_shape
from core.errors import DesignError
from core.laws import LAWS, PieceTable
from core.motion import program
from core.motion.split import split_segment
from core.project import dumps, load, loads
from core.study import Study, certificate_of, findings_of, many

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
U = np.linspace(0.0, 1.0, 40001)


def motion_with(curve: OptimalCurve, span: float = 100.0, rise: float = 40.0) -> Motion:
    """The law between dwells, and a return."""
    rows = ((span, rise, curve), (90.0, 0.0, NamedCurve("dwell")), (100.0, -rise, NamedCurve("3-4-5")))
    segments = tuple(Segment(*row) for row in rows)
    return Motion(0.0, (*segments, Segment(360.0 - sum(s.span_deg for s in segments), 0.0)))


def derivatives(curve: OptimalCurve, u: np.ndarray = U, span: float = 100.0, rise: float = 40.0) -> np.ndarray:
    """s, s', s'', s''' (4, n) at u, with span 1 and rise 1, of the compiled motion."""
    compiled = program(motion_with(curve, span, rise))
    inside = compiled.angles(np.deg2rad(span) * np.clip(u, 0.0, 1.0 - 1e-13))
    y = compiled.state(inside).y / compiled.motion.scale / rise
    return y * np.deg2rad(span) ** np.arange(4)[:, None]


def peaks(curve: OptimalCurve) -> np.ndarray:
    return np.abs(derivatives(curve)).max(axis=1)


# -- closed forms --------------------------------------------------------------------------------------------


def trapezoid(jerk: float) -> float:
    return jerk * (0.5 - math.sqrt(0.25 - 8.0 / jerk)) / 2.0


CLOSED: tuple[tuple[OptimalCurve, int, float], ...] = (
    (OptimalCurve(), 2, 4.0),
    (OptimalCurve(minimise="jerk"), 3, 32.0),
    (OptimalCurve(limits=CurveLimits(jerk=40.0)), 2, trapezoid(40.0)),
    (OptimalCurve(limits=CurveLimits(jerk=200.0)), 2, trapezoid(200.0)),
    (OptimalCurve(minimise="velocity", limits=CurveLimits(acceleration=6.0)), 1, 3.0 - math.sqrt(3.0)),
)


@pytest.mark.parametrize(("curve", "order", "exact"), CLOSED)
def test_peaks_approach_their_closed_forms_from_above(curve: OptimalCurve, order: int, exact: float) -> None:
    coarse, fine = (peaks(replace(curve, intervals=n))[order] for n in (60, 200))
    assert exact - 1e-9 * exact <= fine < coarse <= 1.008 * exact
    assert fine <= exact * (1.0004 if order != 3 and not curve.limits.jerk else 1.002)


def test_least_acceleration_stays_below_four_and_a_little() -> None:
    assert 4.0 <= peaks(OptimalCurve())[2] <= 4.008
    assert 4.0 <= peaks(OptimalCurve(intervals=200))[2] <= 4.0016


@pytest.mark.parametrize("intervals", [1, 2, 7, 60, 400])
@pytest.mark.parametrize(("minimise", "law"), [("rms_acceleration", "2-3"), ("rms_jerk", "3-4-5")])
def test_least_mean_squares_are_the_polynomials_whatever_the_intervals(minimise: str, law: str, intervals: int) -> None:
    assert np.abs(derivatives(OptimalCurve(minimise=minimise, intervals=intervals))[0] - LAWS[law](U)[0]).max() <= 1e-9


def test_the_least_rms_jerk_through_points_is_the_spline() -> None:
    points = (SplinePoint(22.0, 12.0), SplinePoint(48.0, 15.0), SplinePoint(71.0, 36.0))
    ours, spline = (
        derivatives(curve)[0] for curve in (OptimalCurve(minimise="rms_jerk", points=points), SplineCurve(points))
    )
    assert np.abs(ours - spline).max() <= 1e-9


# -- a programme from outside --------------------------------------------------------------------------------


def by_straight_pieces(minimised: int, bounds: dict[int, float], below: tuple[float, float, float] | None) -> float:
    """Least peak where the highest derivative is straight on 240 pieces, by sums of values on a grid."""
    pieces, top = 240, max(minimised, *bounds, 2)
    h = 1.0 / pieces
    step = np.tril(np.ones((pieces + 1, pieces + 1))) * h
    step -= 0.5 * h * np.eye(pieces + 1)  # trapezoids
    step[:, 0] -= 0.5 * h
    rows = {top: np.eye(pieces + 1)}
    for order in reversed(range(top)):
        rows[order] = step @ rows[order + 1]  # from 0 at rest
    equal = np.array([rows[order][-1] for order in range(top)])
    values = np.array([1.0] + [0.0] * (top - 1))
    upper, sides = [], []
    for order, limit in [*bounds.items(), (minimised, 0.0)]:
        for sign in (1.0, -1.0):
            peak = -np.ones((pieces + 1, 1)) if order == minimised and not limit else np.zeros((pieces + 1, 1))
            upper.append(np.hstack((sign * rows[order], peak)))
            sides.append(np.full(pieces + 1, limit))
    if below is not None:
        u = np.linspace(0.0, 1.0, pieces + 1)
        inside = (u >= below[0]) & (u <= below[1])
        upper.append(np.hstack((rows[0][inside], np.zeros((int(inside.sum()), 1)))))
        sides.append(np.full(int(inside.sum()), below[2]))
    result = linprog(
        np.append(np.zeros(pieces + 1), 1.0),
        A_ub=np.vstack(upper),
        b_ub=np.concatenate(sides),
        A_eq=np.hstack((equal, np.zeros((equal.shape[0], 1)))),
        b_eq=values,
        bounds=(None, None),
    )
    assert result.status == 0
    return float(result.fun)


@pytest.mark.parametrize(
    ("minimise", "bounds", "below"),
    [
        ("acceleration", {3: 60.0}, None),
        pytest.param("acceleration", {1: 1.6}, (0.0, 0.5, 0.35), marks=pytest.mark.stress),
        pytest.param("acceleration", {3: 90.0, 1: 1.8}, (0.1, 0.45, 0.3), marks=pytest.mark.stress),
        ("jerk", {1: 1.7}, None),
        ("jerk", {2: 6.5}, (0.0, 0.5, 0.45)),
        pytest.param("velocity", {2: 7.0, 3: 120.0}, None, marks=pytest.mark.stress),
    ],
)
def test_a_programme_of_straight_pieces_agrees(
    minimise: str, bounds: dict[int, float], below: tuple[float, float, float] | None
) -> None:
    names = ("", "velocity", "acceleration", "jerk")
    order = names.index(minimise)
    curve = OptimalCurve(
        minimise=minimise,
        limits=CurveLimits(**{names[k]: value for k, value in bounds.items()}),
        below=(CurveBound(*below),) if below else (),
        intervals=240,
    )
    y = derivatives(curve)
    reached = np.abs(y).max(axis=1)
    assert reached[order] == pytest.approx(by_straight_pieces(order, bounds, below), rel=6e-3)
    for k, limit in bounds.items():
        assert reached[k] <= limit * (1.0 + 2e-9)
    if below is not None:
        inside = (below[0] <= U) & (below[1] >= U)
        assert y[0][inside].max() <= below[2] + 2e-9


# -- limits between the knots, obstacles, ends and points --------------------------------------------------------


@pytest.mark.parametrize("minimise", ["acceleration", "jerk", "velocity", "rms_acceleration", "rms_jerk"])
def test_every_limit_and_obstacle_is_kept_between_the_knots(minimise: str) -> None:
    below, above = CurveBound(0.05, 0.43, 0.33), CurveBound(0.7, 0.93, 0.72)
    bounds = {"velocity": 1.9, "acceleration": 8.0, "jerk": 150.0}
    curve = OptimalCurve(minimise=minimise, limits=CurveLimits(**bounds), below=(below,), above=(above,), intervals=23)
    y = derivatives(curve)
    for order, name in enumerate(("velocity", "acceleration", "jerk"), 1):
        assert np.abs(y[order]).max() <= bounds[name] * (1.0 + 2e-9)
    assert y[0][(below.start <= U) & (below.end >= U)].max() <= below.rise + 2e-9
    assert y[0][(above.start <= U) & (above.end >= U)].min() >= above.rise - 2e-9
    proof = certificate_of(study_of(curve))
    assert proof["optimum_gap_1"].kept
    assert proof["optimum_gap_1"].value < 1e-6


def study_of(curve: OptimalCurve) -> Study:
    return Study(design_of(curve))


def design_of(curve: OptimalCurve) -> Design:
    design = loads(
        'format = 1\nname = "a"\n[motion]\nstart_mm = 0.0\n[[motion.segments]]\nlaw = "dwell"\nspan_deg = 360.0\n'
    )
    return with_drive(design, motion=motion_with(curve))


def test_points_and_joined_ends_are_met() -> None:
    points = (SplinePoint(30.0, 8.0), SplinePoint(61.7, None, 0.55), SplinePoint(80.0, 35.0, 0.3, -0.01))
    curve = OptimalCurve(minimise="jerk", start="joined", end="stop", points=points)
    lead = Segment(60.0, 10.0, PolynomialCurve(PolynomialEnd(), PolynomialEnd(0.4, 0.002)))
    motion = Motion(0.0, (lead, Segment(100.0, 40.0, curve), Segment(200.0, -50.0, NamedCurve("3-4-5"))))
    assert part_faults(motion, "motion") == []
    compiled = program(motion)
    at = np.deg2rad(60.0 + np.array([0.0, 30.0, 61.7, 80.0]))
    y = compiled.state(compiled.angles(at)).y / compiled.motion.scale * np.deg2rad(1.0) ** np.arange(4)[:, None]
    assert y[:3, 0] == pytest.approx([10.0, 0.4, 0.002], abs=1e-9)
    assert y[0, 1] == pytest.approx(18.0, abs=1e-9)
    assert y[1, 2] == pytest.approx(0.55, abs=1e-9)
    assert y[:3, 3] == pytest.approx([45.0, 0.3, -0.01], abs=1e-9)
    assert not any(compiled.joins[0].jumps[:3])
    assert not compiled.joins[1].jumps[1], "the velocity stops"


def test_a_return_is_the_rise_downwards_and_its_image_runs_backwards() -> None:
    curve = OptimalCurve(minimise="rms_jerk", below=(CurveBound(0.0, 0.5, 0.3),), points=(SplinePoint(80.0, 37.0),))
    down = replace(curve, points=(SplinePoint(80.0, -37.0),))
    assert derivatives(down, rise=-40.0) == pytest.approx(derivatives(curve), abs=1e-9)
    image = mirrored(Segment(100.0, 40.0, curve))
    assert mirrored(image) == Segment(100.0, 40.0, curve)
    assert isinstance(image.curve, OptimalCurve)
    assert 1.0 - derivatives(image.curve, 1.0 - U, rise=-40.0)[0] == pytest.approx(derivatives(curve)[0], abs=1e-8)


def test_a_split_keeps_level_ends_and_obstacles_in_both_parts() -> None:
    curve = OptimalCurve(minimise="jerk", below=(CurveBound(0.0, 0.5, 0.45),), points=(SplinePoint(80.0, 37.0),))
    design = design_of(curve)
    level = float(derivatives(curve, np.array([0.4]))[0, 0]) * 40.0
    motion = split_segment(design, 0, 40.0).drive.motion
    assert motion is not None
    first, second = motion.segments[:2]
    assert (first.span_deg, first.rise, second.span_deg) == pytest.approx((40.0, level, 60.0))
    assert part_faults(motion, "motion") == []
    y = program(motion).state(program(motion).angles(np.deg2rad(np.linspace(0.0, 50.0, 501)))).y[0] * 1e3
    assert y.max() <= 0.45 * 40.0 + 1e-6
    assert second.curve.points == (SplinePoint(40.0, pytest.approx(37.0 - level)),)


# -- followers that vibrate -----------------------------------------------------------------------------------


@pytest.mark.parametrize("minimise", ["acceleration", "jerk", "rms_jerk"])
def test_a_follower_rests_after_the_cycles_of_the_law(minimise: str) -> None:
    curve = OptimalCurve(minimise=minimise, vibration_free=(1.4, 3.3), limits=CurveLimits(velocity=2.2))
    shape = segment_shape(Segment(100.0, 40.0, curve), False, "segment")
    table = PieceTable(shape.pieces)
    starts, ends = table.starts, np.append(table.starts[1:], 1.0)
    for cycles in curve.vibration_free:
        for wave in (math.cos, math.sin):

            def part(u: float, wave: Any = wave, cycles: float = cycles) -> float:
                return float(table.at(np.array([u]))[2][0]) * wave(2.0 * math.pi * cycles * u)

            integral = sum(quad(part, a, b - 1e-15)[0] for a, b in zip(starts, ends, strict=True))
            assert abs(integral) <= 1e-9


@pytest.mark.parametrize("cycles", [1.4, 3.3])
def test_the_elastic_follower_is_silent_at_that_speed_alone(cycles: float) -> None:
    mass, stiffness, rise, span = 0.5, 80.0, 8.0, 75.0
    curve = OptimalCurve(minimise="jerk", vibration_free=(cycles,))
    rows = ((60.0, 0.0, NamedCurve("dwell")), (span, rise, curve), (100.0, 0.0, NamedCurve("dwell")))
    motion = Motion(0.0, tuple(Segment(*row) for row in (*rows, (125.0, -rise, NamedCurve("3-4-5")))))
    design = load(EXAMPLES / "tappet_flat.toml")
    design = with_drive(design, motion=motion, cam=replace(design.drive.cam, base_radius_mm=200.0))
    loaded = {"follower_mass_kg": mass, "spring_rate_n_per_mm": 0.0, "preload_n": 400.0, "friction": 0.0}
    design = with_loads(design, **loaded, follower_stiffness_n_per_mm=stiffness, follower_damping_ratio=0.0)
    rpm = 60.0 * span / 360.0 * math.sqrt(stiffness * 1e3 / mass) / (2.0 * math.pi * cycles)
    silent, other = (
        1e3 * Study(edited(design, "shaft.speed_rpm", speed)).follower_response.residuals[1].from_rest / rise
        for speed in (rpm, 1.1 * rpm)
    )
    assert silent <= 1e-9
    assert other > 1e-3


# -- files, bad input, the certificate --------------------------------------------------------------------------

TEXT = """format = 1
name = "Measured law"

[motion]
start_mm = 0.0

[[motion.segments]]
law = "optimal"
span_deg = 100.0
rise_mm = 40.0
minimise = "jerk"
start = "rest"
end = "stop"
limits = { velocity = 2.2, acceleration = 7.5 }
points = []
vibration_free = [3.3]
below = [[0.0, 0.4, 0.35]]
above = [[0.8, 1.0, 0.7]]
intervals = 40

[[motion.segments]]
law = "dwell"
span_deg = 160.0

[[motion.segments]]
law = "3-4-5"
span_deg = 100.0
rise_mm = -40.0
"""


def test_a_file_keeps_what_was_typed() -> None:
    design = loads(TEXT)
    motion = design.drive.motion
    assert motion is not None
    assert motion.segments[0].curve == OptimalCurve(
        minimise="jerk",
        end="stop",
        limits=CurveLimits(2.2, 7.5),
        vibration_free=(3.3,),
        below=(CurveBound(0.0, 0.4, 0.35),),
        above=(CurveBound(0.8, 1.0, 0.7),),
        intervals=40,
    )
    assert loads(dumps(design)) == design
    assert "coefficient" not in dumps(design)
    assert len(dumps(design)) < 2 * len(TEXT)


def test_the_certificate_states_the_gap_of_each_optimal_law(tmp_path: Path, capsys: Any) -> None:
    (tmp_path / "a.toml").write_text(TEXT, "utf-8")
    assert main(["export", str(tmp_path / "a.toml"), "--out", str(tmp_path / "out")]) == 0
    proof = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))["certificate"]
    assert [name for name in proof if name.startswith("optimum_gap")] == ["optimum_gap_1"]
    assert 0.0 <= proof["optimum_gap_1"]["value"] <= 1e-6
    assert proof["optimum_gap_1"]["bound"] == 1e-3


def test_the_gap_is_that_of_the_law_itself() -> None:
    """Of the least jerk by an own program over the same 40 intervals nothing is below it; a worse law is told apart."""
    curve = OptimalCurve(minimise="rms_acceleration", limits=CurveLimits(velocity=1.3))
    gap = certificate_of(study_of(curve))["optimum_gap_1"]
    assert gap.value <= 1e-9
    chance = np.random.default_rng(5)
    y = derivatives(curve)
    best = math.sqrt(np.trapezoid(y[2] ** 2, U))
    for _ in range(200):  # neighbours with the same ends that keep the limit
        bump = sum(chance.normal() * np.sin(k * math.pi * U) ** 2 for k in range(1, 6)) * 10.0 ** chance.uniform(-4, -1)
        if np.abs(np.gradient(y[0] + bump, U)).max() <= 1.3:
            assert math.sqrt(np.trapezoid(np.gradient(np.gradient(y[0] + bump, U), U) ** 2, U)) >= best * (1.0 - 1e-6)


BAD: tuple[tuple[str, str, str], ...] = (
    (
        "acceleration = 7.5",
        "acceleration = 3.0",
        "motion.segments[0].limits.acceleration = 3.0: no law keeps this limit",
    ),
    ('"jerk"', '"snap"', "motion.segments[0].minimise = 'snap': unknown word; allowed: acceleration | jerk | velocity"),
    ("rise_mm = 40.0", "rise_mm = 0.0", "motion.segments[0].rise_mm = 0.0: an optimal law rises or returns"),
    ("[0.0, 0.4, 0.35]", "[0.4, 0.4, 0.35]", "motion.segments[0].below[0]"),
    ("[0.0, 0.4, 0.35]", "[0.0, 0.9, 0.35]", "motion.segments[0].below: no law passes"),
    ("[3.3]", "[-1.0]", "motion.segments[0].vibration_free[0] = -1.0: "),
    ("intervals = 40", "intervals = 401", "motion.segments[0].intervals = 401: outside its range; allowed: 1 ... 400"),
    ("velocity = 2.2", "velocity = 0.0", "motion.segments[0].limits.velocity = 0.0: outside its range; allowed: > 0"),
)


@pytest.mark.parametrize(("old", "new", "message"), BAD)
def test_bad_input_names_field_value_and_range(
    old: str, new: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert old in TEXT
    text = TEXT.replace(old, new, 1)
    text = text.replace("rise_mm = -40.0", "rise_mm = 0.0") if "rise_mm" in old else text
    (tmp_path / "a.toml").write_text(text, "utf-8")
    assert main(["check", str(tmp_path / "a.toml")]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith(message)


@pytest.mark.parametrize(
    "curve",
    [
        OptimalCurve(limits=CurveLimits(jerk=30.0)),
        pytest.param(
            OptimalCurve(minimise="rms_jerk", limits=CurveLimits(jerk=25.0, velocity=2.2)), marks=pytest.mark.stress
        ),
        OptimalCurve(minimise="jerk", limits=CurveLimits(velocity=1.2, acceleration=5.0)),
        OptimalCurve(minimise="jerk", limits=CurveLimits(velocity=0.8, acceleration=2.0)),
    ],
)
def test_the_least_limit_that_is_named_is_one_that_a_law_keeps(curve: OptimalCurve) -> None:
    """The next smaller one is refused again; each limit that the message names is taken until a law exists."""
    for _ in range(len(vars(curve.limits)) + 1):
        try:
            derivatives(curve)
            break
        except DesignError as error:
            fault = error.faults[0]
            name, least = fault.path.rpartition(".")[2], float(fault.allowed.removeprefix(">= "))
            curve = replace(curve, limits=replace(curve.limits, **{name: least}))
    assert np.abs(derivatives(curve)[("", "velocity", "acceleration", "jerk").index(name)]).max() <= least * (1 + 2e-9)
    with pytest.raises(DesignError):
        derivatives(replace(curve, limits=replace(curve.limits, **{name: least * (1.0 - 1e-4)})))


def test_an_acceleration_that_jumps_is_found() -> None:
    """The least acceleration alone jumps at its ends, the least jerk does not."""
    codes = [
        {finding.code for finding in findings_of(study_of(OptimalCurve(minimise=minimise)), ("motion",))}
        for minimise in ("acceleration", "jerk")
    ]
    assert codes[0] - codes[1]


def test_a_study_tells_which_limits_no_law_keeps() -> None:
    """The others have the figures that they have alone."""
    design = edited(load(EXAMPLES / "rocker_cam.toml"), "motion.segments[1].law", "optimal")
    path, torque = "motion.segments[1].limits.jerk", "drive_torque_nm:abs"
    design = edited(design, path, 60.0)
    result = many(design, {path: np.array([28.0, 40.0, 60.0, 90.0])}, [torque])
    assert [bool(reason) for reason in result.reason] == [True, False, False, False]
    assert np.isnan(result.value[torque][0])
    alone = many(edited(design, path, 40.0), {"shaft.speed_rpm": np.array([design.shaft.speed_rpm])}, [torque])
    assert result.value[torque][1] == pytest.approx(alone.value[torque][0], rel=1e-12)
