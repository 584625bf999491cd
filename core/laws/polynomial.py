"""Polynomials with given ends, and the spline of least jerk through given points.

A curve of least ∫ jerk² is a least-squares problem around a ring of knots, reduced by halves with Householder's QR.
Between two knots a distance h apart the curve of least jerk through the states x = (s, s', s'') at both ends is a
quintic, and its ∫ s'''² is |R d|²/h⁵ with the defects
    d = (s₁ - s₀ - h s₀' - h² s₀''/2,  h (s₁' - s₀' - h s₀''),  h² (s₁'' - s₀'')),
where the rows of R give mean, slope and bend of the jerk, its Legendre coefficients. So s, s', s'' join by themselves,
and what is left is to minimise a sum of squares over the states. Squares are never summed up before they are solved,
which keeps twice the digits of the normal equations and bears knots of very uneven distances.

All work is on whole levels of the ring at once: n knots cost 2n small factorisations in log2(n) calls of numpy.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import comb, factorial

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.laws.pieces import Piece, moved

CLOSEST = 1e-9  # distance of two knots of a spline, of its span
ROUNDING = 1e3 * float(np.finfo(float).eps)
STATES = 3  # s, s', s''
# columns of a level's rows: the knot taken out, its neighbours, the right-hand sides
_OWN, _LEFT, _RIGHT, _SIDES = (slice(i * STATES, (i + 1) * STATES if i < 3 else None) for i in range(4))
_R = np.array([[0.0, 0.0, 1.0], [0.0, -2.0 * 3.0**0.5, 3.0**0.5], [12.0 * 5.0**0.5, -6.0 * 5.0**0.5, 5.0**0.5]])


class NoSpline(KindynaError):
    """The points of a spline contradict each other."""

    field = "motion.segments"


def hermite(start: Sequence[float], end: Sequence[float]) -> tuple[float, ...]:
    """Coefficients (ascending) of the polynomial of least degree whose value and derivatives at u = 0 and u = 1 are these.

    Two-point Taylor interpolation in closed form, no equations to solve:
    p(u) = Σ_k start_k u^k/k! (1-u)^q A(u) + the same from the other end, A the truncated series of (1-u)^-q.
    """
    p, q = len(start), len(end)
    mirrored = _from_end([(-1) ** k * v for k, v in enumerate(end)], p)  # written in 1-u
    expanded = [(-1) ** j * c for j, c in enumerate(moved(mirrored.tolist(), 1.0))]
    return tuple(map(float, _from_end(start, q) + np.array(expanded)))


def _from_end(values: Sequence[float], other: int) -> np.ndarray:
    """The part that has these derivatives at 0 and ``other`` zero derivatives at 1."""
    p = len(values)
    taylor = np.array([v / factorial(k) for k, v in enumerate(values)])
    series = np.array([comb(other - 1 + k, k) for k in range(p)], dtype=float)  # of (1-u)^-other
    head = np.convolve(taylor, series)[:p]
    fall = np.array([comb(other, k) * (-1) ** k for k in range(other + 1)], dtype=float)
    return np.convolve(head, fall)


# -- splines of least jerk --------------------------------------------------------------------------------


def least_jerk(
    knots: Sequence[float], conditions: Sequence[tuple[float, int, float]], periodic: bool
) -> tuple[Piece, ...]:
    """The curve of least ∫ s'''² on 0...1 with given values of derivatives at given places.

    knots       increasing, from 0 to 1; every condition's place is among them
    conditions  (place, order 0...2, value)
    periodic    s, s', s'' join from 1 to 0

    Least squares over the states s, s', s'' at the knots , in time proportional to their number.
    Its error is that of conditions rounded to the last digit, times (longest over shortest distance of knots)^(5/2) at
    worst. Raises NoSpline where conditions contradict each other or leave the curve free, or knots are too close.
    """
    u = np.asarray(knots, dtype=float)
    h = np.diff(u)
    if h.min() < CLOSEST:
        raise NoSpline(
            f"motion.segments: two points of the spline are less than {CLOSEST:g} of its span apart; move one"
        )
    around = h if periodic else np.append(h, 0.0)
    known, fixed = np.zeros((around.size, STATES, 1)), np.zeros((around.size, STATES), dtype=bool)
    size = max([1.0, *(abs(value) for _, _, value in conditions)])
    for place, order, value in conditions:
        k = _nearest(u, place) % around.size
        if fixed[k, order] and abs(known[k, order, 0] - value) > 1e-8 * size:
            raise NoSpline("motion.segments: the points of the spline contradict each other; remove one")
        known[k, order], fixed[k, order] = value, True
    try:
        at = states(around, known, fixed)
    except np.linalg.LinAlgError:
        raise NoSpline("motion.segments: the points leave the spline free; add one with a value") from None
    rows = quintics(h, at[: h.size], np.roll(at, -1, axis=0)[: h.size])[:, :, 0].tolist()
    return tuple(Piece(start, tuple(row)) for start, row in zip(u[:-1].tolist(), rows, strict=True))


def _nearest(u: np.ndarray, place: float) -> int:
    """The knot at a place."""
    k = int(np.searchsorted(u, place))
    return k - 1 if k == u.size or (k > 0 and place - u[k - 1] < u[k] - place) else k


def defects(h: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """d of each interval (k, 3, r) from its distance h (k,) and the states at its ends (k, 3, r)."""
    wide = h[:, None]
    return np.stack(
        (
            end[:, 0] - start[:, 0] - wide * start[:, 1] - 0.5 * wide**2 * start[:, 2],
            wide * (end[:, 1] - start[:, 1] - wide * start[:, 2]),
            wide**2 * (end[:, 2] - start[:, 2]),
        ),
        axis=1,
    )


def jerk_rows(h: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Rows (k, 3, r) whose sum of squares is ∫ s'''² over each interval, one column for each curve."""
    return (_R @ defects(h, start, end)) / (h**2.5)[:, None, None]


def quintics(h: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Coefficients (k, 6, r) of the quintics w⁰...w⁵ with these states (k, 3, r) at both ends of intervals h (k,).

    The jerk c₀ + c₁ P₁ + c₂ P₂ (Legendre) follows from the defects, and its integrals are the last three.
    """
    d0, d1, d2 = np.moveaxis(defects(h, start, end), 1, 0)
    c1, c2 = 3.0 * d2 - 6.0 * d1, 60.0 * d0 - 30.0 * d1 + 5.0 * d2
    jerk = (d2 - c1 + c2, 2.0 * c1 - 6.0 * c2, 6.0 * c2)  # by powers of w/h, times h³
    wide = h[:, None]
    made = [start[:, 0], start[:, 1], 0.5 * start[:, 2]]
    made += [c / f / wide**k for c, f, k in zip(jerk, (6.0, 24.0, 60.0), (3, 4, 5), strict=True)]
    return np.stack(made, axis=1)


@frozen(eq=False)
class _Half:
    """What one level leaves behind: own x_j = sides - left x_{j-1} - right x_{j+1} for the knots taken out of it."""

    own: np.ndarray
    left: np.ndarray
    right: np.ndarray
    sides: np.ndarray


def states(h: np.ndarray, known: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """The states (n, 3, r) at the knots of the r curves of least ∫ s'''².

    h       (n,) distance from each knot to the next, the last to the first; 0: the two have nothing to do with each other
    known   (n, 3, r) the states that are fixed; 0 elsewhere
    fixed   (n, 3) which are

    Raises numpy.linalg.LinAlgError where what is fixed leaves the curve free.
    """
    n, _, r = known.shape
    linked = h > 0.0
    size = np.where(linked, h, 1.0)
    one = np.broadcast_to(np.eye(STATES), (n, STATES, STATES))
    none = np.zeros_like(one)
    gain = (linked / size**2.5)[:, None, None]
    start = gain * (_R @ defects(size, one, none)) * ~fixed[:, None, :]
    end = gain * (_R @ defects(size, none, one)) * ~np.roll(fixed, -1, axis=0)[:, None, :]
    sides = -gain * (_R @ defects(size, known, np.roll(known, -1, axis=0)))
    node = fixed[:, :, None] * np.eye(STATES)
    usual = np.abs(np.concatenate((start[0], end[-1], node[0]))).max(axis=0)
    halves = []
    while node.shape[0] > 1:
        half, start, end, sides = _halved(start, end, sides, node)
        node = node[0::2]
        halves.append(half)
    rows = np.concatenate((start[0] + end[0], node[0]))
    x = _determined(rows, np.concatenate((sides[0], np.zeros((STATES, r)))), usual)[None]
    for half in reversed(halves):
        k = half.own.shape[0]
        kept = x
        after = np.roll(kept, -1, axis=0)[:k]
        result = np.linalg.solve(half.own, half.sides - half.left @ kept[:k] - half.right @ after)
        x = np.empty((kept.shape[0] + k, STATES, r))
        x[0::2], x[1::2] = kept, result
    return np.where(fixed[:, :, None], known, x)


def _halved(
    start: np.ndarray, end: np.ndarray, sides: np.ndarray, node: np.ndarray
) -> tuple[_Half, np.ndarray, np.ndarray, np.ndarray]:
    """Every second knot taken out, so that the two intervals beside it become one: what that leaves behind, and the
    rows of the intervals that remain."""
    k = node.shape[0] // 2
    rows, r = start.shape[1], sides.shape[2]
    stack = np.zeros((k, 2 * rows + STATES, 3 * STATES + r))
    before, behind, own = stack[:, :rows], stack[:, rows : 2 * rows], stack[:, 2 * rows :]
    before[:, :, _OWN], before[:, :, _LEFT], before[:, :, _SIDES] = (
        part[0 : 2 * k : 2] for part in (end, start, sides)
    )
    behind[:, :, _OWN], behind[:, :, _RIGHT], behind[:, :, _SIDES] = (
        part[1 : 2 * k : 2] for part in (start, end, sides)
    )
    own[:, :, _OWN] = node[1::2]
    # heavy rows first: then each row keeps its own digits, however uneven the knots are (Powell, Reid 1969)
    order = np.argsort(-np.abs(stack[:, :, : 3 * STATES]).max(axis=2), axis=1, kind="stable")
    stack = np.take_along_axis(stack, order[:, :, None], axis=1)
    made = np.asarray(np.linalg.qr(stack, mode="r"))
    top, rest = made[:, :STATES], made[:, STATES : 3 * STATES]
    half = _Half(*(top[:, :, part] for part in (_OWN, _LEFT, _RIGHT, _SIDES)))
    new = [rest[:, :, part] for part in (_LEFT, _RIGHT, _SIDES)]
    if node.shape[0] > 2 * k:  # an odd ring: its last interval stays
        for i, part in enumerate((start, end, sides)):
            last = np.zeros((1, 2 * STATES, part.shape[2]))
            last[0, :rows] = part[-1]
            new[i] = np.concatenate((new[i], last))
    return half, new[0], new[1], new[2]


def _determined(rows: np.ndarray, sides: np.ndarray, usual: np.ndarray) -> np.ndarray:
    """Least squares for the last knot's state; its columns (3,) differ in size by powers of the distances, and what has
    become of one of ``usual`` size when all other knots are gone may be rounding alone."""
    size = np.abs(rows).max(axis=0)
    if np.any(size <= ROUNDING * usual):
        raise np.linalg.LinAlgError("a state is left free")
    result, _, rank, _ = np.linalg.lstsq(rows / size, sides, rcond=ROUNDING)
    if rank < STATES:
        raise np.linalg.LinAlgError("the curve is left free")
    return result / size[:, None]
