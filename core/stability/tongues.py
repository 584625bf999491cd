"""Instability tongues as eigenvalues: all tongues of a row of Q at once, with their own error (Kim1990 §5).

A tongue's edges are the η at which ζ'' + 4π²(η² w + p) ζ = 0 has a solution of one turn (n even) or two (n odd):
[R² - T[p]] a = η² T[w] a, R the harmonics, T[f] multiplication by f. Kim1990 (32) searches the zeros of a determinant,
which overflows at 60 harmonics, on a grid that steps over narrow tongues.

The inverse problem is solved, T[w] a = μ [R² - T[p] + σ T[w]] a with μ = 1/(η² + σ) and each harmonic scaled by its
size:
then rounding does not grow with the order N, while that of η² itself grows like eps N² and from N ≈ 50 on exceeds the
gain
of more harmonics. The harmonics beyond N enter by second-order perturbation of each pair of edges.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.errors import NoStability
from core.frozen import frozen
from core.motion import EPS
from core.number_text import result_text
from core.numerics.lazy import checkpoint
from core.stability.coefficients import (
    CENTRIPETAL,
    EXACT,
    LOAD,
    Basis,
    Coefficients,
    basis,
    fourier,
    inertia_and_pull,
    product,
    toeplitz,
    truncation,
    weight_and_potential,
)

# -- instability tongues as eigenvalues -------------------------------------------------------------------------

ETA_MAX = 5.6  # of a chart, as in Kim1990 Fig. 8
EDGE_ERROR = 1e-9  # target error of an edge η
LEAST_ORDER, MOST_ORDER = 8, 40
SPARE = 6  # harmonics above those of the highest requested tongue
GROWTH = 1.4
ROUNDING = 32.0  # times eps times the condition
SHIFTS = (1.0, 4.0, 16.0, 0.25, 64.0, 0.05, 1e3, 2e4, 4e5)  # tried in this order; a large load needs a large shift


@frozen(eq=False)
class Tongues:
    """Tongues of one equation.

    Attributes
    ----------
    equation : str
        Key of `EQUATIONS`.
    q : ndarray (rows,), dimensionless
    edges : ndarray (rows, n, 2), dimensionless
        Lower and upper η of the tongues 1 ... n, near η ≈ n/2; 0 where η² is negative, NaN where damping closes the
        tongue.
    error : ndarray (rows, n), dimensionless
        Bound of the error of both edges.
    bottom : ndarray (rows,), dimensionless
        Everything is unstable below this η; 0 where it is stable down to η = 0.
    order : int
        Highest harmonic in the matrices.
    damping : float
        Damping ratio ζ.
    method : str
        `harmonic balance`, or how its edges were refined.
    """

    equation: str
    q: np.ndarray
    edges: np.ndarray
    error: np.ndarray
    bottom: np.ndarray
    order: int
    damping: float = 0.0
    method: str = "harmonic balance"

    @property
    def count(self) -> int:
        """Number of tongues."""
        return self.edges.shape[1]


def count_up_to(eta_max: float) -> int:
    """Number of tongues that may reach below an η: one at each half, and one more by its lower edge."""
    return max(1, int(np.floor(2.0 * eta_max + 1e-9)))


def harmonic_tongues(
    coefficients: Coefficients,
    q: np.ndarray,
    count: int,
    equation: str = EXACT,
    error: float = EDGE_ERROR,
    most_order: int = MOST_ORDER,
) -> Tongues:
    """Tongues 1 ... count without damping, with as many harmonics as the target error needs.

    Parameters
    ----------
    coefficients : Coefficients
    q : ndarray (rows,), dimensionless
    count : int
    equation : str
        Key of `EQUATIONS`.
    error : float
        Target error of the edges η.
    most_order : int
        Highest order; with it the `error` of the result may exceed the target.

    Returns
    -------
    Tongues

    References
    ----------
    Kim (1990), §5.
    Kim1990 (21), harmonics.
    """
    q = np.atleast_1d(np.asarray(q, dtype=float))
    order = max(LEAST_ORDER, (count + 1) // 2 + SPARE)
    result = tongues_of_order(coefficients, q, count, order, equation)
    while True:
        poor = np.flatnonzero(result.error.max(axis=1, initial=0.0) > error)
        if poor.size == 0 or order >= most_order:
            return result
        order = min(most_order, int(np.ceil(order * GROWTH)))
        result = with_rows(result, poor, tongues_of_order(coefficients, q[poor], count, order, equation))


def with_rows(all_rows: Tongues, at: np.ndarray, better: Tongues) -> Tongues:
    """Replace some rows by a better result.

    Parameters
    ----------
    all_rows : Tongues
    at : ndarray (k,) of int, dimensionless
        Numbers of the rows.
    better : Tongues
        Result of k rows.

    Returns
    -------
    Tongues
    """
    edges, error, bottom = all_rows.edges.copy(), all_rows.error.copy(), all_rows.bottom.copy()
    edges[at], error[at], bottom[at] = better.edges, better.error, better.bottom
    return replace(better, q=all_rows.q, edges=edges, error=error, bottom=bottom)


def tongues_of_order(
    coefficients: Coefficients, q: np.ndarray, count: int, order: int, equation: str = EXACT
) -> Tongues:
    """Tongues 1 ... count with harmonics up to an order; harmonics up to three times as high enter as a perturbation.

    Parameters
    ----------
    coefficients : Coefficients
    q : ndarray (rows,), dimensionless
    count, order : int
    equation : str
        Key of `EQUATIONS`.

    Returns
    -------
    Tongues

    Raises
    ------
    ValueError
        Where the order is too small for the number of tongues.
    NoStability
        Where the load is stiffer than the shaft.
    """
    q = np.atleast_1d(np.asarray(q, dtype=float))
    if (count + 1) // 2 > order:
        raise ValueError(f"order {order}: {count} tongues need harmonics up to {(count + 1) // 2}")
    w, p = weight_and_potential(coefficients, equation, q)
    panels = coefficients.panels
    reach = 3 * order
    # a harmonic of the outer block times one of the inner
    coefficients_of_both = fourier(panels, np.stack((w, p)), reach + order)
    truncated = truncation(panels, np.stack((w, p)))
    squares = np.empty((q.size, count, 2))
    errors = np.empty((q.size, count))
    bottom = np.zeros(q.size)
    for half in (False, True):
        checkpoint()
        inner, outer = basis(-1, order, half), basis(order, reach, half)
        pairs = count // 2 if not half else (count + 1) // 2
        skip = 0 if half else 1  # the lowest eigenvalue of the integer harmonics has no partner
        eigenvalue_count = 2 * pairs + skip
        if eigenvalue_count == 0:
            continue
        try:
            square, error = _lowest(coefficients_of_both, truncated, inner, outer, eigenvalue_count, skip)
        except np.linalg.LinAlgError:
            raise NoStability(
                f"at Q = {result_text(q.max())} the load is stiffer than the shaft, which does not hold the cam",
                "shaft.stiffness_nm_per_rad",
                "increase it, or decrease Q",
            ) from None
        if not half:
            bottom = np.sqrt(np.maximum(square[:, 0], 0.0))
        at = slice(0, None, 2) if half else slice(1, None, 2)
        squares[:, at] = square[:, skip:].reshape(q.size, pairs, 2)
        errors[:, at] = error[:, skip:].reshape(q.size, pairs, 2).max(axis=2)
    edges = np.sqrt(np.maximum(squares, 0.0))
    # the error of η² becomes that of η, and is η itself where η² may be 0
    lower = np.maximum(edges[..., 0], np.sqrt(errors))
    known = (lower > 0.0) & np.isfinite(errors)
    error = np.where(known, errors / np.where(known, lower, 1.0), errors)
    return Tongues(equation, q, edges, error, bottom, order)


def _lowest(
    fourier_wp: np.ndarray, truncated: np.ndarray, inner: Basis, outer: Basis, count: int, skip: int
) -> tuple[np.ndarray, np.ndarray]:
    """The lowest η² (rows, count) in rising order, and the bounds of their errors.

    The inputs are the Fourier coefficients of w and p (2, rows, order + 1) and the bounds of their errors (2, rows).
    """
    top = float(inner.numbers[-1] if count >= inner.numbers.size else np.sort(inner.numbers)[count - 1])
    tw, tp = product(fourier_wp, inner, inner)
    mu, vectors, shift = _inverted(tw, tp, inner, top)
    # the largest μ are the lowest η²
    mu, vectors = mu[:, : -count - 1 : -1], vectors[:, :, : -count - 1 : -1]
    square = 1.0 / mu - shift
    error = ROUNDING * EPS * (square + shift) ** 2 * np.abs(mu[:, :1])
    error += truncated[1][:, None] + np.abs(square) * truncated[0][:, None]
    square, perturbation_error = _with_outer_harmonics(
        fourier_wp, inner, outer, square, vectors / np.sqrt(mu)[:, None, :], skip
    )
    return square, error + perturbation_error


def _inverted(tw: np.ndarray, tp: np.ndarray, inner: Basis, top: float) -> tuple[np.ndarray, np.ndarray, float]:
    """All μ (rows, n) rising and the vectors (rows, n, n) with aᵀ [R² - T[p] + σ T[w]] a = 1, and σ.

    Raises LinAlgError where no σ makes the matrix in brackets definite.
    """
    square = inner.numbers**2
    shift = max(1.0, 0.25 * top * top)
    for factor in SHIFTS:
        sigma = factor * shift
        scale = 1.0 / np.sqrt(square + sigma)
        pencil = sigma * tw - tp
        pencil[:, range(square.size), range(square.size)] += square
        try:
            lower = np.linalg.cholesky(pencil * (scale[:, None] * scale))
        except np.linalg.LinAlgError:
            continue
        back = np.linalg.inv(lower)
        mu, vectors = np.linalg.eigh(back @ (tw * (scale[:, None] * scale)) @ back.swapaxes(1, 2))
        return mu, scale[:, None] * (back.swapaxes(1, 2) @ vectors), sigma
    raise np.linalg.LinAlgError


def _with_outer_harmonics(
    fourier_wp: np.ndarray, inner: Basis, outer: Basis, square: np.ndarray, vectors: np.ndarray, skip: int
) -> tuple[np.ndarray, np.ndarray]:
    """η² corrected by the harmonics of the outer block, pair by pair, and the bounds of their errors (rows, count).

    λ_ij -> λ_ij - Σ_r ρ_ri ρ_rj / (r² - p_0 - λ w_0), ρ = (T[p] + λ T[w]) a: the outer harmonics couple the two edges
    of a
    narrow tongue, so each pair is diagonalised together.
    """
    count, (cw, cp) = square.shape[1], fourier_wp
    by_w, by_p = product(fourier_wp, outer, inner) @ vectors
    residual = by_p + square[:, None, :] * by_w
    stiff = outer.numbers[:, None] ** 2 - cp.real[:, :1, None] - cw.real[:, :1, None] * square[:, None, :]
    weighted = residual / stiff
    parts = residual * weighted
    corrected, change = square.copy(), np.abs(parts).sum(axis=1)
    shift = parts.sum(axis=1)
    if skip:
        corrected[:, 0] -= shift[:, 0]
    first, second = slice(skip, count, 2), slice(skip + 1, count, 2)
    cross = (residual[..., first] * weighted[..., second]).sum(axis=1)
    a, b = square[:, first] - shift[:, first], square[:, second] - shift[:, second]
    middle, half_distance = 0.5 * (a + b), np.hypot(0.5 * (a - b), cross)
    corrected[:, first], corrected[:, second] = middle - half_distance, middle + half_distance
    # neglected: the coupling of the outer harmonics, and the harmonics above them, which fall like r⁻⁴ or faster
    pull = 2.0 * (np.abs(cp[:, None, 1:]) + np.abs(square[..., None]) * np.abs(cw[:, None, 1:])).sum(axis=2)
    farthest = outer.numbers > 2.0 * outer.numbers.min()
    least = stiff.min(axis=1)
    with np.errstate(divide="ignore"):
        error = change * pull / least + 0.5 * np.abs(parts[:, farthest]).sum(axis=1)
    return corrected, np.where(least > 0.0, error, np.inf)  # infinite where the load exceeds an outer harmonic


# -- the linear forced response ---------------------------------------------------------------------------------

ORDER = 96  # least number of harmonics that are balanced


def forced_response(
    coefficients: Coefficients, eta: float, q: float, damping: float = 0.0, equation: str = EXACT, highest: int = 24
) -> np.ndarray:
    """Fourier coefficients of the linear forced response β by the angle of the input.

    κ = C' has a delta function where C jumps: its coefficients are ik times those of C.

    Parameters
    ----------
    coefficients : Coefficients
    eta, q, damping : float
    equation : str
        Key of `EQUATIONS`.
    highest : int
        Highest harmonic of the result.

    Returns
    -------
    ndarray (highest + 1,) complex [turns]
        c_0 ... c_highest; c_-k is the conjugate. NaN where η is on the edge of a tongue, so that the response is
        unbounded.

    References
    ----------
    Kim (1990), eq. (27) with γ = 0.
    """
    order = max(ORDER, 4 * highest)
    load = eta * eta if coefficients.fixed else 1.0
    inertia, pull, slope = inertia_and_pull(coefficients, equation, np.array([q]))
    rows = coefficients.panels.values
    push = q * (rows[CENTRIPETAL] + load * rows[LOAD])
    d, c, psi, right = fourier(coefficients.panels, np.concatenate((inertia, pull, slope, push[None])), 2 * order)
    r = np.arange(-order, order + 1)
    turning = load * psi + 1j * np.arange(c.size) * c
    matrix = toeplitz(turning, r.size) - r[:, None] * toeplitz(d, r.size) * r
    matrix += np.diag(eta * eta + 2j * damping * eta * r)
    right = right[: order + 1]
    try:
        response = np.linalg.solve(matrix, np.concatenate((right[:0:-1].conj(), right)) / (2.0 * np.pi))
    except np.linalg.LinAlgError:
        return np.full(highest + 1, np.nan + 0j)
    return np.asarray(response[order : order + highest + 1])
