"""A segment's curve as pieces: every kind of curve is one row that turns what was typed into a table of coefficients."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import comb
from operator import add
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import (
    AT_REST,
    JOINED,
    ComputedCurve,
    Curve,
    Motion,
    NamedCurve,
    PolynomialCurve,
    SccaCurve,
    Segment,
    SplineCurve,
    SplinePoint,
    TableCurve,
)
from core.design.design import Design, Drive
from core.design.fields import choice, number, whole
from core.design.linkage import MOTION_SPEED
from core.design.parts import OUTPUT_LOADS, Output, Shaft
from core.design.rules import CLOSING
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.laws import LAWS, Piece, PieceTable, asymmetric, find_law, hermite, least_jerk, moved, scca
from core.numerics.lazy import taker

# -- A segment's curve as pieces --------------------------------------------------------------------------------


@frozen
class CurveShape:
    """pieces of s(u), u = 0...1; gain: what s is multiplied by [unit of the motion]; velocity_signs: the sign of the velocity on
    each piece, 0 where nothing moves."""

    pieces: tuple[Piece, ...]
    gain: float
    velocity_signs: tuple[float, ...]


def _named(curve: NamedCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    law = find_law(curve.law)
    if law is None:
        raise DesignError([Fault(f"{path}.law", curve.law, "unknown law")])
    pieces = law.flat(curve.flat_fraction) if law.flat is not None and curve.flat_fraction else law.pieces
    if curve.crossover != 0.5:
        pieces = asymmetric(law.pieces, curve.crossover)
    velocity_sign = 0.0 if law.is_dwell else np.sign(segment.rise)
    return CurveShape(pieces, segment.rise, (velocity_sign,) * len(pieces))


def _scca(curve: SccaCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    rest = 1.0 - curve.cv_fraction
    b, c = curve.ramp_fraction * rest, curve.flat_fraction * rest
    pieces = scca(b, c, rest - b - c)
    return CurveShape(pieces, segment.rise, (np.sign(segment.rise),) * len(pieces))


def _polynomial(curve: PolynomialCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    span = segment.span_deg
    ends = []
    for value, end in ((0.0, curve.start), (segment.rise, curve.end)):
        wanted = [value, end.velocity * span, end.acceleration * span**2]
        ends.append(wanted if end.jerk is None else [*wanted, end.jerk * span**3])
    return _turning((Piece(0.0, hermite(*ends)),))


_END_ORDERS: Mapping[str, tuple[int, ...]] = MappingProxyType(
    {AT_REST: (1, 2), "stop": (1,), "free": (), JOINED: (1, 2)}
)
"""What an end of a table makes 0, where no row states it: velocity and acceleration."""


def _spline(curve: SplineCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    return _through(curve, segment, whole_turn, (AT_REST, AT_REST))


def _table(curve: TableCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    return _through(curve, segment, whole_turn, (curve.start, curve.end))


def with_joined_ends(motion: Motion, index: int) -> Segment:
    """A segment as its neighbours leave it: of a table whose start or end is joined the row there is given the velocity and the
    acceleration of the segment beside it, per degree."""
    segment, count = motion.segments[index], len(motion.segments)
    curve = segment.curve
    if not isinstance(curve, TableCurve) or JOINED not in (curve.start, curve.end) or count == 1:
        return segment
    points = list(curve.points)
    for kind, at, level, side in ((curve.start, 0.0, 0.0, -1), (curve.end, segment.span_deg, segment.rise, 1)):
        if kind == JOINED:
            beside = motion.segments[(index + side) % count]
            shape = segment_shape(beside, False, f"motion.segments[{(index + side) % count}]")
            y = PieceTable(shape.pieces).at(np.array([0.0 if side > 0 else 1.0])).all[:, 0]
            _, v, a, _ = (shape.gain * y / beside.span_deg ** np.arange(4)).tolist()
            points = [p for p in points if abs(p.at_deg - at) > _SAME]
            points.insert(0 if side < 0 else len(points), SplinePoint(at, level, v, a))
    return replace(segment, curve=replace(curve, points=tuple(points)))


_SAME = 1e-9  # degrees


def _through(curve: SplineCurve, segment: Segment, whole_turn: bool, at_ends: tuple[str, str]) -> CurveShape:
    span = segment.span_deg
    given = [
        (p.at_deg / span, order, value * span**order)
        for p in curve.points
        for order, value in enumerate((p.value, p.velocity, p.acceleration))
        if value is not None
    ]
    stated = {(place, order) for place, order, _ in given}
    ends = [(0.0, 0, 0.0), (1.0, 0, segment.rise)]
    if not whole_turn:
        ends += [(x, order, 0.0) for x, kind in zip((0.0, 1.0), at_ends, strict=True) for order in _END_ORDERS[kind]]
    if whole_turn:
        ends = ends[:1]  # the end is the start
    given += [e for e in ends if e[:2] not in stated and not (whole_turn and (1.0, e[1]) in stated)]
    knots = sorted({0.0, 1.0, *(place for place, _, _ in given)})
    if not (whole_turn and segment.rise):
        return _turning(least_jerk(knots, given, periodic=whole_turn))
    # where it gains on the turn what it does beyond going on evenly is periodic
    evenly = (lambda place: segment.rise * place, lambda place: segment.rise, lambda place: 0.0)
    beyond = [(place, order, value - evenly[order](place)) for place, order, value in given]
    pieces = least_jerk(knots, beyond, periodic=True)
    even = ((p, (evenly[0](p.start), segment.rise)) for p in pieces)
    return _turning(tuple(Piece(p.start, (*map(add, p.polynomial, line), *p.polynomial[2:])) for p, line in even))


def _computed(curve: ComputedCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    return _turning(curve.pieces)


def _turning(pieces: tuple[Piece, ...]) -> CurveShape:
    """Pieces cut where the velocity turns, so that each has one sign of it."""
    parts: list[Piece] = []
    for piece, turns in zip(pieces, _turns(pieces), strict=True):
        parts.append(piece)
        parts += [Piece(piece.start + w, moved(piece.polynomial, w)) for w in turns]
    table = PieceTable(parts)
    ends = [*(p.start for p in parts[1:]), 1.0]
    middle = np.array([0.5 * (e - p.start) for p, e in zip(parts, ends, strict=True)])
    row = table.rows(np.arange(len(parts)), middle)
    place, speed = row(0), row(1)
    stands = np.abs(speed) <= 1e-12 * max(float(np.abs([place, speed]).max()), 1e-300)
    return CurveShape(tuple(parts), 1.0, tuple(float(w) for w in np.where(stands, 0.0, np.sign(speed))))


def _turns(pieces: tuple[Piece, ...]) -> list[list[float]]:
    """Where inside each polynomial piece the velocity is zero, in order, from the piece's start."""
    powers = max(2, *(len(p.polynomial) for p in pieces))
    rows = np.zeros((len(pieces), powers))
    for row, piece in zip(rows, pieces, strict=True):
        row[: len(piece.polynomial)] = piece.polynomial
    width = np.diff([*(p.start for p in pieces), 1.0])
    speed = (rows * np.arange(powers) * width[:, None] ** np.arange(powers))[:, 1:]  # by powers of w/width
    result: list[list[float]] = [[] for _ in pieces]
    for i in np.flatnonzero(_both_signs(speed)).tolist():
        roots = np.roots(speed[i, ::-1])
        real = roots[np.abs(roots.imag) < 1e-9].real
        result[i] = sorted(float(x * width[i]) for x in real if 1e-6 < x < 1.0 - 1e-6)
    return result


def _both_signs(polynomials: np.ndarray) -> np.ndarray:
    """Which polynomials (m, n + 1) can be of both signs within 0...1: those whose Bernstein coefficients are."""
    n = polynomials.shape[1] - 1
    bernstein = np.array([[comb(i, j) / comb(n, j) for j in range(n + 1)] for i in range(n + 1)])
    ordinates = polynomials @ bernstein.T
    return (ordinates.max(axis=1) > 0.0) & (ordinates.min(axis=1) < 0.0)


SHAPES: Mapping[type, Callable[[Any, Segment, bool, str], CurveShape]] = MappingProxyType(
    {
        NamedCurve: _named,
        SccaCurve: _scca,
        PolynomialCurve: _polynomial,
        SplineCurve: _spline,
        TableCurve: _table,
        ComputedCurve: _computed,
    }
)


_ONLY_STRETCHED = frozenset({NamedCurve, SccaCurve})
"""Curves whose pieces stay the same over any span and to any rise."""


def has_common_pieces(motion: Motion) -> bool:
    """Whether the motions of many designs, whose numbers are columns, have the same pieces, which spans and rises stretch: no curve has
    numbers of its own in each, and nothing rises in a dwell."""
    return all(taker(segment) is None or _stretches(segment) for segment in motion.segments)


def _stretches(segment: Segment) -> bool:
    curve = segment.curve
    law = find_law(curve.law) if isinstance(curve, NamedCurve) else None
    rises_in_a_dwell = law is not None and law.is_dwell and taker(segment.rise) is not None
    return type(curve) in _ONLY_STRETCHED and taker(curve) is None and not rises_in_a_dwell


_OFF: Mapping[str, tuple[float, float]] = MappingProxyType(
    {"crossover": (0.5, 0.45), "flat_fraction": (0.0, 0.05), "cv_fraction": (0.0, 0.05), "ramp_fraction": (0.0, 0.05)}
)
"""Number of a law -> where it leaves out a piece, and a value where it does not."""


def with_all_pieces(plain: Motion, motion: Motion) -> Motion:
    """A motion with the pieces that most of many designs have, whose numbers are columns in the other: where a number of a law is varied,
    the piece that the plain one leaves out is there."""
    rows = zip(plain.segments, motion.segments, strict=True)
    return replace(plain, segments=tuple(replace(own, curve=_whole(own.curve, varied.curve)) for own, varied in rows))


def _whole(curve: Curve, varied: Curve) -> Curve:
    if type(curve) not in _ONLY_STRETCHED or taker(varied) is None:
        return curve
    numbers = [(name, *row) for name, row in _OFF.items() if taker(getattr(varied, name, None)) is not None]
    moved_off: Any = {name: other for name, without, other in numbers if getattr(curve, name) == without}
    made: Any = replace(curve, **moved_off)
    return made if getattr(made, "ramp_fraction", 0.0) + made.flat_fraction <= 1.0 else curve


def segment_shape(segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    """The pieces of a segment; whole_turn: it is the only one. Raises DesignError, NoSpline."""
    return SHAPES[type(segment.curve)](segment.curve, segment, whole_turn, path)


# -- motions to begin with that need no mechanism ---------------------------------------------------------------


REST_TO_REST = tuple(slug for slug, law in LAWS.items() if law.symmetric and not law.rises)
LEAST_RAMP = 0.5  # [deg] that a flying shear must have left to speed up in
ASSUMED = ("shaft.rotation",)


@frozen(kw_only=True)
class Indexer:
    """stops: of a whole turn of the table; index_deg, dwell_deg: of the shaft, for a step and a rest."""

    stops: int = whole("Stops", 1, 1000, default=6, help="of a whole turn of the table")
    index_deg: float = number("Index angle", 1.0, 360.0, default=270.0, step=5.0, help="of the shaft, for one step")
    dwell_deg: float = number("Dwell", 0.0, 359.0, default=90.0, step=5.0, help="of the shaft, at each stop")
    law: str = choice("Law", REST_TO_REST, default="modified-sine")
    speed_rpm: float = number("Speed", 0.0, 1e5, open_low=True, default=MOTION_SPEED, step=5.0, help="of the shaft")


@frozen(kw_only=True)
class FlyingShear:
    """length_mm: of a cut, which the material runs in a turn of the shaft; window_deg: over which the shear runs with it; return_deg: for
    the way back. Speeding up and slowing down share what is left."""

    length_mm: float = number("Length", 0.0, 1e6, open_low=True, default=500.0, step=10.0, help="of a cut, a turn")
    window_deg: float = number("Synchronous window", 1.0, 357.0, default=60.0, step=5.0, help="at the material's speed")
    return_deg: float = number("Return", 1.0, 357.0, default=160.0, step=5.0, help="for the way back")
    law: str = choice("Law of the return", REST_TO_REST, default="modified-sine")
    speed_rpm: float = number("Speed", 0.0, 1e5, open_low=True, default=MOTION_SPEED, step=5.0, help="cuts a minute")


def indexer(wanted: Indexer) -> Design:
    """Steps of 360°/stops, a whole number of them in a turn of the shaft. Raises DesignError where no whole number fits."""
    cycle = wanted.index_deg + wanted.dwell_deg
    steps = round(360.0 / cycle)
    if steps < 1 or abs(steps * cycle - 360.0) > CLOSING:
        raise _refused("dwell_deg", wanted.dwell_deg, f"index angle and dwell make {cycle:g} deg",
                       "360 deg, or a half, a third ... of it")  # fmt: skip
    step = Segment(wanted.index_deg, 360.0 / wanted.stops, NamedCurve(wanted.law))
    rest = (Segment(wanted.dwell_deg, 0.0),) if wanted.dwell_deg else ()
    motion = Motion(0.0, (step, *rest) * steps, "deg", steps * 360.0 / wanted.stops)
    return _axis(f"Indexer of {wanted.stops} stops", motion, wanted.speed_rpm)


def flying_shear(wanted: FlyingShear) -> Design:
    """C1 - CV1 - C2 and a return: half a cycloid up to the material's speed v = length/360°, of height v β/2, that speed over the window,
    half a cycloid to rest. Raises DesignError where nothing is left to speed up in."""
    ramp = 0.5 * (360.0 - wanted.window_deg - wanted.return_deg)
    if ramp < LEAST_RAMP:
        raise _refused("return_deg", wanted.return_deg, f"leaves {2.0 * ramp:g} deg to speed up and to slow down",
                       f"at most {360.0 - wanted.window_deg - 2.0 * LEAST_RAMP:g} deg beside this window")  # fmt: skip
    v = wanted.length_mm / 360.0
    rises = (
        (ramp, 0.5 * v * ramp, "c1"),
        (wanted.window_deg, v * wanted.window_deg, "cv1"),
        (ramp, 0.5 * v * ramp, "c2"),
    )
    back = (wanted.return_deg, -sum(rise for _, rise, _ in rises), wanted.law)
    segments = tuple(Segment(span, rise, NamedCurve(law)) for span, rise, law in (*rises, back))
    return _axis("Flying shear", Motion(0.0, segments), wanted.speed_rpm)


def _axis(name: str, motion: Motion, speed: float) -> Design:
    drive = Drive(motion, Output(motion.unit), None, OUTPUT_LOADS[motion.unit]())
    return Design(name, Shaft("ccw", speed), (drive,), ASSUMED)


def _refused(field: str, value: float, problem: str, allowed: str) -> DesignError:
    return DesignError([Fault(field, value, problem, allowed)])
