"""Extremes and sign changes of piecewise smooth quantities over one turn, refined to the continuous curve.

Both limits at every jump are evaluated.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from itertools import pairwise
from math import ceil, pi, radians
from typing import Protocol

import numpy as np

from core.design import Motion, NamedCurve, SccaCurve, stroke
from core.frozen import frozen
from core.motion import EPS, TURN, Angles, CompiledMotion, program
from core.numerics.derivatives import distinct
from core.numerics.lazy import checkpoint, locked
from core.numerics.roots import gauss_legendre

PANEL, PANEL_NODES = radians(2.0), 8  # of the Gauss quadrature over a turn

# -- extremes ---------------------------------------------------------------------------------------------------


STEP = np.deg2rad(1.0)  # [rad] of the first samples within a piece
LEAST, MOST = 17, 721  # equally spaced samples of a piece; further samples
# approach its ends geometrically, because a short piece may vary only there
ENDS = np.concatenate((10.0 ** np.arange(-6.0, -1.0), 1.0 - 10.0 ** np.arange(-6.0, -1.0)))
CANDIDATES = 64  # greatest number of local extremes per quantity and sign that are refined
LEAST_PARTS = 8  # least number of parts into which a bracket is divided
AT_ONCE = 128  # points per pass for a quantity and sign: so many cost little more than one
PASSES = 24
DEGREE = 16  # of the polynomial that interpolates a bracket
TAIL = 2e-14  # the interpolation is exact if its last two Chebyshev coefficients are below this fraction of the largest value
CREASE_TAIL = 1e-11  # the same for g of a crease c - |g|; next to a change point there is more rounding
LEAST_CREASE = 1e-3  # of the range of the values: least fall on either side of a crease
NEWTON = 4  # iterations
FINEST = 1e-4  # final half width of a bracket where the quantity is smooth, as a fraction of the piece
FINEST_RAD = 2e-5  # [rad] its upper limit
SHARPEST = 1e-13  # [rad] final half width at a kink

DIGITS = 12  # reliable digits of a stroke

Quantities = Callable[[Angles], Mapping[str, np.ndarray]]


class Pieces(Protocol):
    """Pieces of one turn, inside which quantities are smooth.

    Attributes
    ----------
    starts, ends : ndarray (m,) [rad]
    """

    starts: np.ndarray
    ends: np.ndarray

    def __hash__(self) -> int: ...


_ORDER = np.arange(DEGREE + 1)
_CHEBYSHEV_POINTS = np.cos(np.pi * _ORDER[::-1] / DEGREE)  # Chebyshev points of -1 ... 1, ascending
_HALF = np.where((_ORDER == 0) | (_ORDER == DEGREE), 0.5, 1.0)
_TO_CHEBYSHEV = 2.0 / DEGREE * _HALF[:, None] * np.cos(np.pi / DEGREE * np.outer(_ORDER, _ORDER[::-1])) * _HALF[::-1]
"""Matrix from the values at the Chebyshev points to the coefficients of T_k(t) = cos(k arccos t)."""


@frozen
class Extreme:
    """An extreme value and its cam angle theta [rad]."""

    value: float
    theta: float


@frozen
class Extremes:
    """Smallest and largest value over the turn."""

    low: Extreme
    high: Extreme


@lru_cache(maxsize=64)
def _sample_fractions(count: int) -> np.ndarray:
    """Sample positions within a piece, 0 ... 1: equally spaced, and close to its ends."""
    # np.union1d would import numpy.ma
    return np.array(sorted({*np.linspace(0.0, 1.0, count).tolist(), *ENDS}))


@lru_cache(maxsize=64)
def piecewise_angles(program: Pieces) -> Angles:
    """Samples of every piece, both ends included, dense enough to bracket extremes.

    Equal programs return the same object, so that searches share their solutions.
    """
    counts = np.clip(np.ceil((program.ends - program.starts) / STEP) + 1, LEAST, MOST).astype(int)
    theta = []
    for a, b, count in zip(program.starts, program.ends, counts.tolist(), strict=True):
        theta.append(a + (b - a) * _sample_fractions(count))
        theta[-1][-1] = b
    return locked(
        Angles(np.concatenate(theta), np.repeat(np.arange(counts.size), [t.size for t in theta]), True, search=True)
    )


def turn_quadrature(
    pieces: Pieces, breaks: Sequence[float] = (), panel: float = PANEL, count: int = PANEL_NODES
) -> tuple[Angles, np.ndarray]:
    """Gauss nodes and weights that integrate over one turn.

    Parameters
    ----------
    pieces : Pieces
        The motion's pieces; no panel crosses their ends.
    breaks : sequence of float [rad]
        Further angles that no panel crosses.
    panel : float [rad]
        Greatest width of a panel.
    count : int
        Nodes of a panel.

    Returns
    -------
    angles : Angles (n,)
    weights : ndarray (n,) [rad]
    """
    x, w = gauss_legendre(count)
    theta, weights, piece = [], [], []
    for number, (low, high) in enumerate(zip(pieces.starts.tolist(), pieces.ends.tolist(), strict=True)):
        inside = sorted(angle for angle in breaks if low < angle < high)
        for start, end in pairwise([low, *inside, high]):
            edges = np.linspace(start, end, max(1, ceil((end - start) / panel)) + 1)
            half = 0.5 * np.diff(edges)[:, None]
            theta.append((edges[:-1, None] + half * (1.0 + x)).ravel())
            weights.append((half * w).ravel())
            piece.append(np.full(theta[-1].size, number))
    return Angles(np.concatenate(theta), np.concatenate(piece)), np.concatenate(weights)


def find_extremes(quantities: Quantities, program: Pieces) -> dict[str, Extremes]:
    """Smallest and largest value of each quantity over one turn.

    All quantities are refined together, so that a pass costs one evaluation. Infinite values count, NaN is ignored.
    Where several angles share an extreme, the smallest angle is returned.

    Parameters
    ----------
    quantities : Callable[[Angles], Mapping[str, ndarray (n,)]]
        Values of the quantities by name at given cam angles.
    program : Pieces

    Returns
    -------
    dict[str, Extremes]
    """
    best = _refined(quantities, program, (-1.0, 1.0))
    return {name: Extremes(best[name, -1.0], best[name, 1.0]) for name, _ in best}


def find_highest(quantities: Quantities, program: CompiledMotion) -> dict[str, Extreme]:
    """Largest value of each quantity over one turn, as in ``find_extremes``; -inf where it is NaN throughout."""
    return {name: highest for (name, _), highest in _refined(quantities, program, (1.0,)).items()}


def find_above(quantity: Callable[[Angles], np.ndarray], program: CompiledMotion, level: float) -> Extreme | None:
    """Largest value of one quantity over one turn if it reaches a level, else None.

    Only local maxima that may reach the level are refined.

    Parameters
    ----------
    quantity : Callable[[Angles], ndarray (n,) [its unit]]
    program : CompiledMotion
    level : float
        Level in the unit of the quantity.

    Returns
    -------
    Extreme or None
    """
    highest = _refined(lambda angles: {"": quantity(angles)}, program, (1.0,), level)["", 1.0]
    return highest if highest.value >= level else None


def _refined(
    quantities: Quantities, program: Pieces, signs: tuple[float, ...], level: float = -np.inf
) -> dict[tuple[str, float], Extreme]:
    """Largest value of each quantity times each sign, by name and sign, refined where it may reach the level."""
    angles = piecewise_angles(program)
    sampled = quantities(angles)
    sides = [(name, sign) for name in sampled for sign in signs]
    if not sides:
        return {}
    values, bounds = _tops(np.array([sign * np.asarray(sampled[name], dtype=float) for name, sign in sides]), angles)
    finest = np.minimum(FINEST_RAD, FINEST * (program.ends - program.starts))
    may_be_highest = bounds >= np.maximum(values.max(axis=1), level)[:, None]
    may_be_highest &= bounds > -np.inf
    searches = [
        _Search(name, sign, value, bound, is_peak.nonzero()[0], angles, finest)
        for (name, sign), value, bound, is_peak in zip(sides, values, bounds, may_be_highest, strict=True)
    ]
    is_fitted = False
    for _ in range(PASSES):
        brackets = [(search, bracket) for search in searches for bracket in search.brackets]
        if not brackets:
            break
        checkpoint()
        parts = [bracket.sample_angles(AT_ONCE // len(search.brackets)) for search, bracket in brackets]
        counts = [part.size for part in parts]
        refined = quantities(Angles(np.concatenate(parts), np.repeat([b.piece for _, b in brackets], counts)))
        ends = np.cumsum(counts).tolist()
        rows = [
            search.sign * np.asarray(refined[search.name])[end - theta.size : end]
            for (search, _), theta, end in zip(brackets, parts, ends, strict=True)
        ]
        vertices: Sequence[Top | None] = [None] * len(rows) if is_fitted else _smooth_tops(np.array(rows))
        is_fitted = True
        for (_, bracket), theta, value, vertex in zip(brackets, parts, rows, vertices, strict=True):
            bracket.narrow(theta, value, vertex)
        for search in searches:
            search.drop_hopeless()
    return {(s.name, s.sign): s.best() for s in searches}


class _Bracket:
    """Three cam angles of one piece around a local maximum of a quantity times its sign."""

    def __init__(self, left: float, right: float, piece: int, theta: float, value: float, finest: float) -> None:
        self.left, self.right, self.piece = left, right, piece
        self.theta, self.value, self.finest = theta, value, finest
        self._smooth = finest
        self.room = np.inf  # largest possible excess between the evaluated points
        self._is_fitted = False

    def is_wide(self) -> bool:
        return self.right - self.left > 2.0 * self.finest

    def sample_angles(self, most: int) -> np.ndarray:
        """Chebyshev points of the bracket; equally spaced angles where their polynomial was not exact.

        The equally spaced angles are an odd number, so that they contain the middle, where the highest sample was;
        their distance is at least a quarter of the final half width.
        """
        if not self._is_fitted:
            theta = 0.5 * (self.left + self.right) + 0.5 * (self.right - self.left) * _CHEBYSHEV_POINTS
            theta[0], theta[-1] = self.left, self.right
            return np.asarray(theta)
        pairs = 1 + int(min(2.0 * (self.right - self.left) / self.finest, 0.5 * most - 1.5))
        return np.linspace(self.left, self.right, 1 + max(LEAST_PARTS, 2 * pairs))

    def narrow(self, theta: np.ndarray, value: np.ndarray, vertex: Top | None) -> None:
        """Narrow the bracket around its highest sample; ``vertex``: top of the polynomial, where it is exact."""
        if not self._is_fitted:
            self._is_fitted = True
            vertex = _top_at_crease(value) if vertex is None and np.isfinite(value).all() else vertex
            if vertex is not None:
                self.theta = 0.5 * (self.left + self.right) + 0.5 * (self.right - self.left) * vertex[0]
                self.value = max(self.value, *vertex[1:])
                self.left = self.right = self.theta
                return
        value = np.where(np.isnan(value), -np.inf, value)
        top = int(np.argmax(value))
        if value[top] > self.value:
            self.theta, self.value = float(theta[top]), float(value[top])
        low, high = max(top - 1, 0), min(top + 1, theta.size - 1)
        self.left, self.right = float(theta[low]), float(theta[high])
        samples = value[low : high + 1] if high - low == 2 else value
        self.room = float(value[top] - samples.min()) if np.isfinite(value[top]) else np.inf
        if not self.is_wide() and self.finest == self._smooth and 2 <= top <= theta.size - 3:
            self._polish(theta[top - 2 : top + 3], value[top - 2 : top + 3])

    def _polish(self, theta: np.ndarray, value: np.ndarray) -> None:
        """Vertex of the quartic through five equally spaced points, by one Newton step from the middle point."""
        h = theta[3] - theta[2]
        a, b, _, c, d = value - value[2]
        first_difference = (a - 8.0 * b + 8.0 * c - d) / 12.0
        second_difference = (-a + 16.0 * b + 16.0 * c - d) / 12.0
        if abs(a - 4.0 * b - 4.0 * c + d) > 0.1 * abs(second_difference) and abs(second_difference) > 1e3 * EPS * abs(
            value[2]
        ):
            self.finest = SHARPEST  # a kink: the fourth difference is as large as the second
        elif second_difference < 0.0 and abs(first_difference) < abs(second_difference):
            self.theta = float(theta[2] - h * first_difference / second_difference)
            self.value = max(
                self.value, float(value[2] - 0.5 * first_difference * first_difference / second_difference)
            )


Top = tuple[float, float, float]
"""Top of a bracket: its position, -1 ... 1; the value of the polynomial there; the highest sample."""


def _smooth_tops(values: np.ndarray) -> list[Top | None]:
    """Tops of the polynomials through values (b, DEGREE + 1) at Chebyshev points; None where inexact."""
    values = np.where(np.isfinite(values).all(axis=1)[:, None], values, np.nan)
    coefficients = _in_chebyshev(values)
    smooth = np.abs(coefficients[:, -2:]).max(axis=1) <= TAIL * np.abs(values).max(axis=1)
    tops = values.argmax(axis=1)
    start = np.pi * (1.0 - tops / DEGREE)
    phi = _newton(_ORDER * coefficients, _ORDER**2 * coefficients, np.sin, np.cos, start)
    inside, highest = (tops > 0) & (tops < DEGREE), values.max(axis=1)
    phi = np.where(inside, phi, start)
    heights = np.where(inside, (coefficients * np.cos(_ORDER * phi[:, None])).sum(axis=1), highest)
    rows = zip(np.cos(phi).tolist(), heights.tolist(), highest.tolist(), strict=True)
    return [row if is_smooth else None for row, is_smooth in zip(rows, smooth.tolist(), strict=True)]


def _top_at_crease(value: np.ndarray) -> Top | None:
    """Top of a quantity c - |g| with a smooth g, at the zero of g; None where the values are of no such quantity.

    A magnitude has c = 0, the angle between two lines c = π/2. With the signs of g the values have the Chebyshev coefficients of
    g and c times those of the signs, and the last coefficients of g vanish.
    """
    top, size = int(np.argmax(value)), np.abs(value).max()
    signs = np.array([np.where(is_beyond, -1.0, 1.0) for is_beyond in (top < _ORDER, top <= _ORDER)])
    signed, steps = _in_chebyshev(signs * value), _in_chebyshev(signs)

    def zero(coefficients: np.ndarray) -> float:
        start = np.array([np.pi * (1.0 - top / DEGREE)])
        return float(_newton(coefficients[None], -_ORDER * coefficients[None], np.cos, np.sin, start)[0])

    smooth = np.abs(signed[:, -2:]).max(axis=1) <= TAIL * size
    if smooth.any():
        g = signed[smooth.argmax()]
        phi = zero(g)
        return float(np.cos(phi)), -abs(float((g * np.cos(_ORDER * phi)).sum())), float(value[top])
    neighbours = value[[max(top - 2, 0), min(top + 2, DEGREE)]]
    if (value[top] - neighbours).min() <= LEAST_CREASE * np.ptp(value):
        return None
    for c in (np.zeros(2), _crease_heights(signed, steps)):
        coefficients = signed - c[:, None] * steps
        smooth = (np.abs(coefficients[:, -3:]).max(axis=1) <= CREASE_TAIL * size) & (c >= value[top] - TAIL * size)
        if smooth.any():
            row = int(smooth.argmax())
            return float(np.cos(zero(coefficients[row]))), float(c[row]), float(value[top])
    return None


def _crease_heights(signed: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Heights c (b,) with which the last coefficients of signed - c steps (b, DEGREE + 1) are least; NaN where no sign changes."""
    a, b = signed[:, -3:], steps[:, -3:]
    square = (b * b).sum(axis=1)
    return np.where(square > 0.0, (a * b).sum(axis=1) / np.where(square > 0.0, square, 1.0), np.nan)


def _in_chebyshev(values: np.ndarray) -> np.ndarray:
    """Chebyshev coefficients (b, DEGREE + 1) of brackets.

    Not by matmul: BLAS may round a row differently, depending on the other rows.
    """
    coefficients: np.ndarray = (values[:, None, :] * _TO_CHEBYSHEV).sum(axis=2)
    return coefficients


def _newton(f: np.ndarray, slope: np.ndarray, g: np.ufunc, g_slope: np.ufunc, start: np.ndarray) -> np.ndarray:
    """Zeros (b,) of Σ f_k g(kφ) near a start; its derivative is Σ slope_k g_slope(kφ); f, slope: (b, DEGREE + 1)."""
    phi, low, high = start, start - np.pi / DEGREE, start + np.pi / DEGREE
    for _ in range(NEWTON):
        arguments = _ORDER * phi[:, None]
        derivative = (slope * g_slope(arguments)).sum(axis=1)
        is_finite = derivative != 0.0
        step = np.where(is_finite, (f * g(arguments)).sum(axis=1) / np.where(is_finite, derivative, 1.0), 0.0)
        phi = np.minimum(np.maximum(phi - step, low), high)
    return phi


def _tops(value: np.ndarray, angles: Angles) -> tuple[np.ndarray, np.ndarray]:
    """Samples (q, n) with NaN as -inf; and an upper bound around each local maximum within its piece, else -inf."""
    value = np.where(np.isnan(value), -np.inf, value)
    same_piece = angles.piece[1:] == angles.piece[:-1]
    left, right = np.full_like(value, -np.inf), np.full_like(value, -np.inf)
    left[:, 1:], right[:, :-1] = (
        np.where(same_piece, value[:, :-1], -np.inf),
        np.where(same_piece, value[:, 1:], -np.inf),
    )
    # at least as high as both neighbours and higher than one: plateaus need no refinement
    higher = ((value > left) & (left > -np.inf)) | ((value > right) & (right > -np.inf))
    tops = (value >= left) & (value >= right) & higher & np.isfinite(value)
    room = np.where(tops, _room(angles.theta, value, left, right), 0.0)
    tops &= room > TAIL * np.abs(value)  # nor do plateaus with rounding
    return value, np.where(tops, value + room, -np.inf)


def _room(theta: np.ndarray, value: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Largest possible excess of a quantity above its samples (q, n), up to the neighbouring samples.

    A parabola adds an eighth of the second difference, at the end of a piece that of the next samples inside; the bound
    is eight times as large. Where the neighbour on one side is farther away, the slope of the other side is
    extrapolated.
    """
    gap = np.concatenate((theta[:1] - theta[-1:], theta[1:] - theta[:-1], theta[:1] - theta[-1:]))
    second_right = np.concatenate((right[:, 1:], right[:, :1]), axis=1)  # two samples away
    second_left = np.concatenate((left[:, -1:], left[:, :-1]), axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):  # inf - inf: no refinement
        ratio = gap[1:] / gap[:-1]
        inside = np.maximum((value - left) * np.maximum(ratio, 1.0), (value - right) * np.maximum(1.0 / ratio, 1.0))
        at_start, at_end = np.abs(value - 2.0 * right + second_right), np.abs(value - 2.0 * left + second_left)
    room = np.where(left == -np.inf, at_start, np.where(right == -np.inf, at_end, inside))
    return np.where(np.isfinite(room), room, np.inf)


class _Search:
    """Search for the largest value of one quantity times one sign: the local maxima that may contain it."""

    def __init__(
        self,
        name: str,
        sign: float,
        value: np.ndarray,
        bound: np.ndarray,
        peaks: np.ndarray,
        angles: Angles,
        finest: np.ndarray,
    ) -> None:
        self.name, self.sign = name, sign
        theta, pieces = angles.theta, angles.piece
        top, last = int(value.argmax()), value.size - 1
        self.sampled = Extreme(float(value[top]), float(theta[top]))
        self.brackets = []
        for i in peaks[(-bound[peaks]).argsort(kind="stable")][:CANDIDATES].tolist():
            piece = int(pieces[i])
            has_left = i > 0 and pieces[i - 1] == piece and value[i - 1] > -np.inf
            has_right = i < last and pieces[i + 1] == piece and value[i + 1] > -np.inf
            left, right = float(theta[i - has_left]), float(theta[i + has_right])
            self.brackets.append(_Bracket(left, right, piece, float(theta[i]), float(value[i]), float(finest[piece])))
        self._all = list(self.brackets)
        self._value, self._theta, self._piece = value, theta, pieces

    def _highest(self) -> float:
        return max([self.sampled.value, *(b.value for b in self._all)])

    def drop_hopeless(self) -> None:
        """Remove brackets that are narrow enough, or cannot reach the highest value."""
        if not self.brackets:
            return
        top = self._highest()
        self.brackets = [b for b in self.brackets if b.is_wide() and b.value + b.room >= top]

    def best(self) -> Extreme:
        """Highest value; among values equal to rounding, that at the smallest cam angle."""
        top = self._highest()
        slack = TAIL * abs(top) if np.isfinite(top) else 0.0
        if self.sampled.value < top - slack:
            theta, value = min((b.theta, b.value) for b in self._all if b.value >= top - slack)
            return Extreme(self.sign * value, theta % (2.0 * pi))
        first, representative = self._plateaus((self._value >= top - slack).nonzero()[0])
        candidates = list(zip(self._theta[representative].tolist(), self._value[representative].tolist(), strict=True))
        if not candidates and self.sampled.value >= top - slack:
            candidates.append((self.sampled.theta, self.sampled.value))
        low, high = self._theta[np.maximum(first - 1, 0)], self._theta[representative]
        for bracket in self._all:
            # next to a plateau the value differs only by rounding; the angle of the plateau is used
            is_on_plateau = bool(((low <= bracket.theta) & (bracket.theta <= high)).any())
            if bracket.value >= top - slack and not (is_on_plateau and candidates):
                candidates.append((bracket.theta, bracket.value))
        theta, value = min(candidates)
        return Extreme(self.sign * value, theta % (2.0 * pi))

    def _plateaus(self, ties: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First sample of each run of equal samples within a piece, and the sample whose angle represents the run.

        That is the first sample; for a curve that ends in a plateau at the end of its piece, the last sample.
        """
        if ties.size < 2:
            return ties[:0], ties[:0]
        piece = self._piece[ties]
        is_cut = ((ties[1:] - ties[:-1] > 1) | (piece[1:] != piece[:-1])).nonzero()[0]
        first, last = ties[np.concatenate(([0], is_cut + 1))], ties[np.concatenate((is_cut, [ties.size - 1]))]
        is_run = last > first
        first, last = first[is_run], last[is_run]
        piece = self._piece[first]  # ascending
        begin, end = (np.searchsorted(self._piece, piece, side) for side in ("left", "right"))
        is_final = (last == end - 1) & (first != begin)
        return first, np.where(is_final, last, first)


@lru_cache(maxsize=32)
def true_stroke(motion: Motion) -> float:
    """Highest minus lowest position over one turn, in the motion's unit, rounded to ``DIGITS`` digits.

    Named laws stay between their ends; polynomials and splines may not. Raises NoSolution where the points of a spline
    contradict each other.
    """
    if all(isinstance(segment.curve, NamedCurve | SccaCurve) for segment in motion.segments):
        return stroke(motion)
    compiled = program(motion)
    y = find_extremes(lambda angles: {"y": compiled.state(angles).displacement[0]}, compiled)["y"]
    return float(f"{(y.high.value - y.low.value) / motion.scale:.{DIGITS}g}")


# -- sign changes -----------------------------------------------------------------------------------------------


ROOT_PASSES = 100
ROOT_WIDTH = EPS * TURN  # [rad] final half width of the interval around a root
BETWEEN = 33  # additional samples of a dip towards zero

Quantity = Callable[[Angles], np.ndarray]


@np.errstate(invalid="ignore")  # inf - inf at a dead centre
def crossings(quantity: Quantity, angles: Angles, value: np.ndarray) -> Angles:
    """Cam angles at which quantities change their sign, ordered by piece and angle.

    Two sign changes between adjacent samples are noticed where the neighbouring samples curve towards zero.

    Parameters
    ----------
    quantity : Callable[[Angles], ndarray (n,) or (k, n) [unit of the quantities]]
        Values at given cam angles.
    angles : Angles
        The n samples, ascending within each piece.
    value : ndarray (n,) or (k, n) [unit of the quantities]
        Values at the samples.

    Returns
    -------
    Angles
        Roots with their pieces.

    References
    ----------
    Dowell and Jarratt 1971 (Illinois method).
    """
    values = np.atleast_2d(value)
    dips = distinct(np.concatenate([_dips(angles, row) for row in values]))
    theta, piece = angles.theta, angles.piece
    if dips.size:
        dip_angles = [np.linspace(theta[i - 1], theta[i + 1], BETWEEN)[1:-1] for i in dips]
        dip_samples = Angles(np.concatenate(dip_angles), np.repeat(piece[dips], BETWEEN - 2))
        theta, piece = np.append(theta, dip_samples.theta), np.append(piece, dip_samples.piece)
        values = np.hstack([values, np.atleast_2d(quantity(dip_samples))])
        order = np.lexsort((theta, piece))
        theta, piece, values = theta[order], piece[order], values[:, order]
    same_piece = piece[:-1] == piece[1:]
    row, before = np.nonzero((values[:, :-1] * values[:, 1:] < 0.0) & same_piece)
    root = _illinois_roots(quantity, theta, piece, values, row, before)
    # a sample of value zero is a root where the signs of its neighbours differ
    is_zero = (values[:, 1:-1] == 0.0) & (values[:, :-2] * values[:, 2:] < 0.0) & same_piece[:-1] & same_piece[1:]
    exact = np.nonzero(is_zero)[1] + 1
    result, root_piece = np.append(root, theta[exact]), np.append(piece[before], piece[exact])
    order = np.lexsort((result, root_piece))
    return Angles(result[order], root_piece[order])


def _dips(angles: Angles, value: np.ndarray) -> np.ndarray:
    """Samples closer to zero than their neighbours of the same sign and piece, between which a zero is possible.

    The second difference is taken eightfold, as for a parabola.
    """
    size, same_piece = np.abs(value), np.diff(angles.piece) == 0
    is_dip = (size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]) & same_piece[:-1] & same_piece[1:]
    is_dip &= (value[1:-1] * value[:-2] > 0.0) & (value[1:-1] * value[2:] > 0.0)
    curvature = np.abs(value[:-2] - 2.0 * value[1:-1] + value[2:])
    return np.flatnonzero(is_dip & (curvature >= size[1:-1])) + 1


def _illinois_roots(
    quantity: Quantity, theta: np.ndarray, piece: np.ndarray, value: np.ndarray, row: np.ndarray, before: np.ndarray
) -> np.ndarray:
    """Roots (m,) between samples ``before`` and the next, in their rows of the values (k, n), to rounding.

    Illinois method: false position, where an end that stays twice counts half.
    """
    ends, values = np.array([theta[before], theta[before + 1]]), np.array([value[row, before], value[row, before + 1]])
    root_piece, root = piece[before], ends.mean(axis=0)
    last_side = np.full(before.size, -1)  # the end replaced last
    for _ in range(ROOT_PASSES):
        wide = np.flatnonzero(ends[1] - ends[0] > 2.0 * ROOT_WIDTH)
        if not wide.size:
            break
        (a, b), (fa, fb) = ends[:, wide], values[:, wide]
        x = np.clip(a + (b - a) * (fa / (fa - fb)), a + ROOT_WIDTH, b - ROOT_WIDTH)
        f = np.atleast_2d(quantity(Angles(x, root_piece[wide])))[row[wide], np.arange(wide.size)]
        side = np.where(f * fa > 0.0, 0, 1)  # the end that x replaces
        is_repeated = last_side[wide] == side
        values[1 - side, wide] *= np.where(is_repeated, 0.5, 1.0)
        ends[side, wide], values[side, wide] = x, f
        last_side[wide], root[wide] = side, x
        exact = wide[f == 0.0]
        ends[:, exact] = root[exact]
    return root
