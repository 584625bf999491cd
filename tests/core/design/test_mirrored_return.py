"""core.design.motion_edits: the return runs the rise backwards."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from core.design import (
    Curve,
    Design,
    Motion,
    NamedCurve,
    PolynomialCurve,
    PolynomialEnd,
    SccaCurve,
    Segment,
    SplineCurve,
    SplinePoint,
    has_image,
    join_angles,
    join_levels,
    mirror_stroke,
    mirrored,
    part_faults,
    stretched,
    stroke_mirrored,
    with_assumed,
    with_drive,
)
from core.laws import LAWS
from core.motion import CompiledMotion
from core.project import load

LIFT: Design = load(Path(__file__).parents[3] / "resources" / "examples" / "transfer_lift.toml")
SINE, DWELL, CYCLOID = NamedCurve("modified-sine"), NamedCurve("dwell"), NamedCurve("cycloidal")


def motion(*rows: tuple[float, float, Curve | str], start: float = 0.0) -> Motion:
    return Motion(start, tuple(Segment(s, r, NamedCurve(c) if isinstance(c, str) else c) for s, r, c in rows))


def with_image(of: Motion, index: int) -> Motion:
    return stroke_mirrored(of, index)[0]


def rows(of: Motion) -> list[tuple[float, float, str]]:
    return [(s.span_deg, s.rise, s.curve.law) for s in of.segments]


def state(of: Motion, angles: np.ndarray) -> np.ndarray:
    """s, v, a, j (4, n), per degree."""
    program = CompiledMotion(of)
    y = program.state(program.angles(np.deg2rad(angles))).y / of.scale
    return y * (math.pi / 180.0) ** np.arange(4)[:, None]


# -- one segment ------------------------------------------------------------------------------------------

ONE_WAY = ("double-harmonic",)
"""Laws that begin smoothly and end abruptly, and have no counterpart that does it the other way round."""

SHAPES: tuple[Curve, ...] = (
    *(NamedCurve(slug) for slug in LAWS if slug not in ("dwell", *ONE_WAY)),
    NamedCurve("cycloidal", 0.3),
    SccaCurve(0.2, 0.3, 0.4),
    PolynomialCurve(PolynomialEnd(0.1, 0.002, 0.0003), PolynomialEnd(-0.2, 0.001)),
    SplineCurve((SplinePoint(20.0, 3.0), SplinePoint(45.0, None, 0.2, 0.01), SplinePoint(70.0, 9.0))),
)


@pytest.mark.parametrize("curve", SHAPES, ids=lambda c: f"{c.law}{getattr(c, 'crossover', '')}")
def test_the_image_runs_backwards(curve: Curve) -> None:
    """y(θ) on the segment is y(span - θ) on its image, with the signs that derivatives get."""
    law = LAWS.get(curve.law)
    rise = -12.0 if law is not None and law.rises < 0 else 12.0
    there = Segment(90.0, rise, curve)
    back = mirrored(there)
    assert (back.span_deg, back.rise) == (90.0, -rise)
    both = Motion(3.0, (there, back, Segment(180.0, 0.0, DWELL)))
    assert part_faults(both, "motion") == []
    way = np.array([7.0, 31.0, 44.0, 46.0, 62.5, 88.0])
    signs = np.array([1.0, -1.0, 1.0, -1.0])[:, None]
    size = np.abs(state(both, np.linspace(0.0, 89.0, 90))).max(axis=1)[:, None]
    assert (np.abs(state(both, 180.0 - way) - signs * state(both, way)) <= 1e-9 * size).all()


@pytest.mark.parametrize("curve", SHAPES, ids=lambda c: f"{c.law}{getattr(c, 'crossover', '')}")
def test_the_image_of_the_image_is_the_segment(curve: Curve) -> None:
    segment = Segment(90.0, 12.0, curve)
    assert mirrored(mirrored(segment)) == segment


@pytest.mark.parametrize("curve", SHAPES[-2:], ids=lambda c: c.law)
def test_a_stretched_curve_has_the_same_shape(curve: Curve) -> None:
    small = Motion(0.0, (Segment(90.0, 12.0, curve), Segment(270.0, -12.0, CYCLOID)))
    large = Motion(0.0, (Segment(180.0, 36.0, stretched(curve, 2.0, 3.0)), Segment(180.0, -36.0, CYCLOID)))
    way = np.linspace(1.0, 89.0, 23)
    grown = state(small, way) * 3.0 / 2.0 ** np.arange(4)[:, None]
    assert state(large, 2.0 * way) == pytest.approx(grown, rel=1e-9, abs=1e-9)


# -- strokes ----------------------------------------------------------------------------------------------


def test_the_return_becomes_the_image_of_the_rise() -> None:
    laid_out = motion((60, 0, "dwell"), (50, 20, NamedCurve("cycloidal", 0.4)), (150, 0, "dwell"), (100, -20, SINE))
    made = with_image(laid_out, 1)
    assert rows(made) == [(60, 0, "dwell"), (50, 20, "cycloidal"), (200, 0, "dwell"), (50, -20, "cycloidal")]
    assert made.segments[3].curve == NamedCurve("cycloidal", 0.6)
    assert with_image(made, 1) == made
    assert with_image(made, 3) == made


def test_the_rise_becomes_the_image_of_the_return() -> None:
    laid_out = motion((60, 0, "dwell"), (50, 20, CYCLOID), (150, 0, "dwell"), (100, -20, SINE))
    made = with_image(laid_out, 3)
    assert rows(made) == [(60, 0, "dwell"), (100, 20, "modified-sine"), (100, 0, "dwell"), (100, -20, "modified-sine")]
    assert join_angles(made)[3] == join_angles(laid_out)[3]


def test_a_blend_is_one_stroke() -> None:
    """C1-CV1-C2 comes back as C3-CV2-C4, the last curve first."""
    blend = (30, 5, "c1"), (20, 10, "cv1"), (25, 5, "c2")
    made = with_image(motion((60, 0, "dwell"), *blend, (100, 0, "dwell"), (125, -20, SINE)), 2)
    assert rows(made)[5:] == [(25, -5, "c3"), (20, -10, "cv2"), (30, -5, "c4")]
    assert rows(made)[4] == (150, 0, "dwell")
    assert not any(join.jumps[:1].any() for join in CompiledMotion(made).joins)


def test_rise_and_return_alone_share_the_turn() -> None:
    made = with_image(motion((150, 20, SINE), (210, -20, CYCLOID)), 0)
    assert rows(made) == [(180, 20, "modified-sine"), (180, -20, "modified-sine")]


def test_dwells_that_cannot_give_enough_give_alike() -> None:
    laid_out = motion((160, 20, SINE), (15, 0, "dwell"), (150, -20, CYCLOID), (35, 0, "dwell"))
    assert rows(with_image(laid_out, 0))[3] == (25, 0, "dwell")
    laid_out = motion((169, 20, SINE), (6, 0, "dwell"), (179, -20, CYCLOID), (6, 0, "dwell"))
    assert rows(with_image(laid_out, 2)) == [
        (179, 20, "cycloidal"),
        (1, 0, "dwell"),
        (179, -20, "cycloidal"),
        (1, 0, "dwell"),
    ]


def test_what_does_not_fit_is_shared() -> None:
    """Twice 300 degrees are more than a turn: both strokes get half of what the dwells leave."""
    made = with_image(motion((300, 20, SINE), (20, 0, "dwell"), (30, -20, CYCLOID), (10, 0, "dwell")), 0)
    assert rows(made) == [(165, 20, "modified-sine"), (20, 0, "dwell"), (165, -20, "modified-sine"), (10, 0, "dwell")]


def test_other_strokes_bring_the_follower_back() -> None:
    laid_out = motion((60, 20, SINE), (60, -15, SINE), (120, 0, "dwell"), (60, 5, SINE), (60, -10, SINE))
    made = with_image(laid_out, 0)
    assert [s.rise for s in made.segments] == [20, -20, 0, 10, -10]
    assert part_faults(made, "motion") == []


def test_the_image_may_lie_across_cam_angle_0() -> None:
    """The levels that the stroke itself runs between stay."""
    laid_out = motion((40, -8, "c4"), (60, 0, "dwell"), (50, 20, SINE), (150, 0, "dwell"), (60, -12, "c3"), start=9)
    made = with_image(laid_out, 2)
    assert part_faults(made, "motion") == []
    at = [s.rise for s in made.segments].index(20)
    assert join_levels(made)[at] == join_levels(laid_out)[2] == 1.0
    assert sorted(r for _, r, _ in rows(made)) == [-20, 0, 0, 20]


def test_a_law_without_a_counterpart_has_no_image() -> None:
    assert {slug for slug in LAWS if not has_image(NamedCurve(slug))} == set(ONE_WAY)
    laid_out = motion((50, 20, "double-harmonic"), (130, 0, "dwell"), (180, -20, SINE))
    assert with_image(laid_out, 0) is laid_out
    assert with_image(laid_out, 2).segments[0].curve == SINE


@pytest.mark.parametrize("index", [0, 2])
def test_without_a_stroke_there_is_no_image(index: int) -> None:
    assert with_image(LIFT.drive.motion, index) is LIFT.drive.motion


def test_the_lift_is_its_own_image() -> None:
    assert mirror_stroke(LIFT, 1) is LIFT


def test_what_is_assumed_of_the_stroke_is_assumed_of_its_image() -> None:
    design = with_assumed(with_assumed(LIFT, "motion.segments[1].law", True), "motion.segments[4].span_deg", True)
    changed = replace(design.drive.motion.segments[1], curve=CYCLOID)
    segments = (*design.drive.motion.segments[:1], changed, *design.drive.motion.segments[2:])
    design = with_drive(design, motion=replace(design.drive.motion, segments=segments))
    made = mirror_stroke(design, 1)
    assert [s.curve.law for s in made.drive.motion.segments] == ["dwell", "cycloidal", "dwell", "cycloidal", "dwell"]
    assert made.assumed[:3] == ("motion.segments[1].law", "motion.segments[3].law", "motion.segments[4].span_deg")
    assert made.assumed[3:] == LIFT.assumed


@given(st.data())
def test_an_image_leaves_a_whole_motion(data: st.DataObject) -> None:
    laid_out = replace(data.draw(strategies.motions()), start=data.draw(st.floats(-1e3, 1e3)))
    index = data.draw(st.integers(0, len(laid_out.segments) - 1))
    made = with_image(laid_out, index)
    assert part_faults(made, "motion") == []
    if made is laid_out:
        return
    wanted = laid_out.segments[index]
    image = [s for s in made.segments if s.rise == -wanted.rise and s.curve.law == wanted.curve.law]
    own = [s for s in made.segments if s.rise == wanted.rise and s.curve.law == wanted.curve.law]
    assert [s.span_deg for s in image if s.span_deg in {s.span_deg for s in own}]
