"""core.motion.split: a segment is cut, or followed by a copy of itself."""

import math
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from types import NoneType

import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from core.design import (
    Design,
    Motion,
    NamedCurve,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    SplineCurve,
    SplinePoint,
    part_faults,
    with_assumed,
    with_drive,
)
from core.motion import CompiledMotion
from core.motion.split import add_point, copy_segment, cut_at, split_segment, with_segment_copied, with_segment_split
from core.project import load

LIFT: Design = load(Path(__file__).parents[3] / "resources" / "examples" / "transfer_lift.toml")
MOTION = LIFT.drive.motion
BACK = NamedCurve("cycloidal")


def rows(of: Motion) -> list[tuple[float, float, str]]:
    return [(s.span_deg, s.rise, s.curve.law) for s in of.segments]


def state(of: Motion, angles: np.ndarray) -> np.ndarray:
    """s, v, a, j by cam angle (4, n), per degree."""
    program = CompiledMotion(of)
    y = program.state(program.angles(np.deg2rad(angles))).y / of.scale
    return y * (math.pi / 180.0) ** np.arange(4)[:, None]


def kinds(part: object) -> set[type]:
    """Of all that a part of a design holds."""
    if is_dataclass(part) or isinstance(part, tuple):
        inner = part if isinstance(part, tuple) else tuple(getattr(part, f.name) for f in fields(part))
        return set().union(*map(kinds, inner))
    return {type(part)}


# -- where ------------------------------------------------------------------------------------------------


def test_a_segment_is_cut_where_the_cam_stands_else_in_its_middle() -> None:
    assert cut_at(MOTION, 1, 50.0) == 50.0
    for elsewhere in (None, 35.0, 76.5, 200.0, 0.0, 35.0001):
        assert cut_at(MOTION, 1, elsewhere) == 55.75


# -- split ------------------------------------------------------------------------------------------------


def test_a_dwell_becomes_two() -> None:
    assert rows(with_segment_split(MOTION, 2, 100.1))[2:4] == [(23.6, 0, "dwell"), (183.4, 0, "dwell")]


def test_a_law_becomes_two_with_the_cut_at_its_level() -> None:
    assert rows(with_segment_split(MOTION, 1))[1:3] == [(20.75, -75, "modified-sine"), (20.75, -75, "modified-sine")]
    parts = with_segment_split(MOTION, 1, 50.0)
    assert [s.span_deg for s in parts.segments[1:3]] == [15.0, 26.5]
    assert parts.segments[1].rise == pytest.approx(float(state(MOTION, np.array([50.0]))[0, 0]) - 150.0, abs=1e-10)
    assert math.fsum(s.rise for s in parts.segments) == 0.0


SMOOTH = (
    NamedCurve("constant-velocity"),
    NamedCurve("cv1"),
    PolynomialCurve(),
    PolynomialCurve(PolynomialEnd(0.2, 0.01), PolynomialEnd(-0.1, -0.02)),
    PolynomialCurve(PolynomialEnd(0.2, 0.01, 0.003), PolynomialEnd(-0.1, -0.02)),
    PolynomialCurve(PolynomialEnd(0.2, 0.01), PolynomialEnd(-0.1, -0.02, 0.004)),
    PolynomialCurve(PolynomialEnd(0.2, 0.01, 0.003), PolynomialEnd(-0.1, -0.02, 0.004)),
    SplineCurve(
        (
            SplinePoint(20.0, 4.0),
            SplinePoint(50.0, None, 0.1, 0.02),
            SplinePoint(70.0, 8.0),
            SplinePoint(90.0, None, 0.3),
        )
    ),
)


@pytest.mark.parametrize("curve", SMOOTH, ids=str)
@pytest.mark.parametrize("at", [13.0, 50.0, 81.7])
def test_what_can_go_on_goes_on(curve: PolynomialCurve, at: float) -> None:
    """Both parts together are the curve that was cut: s, v, a and j alike everywhere."""
    whole = Motion(1.0, (Segment(100.0, 10.0 / 3.0, curve), Segment(260.0, -10.0 / 3.0, BACK)))
    parts = with_segment_split(whole, 0, at)
    assert [s.curve.law for s in parts.segments] == [curve.law, curve.law, "cycloidal"]
    assert part_faults(parts, "motion") == []
    assert kinds(parts) <= {float, int, str, bool, NoneType}, "numbers as typed ones"
    angles = np.linspace(0.5, 99.5, 67)
    size = np.abs(state(whole, angles)).max(axis=1)[:, None]
    assert (np.abs(state(parts, angles) - state(whole, angles)) <= 1e-9 * size).all()
    assert not CompiledMotion(parts).joins[0].jumps[:3].any()


def test_a_periodic_spline_becomes_two_of_half_a_turn() -> None:
    """Measured motion: its join at cam angle 0 goes on smoothly too."""
    points = tuple(SplinePoint(a, 10.0 * math.sin(math.radians(a + 20.0))) for a in range(0, 360, 30))
    whole = Motion(5.0, (Segment(360.0, 0.0, SplineCurve(points)),))
    parts = with_segment_split(whole, 0, 100.0)
    assert [s.span_deg for s in parts.segments] == [100.0, 260.0]
    assert part_faults(parts, "motion") == []
    angles = np.linspace(0.0, 359.0, 360)
    assert state(parts, angles)[:3] == pytest.approx(state(whole, angles)[:3], abs=1e-8)
    for join in CompiledMotion(parts).joins:
        assert np.abs(join.jump[:3]).max() < 1e-8


def test_what_is_assumed_is_assumed_of_both_parts() -> None:
    guessed = with_assumed(with_assumed(LIFT, "motion.segments[1].law", True), "motion.segments[3].law", True)
    for made in (split_segment(guessed, 1), copy_segment(guessed, 1)):
        assert made.assumed == (*(f"motion.segments[{i}].law" for i in (1, 2, 4)), *LIFT.assumed)


# -- copies -----------------------------------------------------------------------------------------------


def test_a_copy_shares_span_and_rise() -> None:
    made = with_segment_copied(MOTION, 1)
    assert rows(made) == [
        (35, 0, "dwell"),
        (20.75, -75, "modified-sine"),
        (20.75, -75, "modified-sine"),
        (207, 0, "dwell"),
        (41.5, 150, "modified-sine"),
        (35, 0, "dwell"),
    ]
    assert made.start == MOTION.start


@pytest.mark.parametrize("curve", SMOOTH[3:], ids=str)
def test_the_shape_comes_twice(curve: PolynomialCurve) -> None:
    whole = Motion(1.0, (Segment(100.0, 6.0, curve), Segment(260.0, -6.0, BACK)))
    made = with_segment_copied(whole, 0)
    assert part_faults(made, "motion") == []
    way = np.linspace(0.5, 99.5, 37)
    shrunk = state(Motion(0.0, whole.segments), way) * 0.5 / 0.5 ** np.arange(4)[:, None]
    for begin, level in ((0.0, 1.0), (50.0, 4.0)):
        shrunk_there = shrunk + np.array([level, 0.0, 0.0, 0.0])[:, None]
        size = np.abs(shrunk_there).max(axis=1)[:, None]
        assert (np.abs(state(made, begin + way / 2.0) - shrunk_there) <= 1e-9 * size).all()


def test_a_bump_keeps_its_height() -> None:
    """It ends where it began, so nothing has to be shared."""
    bump = SplineCurve((SplinePoint(50.0, 8.0),))
    made = with_segment_copied(Motion(0.0, (Segment(100.0, 0.0, bump), Segment(260.0, 0.0, NamedCurve("dwell")))), 0)
    assert state(made, np.array([25.0, 75.0]))[0] == pytest.approx([8.0, 8.0], abs=1e-9)


def test_a_turn_measured_once_runs_twice() -> None:
    points = tuple(SplinePoint(a, 10.0 * math.sin(math.radians(a + 20.0))) for a in range(0, 360, 30))
    whole = Motion(5.0, (Segment(360.0, 0.0, SplineCurve(points)),))
    made = with_segment_copied(whole, 0)
    assert part_faults(made, "motion") == []
    angles = np.linspace(0.0, 179.0, 90)
    wanted = state(whole, 2.0 * angles) * 2.0 ** np.arange(4)[:, None]
    for begin in (0.0, 180.0):
        assert state(made, begin + angles)[:3] == pytest.approx(wanted[:3], abs=1e-7)


# -- points -----------------------------------------------------------------------------------------------


def test_a_point_is_added_where_the_curve_runs() -> None:
    """Nothing moves: the curve of least jerk through a point of its own is itself."""
    whole = Motion(1.0, (Segment(100.0, 10.0, SplineCurve((SplinePoint(40.0, 8.0),))), Segment(260.0, -10.0, BACK)))
    design = with_drive(LIFT, motion=whole)
    made = add_point(design, 0, 62.0)
    curve = made.drive.motion.segments[0].curve
    assert isinstance(curve, SplineCurve)
    assert [p.at_deg for p in curve.points] == [40.0, 62.0]
    angles = np.linspace(0.5, 99.5, 67)
    size = np.abs(state(whole, angles)).max(axis=1)[:, None]
    assert (np.abs(state(made.drive.motion, angles) - state(whole, angles)) <= 1e-7 * size).all()
    for elsewhere in (None, 40.0, 100.0, 200.0, 0.0):
        halved = add_point(design, 0, elsewhere).drive.motion.segments[0].curve
        assert isinstance(halved, SplineCurve)
        assert [p.at_deg for p in halved.points] == [40.0, 70.0]


# -- any motion -------------------------------------------------------------------------------------------


@given(st.data())
def test_no_other_join_moves(data: st.DataObject) -> None:
    motion = replace(data.draw(strategies.motions()), start=data.draw(st.floats(-1e3, 1e3)))
    index = data.draw(st.integers(0, len(motion.segments) - 1))
    angle = data.draw(st.one_of(st.none(), st.floats(0.0, 360.0)))
    for made in (with_segment_split(motion, index, angle), with_segment_copied(motion, index)):
        assert part_faults(made, "motion") == []
        assert len(made.segments) == len(motion.segments) + 1
        whole, two = motion.segments[index], made.segments[index : index + 2]
        assert math.fsum(s.span_deg for s in two) == pytest.approx(whole.span_deg, abs=1e-9)
        assert math.fsum(s.rise for s in two) == pytest.approx(whole.rise, abs=1e-9)
        assert (*made.segments[:index], *made.segments[index + 2 :]) == (
            *motion.segments[:index],
            *motion.segments[index + 1 :],
        )
