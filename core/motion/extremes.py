"""True extremes of smooth-by-pieces quantities: refined, not read off samples, both sides of every jump seen."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from math import pi
from typing import Protocol

import numpy as np

from core.design import Motion, NamedCurve, SccaCurve, stroke
from core.frozen import frozen
from core.motion import EPS, TURN, Angles, CompiledMotion, program
from core.numerics.derivatives import distinct
from core.numerics.lazy import checkpoint, locked

# -- true extremes of smooth-by-pieces quantities ---------------------------------------------------------------


STEP = np.deg2rad(1.0)  # first sampling within a piece
LEAST, MOST = 17, 721  # points of a piece, and besides these
# some that close in on its ends: in a short piece all that happens may happen there
ENDS = np.concatenate((10.0 ** np.arange(-6.0, -1.0), 1.0 - 10.0 ** np.arange(-6.0, -1.0)))
CANDIDATES = 64  # local extremes per quantity and side that are refined
LEAST_PARTS = 8  # that a bracket is cut into
AT_ONCE = 128  # points of one pass for a quantity and side with few brackets: as many cost hardly more than one
PASSES = 24
DEGREE = 16  # of the polynomial through a bracket, which ends the search where it leaves nothing out ...
TAIL = 2e-14  # ... of the largest value: its last two Chebyshev coefficients
NEWTON = 4
FINEST = 1e-4  # of the piece, and at most FINEST_RAD: half width at which a parabola takes over where it is smooth ...
FINEST_RAD = 2e-5
SHARPEST = 1e-13  # ... and where a kink is left to be narrowed down

DIGITS = 12  # of a stroke: those that are certain

Quantities = Callable[[Angles], Mapping[str, np.ndarray]]


class Pieces(Protocol):
    """Of one turn: starts and ends (m,) [rad], between which quantities are smooth."""

    starts: np.ndarray
    ends: np.ndarray

    def __hash__(self) -> int: ...


_ORDER = np.arange(DEGREE + 1)
_AT = np.cos(np.pi * _ORDER[::-1] / DEGREE)  # Chebyshev's points of -1 ... 1 in rising order, the middle among them
_HALF = np.where((_ORDER == 0) | (_ORDER == DEGREE), 0.5, 1.0)
_TO_CHEBYSHEV = 2.0 / DEGREE * _HALF[:, None] * np.cos(np.pi / DEGREE * np.outer(_ORDER, _ORDER[::-1])) * _HALF[::-1]
"""From the values there to the coefficients of T_k = cos(k arccos t)."""


@frozen
class Extreme:
    """A value and the cam angle [rad] where it stands."""

    value: float
    theta: float


@frozen
class Extremes:
    """The smallest and the largest value over the turn."""

    low: Extreme
    high: Extreme


@lru_cache(maxsize=64)
def _places(count: int) -> np.ndarray:
    """Where a piece is sampled, 0 ... 1: equally spaced, and close to its ends. Not by np.union1d, which imports numpy.ma."""
    return np.array(sorted({*np.linspace(0.0, 1.0, count).tolist(), *ENDS}))


@lru_cache(maxsize=64)
def piecewise_angles(program: Pieces) -> Angles:
    """Samples of every piece from inside, its ends included: dense enough to bracket extremes. The same object for the same program,
    so that every search over a turn finds what another one has solved."""
    counts = np.clip(np.ceil((program.ends - program.starts) / STEP) + 1, LEAST, MOST).astype(int)
    theta = []
    for a, b, count in zip(program.starts, program.ends, counts.tolist(), strict=True):
        theta.append(a + (b - a) * _places(count))
        theta[-1][-1] = b
    return locked(
        Angles(np.concatenate(theta), np.repeat(np.arange(counts.size), [t.size for t in theta]), True, search=True)
    )


def find_extremes(quantities: Quantities, program: Pieces) -> dict[str, Extremes]:
    """Lowest and highest value of each quantity over one turn.

    quantities: gives the values (n,) by name at any cam angles; all are refined together, so that each pass costs one
    evaluation. Values that are not finite count as they are (inf is the highest); NaN is left out.
    Where several angles share an extreme the smallest is named.
    """
    best = _refined(quantities, program, (-1.0, 1.0))
    return {name: Extremes(best[name, -1.0], best[name, 1.0]) for name, _ in best}


def find_highest(quantities: Quantities, program: CompiledMotion) -> dict[str, Extreme]:
    """The highest value of each quantity over one turn, as by ``find_extremes``; -inf where a quantity is NaN throughout."""
    return {name: found for (name, _), found in _refined(quantities, program, (1.0,)).items()}


def find_above(quantity: Callable[[Angles], np.ndarray], program: CompiledMotion, level: float) -> Extreme | None:
    """The highest value of one quantity (n,) over one turn, as by ``find_extremes``, if it reaches the level; None where it
    does not, and then nothing is refined that could not."""
    highest = _refined(lambda angles: {"": quantity(angles)}, program, (1.0,), level)["", 1.0]
    return highest if highest.value >= level else None


def _refined(
    quantities: Quantities, program: Pieces, signs: tuple[float, ...], level: float = -np.inf
) -> dict[tuple[str, float], Extreme]:
    """By name and sign: the highest value of each quantity times each sign, refined where it may reach the level."""
    angles = piecewise_angles(program)
    sampled = quantities(angles)
    sides = [(name, sign) for name in sampled for sign in signs]
    if not sides:
        return {}
    tops = _tops(np.array([sign * np.asarray(sampled[name], dtype=float) for name, sign in sides]), angles)
    widths = program.ends - program.starts
    searches = [
        _Search(name, sign, value, bound, angles, widths, level)
        for (name, sign), value, bound in zip(sides, *tops, strict=True)
    ]
    fitted = False
    for _ in range(PASSES):
        brackets = [(search, bracket) for search in searches for bracket in search.brackets]
        if not brackets:
            break
        checkpoint()
        parts = [bracket.sampled(AT_ONCE // len(search.brackets)) for search, bracket in brackets]
        counts = [part.size for part in parts]
        values = quantities(Angles(np.concatenate(parts), np.repeat([b.piece for _, b in brackets], counts)))
        ends = np.cumsum(counts).tolist()
        rows = [
            search.sign * np.asarray(values[search.name])[end - theta.size : end]
            for (search, _), theta, end in zip(brackets, parts, ends, strict=True)
        ]
        vertices: Sequence[Top | None] = [None] * len(rows) if fitted else _smooth_tops(np.array(rows))
        fitted = True
        for (_, bracket), theta, value, vertex in zip(brackets, parts, rows, vertices, strict=True):
            bracket.narrow(theta, value, vertex)
        for search in searches:
            search.drop_hopeless()
    return {(s.name, s.sign): s.best() for s in searches}


class _Bracket:
    """Three cam angles of one piece around a local maximum of a quantity (times its sign)."""

    def __init__(self, left: float, right: float, piece: int, theta: float, value: float, finest: float) -> None:
        self.left, self.right, self.piece = left, right, piece
        self.theta, self.value, self.finest = theta, value, finest
        self._smooth = finest
        self.room = np.inf  # how much higher the quantity may be between the points evaluated
        self._fitted = False

    def wide(self) -> bool:
        return self.right - self.left > 2.0 * self.finest

    def sampled(self, most: int) -> np.ndarray:
        """Chebyshev's points of the bracket. Where the polynomial through these has told nothing, cam angles that cut it into
        equal parts, down to a quarter of the half width that it shall have: an even number of them, so that its middle, where
        the highest of the samples before stands, is among them."""
        if not self._fitted:
            theta = 0.5 * (self.left + self.right) + 0.5 * (self.right - self.left) * _AT
            theta[0], theta[-1] = self.left, self.right
            return np.asarray(theta)
        pairs = 1 + int(min(2.0 * (self.right - self.left) / self.finest, 0.5 * most - 1.5))
        return np.linspace(self.left, self.right, 1 + max(LEAST_PARTS, 2 * pairs))

    def narrow(self, theta: np.ndarray, value: np.ndarray, vertex: Top | None) -> None:
        """vertex: of the polynomial through the values, where they stand at Chebyshev's points and it leaves nothing out."""
        if not self._fitted:
            self._fitted = True
            vertex = _top_at_zero(value) if vertex is None and np.isfinite(value).all() else vertex
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
        near = value[low : high + 1] if high - low == 2 else value
        self.room = float(value[top] - near.min()) if np.isfinite(value[top]) else np.inf
        if not self.wide() and self.finest == self._smooth and 2 <= top <= theta.size - 3:
            self._polish(theta[top - 2 : top + 3], value[top - 2 : top + 3])

    def _polish(self, theta: np.ndarray, value: np.ndarray) -> None:
        """The vertex of the quartic through five equally spaced points, by one Newton step from the middle one."""
        h = theta[3] - theta[2]
        a, b, _, c, d = value - value[2]
        slope = (a - 8.0 * b + 8.0 * c - d) / 12.0
        bend = (-a + 16.0 * b + 16.0 * c - d) / 12.0
        if abs(a - 4.0 * b - 4.0 * c + d) > 0.1 * abs(bend) and abs(bend) > 1e3 * EPS * abs(value[2]):
            self.finest = SHARPEST  # the fourth difference is no smaller than the second: a kink
        elif bend < 0.0 and abs(slope) < abs(bend):
            self.theta = float(theta[2] - h * slope / bend)
            self.value = max(self.value, float(value[2] - 0.5 * slope * slope / bend))


Top = tuple[float, float, float]
"""Of a bracket: where its highest value stands, -1 ... 1, how high the polynomial is there, and the highest of its samples."""


def _smooth_tops(values: np.ndarray) -> list[Top | None]:
    """Of brackets (b, DEGREE + 1) at Chebyshev's points the tops of the polynomials through them; None where one leaves anything out."""
    values = np.where(np.isfinite(values).all(axis=1)[:, None], values, np.nan)
    c = _in_chebyshev(values)
    smooth = np.abs(c[:, -2:]).max(axis=1) <= TAIL * np.abs(values).max(axis=1)
    tops = values.argmax(axis=1)
    start = np.pi * (1.0 - tops / DEGREE)
    phi = _newton(_ORDER * c, _ORDER**2 * c, np.sin, np.cos, start)
    inside, highest = (tops > 0) & (tops < DEGREE), values.max(axis=1)
    phi = np.where(inside, phi, start)
    heights = np.where(inside, (c * np.cos(_ORDER * phi[:, None])).sum(axis=1), highest)
    rows = zip(np.cos(phi).tolist(), heights.tolist(), highest.tolist(), strict=True)
    return [row if good else None for row, good in zip(rows, smooth.tolist(), strict=True)]


def _top_at_zero(value: np.ndarray) -> Top | None:
    """Where the quantity is minus the size of another one, which goes through zero, that zero; None where it is not."""
    top = int(np.argmax(value))
    halves = np.array([np.where(beyond, -value, value) for beyond in (top < _ORDER, top <= _ORDER)])
    c = _in_chebyshev(halves)
    smooth = np.abs(c[:, -2:]).max(axis=1) <= TAIL * np.abs(value).max()
    if not smooth.any():
        return None
    c = c[smooth.argmax()][None]
    phi = _newton(c, -_ORDER * c, np.cos, np.sin, np.array([np.pi * (1.0 - top / DEGREE)]))
    height = -abs(float((c * np.cos(_ORDER * phi[:, None])).sum()))
    return float(np.cos(phi[0])), height, float(value[top])


def _in_chebyshev(values: np.ndarray) -> np.ndarray:
    """The coefficients of brackets (b, DEGREE + 1); of each the same bits whatever is searched beside it, which BLAS would not give."""
    made: np.ndarray = (values[:, None, :] * _TO_CHEBYSHEV).sum(axis=2)
    return made


def _newton(f: np.ndarray, slope: np.ndarray, of: np.ufunc, of_slope: np.ufunc, start: np.ndarray) -> np.ndarray:
    """Where Σ f_k of(kφ) is zero (b,), near a start; its derivative is Σ slope_k of_slope(kφ); both (b, DEGREE + 1)."""
    phi, near = start, np.pi / DEGREE
    for _ in range(NEWTON):
        at = _ORDER * phi[:, None]
        rise = (slope * of_slope(at)).sum(axis=1)
        moves = rise != 0.0
        step = np.where(moves, (f * of(at)).sum(axis=1) / np.where(moves, rise, 1.0), 0.0)
        phi = np.clip(phi - step, start - near, start + near)
    return phi


def _tops(value: np.ndarray, angles: Angles) -> tuple[np.ndarray, np.ndarray]:
    """Of samples (q, n): themselves, NaN as the lowest; and what may stand there at most, where one is a local maximum within its piece,
    else -inf."""
    value = np.where(np.isnan(value), -np.inf, value)
    same = np.diff(angles.piece) == 0
    left, right = np.full_like(value, -np.inf), np.full_like(value, -np.inf)
    left[:, 1:], right[:, :-1] = np.where(same, value[:, :-1], -np.inf), np.where(same, value[:, 1:], -np.inf)
    # no lower than its neighbours and higher than one: plateaus hide nothing, and would crowd out what is narrow
    higher = ((value > left) & (left > -np.inf)) | ((value > right) & (right > -np.inf))
    tops = (value >= left) & (value >= right) & higher & np.isfinite(value)
    room = np.where(tops, _room(angles.theta, value, left, right), 0.0)
    tops &= room > TAIL * np.abs(value)  # what rounding does to a plateau hides nothing either
    return value, np.where(tops, value + room, -np.inf)


def _room(theta: np.ndarray, value: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """What may stand above samples (q, n) between them and their neighbours: a parabola adds an eighth of the second
    difference, which at an end of a piece is that of the first samples inside; taken eightfold. Where the neighbour on
    one side is farther away, the slope on the other side is continued as far."""
    gap = np.diff(theta, prepend=theta[-1], append=theta[0])
    ahead, behind = np.roll(right, -1, axis=-1), np.roll(left, 1, axis=-1)  # two samples away, on either side
    with np.errstate(invalid="ignore", divide="ignore"):  # inf - inf, of which nothing is refined
        wider = gap[1:] / gap[:-1]
        inside = np.maximum((value - left) * np.maximum(wider, 1.0), (value - right) * np.maximum(1.0 / wider, 1.0))
        at_start, at_end = np.abs(value - 2.0 * right + ahead), np.abs(value - 2.0 * left + behind)
    room = np.where(left == -np.inf, at_start, np.where(right == -np.inf, at_end, inside))
    return np.where(np.isfinite(room), room, np.inf)


class _Search:
    """One quantity, one side: the local maxima of its samples that may hold the highest value."""

    def __init__(
        self,
        name: str,
        sign: float,
        value: np.ndarray,
        bound: np.ndarray,
        angles: Angles,
        widths: np.ndarray,
        level: float,
    ) -> None:
        self.name, self.sign = name, sign
        top, last = int(np.argmax(value)), value.size - 1
        self.sampled = Extreme(float(value[top]), float(angles.theta[top]))
        peaks = np.flatnonzero((bound >= max(self.sampled.value, level)) & (bound > -np.inf))
        self.brackets = []
        for i in peaks[np.argsort(-bound[peaks], kind="stable")][:CANDIDATES].tolist():
            piece = int(angles.piece[i])
            before = i > 0 and angles.piece[i - 1] == piece and value[i - 1] > -np.inf
            after = i < last and angles.piece[i + 1] == piece and value[i + 1] > -np.inf
            lo, hi = angles.theta[i - before], angles.theta[i + after]
            finest = min(FINEST_RAD, FINEST * float(widths[piece]))
            self.brackets.append(_Bracket(float(lo), float(hi), piece, float(angles.theta[i]), float(value[i]), finest))
        self._all = list(self.brackets)
        self._value, self._theta, self._piece = value, angles.theta, angles.piece

    def _highest(self) -> float:
        return max([self.sampled.value, *(b.value for b in self._all)])

    def drop_hopeless(self) -> None:
        """Leave the brackets that are narrow enough, or can no longer reach the highest value found."""
        top = self._highest()
        self.brackets = [b for b in self.brackets if b.wide() and b.value + b.room >= top]

    def best(self) -> Extreme:
        """The highest; among equals (to rounding) the smallest cam angle."""
        top = self._highest()
        slack = TAIL * abs(top) if np.isfinite(top) else 0.0
        first, named = self._plateaus(np.flatnonzero(self._value >= top - slack))
        equal = list(zip(self._theta[named].tolist(), self._value[named].tolist(), strict=True))
        if not equal and self.sampled.value >= top - slack:
            equal.append((self.sampled.theta, self.sampled.value))
        low, high = self._theta[np.maximum(first - 1, 0)], self._theta[named]
        for b in self._all:
            # beside a plateau the value differs by rounding only: the plateau names the angle
            beside = bool(((low <= b.theta) & (b.theta <= high)).any())
            if b.value >= top - slack and not (beside and equal):
                equal.append((b.theta, b.value))
        theta, value = min(equal)
        return Extreme(self.sign * value, theta % (2.0 * pi))

    def _plateaus(self, ties: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Runs of equal samples within a piece: the first of each, and the one that names it. That is the first, but for
        a curve that runs into the end of its piece, where it arrives: its last."""
        if ties.size < 2:
            return ties[:0], ties[:0]
        cuts = np.flatnonzero((np.diff(ties) > 1) | (np.diff(self._piece[ties]) != 0)) + 1
        first, last = ties[np.append(0, cuts)], ties[np.append(cuts - 1, ties.size - 1)]
        long = last > first
        first, last = first[long], last[long]
        piece = self._piece[first]  # in rising order, as all samples are
        begin, end = (np.searchsorted(self._piece, piece, side) for side in ("left", "right"))
        arrives = (last == end - 1) & (first != begin)
        return first, np.where(arrives, last, first)


@lru_cache(maxsize=32)
def true_stroke(motion: Motion) -> float:
    """Highest minus lowest position over one turn, in the motion's unit, to ``DIGITS`` digits. A named law stays between
    its ends; a polynomial or a spline need not. Raises NoSolution where the points of a spline contradict each other."""
    if all(isinstance(segment.curve, NamedCurve | SccaCurve) for segment in motion.segments):
        return stroke(motion)
    compiled = program(motion)
    y = find_extremes(lambda angles: {"y": compiled.state(angles).displacement[0]}, compiled)["y"]
    return float(f"{(y.high.value - y.low.value) / motion.scale:.{DIGITS}g}")


# -- where a quantity passes zero -------------------------------------------------------------------------------


ROOT_PASSES = 100
ROOT_WIDTH = EPS * TURN  # [rad] half width at which a root is found
BETWEEN = 33  # points by which a dip towards zero is sampled closer

Quantity = Callable[[Angles], np.ndarray]


@np.errstate(invalid="ignore")  # inf - inf, where a crank locks
def crossings(quantity: Quantity, angles: Angles, value: np.ndarray) -> Angles:
    """The cam angles at which the quantity changes its sign, each with the piece it is in, by piece and angle.

    quantity  gives (n,) at any cam angles; of several quantities (k, n), whose angles are found together
    angles    samples (n,), rising within each piece; value (n,) or (k, n) of the quantity there. A sign that changes twice
              between two samples is noticed where the samples beside bend that way.
    """
    values = np.atleast_2d(value)
    dips = distinct(np.concatenate([_dips(angles, row) for row in values]))
    theta, piece = angles.theta, angles.piece
    if dips.size:
        more = [np.linspace(theta[i - 1], theta[i + 1], BETWEEN)[1:-1] for i in dips]
        closer = Angles(np.concatenate(more), np.repeat(piece[dips], BETWEEN - 2))
        theta, piece = np.append(theta, closer.theta), np.append(piece, closer.piece)
        values = np.hstack([values, np.atleast_2d(quantity(closer))])
        order = np.lexsort((theta, piece))
        theta, piece, values = theta[order], piece[order], values[:, order]
    same = piece[:-1] == piece[1:]
    row, turns = np.nonzero((values[:, :-1] * values[:, 1:] < 0.0) & same)
    root = _narrowed(quantity, theta, piece, values, row, turns)
    # a sample that is zero itself counts where the sign differs on its two sides
    met = (values[:, 1:-1] == 0.0) & (values[:, :-2] * values[:, 2:] < 0.0) & same[:-1] & same[1:]
    exact = np.nonzero(met)[1] + 1
    result, where = np.append(root, theta[exact]), np.append(piece[turns], piece[exact])
    order = np.lexsort((result, where))
    return Angles(result[order], where[order])


def _dips(angles: Angles, value: np.ndarray) -> np.ndarray:
    """Samples nearer to zero than both their neighbours of the same sign and piece, whose second difference, taken
    eightfold as that of a parabola, would bring it beyond."""
    size, same = np.abs(value), np.diff(angles.piece) == 0
    middle = (size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]) & same[:-1] & same[1:]
    middle &= (value[1:-1] * value[:-2] > 0.0) & (value[1:-1] * value[2:] > 0.0)
    bend = np.abs(value[:-2] - 2.0 * value[1:-1] + value[2:])
    return np.flatnonzero(middle & (bend >= size[1:-1])) + 1


def _narrowed(
    quantity: Quantity, theta: np.ndarray, piece: np.ndarray, value: np.ndarray, row: np.ndarray, turns: np.ndarray
) -> np.ndarray:
    """The roots (m,) between samples and their next, each of its row of the values (k, n), to the last bits: false position,
    where an end that stays a second time counts half (Illinois), which kinks do not slow down."""
    ends, values = np.array([theta[turns], theta[turns + 1]]), np.array([value[row, turns], value[row, turns + 1]])
    at, root = piece[turns], ends.mean(axis=0)
    moved = np.full(turns.size, -1)  # which end moved last
    for _ in range(ROOT_PASSES):
        wide = np.flatnonzero(ends[1] - ends[0] > 2.0 * ROOT_WIDTH)
        if not wide.size:
            break
        (a, b), (fa, fb) = ends[:, wide], values[:, wide]
        x = np.clip(a + (b - a) * (fa / (fa - fb)), a + ROOT_WIDTH, b - ROOT_WIDTH)
        f = np.atleast_2d(quantity(Angles(x, at[wide])))[row[wide], np.arange(wide.size)]
        side = np.where(f * fa > 0.0, 0, 1)  # the end that x takes the place of
        again = moved[wide] == side
        values[1 - side, wide] *= np.where(again, 0.5, 1.0)
        ends[side, wide], values[side, wide] = x, f
        moved[wide], root[wide] = side, x
        met = wide[f == 0.0]
        ends[:, met] = root[met]
    return root
