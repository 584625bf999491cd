"""Polynomials with wanted ends, and the spline of least jerk through wanted points."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb, factorial

import numpy as np

from core.errors import KindynaError
from core.laws.pieces import Piece
from core.laws.ring import STATES, quintics, states


class NoSpline(KindynaError):
    """The points of a spline contradict each other."""


CLOSEST = 1e-9  # distance of two knots of a spline, of its span


def hermite(start: Sequence[float], end: Sequence[float]) -> tuple[float, ...]:
    """Coefficients (ascending) of the polynomial of least degree whose value and derivatives at u = 0 and u = 1 are these.

    Two-point Taylor interpolation in closed form, no equations to solve:
    p(u) = Σ_k start_k u^k/k! (1-u)^q A(u) + the same from the other end, A the truncated series of (1-u)^-q.
    """
    p, q = len(start), len(end)
    out = np.zeros(p + q)
    out += _from_end(start, q)
    mirrored = _from_end([(-1) ** k * v for k, v in enumerate(end)], p)
    # written in 1-u: expand
    for k, c in enumerate(mirrored):
        for j in range(k + 1):
            out[j] += c * comb(k, j) * (-1) ** j
    return tuple(map(float, out))


def _from_end(values: Sequence[float], other: int) -> np.ndarray:
    """The part that has these derivatives at 0 and ``other`` zero derivatives at 1."""
    p = len(values)
    taylor = np.array([v / factorial(k) for k, v in enumerate(values)])
    series = np.array([comb(other - 1 + k, k) for k in range(p)], dtype=float)  # of (1-u)^-other
    head = np.convolve(taylor, series)[:p]
    fall = np.array([comb(other, k) * (-1) ** k for k in range(other + 1)], dtype=float)
    return np.convolve(head, fall)


def least_jerk(
    knots: Sequence[float], conditions: Sequence[tuple[float, int, float]], periodic: bool
) -> tuple[Piece, ...]:
    """The curve of least ∫ s'''² on 0...1 with given values of derivatives at given places.

    knots       increasing, from 0 to 1; every condition's place is among them
    conditions  (place, order 0...2, value)
    periodic    s, s', s'' join from 1 to 0

    Least squares over the states s, s', s'' at the knots (``core.laws.ring``), in time proportional to their number.
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
    nothing = np.zeros_like(known)
    try:
        at = states(around, known, fixed, np.zeros(fixed.shape), nothing)
    except np.linalg.LinAlgError:
        raise NoSpline("motion.segments: the points leave the spline free; add one with a value") from None
    rows = quintics(h, at[: h.size], np.roll(at, -1, axis=0)[: h.size])[:, :, 0].tolist()
    return tuple(Piece(start, tuple(row)) for start, row in zip(u[:-1].tolist(), rows, strict=True))


def _nearest(u: np.ndarray, place: float) -> int:
    """The knot at a place."""
    k = int(np.searchsorted(u, place))
    return k - 1 if k == u.size or (k > 0 and place - u[k - 1] < u[k] - place) else k
