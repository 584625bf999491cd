"""core.design.motion_edits: a join is moved, and every other join stays where it was."""

import math
from dataclasses import replace

import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from core.design import (
    Motion,
    NamedCurve,
    PolynomialCurve,
    Segment,
    SplineCurve,
    SplinePoint,
    join_angles,
    join_levels,
    join_range,
    joins_of_level,
    part_faults,
    with_join_moved,
)
from core.motion import CompiledMotion

SINE, DWELL = NamedCurve("modified-sine"), NamedCurve("dwell")
LIFT = Motion(
    150.0,
    (
        Segment(35.0, 0.0, DWELL),
        Segment(41.5, -150.0, SINE),
        Segment(207.0, 0.0, DWELL),
        Segment(41.5, 150.0, SINE),
        Segment(35.0, 0.0, DWELL),
    ),
)
THREE = Motion(5.0, tuple(Segment(120.0, rise, NamedCurve("cycloidal")) for rise in (10.0, 20.0, -30.0)))


def spans(motion: Motion) -> list[float]:
    return [s.span_deg for s in motion.segments]


def rises(motion: Motion) -> list[float]:
    return [s.rise for s in motion.segments]


# -- where joins are --------------------------------------------------------------------------------------


def test_joins_stand_at_angles_and_levels() -> None:
    assert join_angles(LIFT) == (0.0, 35.0, 76.5, 283.5, 325.0)
    assert join_levels(LIFT) == (150.0, 150.0, 0.0, 0.0, 150.0)


def test_sums_are_those_of_the_decimals() -> None:
    tenths = Motion(0.1, tuple(Segment(120.0, r, SINE) for r in (0.2, 0.4, -0.6)))  # 0.1 + 0.2 is 0.30000000000000004
    assert join_levels(tenths) == (0.1, 0.3, 0.7)


def test_dwells_keep_joins_at_one_level() -> None:
    assert [sorted(joins_of_level(LIFT, k)) for k in range(5)] == [[0, 1, 4], [0, 1, 4], [2, 3], [2, 3], [0, 1, 4]]
    assert [sorted(joins_of_level(THREE, k)) for k in range(3)] == [[0], [1], [2]]
    still = Motion(0.0, tuple(Segment(120.0, 0.0, DWELL) for _ in range(3)))
    assert sorted(joins_of_level(still, 1)) == [0, 1, 2]
    assert sorted(joins_of_level(Motion(0.0, (Segment(360.0, 0.0, DWELL),)), 0)) == [0]


# -- angles -----------------------------------------------------------------------------------------------


def test_both_segments_share_what_a_moved_join_changes() -> None:
    changed = with_join_moved(LIFT, 2, 80.0)
    assert spans(changed) == [35.0, 45.0, 203.5, 41.5, 35.0]
    assert (changed.start, rises(changed)) == (LIFT.start, rises(LIFT))
    assert spans(with_join_moved(LIFT, 4, 330.1)) == [35.0, 41.5, 207.0, 46.6, 29.9]


def test_cam_angle_0_stays() -> None:
    assert with_join_moved(LIFT, 0, 10.0) == LIFT


def least_span(motion: Motion) -> float:
    """What a join leaves of the segment before it [deg]: a little, but something."""
    low, _ = join_range(motion, 2)
    assert 0.0 < low - 35.0 < 2.0
    return low - 35.0


def test_a_join_moves_between_its_neighbours() -> None:
    least = least_span(LIFT)
    assert join_range(LIFT, 2) == (35.0 + least, 283.5 - least)
    assert join_range(LIFT, 2, 10.0) == (45.0, 273.5)
    assert join_range(LIFT, 0) == (0.0, 0.0)
    narrow = with_join_moved(LIFT, 2, 35.2)
    assert join_range(narrow, 2) == (35.2, 283.5 - least), "one that is narrower already stays so"


def test_beyond_its_neighbours_it_is_a_fault() -> None:
    assert [f.path for f in part_faults(with_join_moved(LIFT, 2, 290.0), "motion")] == ["motion.segments[2].span_deg"]
    for angle in (math.inf, -math.inf, math.nan):
        assert part_faults(with_join_moved(LIFT, 2, angle), "motion")


# -- levels -----------------------------------------------------------------------------------------------


def test_a_moved_level_is_taken_by_both_sides() -> None:
    assert rises(with_join_moved(THREE, 1, level=12.0)) == [7.0, 23.0, -30.0]
    assert rises(with_join_moved(THREE, 2, level=30.1)) == [10.0, 15.1, -25.1]


def test_the_level_of_join_0_is_the_start() -> None:
    changed = with_join_moved(THREE, 0, level=2.0)
    assert (changed.start, rises(changed)) == (2.0, [13.0, 20.0, -33.0])


def test_a_dwell_keeps_still() -> None:
    low = with_join_moved(LIFT, 2, level=-10.0)
    assert low == with_join_moved(LIFT, 3, level=-10.0)
    assert (low.start, rises(low)) == (150.0, [0.0, -160.0, 0.0, 160.0, 0.0])
    high = with_join_moved(LIFT, 1, level=140.0)
    assert high == with_join_moved(LIFT, 0, level=140.0) == with_join_moved(LIFT, 4, level=140.0)
    assert (high.start, rises(high)) == (140.0, [0.0, -140.0, 0.0, 140.0, 0.0])


def test_where_all_is_still_the_start_moves() -> None:
    still = Motion(7.0, tuple(Segment(180.0, 0.0, DWELL) for _ in range(2)))
    changed = with_join_moved(still, 1, level=9.0)
    assert (changed.start, rises(changed)) == (9.0, [0.0, 0.0])


def test_angle_and_level_at_once() -> None:
    both = with_join_moved(LIFT, 2, 80.0, -10.0)
    assert both == with_join_moved(with_join_moved(LIFT, 2, 80.0), 2, level=-10.0)
    assert (join_angles(both)[2], join_levels(both)[2]) == (80.0, -10.0)


def test_an_absurd_level_is_a_fault() -> None:
    for level in (math.inf, math.nan, 1e300):
        assert part_faults(with_join_moved(LIFT, 2, level=level), "motion")


@given(st.data())
def test_every_other_join_stays(data: st.DataObject) -> None:
    # a level of 1e9 cannot be told to the 1e-9 that rises must close to
    motion = replace(data.draw(strategies.motions()), start=data.draw(st.floats(-1e6, 1e6)))
    join = data.draw(st.integers(0, len(motion.segments) - 1))
    low, high = join_range(motion, join)
    angle = data.draw(st.floats(low, high))
    level = data.draw(st.floats(-1e6, 1e6))
    changed = with_join_moved(motion, join, angle, level)
    assert part_faults(changed, "motion") == []
    lifted = joins_of_level(motion, join)
    for k, (before, after) in enumerate(zip(join_angles(motion), join_angles(changed), strict=True)):
        assert after == pytest.approx(angle if k == join and k else before, abs=1e-8)
    for k, (before, after) in enumerate(zip(join_levels(motion), join_levels(changed), strict=True)):
        assert after == pytest.approx(level if k in lifted else before, abs=2e-8)
    assert [s.curve for s in changed.segments] == [s.curve for s in motion.segments]


@given(st.data())
def test_there_and_back_again(data: st.DataObject) -> None:
    """Ten moves of random joins leave sums that close and decimals that a reader would write."""
    motion = LIFT
    for _ in range(10):
        join = data.draw(st.integers(0, 4))
        low, high = join_range(motion, join)
        angle = round(data.draw(st.floats(low, high)) * 2.0) / 2.0
        motion = with_join_moved(motion, join, min(max(angle, low), high), float(data.draw(st.integers(-300, 300))))
    assert math.fsum(spans(motion)) == 360.0
    assert math.fsum(rises(motion)) == 0.0
    assert all(2.0 * span == round(2.0 * span) for span in spans(motion))
    assert all(rise == round(rise) for rise in rises(motion))


# -- splines ----------------------------------------------------------------------------------------------


def spline(*points: SplinePoint) -> SplineCurve:
    return SplineCurve(points)


BENT = Motion(
    0.0,
    (
        Segment(100.0, 20.0, spline(SplinePoint(40.0, 15.0), SplinePoint(100.0, 20.0, 0.5))),
        Segment(160.0, 10.0, spline(SplinePoint(0.0, None, 0.5), SplinePoint(60.0, 4.0))),
        Segment(100.0, -30.0, NamedCurve("cycloidal")),
    ),
)


def position(motion: Motion, angle: float) -> float:
    program = CompiledMotion(motion)
    return float(program.state(program.angles(np.array([math.radians(angle)]))).y[0, 0]) / motion.scale


def test_points_of_a_spline_stay_at_their_angles_and_levels() -> None:
    changed = with_join_moved(BENT, 1, 90.0, 30.0)
    assert changed.segments[0].curve == spline(SplinePoint(40.0, 15.0), SplinePoint(90.0, 30.0, 0.5))
    assert changed.segments[1].curve == spline(SplinePoint(0.0, None, 0.5), SplinePoint(70.0, -6.0))
    assert part_faults(changed, "motion") == []
    assert position(changed, 40.0) == pytest.approx(15.0, abs=1e-9)
    assert position(changed, 90.0) == pytest.approx(30.0, abs=1e-9)
    assert position(changed, 160.0) == pytest.approx(24.0, abs=1e-9)


def test_a_join_does_not_pass_the_points_of_a_spline() -> None:
    least = least_span(LIFT)
    assert join_range(BENT, 1) == (40.0 + least, 160.0 - least)
    assert join_range(BENT, 2) == (160.0 + least, 360.0 - least)


def test_the_ends_of_a_polynomial_keep_their_velocities() -> None:
    curve = PolynomialCurve()
    motion = replace(LIFT, segments=tuple(replace(s, curve=curve) for s in LIFT.segments))
    assert all(s.curve == curve for s in with_join_moved(motion, 2, 80.0, 10.0).segments)


def test_a_motion_of_one_segment_has_one_join() -> None:
    alone = Motion(3.0, (Segment(360.0, 0.0, DWELL),))
    assert with_join_moved(alone, 0, 10.0, 4.0) == replace(alone, start=4.0)
