"""Polynomials with given ends, and the spline of least jerk through given points.

The curve of least ∫ s'''² du through the states x = (s, s', s'') at two knots at distance h is a quintic, with
∫ s'''² = |R d|²/h⁵ and the defects
    d = (s₁ - s₀ - h s₀' - h² s₀''/2,  h (s₁' - s₀' - h s₀''),  h² (s₁'' - s₀'')).
The rows of R give mean, slope and curvature of the jerk, its Legendre coefficients. The states at the knots then solve a
linear least-squares problem over the ring of knots, reduced by halves with Householder's QR. It has twice the digits of
the normal equations, also for knots at very uneven distances. All knots of a level are reduced together: n knots cost 2n
small factorisations in log2(n) calls of numpy.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import comb, factorial

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.laws.pieces import Piece, shifted

CLOSEST = 1e-9  # least distance of two knots of a spline, relative to its span
ROUNDING = 1e3 * float(np.finfo(float).eps)
STATES = 3  # s, s', s''
# columns of a level's rows: the eliminated knot, its neighbours, the right-hand sides
_KNOT, _LEFT, _RIGHT, _SIDES = (slice(i * STATES, (i + 1) * STATES if i < 3 else None) for i in range(4))
_R = np.array([[0.0, 0.0, 1.0], [0.0, -2.0 * 3.0**0.5, 3.0**0.5], [12.0 * 5.0**0.5, -6.0 * 5.0**0.5, 5.0**0.5]])


class NoSpline(KindynaError):
    """The points of a spline contradict each other, or leave it undetermined."""

    field = "motion.segments"


def hermite(start: Sequence[float], end: Sequence[float]) -> tuple[float, ...]:
    """Ascending coefficients of the polynomial of least degree with given value and derivatives at u = 0 and u = 1.

    Two-point Taylor interpolation in closed form: p(u) = Σ_k start_k u^k/k! (1-u)^q A(u) plus its mirror image for the other
    end, A the truncated series of (1-u)^-q.
    """
    p, q = len(start), len(end)
    mirrored = _end_part([(-1) ** k * v for k, v in enumerate(end)], p)  # in powers of 1-u
    expanded = [(-1) ** j * c for j, c in enumerate(shifted(mirrored.tolist(), 1.0))]
    return tuple(map(float, _end_part(start, q) + np.array(expanded)))


def _end_part(values: Sequence[float], zeros: int) -> np.ndarray:
    """Coefficients of the polynomial with these derivatives at 0 and ``zeros`` zero derivatives at 1."""
    p = len(values)
    taylor = np.array([v / factorial(k) for k, v in enumerate(values)])
    series = np.array([comb(zeros - 1 + k, k) for k in range(p)], dtype=float)  # of (1-u)^-zeros
    truncated = np.convolve(taylor, series)[:p]
    factor = np.array([comb(zeros, k) * (-1) ** k for k in range(zeros + 1)], dtype=float)
    return np.convolve(truncated, factor)


# -- splines of least jerk --------------------------------------------------------------------------------


def least_jerk(
    knots: Sequence[float], conditions: Sequence[tuple[float, int, float]], periodic: bool
) -> tuple[Piece, ...]:
    """Curve of least ∫ s'''² du on 0...1 with given derivatives at given points.

    Least squares over the states s, s', s'' at the knots, in time proportional to their number. Its error is that of
    conditions rounded to the last digit, at most times (greatest over least distance of knots)^(5/2).

    Parameters
    ----------
    knots : sequence of float
        Ascending from 0 to 1, with the points of all conditions.
    conditions : sequence of (u, order, value)
        Value of the derivative of order 0...2 at u.
    periodic : bool
        Whether s, s', s'' are continuous from 1 to 0.

    Returns
    -------
    tuple of Piece

    Raises
    ------
    NoSpline
        Where conditions contradict each other or leave the curve undetermined, or where knots are too close.
    """
    u = np.asarray(knots, dtype=float)
    h = np.diff(u)
    if h.min() < CLOSEST:
        raise NoSpline(
            f"motion.segments: two points of the spline are less than {CLOSEST:g} of its span from each other; move one"
        )
    around = h if periodic else np.append(h, 0.0)
    known, fixed = np.zeros((around.size, STATES, 1)), np.zeros((around.size, STATES), dtype=bool)
    size = max([1.0, *(abs(value) for _, _, value in conditions)])
    for point, order, value in conditions:
        k = _nearest(u, point) % around.size
        if fixed[k, order] and abs(known[k, order, 0] - value) > 1e-8 * size:
            raise NoSpline("motion.segments: the points of the spline contradict each other; remove one")
        known[k, order], fixed[k, order] = value, True
    try:
        at = least_jerk_states(around, known, fixed)
    except np.linalg.LinAlgError:
        raise NoSpline("motion.segments: the points do not determine the spline; add one with a value") from None
    rows = quintics(h, at[: h.size], np.roll(at, -1, axis=0)[: h.size])[:, :, 0].tolist()
    return tuple(Piece(start, tuple(row)) for start, row in zip(u[:-1].tolist(), rows, strict=True))


def _nearest(u: np.ndarray, point: float) -> int:
    """Number of the knot nearest to a point."""
    k = int(np.searchsorted(u, point))
    return k - 1 if k == u.size or (k > 0 and point - u[k - 1] < u[k] - point) else k


def defects(h: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Defects d of each interval, for r curves.

    Parameters
    ----------
    h : ndarray (k,) [unit of u]
        Widths of the intervals.
    start, end : ndarray (k, 3, r) [unit of s, per unit of uᵏ]
        States s, s', s'' at their ends.

    Returns
    -------
    ndarray (k, 3, r) [unit of s]
    """
    width = h[:, None]
    return np.stack(
        (
            end[:, 0] - start[:, 0] - width * start[:, 1] - 0.5 * width**2 * start[:, 2],
            width * (end[:, 1] - start[:, 1] - width * start[:, 2]),
            width**2 * (end[:, 2] - start[:, 2]),
        ),
        axis=1,
    )


def jerk_rows(h: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Rows R d/h^(5/2) whose sum of squares is ∫ s'''² du over each interval, for r curves.

    Parameters
    ----------
    h : ndarray (k,) [unit of u]
        Widths of the intervals.
    start, end : ndarray (k, 3, r) [unit of s, per unit of uᵏ]
        States s, s', s'' at their ends.

    Returns
    -------
    ndarray (k, 3, r) [unit of s, per unit of u^(5/2)]
    """
    return (_R @ defects(h, start, end)) / (h**2.5)[:, None, None]


def quintics(h: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Coefficients of the quintics with given states at both ends of each interval, for r curves.

    The jerk c₀ + c₁ P₁ + c₂ P₂ (Legendre polynomials) follows from the defects.

    Parameters
    ----------
    h : ndarray (k,) [unit of u]
        Widths of the intervals.
    start, end : ndarray (k, 3, r) [unit of s, per unit of uᵏ]
        States s, s', s'' at their ends.

    Returns
    -------
    ndarray (k, 6, r) [unit of s, per unit of uᵏ]
        Of w⁰...w⁵, w from the start of the interval.
    """
    d0, d1, d2 = np.moveaxis(defects(h, start, end), 1, 0)
    c1, c2 = 3.0 * d2 - 6.0 * d1, 60.0 * d0 - 30.0 * d1 + 5.0 * d2
    jerk = (d2 - c1 + c2, 2.0 * c1 - 6.0 * c2, 6.0 * c2)  # by powers of w/h, times h³
    width = h[:, None]
    coefficients = [start[:, 0], start[:, 1], 0.5 * start[:, 2]]
    coefficients += [c / f / width**k for c, f, k in zip(jerk, (6.0, 24.0, 60.0), (3, 4, 5), strict=True)]
    return np.stack(coefficients, axis=1)


@frozen(eq=False)
class _Elimination:
    """Equations knot x_j = sides - left x_{j-1} - right x_{j+1} of the knots that one level eliminates."""

    knot: np.ndarray
    left: np.ndarray
    right: np.ndarray
    sides: np.ndarray


def least_jerk_states(h: np.ndarray, known: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """States s, s', s'' at the knots of r curves of least ∫ s'''² du.

    Parameters
    ----------
    h : ndarray (n,) [unit of u]
        Distance from each knot to the next, and from the last to the first; 0 where the two are not connected.
    known : ndarray (n, 3, r) [unit of s, per unit of uᵏ]
        Fixed states; 0 elsewhere.
    fixed : ndarray (n, 3) of bool, dimensionless
        Which states are fixed.

    Returns
    -------
    ndarray (n, 3, r) [unit of s, per unit of uᵏ]

    Raises
    ------
    numpy.linalg.LinAlgError
        Where the fixed states do not determine the curve.
    """
    n, _, r = known.shape
    linked = h > 0.0
    size = np.where(linked, h, 1.0)
    identity = np.broadcast_to(np.eye(STATES), (n, STATES, STATES))
    zero = np.zeros_like(identity)
    gain = (linked / size**2.5)[:, None, None]
    start = gain * (_R @ defects(size, identity, zero)) * ~fixed[:, None, :]
    end = gain * (_R @ defects(size, zero, identity)) * ~np.roll(fixed, -1, axis=0)[:, None, :]
    sides = -gain * (_R @ defects(size, known, np.roll(known, -1, axis=0)))
    node = fixed[:, :, None] * np.eye(STATES)
    typical = np.abs(np.concatenate((start[0], end[-1], node[0]))).max(axis=0)
    eliminations = []
    while node.shape[0] > 1:
        elimination, start, end, sides = _eliminate_half(start, end, sides, node)
        node = node[0::2]
        eliminations.append(elimination)
    rows = np.concatenate((start[0] + end[0], node[0]))
    x = _solve_last(rows, np.concatenate((sides[0], np.zeros((STATES, r)))), typical)[None]
    for level in reversed(eliminations):
        k = level.knot.shape[0]
        remaining = x
        after = np.roll(remaining, -1, axis=0)[:k]
        eliminated = np.linalg.solve(level.knot, level.sides - level.left @ remaining[:k] - level.right @ after)
        x = np.empty((remaining.shape[0] + k, STATES, r))
        x[0::2], x[1::2] = remaining, eliminated
    return np.where(fixed[:, :, None], known, x)


def _eliminate_half(
    start: np.ndarray, end: np.ndarray, sides: np.ndarray, node: np.ndarray
) -> tuple[_Elimination, np.ndarray, np.ndarray, np.ndarray]:
    """Eliminate every second knot, which joins its two intervals; returns its equations and the rows of the new intervals."""
    k = node.shape[0] // 2
    rows, r = start.shape[1], sides.shape[2]
    stack = np.zeros((k, 2 * rows + STATES, 3 * STATES + r))
    before, behind, knot = stack[:, :rows], stack[:, rows : 2 * rows], stack[:, 2 * rows :]
    before[:, :, _KNOT], before[:, :, _LEFT], before[:, :, _SIDES] = (
        part[0 : 2 * k : 2] for part in (end, start, sides)
    )
    behind[:, :, _KNOT], behind[:, :, _RIGHT], behind[:, :, _SIDES] = (
        part[1 : 2 * k : 2] for part in (start, end, sides)
    )
    knot[:, :, _KNOT] = node[1::2]
    # large rows first, so that no row loses digits, however uneven the knots are (Powell, Reid 1969)
    order = np.argsort(-np.abs(stack[:, :, : 3 * STATES]).max(axis=2), axis=1, kind="stable")
    stack = np.take_along_axis(stack, order[:, :, None], axis=1)
    upper = np.asarray(np.linalg.qr(stack, mode="r"))
    top, rest = upper[:, :STATES], upper[:, STATES : 3 * STATES]
    elimination = _Elimination(*(top[:, :, part] for part in (_KNOT, _LEFT, _RIGHT, _SIDES)))
    new = [rest[:, :, part] for part in (_LEFT, _RIGHT, _SIDES)]
    if node.shape[0] > 2 * k:  # an odd ring retains its last interval
        for i, part in enumerate((start, end, sides)):
            last = np.zeros((1, 2 * STATES, part.shape[2]))
            last[0, :rows] = part[-1]
            new[i] = np.concatenate((new[i], last))
    return elimination, new[0], new[1], new[2]


def _solve_last(rows: np.ndarray, sides: np.ndarray, typical: np.ndarray) -> np.ndarray:
    """State of the last knot by least squares.

    The columns differ in size by powers of the distances; one that is small against its ``typical`` size (3,) is rounding.
    """
    size = np.abs(rows).max(axis=0)
    if np.any(size <= ROUNDING * typical):
        raise np.linalg.LinAlgError("a state is undetermined")
    result, _, rank, _ = np.linalg.lstsq(rows / size, sides, rcond=ROUNDING)
    if rank < STATES:
        raise np.linalg.LinAlgError("the curve is undetermined")
    return result / size[:, None]
