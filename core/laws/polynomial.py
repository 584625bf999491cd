"""Polynomials with wanted ends, and the spline of least jerk through wanted points."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb, factorial

import numpy as np

from core.errors import KindynaError
from core.laws.pieces import Piece


class NoSpline(KindynaError):
    """The points of a spline contradict each other."""


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


_DEGREE = 5  # a minimiser of ∫ jerk² is of this degree between its knots


def least_jerk(
    knots: Sequence[float], conditions: Sequence[tuple[float, int, float]], periodic: bool
) -> tuple[Piece, ...]:
    """The curve of least ∫ s'''² on 0...1 with given values of derivatives at given places.

    knots       increasing, from 0 to 1; every condition's place is among them
    conditions  (place, order 0...2, value)
    periodic    s, s', s'' join from 1 to 0

    One linear system: the energy's gradient and the conditions' multipliers (Karush-Kuhn-Tucker). Raises NoSpline
    where conditions contradict each other.
    """
    u = np.asarray(knots, dtype=float)
    m, n = u.size - 1, _DEGREE + 1
    h = np.diff(u)
    hessian = np.zeros((m * n, m * n))
    for i in range(m):
        hessian[i * n : (i + 1) * n, i * n : (i + 1) * n] = _energy() / h[i] ** 5
    rows: list[np.ndarray] = []
    wanted: list[float] = []

    def row(piece: int, end: int, order: int) -> np.ndarray:
        made = np.zeros(m * n)
        made[piece * n : (piece + 1) * n] = _derivative_row(end, order) / h[piece] ** order
        return made

    joins = [(i, i + 1) for i in range(m - 1)] + ([(m - 1, 0)] if periodic else [])
    for a, b in joins:
        for order in range(3):
            scale = min(h[a], h[b]) ** order
            rows.append((row(a, 1, order) - row(b, 0, order)) * scale)
            wanted.append(0.0)
    for place, order, value in conditions:
        k = int(np.argmin(np.abs(u - place)))
        piece, end = (k, 0) if k < m else (k - 1, 1)
        scale = h[piece] ** order
        rows.append(row(piece, end, order) * scale)
        wanted.append(value * scale)
    equations, right_sides = np.array(rows), np.array(wanted)
    weight = 1.0 / max(float(np.abs(hessian).max()), 1.0)
    system = np.block([[hessian * weight, equations.T], [equations, np.zeros((len(rows), len(rows)))]])
    right = np.concatenate((np.zeros(m * n), right_sides))
    solved = np.linalg.lstsq(system, right, rcond=None)[0]
    solved -= np.linalg.lstsq(system, system @ solved - right, rcond=None)[0]  # one step of refinement
    coefficients = solved[: m * n].reshape(m, n)
    missed = np.abs(equations @ solved[: m * n] - right_sides).max(initial=0.0)
    if missed > 1e-8 * max(1.0, float(np.abs(right_sides).max(initial=0.0))):
        raise NoSpline("motion.segments: the points of the spline contradict each other; remove one")
    return tuple(
        Piece(float(u[i]), tuple(float(c) / float(h[i]) ** k for k, c in enumerate(coefficients[i]))) for i in range(m)
    )


def _energy() -> np.ndarray:
    """∫ of products of third derivatives of 1, x, ... x^5 over 0...1."""
    n = _DEGREE + 1
    made = np.zeros((n, n))
    for i in range(3, n):
        for j in range(3, n):
            made[i, j] = factorial(i) / factorial(i - 3) * factorial(j) / factorial(j - 3) / (i + j - 5)
    return made


def _derivative_row(end: int, order: int) -> np.ndarray:
    """Derivative of 1, x, ... x^5 at x = 0 or 1."""
    n = _DEGREE + 1
    if end == 0:
        return np.array([float(factorial(order)) if k == order else 0.0 for k in range(n)])
    return np.array([factorial(k) / factorial(k - order) if k >= order else 0.0 for k in range(n)])
