"""core.motion.extremes: true extremes, against roots of derivatives, kinks, jumps and plateaus."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanisms import LAYOUT_DESIGNS, LIFT, PUSHER, buildable, levels, with_drive
from references import EPS, MP, Series, cam_shape, motion_series, placed, solved
from sampled import spread, stressed

from core.design import Motion, PolynomialCurve, PolynomialEnd, Segment, SplineCurve, SplinePoint, edited, with_stroke
from core.motion import TURN, Angles, CompiledMotion
from core.motion.extremes import Extremes, find_extremes, piecewise_angles, true_stroke
from core.study import Study, extremes_of, quantities_of

ONE = CompiledMotion(levels(0.0, (360.0, 0.0, "dwell")))
HALVES = CompiledMotion(levels(0.0, (180.0, 10.0, "cycloidal"), (180.0, 0.0, "cycloidal")))
UNEVEN = CompiledMotion(levels(0.0, (1e-3, 0.0, "dwell"), (120.0, 10.0, "modified-sine"), (239.999, 0.0, "cycloidal")))
PROGRAMS = {"one": ONE, "halves": HALVES, "uneven": UNEVEN}


def extremes(quantity: Callable[[Angles], np.ndarray], program: CompiledMotion = ONE) -> Extremes:
    return find_extremes(lambda angles: {"q": quantity(angles)}, program)["q"]


# -- smooth -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("program", PROGRAMS.values(), ids=PROGRAMS)
@pytest.mark.parametrize("phase", [0.1, 1.0, 2.5, 4.0, 6.0])
def test_a_waves_top_and_bottom_are_found_to_rounding(program: CompiledMotion, phase: float) -> None:
    """3 cos(θ - phase): the value to a few eps, the angle to what five points 5e-6 apart tell of its slope."""
    found = extremes(lambda a: 3.0 * np.cos(a.theta - phase), program)
    assert found.high.value == pytest.approx(3.0, rel=8 * EPS)
    assert found.low.value == pytest.approx(-3.0, rel=8 * EPS)
    assert found.high.theta == pytest.approx(phase, abs=16 * EPS / 5e-6)
    assert found.low.theta == pytest.approx((phase + math.pi) % TURN, abs=16 * EPS / 5e-6)


def _by_newton(cosines: list[float], sines: list[float], sign: float) -> float:
    """The highest of sign x the sum of waves, by Newton's method from every sample of 20,000 that tops its neighbours."""
    n = np.arange(1, len(cosines) + 1)[:, None]
    a, b = np.array(cosines)[:, None], np.array(sines)[:, None]

    def at(theta: np.ndarray, order: int) -> np.ndarray:
        turned = n * theta + order * math.pi / 2
        return sign * (n**order * (a * np.cos(turned) + b * np.sin(turned))).sum(axis=0)

    theta = np.linspace(0.0, TURN, 20_000, endpoint=False)
    value = at(theta, 0)
    theta = theta[(value >= np.roll(value, 1)) & (value >= np.roll(value, -1))]
    for _ in range(6):
        bend = at(theta, 2)
        theta = theta - np.where(bend < -1e-9, at(theta, 1) / np.where(bend, bend, 1.0), 0.0)
    return sign * max(at(theta, 0).max(), value.max())


SHARE = st.integers(-1000, 1000).map(lambda n: n / 1000)


@settings(max_examples=30)
@given(st.lists(st.tuples(SHARE, SHARE), min_size=1, max_size=6), st.sampled_from(list(PROGRAMS)))
def test_the_extremes_of_any_sum_of_waves_are_the_highest_and_the_lowest(
    waves: list[tuple[float, float]], name: str
) -> None:
    cosines, sines = [w[0] for w in waves], [w[1] for w in waves]

    def quantity(angles: Angles) -> np.ndarray:
        return sum(
            (c * np.cos((i + 1) * angles.theta) + s * np.sin((i + 1) * angles.theta) for i, (c, s) in enumerate(waves)),
            np.zeros(angles.theta.size),
        )

    found = extremes(quantity, PROGRAMS[name])
    size = sum(abs(c) + abs(s) for c, s in waves)
    # each wave's angle is rounded: 6 x 2 pi eps of it
    assert found.high.value == pytest.approx(_by_newton(cosines, sines, 1.0), abs=64 * EPS * size)
    assert found.low.value == pytest.approx(_by_newton(cosines, sines, -1.0), abs=64 * EPS * size)
    for side in (found.high, found.low):
        there = quantity(ONE.angles(np.array([side.theta])))[0]
        assert there == pytest.approx(side.value, abs=64 * EPS * size), "and it stands where it says"


@pytest.mark.parametrize("which", range(0, 25, 3))
def test_many_equal_tops_are_told_apart_by_the_highest(which: int) -> None:
    """25 tops between the first samples; one is higher by 1e-9, whether or not samples stand high beside it."""
    top = TURN * which / 25 + 0.004

    def quantity(angles: Angles) -> np.ndarray:
        return np.cos(25 * (angles.theta - 0.004)) + 1e-9 * np.cos(angles.theta - top)

    found = extremes(quantity)
    assert found.high.theta == pytest.approx(top, abs=1e-6)
    assert found.high.value == pytest.approx(1.0 + 1e-9, abs=64 * EPS)


def test_of_equal_tops_the_smallest_cam_angle_is_named() -> None:
    found = extremes(lambda a: np.cos(3 * (a.theta - 0.3)))
    assert found.high.theta == pytest.approx(0.3, abs=1e-9)
    assert found.low.theta == pytest.approx(0.3 + math.pi / 3, abs=1e-9)


# -- plateaus, kinks, jumps -------------------------------------------------------------------------------


def test_a_plateau_is_named_by_its_smallest_cam_angle() -> None:
    study = Study(
        with_drive(
            PUSHER,
            motion=levels(
                5.0, (60.0, 5.0, "dwell"), (60.0, 25.0, "cycloidal"), (80.0, 25.0, "dwell"), (160.0, 5.0, "3-4-5")
            ),
        )
    )
    found = extremes_of(study, "motion")["displacement"]
    assert (found.low.value, found.low.theta) == (0.005, 0.0)
    assert found.high.value == pytest.approx(0.025, rel=2 * EPS)
    # the rise arrives flat: within rounding of the top are the cube root of its last 1e-15, some 1e-5 rad
    assert found.high.theta == pytest.approx(math.radians(120.0), abs=1e-4)
    still = extremes(lambda a: np.full(a.theta.size, 7.0))
    assert (still.high.value, still.high.theta, still.low.value, still.low.theta) == (7.0, 0.0, 7.0, 0.0)


@pytest.mark.parametrize("place", [0.2, 1.0, math.pi / 180 * 90, 3.3, 6.2])
@pytest.mark.parametrize("program", PROGRAMS.values(), ids=PROGRAMS)
def test_a_kink_is_narrowed_down(program: CompiledMotion, place: float) -> None:
    """|sin((θ - place)/2)| touches 0 there; 1 - |...| is highest there. A slope of 1/2 over 1e-13 rad remains."""
    found = extremes(lambda a: np.abs(np.sin((a.theta - place) / 2)), program)
    assert found.low.value == pytest.approx(0.0, abs=2e-13)
    assert found.low.theta == pytest.approx(place, abs=4e-13)
    found = extremes(lambda a: 1.0 - np.abs(np.sin((a.theta - place) / 2)), program)
    assert found.high.value == pytest.approx(1.0, abs=2e-13)
    assert found.high.theta == pytest.approx(place, abs=4e-13)


@pytest.mark.parametrize(("below", "above"), [(5.0, 1.0), (1.0, 5.0), (-5.0, -1.0), (-1.0, -5.0)])
def test_both_sides_of_a_jump_are_seen(below: float, above: float) -> None:
    """From the left a value that no cam angle has; from the right the one that the join has."""

    def quantity(angles: Angles) -> np.ndarray:
        away = np.abs(angles.theta - math.pi) * 0.1
        side = np.where(angles.piece == 0, below, above)
        return side * (1.0 - away)

    found = extremes(quantity, HALVES)
    greatest = max(below, above, key=abs)
    side = found.high if greatest > 0 else found.low
    assert side.value == greatest
    assert side.theta == math.pi


def test_the_acceleration_of_a_simple_harmonic_is_highest_and_lowest_at_its_jumps() -> None:
    study = Study(
        with_drive(
            PUSHER,
            motion=levels(
                0.0,
                (90.0, 0.0, "dwell"),
                (120.0, 20.0, "simple-harmonic"),
                (40.0, 20.0, "dwell"),
                (110.0, 0.0, "cycloidal"),
            ),
        )
    )
    found = extremes_of(study, "motion")["acceleration"]
    peak = math.pi**2 / 2 * 0.020 / (math.pi * 2 / 3) ** 2 * study.omega**2
    at_the_return = 2 * math.pi * 0.020 / math.radians(110.0) ** 2 * study.omega**2
    assert at_the_return > peak
    assert found.high.value == pytest.approx(at_the_return, rel=32 * EPS)
    harmonic = Study(
        with_drive(
            PUSHER, motion=levels(0.0, (90.0, 0.0, "dwell"), (120.0, 20.0, "simple-harmonic"), (150.0, 0.0, "3-4-5"))
        )
    )
    found = extremes_of(harmonic, "motion")["acceleration"]
    assert found.high.value == pytest.approx(peak, rel=32 * EPS)
    assert math.degrees(found.high.theta) == pytest.approx(90.0, abs=1e-9)
    assert found.low.value == pytest.approx(-peak, rel=32 * EPS)
    assert math.degrees(found.low.theta) == pytest.approx(210.0, abs=1e-9), (
        "the left-hand limit of the join at 210 degrees"
    )


def test_an_extreme_at_the_end_of_the_turn_stands_at_zero() -> None:
    found = extremes(lambda a: a.theta, HALVES)
    assert found.high.value == TURN
    assert found.high.theta == 0.0
    assert (found.low.value, found.low.theta) == (0.0, 0.0)


def test_infinity_is_highest_and_what_is_no_number_is_left_out() -> None:
    def quantity(angles: Angles) -> np.ndarray:
        value = np.cos(angles.theta)
        value[(angles.theta > 2.0) & (angles.theta < 2.5)] = np.nan
        value[(angles.theta > 4.0) & (angles.theta < 4.2)] = np.inf
        return value

    found = extremes(quantity)
    assert found.high.value == math.inf
    assert 4.0 < found.high.theta < 4.2
    assert found.low.value == pytest.approx(-1.0, rel=8 * EPS)
    nothing = extremes(lambda a: np.full(a.theta.size, np.nan))
    assert not math.isfinite(nothing.high.value)


def test_what_happens_within_a_thousandth_of_a_degree_is_seen() -> None:
    width = math.radians(1e-3)
    found = extremes(lambda a: np.where(a.piece == 0, np.sin(math.pi * a.theta / width), 0.0), UNEVEN)
    assert found.high.value == pytest.approx(1.0, abs=1e-6)
    assert found.high.theta == pytest.approx(width / 2, rel=1e-3)


def test_a_kink_between_uneven_samples_close_to_the_start_of_a_piece_is_found() -> None:
    """Its two neighbours, ten times as far from each other as those before, both stand above another low place."""
    piece = int(np.flatnonzero(UNEVEN.segment == 1)[1])
    start, width = UNEVEN.starts[piece], math.radians(90.0)
    kink = start + 0.0054 * width
    found = extremes(
        lambda a: np.where(a.piece == piece, 90.0 + 100.0 * np.abs(a.theta - kink) / (0.005 * width), 150.0), UNEVEN
    )
    assert found.low.value == pytest.approx(90.0, rel=1e-6)
    assert found.low.theta == pytest.approx(kink, rel=1e-9)


def test_samples_stand_on_both_sides_of_every_join() -> None:
    angles = piecewise_angles(UNEVEN)
    for i, (a, b) in enumerate(zip(UNEVEN.starts, UNEVEN.ends, strict=True)):
        inside = angles.theta[angles.piece == i]
        assert inside[0] == a
        assert inside[-1] == b
        assert inside.size >= 9
        assert np.diff(inside).max() <= math.radians(1.0) * (1 + 1e-9)


# -- of mechanisms ----------------------------------------------------------------------------------------


def _pressure(design: object, theta: object) -> object:
    return cam_shape(design, solved(design, theta, 1)).pressure_angle


@pytest.mark.parametrize(
    ("design", "segment"), spread([(LIFT, 1), (PUSHER, 1), (LAYOUT_DESIGNS["c"], 1)], 1), ids=["lift", "pusher", "c"]
)
def test_the_largest_pressure_angle_of_a_rise_is_the_root_of_its_derivative(design: object, segment: int) -> None:
    """The other segments are made dwells' equals by looking at this one only: its pieces, its root."""
    study = Study(design)
    start, end = (
        float(x)
        for x in (
            study.program.starts[study.program.segment == segment][0],
            study.program.ends[study.program.segment == segment][-1],
        )
    )
    grid = np.linspace(start, end, 200)[1:-1]
    best = float(grid[np.argmax(study.at_theta(grid).cam.flank.pressure_angle)])
    root = MP.findroot(lambda t: MP.diff(lambda x: _pressure(design, x), t), (best - 1e-3, best + 1e-3), tol=1e-20)
    pieces = np.flatnonzero(study.program.segment == segment)

    def quantity(angles: Angles) -> np.ndarray:
        value = study.at(angles).cam.flank.pressure_angle
        return np.where(np.isin(angles.piece, pieces), value, 0.0)

    found = extremes(quantity, study.program)
    assert found.high.value == pytest.approx(
        float(_pressure(design, root)), rel=64 * EPS * float(study.linkage.condition.max())
    )
    assert found.high.theta == pytest.approx(float(root), abs=1e-8)


@pytest.mark.parametrize("segment", [1, stressed(2), stressed(3)])
@pytest.mark.parametrize("letter", ["b", "f"])
def test_the_largest_velocity_of_a_segment_is_the_root_of_the_acceleration(letter: str, segment: int) -> None:
    motion = LAYOUT_DESIGNS[letter].drive.motion
    study = Study(LAYOUT_DESIGNS[letter])
    pieces = np.flatnonzero(study.program.segment == segment)
    way = study.program.velocity_signs[pieces[0]]
    begin, end = study.program.starts[pieces[0]], study.program.ends[pieces[-1]]
    grid = np.linspace(begin, end, 60)[1:-1]
    fastest = max(grid, key=lambda t: way * float(motion_series(motion, t, segment).derivative(1)))
    around = (fastest - grid[1] + grid[0], fastest + grid[1] - grid[0])
    root = MP.findroot(lambda t: motion_series(motion, t, segment).derivative(2), around, solver="anderson", tol=1e-25)

    def quantity(angles: Angles) -> np.ndarray:
        return np.where(np.isin(angles.piece, pieces), study.program.state(angles).y[1], 0.0)

    found = extremes(quantity, study.program)
    side = found.high if way > 0.0 else found.low
    assert side.value == pytest.approx(float(motion_series(motion, root, segment).derivative(1)), rel=64 * EPS)
    assert side.theta == pytest.approx(float(root), abs=1e-8)


@settings(max_examples=8)
@given(buildable())
def test_no_sample_of_any_quantity_passes_its_extremes(design: object) -> None:
    """1,000 cam angles of every quantity of every stage; and each extreme is a value the quantity has."""
    study = Study(design, 1000)
    for stage in study.stages:
        ranges = extremes_of(study, stage)
        for name, row in quantities_of(study, stage).items():
            if row.is_periodic or name not in ranges:
                continue
            samples = np.asarray(row.value(study), dtype=float)
            samples = samples[np.isfinite(samples)]
            found = ranges[name]
            slack = 1e-9 * max(
                np.abs(samples).max(), 1e-3
            )  # jerk is sampled beside its jumps; below is rounding of what is 0
            assert samples.max() <= found.high.value + slack, name
            assert samples.min() >= found.low.value - slack, name


@pytest.mark.stress
def test_the_named_angle_has_the_named_value() -> None:
    for design in (LIFT, PUSHER, LAYOUT_DESIGNS["d"]):
        study = Study(design)
        for stage in study.stages:
            for name, found in extremes_of(study, stage).items():
                row = quantities_of(study, stage)[name]
                for side in (found.low, found.high):
                    # a jump shows one side of its angle, or the other a hair before it
                    there = [
                        float(row.value(study.at_theta(np.array([side.theta + d])))[0]) for d in (0.0, -1e-9, 1e-9)
                    ]
                    size = max(abs(found.low.value), abs(found.high.value))
                    assert min(abs(t - side.value) for t in there) <= 1e-6 * size, (name, side)


def test_the_extremes_of_the_lift_do_not_depend_on_the_samples() -> None:
    coarse, fine = (extremes_of(Study(LIFT, n), "cam")["pressure_angle"].high for n in (16, 36_000))
    assert coarse == fine
    y = Study(LIFT).at_theta(np.array([coarse.theta])).motion.y[:, 0]
    here = placed(LIFT, coarse.theta, Series([v / math.factorial(k) for k, v in enumerate(map(float, y))]))
    assert float(cam_shape(LIFT, here).pressure_angle) == pytest.approx(coarse.value, rel=1e-13)


# -- stroke -----------------------------------------------------------------------------------------------


def test_the_stroke_of_a_spline_lies_between_its_ends() -> None:
    """Through 0, 10, 0, -10 a quarter turn apart the periodic spline of least jerk is 10 sin θ but for its harmonics."""
    points = (SplinePoint(0.0, 0.0), SplinePoint(90.0, 10.0), SplinePoint(180.0, 0.0), SplinePoint(270.0, -10.0))
    motion = Motion(3.0, (Segment(360.0, 0.0, SplineCurve(points)),))
    y = CompiledMotion(motion).state(CompiledMotion(motion).angles(np.linspace(0.0, TURN, 200_001))).y[0] * 1e3
    assert true_stroke(motion) == pytest.approx(np.ptp(y), rel=1e-9)
    assert true_stroke(motion) == pytest.approx(20.0, rel=1e-3)
    assert true_stroke(with_stroke(motion, 50.0, true_stroke(motion))) == pytest.approx(50.0, rel=1e-11)


def test_the_stroke_of_a_polynomial_that_overshoots_counts_the_overshoot() -> None:
    """10 u from rest to a velocity of -1 mm/deg: it comes back to its end from above."""
    curve = PolynomialCurve(PolynomialEnd(), PolynomialEnd(velocity=-1.0))
    motion = Motion(
        0.0,
        (
            Segment(90.0, 10.0, curve),
            Segment(270.0, -10.0, PolynomialCurve(PolynomialEnd(velocity=-1.0), PolynomialEnd())),
        ),
    )
    y = CompiledMotion(motion).state(CompiledMotion(motion).angles(np.linspace(0.0, TURN, 200_001))).y[0] * 1e3
    assert true_stroke(motion) == pytest.approx(np.ptp(y), rel=1e-8)
    assert true_stroke(motion) > 11.0
    twice = with_stroke(motion, 2.0 * true_stroke(motion), true_stroke(motion))
    assert CompiledMotion(twice).state(CompiledMotion(twice).angles(np.array([1.0]))).y == pytest.approx(
        2.0 * CompiledMotion(motion).state(CompiledMotion(motion).angles(np.array([1.0]))).y, rel=1e-11
    )


def test_the_stroke_of_named_laws_is_that_of_their_ends() -> None:
    assert true_stroke(LIFT.drive.motion) == 150.0


def test_velocities_of_the_instant_centre_go_with_the_machines_speed() -> None:
    """The cam's shape does not, and both are of one stage."""
    design = edited(LIFT, "shaft.speed_rpm", 2.0 * LIFT.shaft.speed_rpm)
    for name, factor in (("instant_centre_velocity", 2.0), ("reference_velocity", 2.0), ("pressure_angle", 1.0)):
        before, after = (extremes_of(Study(each), "cam", (name,))[name].high.value for each in (LIFT, design))
        assert after == pytest.approx(factor * before, rel=1e-12), name
