"""core.design.curves: curves with numbers of their own, against fifty-digit solutions that share nothing with the code."""

import math
import random
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sampled import spread

from core.design import (
    Curve,
    Motion,
    NamedCurve,
    PolynomialCurve,
    PolynomialEnd,
    SccaCurve,
    Segment,
    SplineCurve,
    SplinePoint,
    TableCurve,
    mirrored,
    part_faults,
)
from core.errors import DesignError
from core.laws import LAWS
from core.motion import Angles, CompiledMotion, findings, program
from core.motion.split import split_segment
from core.project import dumps, loads

EPS = float(np.finfo(float).eps)
SYMMETRIC = [slug for slug, law in LAWS.items() if law.is_symmetric]
Exact = Callable[[mpmath.mpf], mpmath.mpf]


def states(curve: Curve, places: np.ndarray, span: float = 80.0, rise: float = 30.0) -> np.ndarray:
    """s, s', s'', s''' by u over a segment that stands between dwells; places 0 < u < 1: (4, n)."""
    motion = Motion(
        5.0, (Segment(40.0, 0.0), Segment(span, rise, curve), Segment(320.0 - span, -rise, NamedCurve("3-4-5")))
    )
    y = program(motion).state(program(motion).angles(np.deg2rad(40.0 + span * places))).y
    y = y / motion.scale * np.deg2rad(span) ** np.arange(4)[:, None]
    y[0] -= 5.0
    return y


# -- crossover --------------------------------------------------------------------------------------------


def test_which_laws_have_two_halves_alike() -> None:
    one_sided = {"dwell", "double-harmonic", "p1", "p2", *(f"{k}{i}" for k in "ch" for i in range(1, 5))}
    assert set(LAWS) - set(SYMMETRIC) == one_sided


@pytest.mark.parametrize("slug", ["modified-sine", "cycloidal", "3-4-5", "parabolic", "gutman-1-3"])
@pytest.mark.parametrize("crossover", [0.02, 0.35, 0.5, 0.8])
def test_an_asymmetric_law_is_its_halves_stretched(slug: str, crossover: float) -> None:
    """s = 2x L(u/2x) before the crossover x and 1 - 2(1-x) L((1-u)/(2-2x)) after it."""
    chance = random.Random(slug)
    places = np.array([chance.random() for _ in range(40)])
    got = states(NamedCurve(slug, crossover), places, rise=1.0)
    law, x = LAWS[slug], crossover
    for i, u in enumerate(places):
        if u < x:
            rows, gain, by = law(np.array([u / (2 * x)]))[:, 0], 2 * x, 2 * x
        else:
            rows, gain, by = law(np.array([(1 - u) / (2 - 2 * x)]))[:, 0], 2 - 2 * x, 2 - 2 * x
            rows = rows * np.array([-1.0, 1.0, -1.0, 1.0]) + np.array([1.0 / gain, 0, 0, 0])
        wanted = gain * rows / by ** np.arange(4)
        # the place inside the segment is known to some eps of the turn, which the next derivative multiplies
        room = 64 * EPS * 10.0 ** np.arange(2, 6) / by ** np.arange(4)
        assert np.all(np.abs(got[:, i] - wanted) <= room), u


@pytest.mark.parametrize("slug", sorted(set(LAWS) - set(SYMMETRIC)))
def test_a_law_of_one_half_takes_no_crossover(slug: str) -> None:
    way = -1.0 if LAWS[slug].rises < 0 else 1.0
    rise = 0.0 if LAWS[slug].is_dwell else 10.0 * way
    segments = (Segment(100.0, rise, NamedCurve(slug, 0.4)), Segment(260.0, -rise, NamedCurve("3-4-5")))
    found = part_faults(Motion(0.0, segments), "motion")
    assert [fault.path for fault in found] == ["motion.segments[0].crossover"]
    assert slug in str(found[0])


# -- SCCA -------------------------------------------------------------------------------------------------


def scca_by_quadrature(curve: SccaCurve, u: float) -> tuple[mpmath.mpf, mpmath.mpf, mpmath.mpf]:
    """s, v and a of a sine - constant - cosine law: its acceleration as Norton draws it, integrated numerically."""
    rest = 1 - mpmath.mpf(curve.cv_fraction)
    b, c = curve.ramp_fraction * rest, curve.flat_fraction * rest
    d = rest - b - c
    ends = [mpmath.mpf(0)]
    for width in (b / 2, c / 2, d / 2, 1 - rest, d / 2, c / 2, b / 2):
        ends.append(ends[-1] + width)

    def a(x: mpmath.mpf) -> mpmath.mpf:
        for k, (low, high) in enumerate(pairwise(ends)):
            if x <= high and high > low:
                w = (x - low) / (high - low) * mpmath.pi / 2
                return (mpmath.sin(w), 1, mpmath.cos(w), 0, -mpmath.sin(w), -1, -mpmath.cos(w))[k]
        return mpmath.mpf(0)

    def integral(f: Exact, upto: mpmath.mpf) -> mpmath.mpf:
        cuts = sorted({mpmath.mpf(0), upto, *(e for e in ends if e < upto)})
        return mpmath.quad(f, cuts) if len(cuts) > 1 else mpmath.mpf(0)

    def rising(upto: mpmath.mpf) -> mpmath.mpf:  # by Cauchy's formula for repeated integration
        return integral(lambda x: (upto - x) * a(x), upto)

    whole = rising(mpmath.mpf(1))
    place = mpmath.mpf(u)
    return rising(place) / whole, integral(a, place) / whole, a(place) / whole


@pytest.mark.parametrize(
    "curve",
    spread(
        [
            SccaCurve(),
            SccaCurve(0.3, 0.25, 0.0),
            SccaCurve(0.0, 0.125, 0.5),
            SccaCurve(0.5, 0.4, 0.6),
            SccaCurve(0.99, 0.3, 0.3),
            SccaCurve(0.2, 0.0, 0.0),
        ],
        1,
    ),
)
def test_the_sine_constant_cosine_family_is_its_acceleration_integrated(curve: SccaCurve) -> None:
    places = [0.07, 0.29, 0.5, 0.61, 0.93]
    got = states(curve, np.array(places), rise=1.0)
    size = np.abs(states(curve, np.linspace(1e-6, 1 - 1e-6, 2001), rise=1.0)).max(axis=1)
    with mpmath.workdps(25):
        for i, u in enumerate(places):
            for k, exact in enumerate(scca_by_quadrature(curve, u)):
                assert abs(got[k, i] - float(exact)) <= 64 * EPS * (size[k] + size[k + 1])


@pytest.mark.parametrize(
    ("curve", "slug"),
    [
        (SccaCurve(0.2), "mcv20"),
        (SccaCurve(0.5), "mcv50"),
        (SccaCurve(0.0, 0.25, 0.5), "modified-trapezoid"),
        (SccaCurve(0.0, 0.5, 0.0), "cycloidal"),
    ],
)
def test_members_of_the_family_have_names(curve: SccaCurve, slug: str) -> None:
    places = np.linspace(0.011, 0.989, 57)
    named, own = states(NamedCurve(slug), places), states(curve, places)
    assert np.abs(named - own).max(axis=1) == pytest.approx(0.0, abs=1e-9)
    assert np.all(np.abs(named - own)[:3].max(axis=1) <= 1e-13 * np.abs(named).max(axis=1)[:3])


def test_shares_of_more_than_the_whole_are_a_fault() -> None:
    segments = (Segment(180.0, 10.0, SccaCurve(0.0, 0.7, 0.4)), Segment(180.0, -10.0, SccaCurve(1.5)))
    found = sorted(str(fault) for fault in part_faults(Motion(0.0, segments), "motion"))
    assert len(found) == 2
    assert "motion.segments[0]" in found[0]
    assert "1.1" in found[0]
    assert found[1].startswith("motion.segments[1].cv_fraction = 1.5")


# -- polynomial -------------------------------------------------------------------------------------------


def interpolant(start: list[float], end: list[float]) -> list[mpmath.mpf]:
    """Ascending coefficients of the polynomial with these derivatives at 0 and 1, from its linear equations."""
    n = len(start) + len(end)
    rows, right = [], []
    for place, wanted in ((0, start), (1, end)):
        for order, value in enumerate(wanted):
            rows.append([mpmath.ff(k, order) * mpmath.mpf(place) ** (k - order) if k >= order else 0 for k in range(n)])
            right.append(mpmath.mpf(value))
    return list(mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix(right)))


ENDS = st.builds(
    PolynomialEnd,
    st.floats(-3.0, 3.0),
    st.floats(-0.2, 0.2),
    st.one_of(st.none(), st.floats(-0.01, 0.01)),
)


@given(ENDS, ENDS, st.floats(5.0, 200.0), st.floats(-100.0, 100.0))
def test_a_polynomial_has_the_wanted_ends_and_the_least_degree(
    start: PolynomialEnd, end: PolynomialEnd, span: float, rise: float
) -> None:
    wanted = [
        [value, e.velocity * span, e.acceleration * span**2, *([] if e.jerk is None else [e.jerk * span**3])]
        for value, e in ((0.0, start), (rise, end))
    ]
    places = np.array([0.001, 0.2, 0.5, 0.83, 0.999])
    got = states(PolynomialCurve(start, end), places, span, rise)
    with mpmath.workdps(50):
        exact = interpolant(*wanted)
        # Horner's rule and the expansion in closed form see the sum of the terms, not the value
        terms = sum(abs(float(c)) for c in exact) + sum(map(abs, wanted[0] + wanted[1]))
        for i, u in enumerate(places):
            for order in range(4):
                terms_at = (
                    c * mpmath.ff(k, order) * mpmath.mpf(u) ** (k - order) for k, c in enumerate(exact) if k >= order
                )
                value = mpmath.fsum(terms_at)
                size = terms + (5.0 if order == 0 else 1e-280)  # the level it starts from; subnormal numbers
                assert abs(got[order, i] - float(value)) <= 64 * EPS * size * 8.0**order * (1.0 + 360.0 / span)


def test_a_polynomial_joins_its_neighbours() -> None:
    """Constant velocity before, dwell behind: nothing jumps where its ends say so, and jerk where it is left free."""
    curve = PolynomialCurve(PolynomialEnd(velocity=0.5), PolynomialEnd())
    segments = (
        Segment(40.0, 20.0, NamedCurve("constant-velocity")),
        Segment(60.0, 15.0, curve),
        Segment(100.0, 0.0),
        Segment(160.0, -35.0, PolynomialCurve(PolynomialEnd(), PolynomialEnd(velocity=0.5))),
    )
    jumps = [list(join.jumps) for join in program(Motion(0.0, segments)).joins]
    assert jumps == [[False, False, False, True]] * 4


# -- which way it moves -----------------------------------------------------------------------------------


def test_the_way_changes_where_a_curve_turns() -> None:
    """A rise of nothing that goes out and back turns once: at its middle."""
    curve = SplineCurve((SplinePoint(50.0, value=10.0),))
    motion = Motion(0.0, (Segment(100.0, 0.0, curve), Segment(260.0, 0.0)))
    compiled = CompiledMotion(motion)
    state = compiled.state(compiled.angles(np.deg2rad(np.array([1.0, 49.9, 50.1, 99.0, 200.0]))))
    assert list(state.velocity_sign) == [1.0, 1.0, -1.0, -1.0, 0.0]
    assert np.all(np.sign(state.y[1, :4]) == state.velocity_sign[:4])


@given(
    st.lists(
        st.tuples(st.floats(0.05, 0.95), st.floats(-20.0, 20.0)),
        min_size=1,
        max_size=5,
        unique_by=lambda p: round(p[0], 2),
    )
)
def test_the_sign_of_the_velocity_is_the_way(points: list[tuple[float, float]]) -> None:
    curve = SplineCurve(tuple(SplinePoint(120.0 * at, value=value) for at, value in sorted(points)))
    motion = Motion(0.0, (Segment(120.0, 5.0, curve), Segment(240.0, -5.0, NamedCurve("cycloidal"))))
    compiled = CompiledMotion(motion)
    theta = np.linspace(0.0, np.deg2rad(120.0), 400)[1:-1]
    state = compiled.state(compiled.angles(theta))
    fast = np.abs(state.y[1]) > 1e-6 * np.abs(state.y[1]).max()
    assert np.all(np.sign(state.y[1][fast]) == state.velocity_sign[fast])


# -- spline -----------------------------------------------------------------------------------------------


def test_a_spline_keeps_to_its_points_and_starts_at_rest() -> None:
    points = (
        SplinePoint(10.0, value=2.0),
        SplinePoint(35.0, velocity=0.9),
        SplinePoint(50.0, value=22.0, acceleration=0.0),
    )
    curve = SplineCurve(points)
    at = np.array([1e-9, 10.0 / 80.0, 35.0 / 80.0, 50.0 / 80.0, 1.0 - 1e-9])
    y = states(curve, at) / 80.0 ** np.arange(4)[:, None]
    assert y[0, 1] == pytest.approx(2.0, abs=1e-10)
    assert y[1, 2] == pytest.approx(0.9, abs=1e-11)
    assert y[0, 3] == pytest.approx(22.0, abs=1e-10)
    assert y[2, 3] == pytest.approx(0.0, abs=1e-11)
    assert y[:3, 0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-7)
    assert y[:3, -1] == pytest.approx([30.0, 0.0, 0.0], abs=1e-7)


def test_a_spline_may_start_in_motion_where_a_point_says_so() -> None:
    y = states(SplineCurve((SplinePoint(0.0, velocity=0.25),)), np.array([1e-12]))
    assert y[1, 0] / 80.0 == pytest.approx(0.25, abs=1e-9)


def test_a_spline_over_the_whole_turn_closes_smoothly() -> None:
    points = tuple(SplinePoint(30.0 * k, value=10.0 * math.sin(k) + (3.0 if k == 5 else 0.0)) for k in range(12))
    motion = Motion(0.0, (Segment(360.0, 0.0, SplineCurve(points)),))
    compiled = program(motion)
    assert not compiled.joins[0].jumps[:3].any()
    last = compiled.starts.size - 1
    end = compiled.state(Angles(compiled.ends[[last]], np.array([last]))).y[:, 0]
    start = compiled.state(Angles(compiled.starts[[0]], np.array([0]))).y[:, 0]
    size = np.abs(compiled.state(compiled.angles(np.linspace(0.0, 6.28, 720))).y).max(axis=1)
    assert np.all(np.abs(end - start)[:3] <= 1e-10 * size[:3])


def test_a_spline_costs_less_jerk_than_its_rivals() -> None:
    """Of all curves through the points the spline has the least ∫ jerk²: any bump that keeps the points costs more."""
    points = (SplinePoint(20.0, value=6.0), SplinePoint(55.0, value=21.0))
    x, weights = np.polynomial.legendre.leggauss(8)  # exact for the fifth degree between knots
    knots = [0.0, 20 / 80, 55 / 80, 1.0]
    u = np.concatenate([a + (b - a) * (x + 1.0) / 2.0 for a, b in pairwise(knots)])
    weight = np.concatenate([(b - a) / 2.0 * weights for a, b in pairwise(knots)])
    jerk = states(SplineCurve(points), u)[3]
    cost = float(weight @ jerk**2)
    # u³(1-u)³(u-1/4)(u-11/16) vanishes at the points, and at the ends with two derivatives
    bump = np.polynomial.Polynomial.fromroots([0, 0, 0, 1, 1, 1, 20 / 80, 55 / 80]).deriv(3)(u)
    crossed = float(weight @ (jerk * bump))
    assert abs(crossed) <= 1e-10 * math.sqrt(cost * float(weight @ bump**2)), "a minimum: flat in every direction"


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ((SplinePoint(120.0, value=1.0),), "points[0].at_deg = 120.0: beyond its segment; allowed: 0 ... 80 deg"),
        ((SplinePoint(20.0),), "points[0]: has no value"),
        ((SplinePoint(20.0, value=1.0), SplinePoint(20.0, value=2.0)), "points[1].at_deg = 20.0: given twice"),
    ],
)
def test_a_wrong_point_is_named(points: tuple[SplinePoint, ...], words: str) -> None:
    segments = (Segment(80.0, 10.0, SplineCurve(points)), Segment(280.0, -10.0, NamedCurve("cycloidal")))
    found = [str(fault) for fault in part_faults(Motion(0.0, segments), "motion")]
    assert len(found) == 1
    assert words in found[0]


def test_all_kinds_of_curve_are_told_apart() -> None:
    """Equal numbers, other kinds: compiled motions are kept by what they are."""
    base = Motion(0.0, (Segment(180.0, 10.0, NamedCurve("cycloidal")), Segment(180.0, -10.0, NamedCurve("cycloidal"))))
    curves: tuple[Curve, ...] = (
        NamedCurve("cycloidal"),
        SccaCurve(),
        PolynomialCurve(),
        SplineCurve((SplinePoint(90.0, value=5.0),)),
    )
    theta = np.array([0.7])
    seen = set()
    for curve in curves:
        motion = replace(base, segments=(Segment(180.0, 10.0, curve), base.segments[1]))
        seen.add(float(program(motion).state(program(motion).angles(theta)).y[0, 0]))
    assert len(seen) == len(curves)


# -- tables -----------------------------------------------------------------------------------------------


def test_a_table_with_whole_states_is_the_quintic_between_its_rows() -> None:
    """Rows of (30 + x)^5: the curve between two of them is that polynomial itself."""

    def row(x: float) -> SplinePoint:
        return SplinePoint(x, (30 + x) ** 5 - 30**5, 5 * (30 + x) ** 4, 20 * (30 + x) ** 3)

    rows = tuple(row(x) for x in (0.0, 13.0, 50.0, 80.0))
    got = states(TableCurve(rows), np.array([0.1, 0.5, 0.9]), rise=110.0**5 - 30**5)
    x = 30 + 80.0 * np.array([0.1, 0.5, 0.9])
    assert got[0] == pytest.approx(x**5 - 30**5, rel=1e-12)
    assert got[1] / 80.0 == pytest.approx(5 * x**4, rel=1e-12)
    assert got[2] / 80.0**2 == pytest.approx(20 * x**3, rel=1e-11)


JOINING = """
format = 1
name = "Joined"

[motion]
start_mm = 0.0

[[motion.segments]]
law = "polynomial"
span_deg = 100.0
rise_mm = 10.0
end = { velocity = 0.3, acceleration = 0.002 }

[[motion.segments]]
law = "table"
span_deg = 100.0
rise_mm = 20.0
start = "joined"
end = "stop"
points = [[0.0, 0.0], [40.0, 12.0], [100.0, 20.0]]

[[motion.segments]]
law = "3-4-5"
span_deg = 160.0
rise_mm = -30.0
"""


def at(motion: Motion, angle_deg: float) -> list[float]:
    """s, v, a in the motion's unit and degrees."""
    compiled = program(motion)
    y = compiled.state(compiled.angles(np.deg2rad([angle_deg]))).y[:3, 0]
    return list(y / motion.scale * np.deg2rad(1.0) ** np.arange(3))


def test_the_ends_of_a_table_are_joined_stopped_or_free() -> None:
    design = loads(JOINING)
    assert loads(dumps(design)) == design
    motion = design.drive.motion
    assert at(motion, 100.0) == pytest.approx([10.0, 0.3, 0.002], abs=1e-12)
    assert at(motion, 140.0)[0] == pytest.approx(22.0, abs=1e-12)
    s, v, a = at(motion, 200.0 - 1e-7)
    assert (s, v) == pytest.approx((30.0, 0.0), abs=1e-8)
    assert a < -0.001  # least jerk with no more than velocity 0 asked
    assert [f.code for f in findings(program(motion))] == ["jump-acceleration"]
    assert findings(program(loads(JOINING.replace('"stop"', '"rest"')).drive.motion)) == []
    # three rows that lie on a parabola, with both ends free, are that parabola
    free = JOINING.replace('"stop"', '"free"').replace('"joined"', '"free"').replace("[40.0, 12.0]", "[50.0, 15.0]")
    assert at(loads(free).drive.motion, 125.0) == pytest.approx([10.0 + 8.75, 0.3, -0.004], abs=1e-11)
    # run backwards its start is its end; cut it is the same curve
    turned = mirrored(motion.segments[1])
    assert (turned.curve.start, turned.curve.end) == ("stop", "joined")
    cut = split_segment(design, 1, 130.0).drive.motion
    for angle in (110.0, 150.0, 199.0):
        assert at(cut, angle) == pytest.approx(at(motion, angle), abs=1e-10)


def test_a_table_is_not_joined_to_one_that_is_joined() -> None:
    last = 'law = "table"\nspan_deg = 160.0\nrise_mm = -30.0\nstart = "joined"\npoints = [[0.0, 0.0], [160.0, -30.0]]\n'
    text = JOINING[: JOINING.index('law = "3-4-5"')] + last
    with pytest.raises(DesignError, match=r"segments\[2\]\.start = .joined.: the adjacent segment is joined itself"):
        loads(text)
    with pytest.raises(DesignError, match=r"segments\[1\]\.end = .loose.: .*rest \| stop \| free \| joined"):
        loads(JOINING.replace('"stop"', '"loose"'))
