"""core.motion: levels, joins and derivatives over one turn, against fifty-digit values of the segments' laws."""

import math
from dataclasses import replace
from fractions import Fraction
from math import fsum

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from mechanisms import LIFT, PUSHER, SMOOTH, levels, motions
from references import EPS, LAW_TERMS, MP, joins_of, motion_series, segment_at
from sampled import spread

from core.design import Motion, NamedCurve, SccaCurve, Segment
from core.design.edits import with_rise, with_span
from core.errors import DesignError
from core.findings import ERROR, WARNING
from core.motion import TURN, Angles, CompiledMotion, connected_segments, degrees, findings, program
from core.numerics.lazy import column

# See test_laws; besides, the place inside the segment comes of: start of the segment, difference, span, quotient, start
# of the piece (5 roundings of the cam angle), the level and the rise of two conversions each.
ROUNDINGS = 24


def bounds(motion: Motion, theta: float, segment: int) -> np.ndarray:
    """What roundings do to y, y', y'', y''' [SI] in a segment: of its terms, and of the place inside it."""
    part = motion.segments[segment]
    span = math.radians(part.span_deg)
    rise = abs(part.rise) * motion.scale
    terms = LAW_TERMS[part.curve.law]
    size = [rise / span**k * (terms[k] + theta / span * terms[k + 1]) for k in range(4)]
    size[0] += motion.scale * (abs(motion.start) + sum(abs(s.rise) for s in motion.segments[: segment + 1]))
    return ROUNDINGS * EPS * np.array(size)


def check_state(motion: Motion, theta: float) -> None:
    compiled = CompiledMotion(motion)
    state = compiled.state(compiled.angles(np.array([theta])))
    segment = int(compiled.segment[state.angles.piece[0]])
    exact = motion_series(motion, theta, segment).derivatives
    bound = bounds(motion, theta, segment)
    for k in range(4):
        assert abs(state.y[k, 0] - exact[k]) <= bound[k], k
    rise = motion.segments[segment].rise
    assert state.velocity_sign[0] == (
        0.0 if motion.segments[segment].curve.law == "dwell" else math.copysign(1.0, rise)
    )


@given(motions(-20.0, 60.0), st.floats(0.0, 1.0, exclude_max=True))
def test_a_motion_keeps_to_its_laws_at_any_cam_angle(motion: Motion, share: float) -> None:
    theta = share * TURN
    joins = [float(j) for j in joins_of(motion)]
    if min(abs(theta - j) for j in joins) < 1e-14:
        theta = abs(theta - 1e-12)  # a join itself belongs to the tests below
    check_state(motion, theta)


def test_a_motion_in_degrees_is_one_in_radians() -> None:
    steps = ((120.0, 30.0, "cycloidal"), (240.0, 0.0, "3-4-5"))
    turning = Motion(0.0, levels(0.0, *steps).segments, unit="deg")
    sliding = levels(0.0, *steps)
    theta = np.linspace(0.1, 6.0, 17)
    a, b = (program(m).state(program(m).angles(theta)).y for m in (turning, sliding))
    # two conversions of the level and the rise each, on either side
    assert np.abs(a / math.radians(1.0) - b / 1e-3).max(axis=1) == pytest.approx(0.0, abs=ROUNDINGS * EPS * 60 * 30)
    assert a[0].max() > 0.5
    for x in theta:
        check_state(turning, float(x))


# -- joins ------------------------------------------------------------------------------------------------

MANY = tuple(levels(0.0, *[(1.8, 10.0 * ((7 * i) % 11) * (i < 199), SMOOTH[i % 6]) for i in range(200)]).segments)
SPREAD = ((1e-6, 0.0, "dwell"), (1e-3, 0.0, "dwell"), (0.1, 0.1, "3-4-5"), (359.0, 0.0, "cycloidal"),
          (0.898999, 0.0, "dwell"))  # fmt: skip


@pytest.mark.parametrize(
    "motion",
    [
        Motion(0.0, MANY),
        levels(1e-3, *SPREAD),
        levels(5.0, (360.0, 5.0, "dwell")),
        levels(0.0, *[(0.1, 1e-3 * (i % 2) * (i < 3599), "cycloidal") for i in range(3600)]),
        levels(3.0, (100.1, 1e6, "cycloidal"), (200.2, 0.1, "3-4-5"), (59.7, 3.0, "4-5-6-7")),
    ],
    ids=["200 segments", "spans from 1e-6", "one dwell", "3600 segments", "a kilometre"],
)
def test_segments_begin_at_the_sum_of_the_spans_before_them(motion: Motion) -> None:
    """Correctly rounded sums, whatever stands before: the error does not grow with the number of segments."""
    compiled = CompiledMotion(motion)
    first = np.flatnonzero(np.diff(compiled.segment, prepend=-1))
    sums = [Fraction(0)]
    heights = [Fraction(0)]
    for s in motion.segments:
        sums.append(sums[-1] + Fraction(s.span_deg))
        heights.append(heights[-1] + Fraction(s.rise))
    begins = [math.radians(float(x)) for x in sums[:-1]]
    assert compiled.starts[first] == pytest.approx(begins, rel=EPS, abs=0.0)
    assert compiled.ends[-1] == TURN
    assert compiled.ends[:-1].tolist() == compiled.starts[1:].tolist()
    levels_there = compiled.state(compiled.angles(compiled.starts[first])).y[0]
    for got, height in zip(levels_there, heights, strict=False):
        level = float(height + Fraction(motion.start)) * 1e-3
        size = (abs(float(height)) + abs(motion.start)) * 1e-3
        assert abs(got - level) <= 4 * EPS * size  # start + height, times the unit (itself rounded)


def test_short_and_long_segments_keep_to_their_laws() -> None:
    motion = levels(0.0, *SPREAD)
    for begin, end in zip(joins_of(motion)[:-1], joins_of(motion)[1:], strict=True):
        for share in (0.1, 0.5, 0.9):
            check_state(motion, float(begin + share * (end - begin)))


def test_at_a_join_the_right_hand_limit_is_taken_and_a_rounding_below_it_too() -> None:
    motion = levels(0.0, (90.0, 30.0, "constant-velocity"), (90.0, 30.0, "dwell"), (180.0, 0.0, "simple-harmonic"))
    compiled = CompiledMotion(motion)
    for i, join in enumerate(compiled.starts[1:], start=1):
        for theta in (join, math.nextafter(join, 0.0), math.nextafter(join, 9.0)):
            right = compiled.state(compiled.angles(np.array([theta])))
            assert right.angles.piece[0] == i
            exact = motion_series(motion, join, i).derivatives
            bound = bounds(motion, join, i)
            assert all(abs(right.y[k, 0] - exact[k]) <= bound[k] for k in range(4))
        below = compiled.angles(np.array([join - 1e-13]))
        assert below.piece[0] == i - 1, "but not an angle that is clearly below"


@pytest.mark.parametrize("theta", [0.0, -0.0, TURN, -1e-20, math.nextafter(TURN, 0.0), -TURN, 3 * TURN, 5e-324])
def test_the_end_of_the_turn_is_its_beginning(theta: float) -> None:
    motion = levels(0.0, (180.0, 30.0, "constant-velocity"), (180.0, 0.0, "constant-velocity"))
    compiled = CompiledMotion(motion)
    state = compiled.state(compiled.angles(np.array([theta])))
    assert state.angles.piece[0] == 0
    assert state.y[1, 0] == pytest.approx(0.030 / math.pi, rel=4 * EPS)
    assert abs(state.y[0, 0]) <= 64 * EPS * 0.030


@pytest.mark.parametrize("theta", [-1.0, 7.0, 100.0, -1000.0])
def test_cam_angles_beyond_one_turn_count_from_its_beginning(theta: float) -> None:
    motion = levels(0.0, (180.0, 30.0, "cycloidal"), (180.0, 0.0, "3-4-5"))
    compiled = CompiledMotion(motion)
    exact = MP.mpf(theta) % (2 * MP.pi)
    y = motion_series(motion, exact, segment_at(motion, exact)).c[0]
    got = compiled.state(compiled.angles(np.array([theta]))).y[0, 0]
    # TURN is off by 2.5e-16, and taken off theta/TURN times
    slip = (abs(theta) / TURN + 1.0) * 2.5e-16 * 0.03 * 2.2
    assert abs(got - y) <= slip + bounds(motion, TURN, 0)[0]


def test_degrees_are_rounded_once() -> None:
    for n in (4, 7, 3600, 100_000):
        exact = [float(Fraction(360 * i, n)) for i in range(0, n, max(1, n // 500))]
        assert degrees(n)[:: max(1, n // 500)].tolist() == exact


IN_ORDER = {"lift": LIFT.drive.motion, "pusher": PUSHER.drive.motion, "many": Motion(0.0, MANY),
            "half a dwell": levels(0.0, (100.0, 10.0, "modified-trapezoid"), (180.0, 10.0, "dwell"), (80.0, 0.0, "cycloidal"))}  # fmt: skip


@pytest.mark.parametrize("name", IN_ORDER)
def test_in_turn_or_in_any_order_the_motion_is_the_same_to_the_last_bit(name: str) -> None:
    """A grid is walked piece by piece, angles in disorder are looked up one by one: of each angle the same is told."""
    compiled = CompiledMotion(IN_ORDER[name])
    theta = np.linspace(0.0, TURN, 3600, endpoint=False)
    order = np.random.default_rng(5).permutation(theta.size)
    grid = compiled.state(compiled.angles(theta))
    told = compiled.state(compiled.angles(theta[order]))
    assert told.y.tolist() == grid.y[:, order].tolist()
    assert told.velocity_sign.tolist() == grid.velocity_sign[order].tolist()
    one_by_one = [compiled.state(compiled.angles(theta[[i]])).y[:, 0].tolist() for i in order[:50]]
    assert one_by_one == grid.y[:, order[:50]].T.tolist()


# -- jumps ------------------------------------------------------------------------------------------------


def test_jumps_are_told_with_their_cam_angle_size_and_segment() -> None:
    motion = levels(
        0.0,
        (30.0, 0.0, "dwell"),
        (90.0, 30.0, "constant-velocity"),
        (60.0, 30.0, "dwell"),
        (120.0, 0.0, "simple-harmonic"),
        (60.0, 0.0, "dwell"),
    )
    found = findings(program(motion))
    told = [(f.code, f.severity, f.field, f.cam_angle_deg) for f in found]
    assert told == [
        ("jump-velocity", ERROR, "motion.segments[1]", pytest.approx(30.0, rel=2 * EPS)),
        ("jump-velocity", ERROR, "motion.segments[2]", pytest.approx(120.0, rel=2 * EPS)),
        ("jump-acceleration", WARNING, "motion.segments[3]", pytest.approx(180.0, rel=2 * EPS)),
        ("jump-acceleration", WARNING, "motion.segments[4]", pytest.approx(300.0, rel=2 * EPS)),
    ]
    fast = 30.0 / (math.pi / 2)
    harmonic = -30.0 * math.pi**2 / 2 / (math.pi * 2 / 3) ** 2
    sizes = [f.values["jump"] for f in found]
    assert sizes == pytest.approx([fast, -fast, harmonic, harmonic], rel=ROUNDINGS * EPS)
    assert "mm" in found[0].message


def test_a_jump_across_the_end_of_the_turn_stands_at_zero_in_the_first_segment() -> None:
    motion = levels(0.0, (180.0, 30.0, "constant-velocity"), (180.0, 0.0, "constant-velocity"))
    joins = program(motion).joins
    assert [j.theta for j in joins] == [pytest.approx(math.pi), 0.0]
    assert [j.jump[1] for j in joins] == pytest.approx([-0.06 / math.pi, 0.06 / math.pi], rel=8 * EPS)
    assert [f.field for f in findings(program(motion))] == ["motion.segments[1]", "motion.segments[0]"]
    assert findings(program(motion))[1].cam_angle_deg == 0.0


@pytest.mark.parametrize("miss", [-9e-10, 5e-11, 9e-10])
@pytest.mark.parametrize("index", range(4))
def test_spans_that_miss_the_turn_by_as_much_as_a_file_may_make_no_jump(miss: float, index: int) -> None:
    """The last segment moves: beyond its end its acceleration would go on."""
    motion = PUSHER.drive.motion
    assert motion is not None
    spans = [segment.span_deg + (miss if i == index else 0.0) for i, segment in enumerate(motion.segments)]
    missed = replace(
        motion, segments=tuple(replace(s, span_deg=span) for s, span in zip(motion.segments, spans, strict=True))
    )
    compiled = CompiledMotion(missed)
    assert findings(compiled) == []
    assert compiled.ends[-1] == TURN


def test_segments_that_go_on_into_each_other_without_rest() -> None:
    """One velocity on both sides, or rest with one acceleration; not where both rest, and not where something jumps."""
    harmonic = ("simple-harmonic", 90.0, 9.0), ("simple-harmonic", 90.0, -9.0), ("dwell", 180.0, 0.0)
    smooth = ("cycloidal", 90.0, 9.0), ("cycloidal", 90.0, -9.0), ("dwell", 180.0, 0.0)
    for rows, groups in ((harmonic, [(0, 1), (0, 1), (2,)]), (smooth, [(0,), (1,), (2,)])):
        motion = Motion(0.0, tuple(Segment(span, rise, NamedCurve(law)) for law, span, rise in rows))
        assert [connected_segments(motion, i) for i in range(len(rows))] == groups


def test_two_halves_of_one_velocity_do_not_jump() -> None:
    """30 mm over 100 degrees, then 60 over 200: only the dwell breaks the motion."""
    motion = levels(
        0.0, (100.0, 30.0, "constant-velocity"), (200.0, 90.0, "constant-velocity"), (60.0, 0.0, "cycloidal")
    )
    velocity = [bool(j.jumps[1]) for j in program(motion).joins]
    assert velocity == [False, True, True]


def test_simple_harmonic_rise_and_return_of_one_span_jump_nowhere() -> None:
    motion = levels(0.0, (180.0, 30.0, "simple-harmonic"), (180.0, 0.0, "simple-harmonic"))
    assert findings(program(motion)) == []
    joins = program(motion).joins
    assert not any(j.jumps.any() for j in joins), "a full cosine"


SMALLEST = levels(0.0, (1e-6, 1e-6, "cycloidal"), (359.999999, 0.0, "modified-sine"))
LATE = levels(
    0.0, (123.456789, 0.0, "cycloidal"), (1e-5, 1.0, "cycloidal"), (236.543201, 0.0, "modified-sine")
)  # where angles are rounded


@given(motions(-20.0, 60.0), st.floats(-9.0, 6.0))
@example(SMALLEST, 0.0)
@example(Motion(1e8, SMALLEST.segments), 0.0)
@example(LATE, 0.0)
@settings(max_examples=30)
def test_rounding_is_never_told_as_a_jump(motion: Motion, power: float) -> None:
    """Laws that come to rest join dwells and one another, at any size, without a finding."""
    calm = tuple(
        s if s.curve.law != "simple-harmonic" else Segment(s.span_deg, s.rise, NamedCurve("3-4-5"))
        for s in motion.segments
    )
    scaled = tuple(Segment(s.span_deg, s.rise * 10.0**power, s.curve) for s in calm)
    assert findings(program(Motion(motion.start, scaled))) == []


@given(motions(-20.0, 60.0), st.integers(0, 4), st.floats(-6.0, 3.0))
def test_a_true_jump_is_always_told(motion: Motion, which: int, power: float) -> None:
    """One segment of constant velocity among laws that come to rest breaks the velocity at both its ends."""
    segments = [Segment(s.span_deg, s.rise * 10.0**power, s.curve) for s in motion.segments]
    which %= len(segments)
    part = segments[which]
    if part.rise == 0.0:
        return
    segments[which] = Segment(part.span_deg, part.rise, NamedCurve("constant-velocity"))
    broken = {f.field for f in findings(program(Motion(motion.start, tuple(segments)))) if f.code == "jump-velocity"}
    after = (which + 1) % len(segments)
    assert {f"motion.segments[{which}]", f"motion.segments[{after}]"} <= broken


def test_an_unknown_law_is_named_with_its_place() -> None:
    motion = Motion(0.0, (Segment(180.0, 0.0), Segment(180.0, 0.0, NamedCurve("cycloidial"))))
    with pytest.raises(DesignError) as caught:
        CompiledMotion(motion)
    assert "motion.segments[1].law" in str(caught.value)


@pytest.mark.parametrize("seed", spread(range(10), 3))
def test_many_motions_in_one_table_are_those_of_each_to_the_last_bit(seed: int) -> None:
    """Spans and rises typed as columns: what the others gain, starts, ends, positions with their derivatives; jumps to their rounding."""
    rng, count = np.random.default_rng(seed), 40
    laws = rng.choice(["modified-sine", "cycloidal", "parabolic", "4-5-6-7", "double-harmonic"], 3)
    spans = np.round(rng.uniform(40.0, 90.0, 5), 1)
    rises = [0.0, *np.round(rng.uniform(-20.0, 20.0, 3), 2)]
    segments = [Segment(spans[0], 0.0)]
    segments += [
        Segment(span, rise, NamedCurve(law)) for span, rise, law in zip(spans[1:4], rises[1:], laws, strict=True)
    ]
    segments.append(Segment(360.0 - fsum(spans[:4]), -fsum(rises), SccaCurve(0.2, 0.5, 0.2)))
    motion = Motion(5.0, tuple(segments), advance=12.0 if seed % 2 else None)
    typed = {1: rng.uniform(30.0, 60.0, count), 3: rng.uniform(30.0, 60.0, count)}
    rise = rng.uniform(-10.0, 10.0, count)
    columns = motion
    for i, row in typed.items():
        columns = with_span(columns, i, column(row), typed)
    programs = CompiledMotion.from_columns(with_rise(columns, 2, column(rise)), count)
    pieces = programs.starts.size // count
    for k in range(count):
        own = motion
        for i, row in typed.items():
            own = with_span(own, i, float(row[k]), typed)
        one = CompiledMotion(with_rise(own, 2, float(rise[k])))
        mine = np.repeat(np.arange(pieces), 3)
        theta = one.starts[mine] + np.tile([0.0, 0.3, 1.0], pieces) * (one.ends - one.starts)[mine]
        there = programs.state(Angles(theta, k * pieces + mine))
        assert there.y.tobytes() == one.state(Angles(theta, mine)).y.tobytes()
        assert there.velocity_sign.tolist() == one.velocity_signs[mine].tolist()
        for name in ("starts", "ends", "segment"):
            assert np.split(getattr(programs, name), count)[k].tobytes() == getattr(one, name).tobytes()
    _, jump, real = programs.jumps(count)
    _, own_jump, own_real = one.jumps()
    assert real[:, -len(motion.segments) :].tolist() == own_real.tolist()
    scale = np.abs(one.state(one.angles(np.linspace(0.0, 6.28, 500))).y).max(axis=1)[:, None]
    assert (np.abs(jump[:, -len(motion.segments) :] - own_jump) < 1e-12 * scale).all()
