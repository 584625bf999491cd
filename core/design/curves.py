"""Curves of segments as pieces: one function per kind of curve computes its coefficients from the design."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from math import ceil, comb, floor, log10
from operator import add
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from core.design.motions import (
    AT_REST,
    JOINED,
    MINIMISED,
    ComputedCurve,
    Curve,
    Motion,
    NamedCurve,
    OptimalCurve,
    PolynomialCurve,
    SccaCurve,
    Segment,
    SplineCurve,
    SplinePoint,
    TableCurve,
    is_joined,
)
from core.errors import MISSING, DesignError, Fault, KindynaError
from core.frozen import frozen
from core.laws import NoSpline, Piece, PieceTable, asymmetric, find_law, hermite, least_jerk, scca, trimmed
from core.numerics.derivatives import QUARTER
from core.numerics.lazy import part_mapper
from core.numerics.roots import BracketEnds, bracketed_root

if TYPE_CHECKING:
    from core.laws.knots import OptimalTask
    from core.laws.local import LocalLaw
    from core.laws.optimal import NoOptimalLaw

# -- curve of a segment as pieces -------------------------------------------------------------------------------


@frozen
class CurveShape:
    """Curve of a segment: gain times s(u), u = 0 ... 1.

    Attributes
    ----------
    pieces : tuple of Piece
        Pieces of s(u), dimensionless.
    gain : float [mm or deg]
        Factor of s(u).
    velocity_signs : tuple of float
        Sign of the velocity on each piece, 0 where the output is at rest.
    """

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
        values = [value, end.velocity * span, end.acceleration * span**2]
        ends.append(values if end.jerk is None else [*values, end.jerk * span**3])
    return _split_at_reversals((Piece(0.0, hermite(*ends)),))


_END_ORDERS: Mapping[str, tuple[int, ...]] = MappingProxyType(
    {AT_REST: (1, 2), "stop": (1,), "free": (), JOINED: (1, 2)}
)
"""Kind of end of a table -> orders of the derivatives that are 0 there, unless a row states them."""


def _spline(curve: SplineCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    return _interpolation(curve, segment, whole_turn, (AT_REST, AT_REST))


def _table(curve: TableCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    return _interpolation(curve, segment, whole_turn, (curve.start, curve.end))


def with_joined_ends(motion: Motion, index: int) -> Segment:
    """A segment whose joined ends are resolved.

    Where the start or end of a table or an optimal law is joined, its first or last point receives velocity and acceleration (per degree)
    of the neighbouring segment.
    """
    segment, count = motion.segments[index], len(motion.segments)
    curve = segment.curve
    ends = [end for end in ("start", "end") if is_joined(curve, end)]
    if not isinstance(curve, SplineCurve) or not ends or count == 1:
        return segment
    points = list(curve.points)
    for end, at, level, side in (("start", 0.0, 0.0, -1), ("end", segment.span_deg, segment.rise, 1)):
        if end in ends:
            neighbour = motion.segments[(index + side) % count]
            shape = segment_shape(neighbour, False, f"motion.segments[{(index + side) % count}]")
            derivatives = PieceTable(shape.pieces).at(np.array([0.0 if side > 0 else 1.0])).all[:, 0]
            _, v, a, _ = (shape.gain * derivatives / neighbour.span_deg ** np.arange(4)).tolist()
            points = [p for p in points if abs(p.at_deg - at) > _SAME]
            points.insert(0 if side < 0 else len(points), SplinePoint(at, level, v, a))
    return replace(segment, curve=replace(curve, points=tuple(points)))


_SAME = 1e-9  # [deg] closer angles are equal


def _interpolation(curve: SplineCurve, segment: Segment, whole_turn: bool, at_ends: tuple[str, str]) -> CurveShape:
    conditions = _point_conditions(curve, segment, 1.0)
    stated = {(u, order) for u, order, _ in conditions}
    end_conditions = [(0.0, 0, 0.0), (1.0, 0, segment.rise)]
    if not whole_turn:
        end_conditions += [
            (x, order, 0.0) for x, kind in zip((0.0, 1.0), at_ends, strict=True) for order in _END_ORDERS[kind]
        ]
    if whole_turn:
        end_conditions = end_conditions[:1]  # the end coincides with the start
    conditions += [e for e in end_conditions if e[:2] not in stated and not (whole_turn and (1.0, e[1]) in stated)]
    knots = sorted({0.0, 1.0, *(u for u, _, _ in conditions)})
    if not (whole_turn and segment.rise):
        return _split_at_reversals(least_jerk(knots, conditions, periodic=whole_turn))
    # an advance: a straight line, and a periodic part
    line = (lambda u: segment.rise * u, lambda u: segment.rise, lambda u: 0.0)
    periodic_part = [(u, order, value - line[order](u)) for u, order, value in conditions]
    pieces = least_jerk(knots, periodic_part, periodic=True)
    lines = ((p, (line[0](p.start), segment.rise)) for p in pieces)
    return _split_at_reversals(
        tuple(Piece(p.start, (*map(add, p.polynomial, values), *p.polynomial[2:])) for p, values in lines)
    )


ORDERS_LIMITED = ("velocity", "acceleration", "jerk")


# -- optimal laws -----------------------------------------------------------------------------------------------

MAX_SOLVED = 256  # optimal laws that are cached
_solved: OrderedDict[tuple[Segment, bool], CurveShape | NoOptimalLaw | DesignError] = OrderedDict()
"""Segment with resolved ends, and whether the motion has no other -> its curve, or why no law is optimal."""


def _optimal(curve: OptimalCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    from core.laws.optimal import NoOptimalLaw  # imported here to save start-up time

    key = segment, whole_turn
    result = _solved.get(key)
    if result is None:
        result = _solved[key] = _optimal_shape(curve, segment, whole_turn, path)
        if len(_solved) > MAX_SOLVED:
            _solved.popitem(last=False)
    else:
        with suppress(KeyError):  # another thread removed it just now
            _solved.move_to_end(key)
    if isinstance(result, NoOptimalLaw):
        raise DesignError([_no_optimal_law(result, curve, path)])
    if isinstance(result, DesignError):
        raise DesignError(result.faults)
    return result


def _optimal_shape(
    curve: OptimalCurve, segment: Segment, whole_turn: bool, path: str
) -> CurveShape | NoOptimalLaw | DesignError:
    from core.laws.optimal import NoOptimalLaw, optimal_law  # imported here to save start-up time

    try:
        if curve.needs_machine:
            pieces = machine_law(segment, whole_turn, path).pieces
        else:
            pieces = optimal_law(optimal_task(curve, segment, whole_turn)).pieces
    except (NoOptimalLaw, DesignError) as error:
        return error.with_traceback(None)
    shape = _split_at_reversals(pieces)
    return CurveShape(shape.pieces, segment.rise, tuple(w * np.sign(segment.rise) for w in shape.velocity_signs))


def unsolved_segment(motion: Motion) -> int | None:
    """Number of the first segment whose curve depends on an optimal law that is not solved yet; None where there is none."""
    segments, count = motion.segments, len(motion.segments)

    def is_solved(segment: Segment, whole_turn: bool) -> bool:
        return not isinstance(segment.curve, OptimalCurve) or (segment, whole_turn) in _solved

    for i, segment in enumerate(segments):
        joined = [side for end, side in (("start", -1), ("end", 1)) if is_joined(segment.curve, end) and count > 1]
        if not all(is_solved(segments[(i + side) % count], False) for side in joined):
            return i
        with suppress(KindynaError):  # a neighbour without a solution: nothing is computed
            if not is_solved(with_joined_ends(motion, i) if joined else segment, count == 1):
                return i
    return None


def solve_laws(motions: Iterable[Motion]) -> None:
    """Solve all optimal laws of motions, so that reading them later computes none, whether they have a solution or not."""
    for motion in motions:
        for i in range(len(motion.segments)):
            with suppress(KindynaError):
                segment_shape(with_joined_ends(motion, i), len(motion.segments) == 1, f"motion.segments[{i}]")


MachineSolver = Callable[[Segment, bool], "LocalLaw"]
"""Law of a segment that is optimal in its machine; whether the motion has no other segment."""
_solvers: list[MachineSolver] = []


def solve_machines_by(solver: MachineSolver) -> None:
    """Set the function that computes laws which are optimal in their machine: it solves studies, which are above this room."""
    _solvers[:] = [solver]


def machine_law(segment: Segment, whole_turn: bool, path: str) -> LocalLaw:
    """Law that is optimal in its machine. Raises NoOptimalLaw; DesignError where its motion belongs to no design."""
    curve = segment.curve
    if not _solvers or not isinstance(curve, OptimalCurve) or curve.machine is None:
        problem = "a motion without a machine has no such law"
        raise DesignError(
            [Fault(f"{path}.minimise", getattr(curve, "minimise", ""), problem, "a design, or another aim")]
        )
    return _solvers[0](segment, whole_turn)


def has_optimal_laws(motion: Motion) -> bool:
    """Whether a law keeps the limits of every segment with an optimal law."""
    try:
        for i, segment in enumerate(motion.segments):
            if isinstance(segment.curve, OptimalCurve):
                segment_shape(with_joined_ends(motion, i), len(motion.segments) == 1, f"motion.segments[{i}]")
    except DesignError:
        return False
    return True


def optimal_task(curve: OptimalCurve, segment: Segment, whole_turn: bool) -> OptimalTask:
    """What an optimal law must do, normalised to span 1 and rise 1.

    Its ends have an acceleration of 0 only where the jerk is minimised or limited: else the acceleration may jump.
    """
    from core.laws.knots import OptimalTask  # imported here to save start-up time

    order, rms = MINIMISED[curve.minimise]
    limits = tuple(
        (k, limit) for k, name in enumerate(ORDERS_LIMITED, 1) if (limit := getattr(curve.limits, name)) is not None
    )
    conditions = _point_conditions(curve, segment, segment.rise)
    stated = {(u, k) for u, k, _ in conditions}
    periodic = whole_turn and JOINED in (curve.start, curve.end)
    highest = max(order, *(k for k, _ in limits)) if limits else order
    ends = [(0.0, 0, 0.0), (1.0, 0, 1.0)]
    for u, kind in ((0.0, curve.start), (1.0, curve.end)):
        ends += [(u, k, 0.0) for k in _END_ORDERS[kind] if k < max(highest, 2) and not periodic]
    return OptimalTask(
        order,
        rms,
        limits,
        (*conditions, *(row for row in ends if row[:2] not in stated)),
        periodic,
        curve.vibration_free,
        tuple(
            (row.start, row.end, row.rise, sign)
            for rows, sign in ((curve.below, 1.0), (curve.above, -1.0))
            for row in rows
        ),
        curve.intervals,
    )


def least_limit(motion: Motion, index: int, name: str) -> float | None:
    """Least limit of a derivative that an optimal law keeps together with its other limits, normalised to span 1 and rise 1.

    ``name`` is the derivative's: velocity, acceleration, jerk. None where no law keeps the other limits.
    """
    from core.laws.optimal import least_limit  # imported here to save start-up time

    segment = with_joined_ends(motion, index)
    assert isinstance(segment.curve, OptimalCurve)
    task = optimal_task(segment.curve, segment, len(motion.segments) == 1)
    least = least_limit(task, 1 + ORDERS_LIMITED.index(name))
    return None if least is None else _rounded_up(least)


def _rounded_up(least: float) -> float:
    """A limit with five digits, from the safe side."""
    digit = 10.0 ** (floor(log10(least)) - 4)
    return float(f"{ceil(least / digit) * digit:.6g}")


def _no_optimal_law(error: NoOptimalLaw, curve: OptimalCurve, path: str) -> Fault:
    if error.order:
        name = ORDERS_LIMITED[error.order - 1]
        least, limit = _rounded_up(error.least), getattr(curve.limits, name)
        return Fault(
            f"{path}.limits.{name}", limit, "no law keeps this limit together with the others", f">= {least:g}"
        )
    names = [name for name in ("below", "above", "vibration_free", "points") if getattr(curve, name)]
    problem = "no law passes these bounds, points and ends" if names else "the ends leave the law undetermined"
    return Fault(f"{path}.{names[0] if names else 'start'}", MISSING, problem, "fewer of them, or a rest or stop")


def _point_conditions(curve: SplineCurve, segment: Segment, unit: float) -> list[tuple[float, int, float]]:
    """Derivatives (u, order, value) at the points of a curve; values are fractions of a unit."""
    span = segment.span_deg
    return [
        (p.at_deg / span, order, value * span**order / unit)
        for p in curve.points
        for order, value in enumerate((p.value, p.velocity, p.acceleration))
        if value is not None
    ]


def _computed(curve: ComputedCurve, segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    return _split_at_reversals(curve.pieces)


def _split_at_reversals(pieces: tuple[Piece, ...]) -> CurveShape:
    """Pieces split where the velocity is zero, so that it has one sign on each."""
    parts: list[Piece] = []
    for piece, reversals in zip(pieces, _reversals(pieces), strict=True):
        parts += [piece, *(trimmed(piece, w) for w in reversals)]
    table = PieceTable(parts)
    ends = [*(p.start for p in parts[1:]), 1.0]
    half_width = np.array([0.5 * (e - p.start) for p, e in zip(parts, ends, strict=True)])
    row = table.rows(np.arange(len(parts)), half_width)
    position, velocity = row(0), row(1)
    is_at_rest = np.abs(velocity) <= 1e-12 * max(float(np.abs([position, velocity]).max()), 1e-300)
    return CurveShape(tuple(parts), 1.0, tuple(float(w) for w in np.where(is_at_rest, 0.0, np.sign(velocity))))


_INSIDE = 1e-6  # part of a piece; a zero of the velocity nearer to its end is at the end


def _reversals(pieces: tuple[Piece, ...]) -> list[list[float]]:
    """Zeros of the velocity inside each piece, ascending, measured from the start of the piece."""
    powers = max(2, *(len(p.polynomial) for p in pieces))
    coefficients = np.zeros((len(pieces), powers))
    for values, piece in zip(coefficients, pieces, strict=True):
        values[: len(piece.polynomial)] = piece.polynomial
    width = np.diff([*(p.start for p in pieces), 1.0])
    velocity = (coefficients * np.arange(powers) * width[:, None] ** np.arange(powers))[:, 1:]  # by powers of w/width
    has_sines = np.array([bool(piece.sines) for piece in pieces])
    result: list[list[float]] = [[] for _ in pieces]
    for i in np.flatnonzero(_may_change_sign(velocity) & ~has_sines).tolist():
        roots = np.roots(velocity[i, ::-1])
        real = roots[np.abs(roots.imag) < 1e-9].real
        result[i] = sorted(float(x * width[i]) for x in real if _INSIDE < x < 1.0 - _INSIDE)
    for i in np.flatnonzero(has_sines).tolist():
        result[i] = _reversals_with_sines(pieces[i], float(width[i]))
    return result


def _reversals_with_sines(piece: Piece, width: float) -> list[float]:
    """Zeros of the velocity inside a piece with sines, between samples at least eight of which make a quarter wave."""
    waves = max(q.frequency for q in piece.sines) * width / QUARTER
    at = np.linspace(_INSIDE, 1.0 - _INSIDE, 8 * int(np.ceil(waves)) + 17) * width
    table = PieceTable((piece,))

    def velocity(w: np.ndarray) -> np.ndarray:
        return table.rows(np.zeros(w.size, dtype=int), w)(1)

    sampled = velocity(at)
    brackets = np.flatnonzero(sampled[:-1] * sampled[1:] < 0.0).tolist()
    ends = [BracketEnds(at[k], sampled[k], at[k + 1], sampled[k + 1]) for k in brackets]
    return [float(bracketed_root(lambda w: float(velocity(np.array([w]))[0]), each).b) for each in ends]


def _may_change_sign(polynomials: np.ndarray) -> np.ndarray:
    """Whether the Bernstein coefficients of polynomials (m, n + 1) on 0 ... 1 have both signs."""
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
        OptimalCurve: _optimal,
        ComputedCurve: _computed,
    }
)


_SCALED_CURVES = frozenset({NamedCurve, SccaCurve})
"""Curves whose normalised pieces do not depend on span and rise."""


def has_common_pieces(motion: Motion) -> bool:
    """Whether the motions of many designs, whose numbers are columns, share their normalised pieces.

    True where only spans and rises vary, and no dwell has a varying rise.
    """
    return part_mapper(motion.lobe) is None and all(
        part_mapper(segment) is None or _has_common_pieces(segment) for segment in motion.segments
    )


def _has_common_pieces(segment: Segment) -> bool:
    curve = segment.curve
    law = find_law(curve.law) if isinstance(curve, NamedCurve) else None
    rises_in_a_dwell = law is not None and law.is_dwell and part_mapper(segment.rise) is not None
    return type(curve) in _SCALED_CURVES and part_mapper(curve) is None and not rises_in_a_dwell


_VANISHING_VALUES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {"crossover": (0.5, 0.45), "flat_fraction": (0.0, 0.05), "cv_fraction": (0.0, 0.05), "ramp_fraction": (0.0, 0.05)}
)
"""Parameter of a law -> the value at which a piece vanishes, and a value at which it does not."""


def with_all_pieces(plain: Motion, motion: Motion) -> Motion:
    """The motion ``plain``, changed so that it has every piece that the designs of ``motion`` may have.

    Parameters of a law that are columns in ``motion`` receive a value at which no piece vanishes.
    """
    rows = zip(plain.segments, motion.segments, strict=True)
    return replace(
        plain,
        segments=tuple(
            replace(segment, curve=_with_all_pieces(segment.curve, varied.curve)) for segment, varied in rows
        ),
    )


def _with_all_pieces(curve: Curve, varied: Curve) -> Curve:
    if type(curve) not in _SCALED_CURVES or part_mapper(varied) is None:
        return curve
    numbers = [
        (name, *row) for name, row in _VANISHING_VALUES.items() if part_mapper(getattr(varied, name, None)) is not None
    ]
    changes: Any = {name: regular for name, vanishing, regular in numbers if getattr(curve, name) == vanishing}
    changed: Any = replace(curve, **changes)
    return changed if getattr(changed, "ramp_fraction", 0.0) + changed.flat_fraction <= 1.0 else curve


def segment_shape(segment: Segment, whole_turn: bool, path: str) -> CurveShape:
    """Curve of a segment; ``whole_turn``: the motion has no other segment. Raises DesignError, NoSpline."""
    return SHAPES[type(segment.curve)](segment.curve, segment, whole_turn, path)


# -- the nose of a motion -----------------------------------------------------------------------------------------

_LEVEL = 1e-12  # of the stroke: a level this near to the greatest one is it


@lru_cache(maxsize=64)
def nose_deg(motion: Motion) -> float:
    """Cam angle of the greatest displacement [deg]; the middle of the first dwell at it. 0 where a curve has no solution."""
    if motion.lobe is not None:
        return motion.lobe.nose_at_deg
    angles, levels = [], []
    at = level = 0.0
    try:
        for i, segment in enumerate(motion.segments):
            shape = segment_shape(with_joined_ends(motion, i), len(motion.segments) == 1, f"motion.segments[{i}]")
            starts = np.array([piece.start for piece in shape.pieces])
            angles += (at + starts * segment.span_deg).tolist()
            levels += (level + shape.gain * PieceTable(shape.pieces).at(starts)[0]).tolist()
            at, level = at + segment.span_deg, level + segment.rise
    except (DesignError, NoSpline):
        return 0.0
    top, bottom = max(levels), min(levels)
    is_top = [top - value <= _LEVEL * (top - bottom) for value in levels]
    if all(is_top):
        return 0.0
    first = next(k for k in range(len(levels)) if is_top[k] and not is_top[k - 1])
    last = first
    while is_top[(last + 1) % len(levels)]:
        last = (last + 1) % len(levels)
    span = (angles[last] - angles[first]) % 360.0
    return (angles[first] + 0.5 * span) % 360.0
