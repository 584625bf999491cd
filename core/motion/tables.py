"""Computed motions as segments that can be edited: laws where they are exact, else tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import fsum

import numpy as np

from core.design import (
    ComputedCurve,
    Design,
    Motion,
    NamedCurve,
    Segment,
    SplinePoint,
    TableCurve,
    require_motion,
    with_drive,
)
from core.design.lobe import lobe_sides
from core.design.motion_edits import MIRRORS, without_marks
from core.design.motions import from_zero
from core.errors import MISSING, DesignError, Fault
from core.laws import PieceTable
from core.laws.lobe import Side
from core.laws.pieces import stretched
from core.motion.program import Angles, CompiledMotion, program

# -- the segments of a lobe ---------------------------------------------------------------------------------------


def lobe_to_segments(design: Design) -> Design:
    """The design with the lobe of its motion replaced by segments: run-up and ramp as laws, flank and nose as tables.

    A nose without constant acceleration is the law h2. The tables are within `TABLE_ERROR` of the lift.

    Raises
    ------
    DesignError
        Where the motion has no lobe, or its values make none.
    """
    motion = require_motion(design)
    if motion.lobe is None:
        raise DesignError([Fault("motion.lobe", MISSING, "the segments of this motion are typed")])
    opening, closing = lobe_sides(motion.lobe)
    rise = Segment(opening.span, motion.lobe.lift_mm, ComputedCurve(opening.pieces()))
    fall = Segment(closing.span, -motion.lobe.lift_mm, ComputedCurve(closing.pieces(closing=True)))
    parts = [*_parts(rise), *_parts(fall)]
    laws = [*_names(opening), *(MIRRORS.get(name, "") for name in reversed(_names(closing)))]
    segments, level = from_zero(parts, motion.lobe.nose_at_deg - opening.span)
    last = replace(segments[-1], span_deg=360.0 - fsum(part.span_deg for part in segments[:-1]))
    segments = (*segments[:-1], last)
    split = Motion(motion.start + level, segments, motion.unit)
    compiled = program(split)
    named = {id(part): NamedCurve(law) for part, law in zip(parts, laws, strict=True) if law}
    result = [
        replace(part, curve=named[id(part)])
        if id(part) in named
        else tabled(compiled, i, part)
        if isinstance(part.curve, ComputedCurve)
        else part
        for i, part in enumerate(segments)
    ]
    return with_drive(without_marks(design), motion=replace(split, segments=tuple(result)))


def _names(side: Side) -> list[str]:
    """Laws of the pieces of an opening side; empty where a piece is none."""
    form = side.form
    ramp = ["cv1"] if form.ramp_span > 0.0 else []
    flank = [""] * (2 * (form.flank_flat < 1.0) + (form.flank_flat > 0.0))
    nose = ["h2"] if form.nose_flat == 0.0 else [""] * (1 + (form.nose_flat < 1.0))
    return ["c1", *ramp, *flank, *nose]


def _parts(segment: Segment) -> Iterator[Segment]:
    """A segment for each piece of a computed curve."""
    assert isinstance(segment.curve, ComputedCurve)
    pieces = segment.curve.pieces
    starts = [*(piece.start for piece in pieces), 1.0]
    levels = [*PieceTable(pieces).at(np.array(starts[:-1]))[0].tolist(), segment.rise]
    for piece, (a, b), (low, high) in zip(pieces, pairwise(starts), pairwise(levels), strict=True):
        alone = stretched([piece], a, 1.0 / (b - a), 0.0, 1.0, -low)
        yield Segment((b - a) * segment.span_deg, high - low, ComputedCurve(tuple(alone)))


# -- tables -------------------------------------------------------------------------------------------------------


TABLE_ERROR = 1e-9  # of the stroke: largest error of a table that replaces a computed segment


def tabled(compiled: CompiledMotion, index: int, segment: Segment) -> Segment:
    """A computed segment as a table with velocity and acceleration, interpolated by quintics within `TABLE_ERROR`."""
    pieces = np.flatnonzero(compiled.segment == index)
    low, high = float(compiled.starts[pieces[0]]), float(compiled.ends[pieces[-1]])
    scale, turn = compiled.motion.scale, np.rad2deg(1.0)
    count = 8
    while True:
        at = np.linspace(low, high, count + 1)
        y = _at(compiled, pieces, at)
        if count >= 512 or _quintic_error(compiled, pieces, at, y) <= TABLE_ERROR * float(np.ptp(y[0])):
            break
        count *= 2
    rows = (y[:3] / scale / turn ** np.arange(3)[:, None]).T
    level = rows[0, 0]
    points = [
        SplinePoint(float(d), float(s - level), float(v), float(a))
        for d, (s, v, a) in zip((at - low) * turn, rows, strict=True)
    ]
    points[-1] = replace(points[-1], at_deg=segment.span_deg, value=segment.rise)
    return Segment(segment.span_deg, segment.rise, TableCurve(tuple(points)))


def _at(compiled: CompiledMotion, pieces: np.ndarray, theta: np.ndarray) -> np.ndarray:
    piece = pieces[np.clip(np.searchsorted(compiled.starts[pieces], theta, side="right") - 1, 0, pieces.size - 1)]
    return compiled.state(Angles(theta, piece)).y


def _quintic_error(compiled: CompiledMotion, pieces: np.ndarray, at: np.ndarray, y: np.ndarray) -> float:
    from core.laws.polynomial import quintics

    h = np.diff(at)
    c = quintics(h, y[:3].T[:-1, :, None], y[:3].T[1:, :, None])[:, :, 0]
    x = np.array([0.25, 0.5, 0.75])[:, None] * h
    curve = sum(c[:, k] * x**k for k in range(6))
    return float(np.abs(curve - _at(compiled, pieces, (at[:-1] + x).ravel())[0].reshape(x.shape)).max())
