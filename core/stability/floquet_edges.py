"""Tongue edges from monodromy matrices: the last digits where harmonics converge slowly, and tongues with damping.

At an edge the matrix M(η) has the multiplier s = +1 (n even) or -1 (n odd): det(M - s) = 0. The trace only touches 2 at the
tip of a tongue, so that its zero is lost in rounding. But M(η + δ) - s = E + δ K, K = dM/dη, is singular at both edges of a
tongue at once, and det(E + δK) = det E + δ tr(adj(E) K) + δ² det K has both as its roots: a pencil of 2 x 2 matrices, well
conditioned at the tip too; Newton's method for two zeros that may be one.

Damping closes a tongue from its tip: where the roots are complex there is none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from core.motion import EPS
from core.stability.floquet import determinant, monodromy, size, zeros_at_standstill
from core.stability.hill.coefficients import EXACT, Coefficients
from core.stability.hill.edges import EDGE_ERROR, MOST_ORDER, Tongues, harmonic_tongues, with_rows

STEPS = 40
CLOSE = 1e-9  # a step of η no larger is the last: the next would be its square
FARTHEST = 0.2  # a step must not reach the next tongue
CLEARLY = 0.1  # of the imaginary part of complex roots: a step no larger proves them
ROUNDS = 3  # of steps no smaller than the one before: then rounding is all that is left
NARROW = 0.2  # half width over ζη, below which damping has surely closed a tongue; at 1 it closes it for small Q
ROUNDING = 4.0  # times eps
UNKNOWN = 0.05  # a tenth of what tongues stand apart: an edge that harmonics leave less certain is unknown to them
ASTRAY = 1e-6  # an edge that is off by more has not been found
ONWARDS, FARTHEST_ORDER = 2, 160
BY_MONODROMY = "harmonic balance, refined by monodromy matrices"


def tongues(
    coefficients: Coefficients,
    q: np.ndarray,
    count: int,
    equation: str = EXACT,
    damping: float = 0.0,
    error: float = EDGE_ERROR,
    most_order: int = MOST_ORDER,
) -> Tongues:
    """Tongues 1 ... count of the rows q (rows,) to the wanted error of η, with damping or without.

    By harmonic balance where that reaches it with ``most_order`` harmonics; else, and always with damping, refined by
    monodromy matrices from there. Where these do not find to an edge, for so few harmonics begin too far from it, again
    from more. ``error`` of the answer says what was reached.
    """
    result = harmonic_tongues(coefficients, q, count, equation, error, most_order)
    if damping == 0.0 and float(result.error.max(initial=0.0)) <= error:
        return result
    result = refined(coefficients, result, damping)
    lost = np.flatnonzero(np.nanmax(result.error, axis=1, initial=0.0) > max(error, ASTRAY))
    if lost.size and most_order < FARTHEST_ORDER:
        order = min(ONWARDS * most_order, FARTHEST_ORDER)
        return with_rows(result, lost, tongues(coefficients, result.q[lost], count, equation, damping, error, order))
    return result


def refined(coefficients: Coefficients, harmonic: Tongues, damping: float = 0.0) -> Tongues:
    """The same tongues to the accuracy of the monodromy matrices; with damping nan where it has closed them."""
    rows, count = harmonic.edges.shape[:2]
    q, sign = np.repeat(harmonic.q, count), np.tile(np.where(np.arange(count) % 2 == 0, -1.0, 1.0), rows)
    edges = harmonic.edges.reshape(-1, 2).copy()
    error = np.zeros((edges.shape[0], 2))
    pencil = partial(_pencil, coefficients, harmonic.equation, damping)
    if damping:
        middle, half = edges.mean(axis=1), 0.5 * (edges[:, 1] - edges[:, 0])
        at = np.flatnonzero(half > NARROW * damping * middle)
        edges[:] = np.nan
        edges[at] = np.maximum(_open_roots(pencil, middle[at], q[at], sign[at]), 0.0)  # nan stays
    for side in (0, 1):
        at = np.flatnonzero(edges[:, side] > 0.0)
        edges[at, side], error[at, side] = _newton(pencil, edges[at, side], q[at], sign[at], 2.0 * side - 1.0, damping > 0.0)
    _unproven_zeros(coefficients, harmonic, edges, error)
    closed = np.isnan(edges).any(axis=1)
    edges[closed] = error[closed] = np.nan
    shape = (rows, count, 2)
    largest = error.reshape(shape).max(axis=2)
    return replace(harmonic, edges=edges.reshape(shape), error=largest, damping=damping, method=BY_MONODROMY)


def _unproven_zeros(coefficients: Coefficients, harmonic: Tongues, edges: np.ndarray, error: np.ndarray) -> None:
    """An edge stands at 0 where its η² is negative, as the harmonics say. Where these say nothing (``UNKNOWN``) and zeros of
    the solution do not prove it either, its error is theirs: into ``error`` (rows count, 2)."""
    rows, count = harmonic.error.shape
    numbers = np.tile(np.arange(1, count + 1), rows)
    unsure = (edges == 0.0) & (harmonic.error.reshape(-1, 1) > UNKNOWN)
    for row in np.unique(np.flatnonzero(unsure.any(axis=1)) // count):
        proven = numbers + 2 <= zeros_at_standstill(coefficients, float(harmonic.q[row]), harmonic.equation)
        unsure[row * count : (row + 1) * count] &= ~proven[:count, None]
    error[unsure] = np.repeat(harmonic.error.reshape(-1, 1), 2, axis=1)[unsure]


@dataclass(frozen=True, eq=False)
class _Pencil:
    """The two roots δ = middle ± √discriminant (L,) of det(E + δK) = 0, and what rounding makes of them."""

    middle: np.ndarray
    discriminant: np.ndarray
    error: np.ndarray


PencilAt = Callable[[np.ndarray, np.ndarray, np.ndarray], _Pencil]
"""The pencil at η, Q for the multiplier s, each (L,)."""


def _pencil(
    coefficients: Coefficients, equation: str, damping: float, eta: np.ndarray, q: np.ndarray, sign: np.ndarray
) -> _Pencil:
    turn = monodromy(coefficients, eta, q, equation, damping)
    e, k = turn.matrix - sign[:, None, None] * np.eye(2), turn.slope
    across = e[:, 0, 0] * k[:, 1, 1] - e[:, 0, 1] * k[:, 1, 0] - e[:, 1, 0] * k[:, 0, 1] + e[:, 1, 1] * k[:, 0, 0]
    square = determinant(k)
    middle = -0.5 * across / square
    discriminant = middle * middle - determinant(e) / square
    # without damping K is a definite matrix turned by a quarter: it holds both roots as firmly as its smaller eigenvalue
    error = turn.error * size(k, eta) / np.abs(square)
    # where a turn grows a millionfold, det E is the small difference of large products
    rounding = ROUNDING * EPS * (np.abs(e[:, 0, 0] * e[:, 1, 1]) + np.abs(e[:, 0, 1] * e[:, 1, 0])) / np.abs(square)
    error = error + rounding / np.maximum(np.sqrt(np.abs(discriminant) + rounding), 1e-300)
    if damping:  # two roots that meet give way like a square root
        apart = np.sqrt(np.abs(discriminant))
        reach = np.abs(middle) + apart
        error = error * np.maximum(1.0, reach / np.maximum(apart, np.sqrt(error * reach + error**2)))
    return _Pencil(middle, discriminant, error)


def _open_roots(pencil: PencilAt, middle: np.ndarray, q: np.ndarray, sign: np.ndarray) -> np.ndarray:
    """First guesses (L, 2) of the edges with damping, starting in the middle of each tongue; nan where it is closed."""
    eta, at = middle.copy(), np.arange(middle.size)
    out = np.full((eta.size, 2), np.nan)
    for _ in range(STEPS):
        if at.size == 0:
            break
        pair = pencil(eta[at], q[at], sign[at])
        real = pair.discriminant >= 0.0
        centre, half = eta[at] + pair.middle, np.sqrt(np.abs(pair.discriminant))
        out[at[real]] = (centre[:, None] + half[:, None] * (-1.0, 1.0))[real]
        clearly = ~real & (np.abs(pair.middle) <= CLEARLY * half + CLOSE)
        eta[at] += np.clip(pair.middle, -FARTHEST, FARTHEST)
        at = at[~real & ~clearly]
    return out


def _newton(
    pencil: PencilAt, start: np.ndarray, q: np.ndarray, sign: np.ndarray, side: float, damped: bool
) -> tuple[np.ndarray, np.ndarray]:
    """The lower (side -1) or upper (+1) edge near each η (L,), 0 where η² would be negative, nan where there is none; and
    its error."""
    eta, error = start.copy(), np.zeros(start.size)
    last, stuck = np.full(eta.size, np.inf), np.zeros(eta.size, dtype=int)
    at = np.arange(eta.size)
    for _ in range(STEPS):
        if at.size == 0:
            break
        pair = pencil(eta[at], q[at], sign[at])
        step = pair.middle + side * np.sqrt(np.maximum(pair.discriminant, 0.0))
        eta[at] = np.maximum(eta[at] + np.clip(step, -FARTHEST, FARTHEST), 0.0)
        length = np.abs(step)
        # the next step would be the square of this one; where steps wander, its error is not known
        error[at] = pair.error + np.where(length <= CLOSE * (1.0 + eta[at]), step * step, length)
        stuck[at] = np.where(length < 0.5 * last[at], 0, stuck[at] + 1)
        last[at] = length
        done = (length <= CLOSE * (1.0 + eta[at])) | (stuck[at] >= ROUNDS) | (eta[at] == 0.0)
        if damped:
            eta[at[done & (pair.discriminant < -pair.error * (np.abs(pair.middle) + np.sqrt(pair.error)))]] = np.nan
        at = at[~done]
    return eta, error
