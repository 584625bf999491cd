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
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.laws import Piece, PieceTable, asymmetric, find_law, hermite, least_jerk, moved, scca
from core.numerics.columns import taker


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


def joined(motion: Motion, index: int) -> Segment:
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
            shape = shape_of(beside, False, f"motion.segments[{(index + side) % count}]")
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


def only_stretched(motion: Motion) -> bool:
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


def shape_of(segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    """The pieces of a segment; whole_turn: it is the only one. Raises DesignError, NoSpline."""
    return SHAPES[type(segment.curve)](segment.curve, segment, whole_turn, path)
